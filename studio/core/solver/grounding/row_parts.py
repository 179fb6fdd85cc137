"""Parts of a performer's motion that are grounded separately, and joined again: from one transition to the next."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING

import numpy as np

from studio.core.body.morphology import AnimatedMorphology
from studio.core.solver.grounding.footing import Footing, foot_contacts
from studio.core.solver.request import AdaptRequest

if TYPE_CHECKING:
    from studio.core.solver.grounding.grounded_motion import GroundedMotion


def parts_of(request: AdaptRequest) -> list[tuple[slice, AdaptRequest]]:
    """(frames, request) of each part between transitions, as a motion of its own."""
    if not request.motion.changes:
        return [(slice(0, request.motion.frame_count), request)]
    return [(frames, _part(request, frames)) for frames in request.motion.parts]


def windows_in(frames: slice, count: int, windows: Sequence[slice] | None) -> list[slice]:
    """``windows`` within the ``frames`` of a part, relative to its beginning, with its ends, which transitions read.

    ``count`` is the number of frames of the whole motion.
    """
    last = frames.stop - frames.start
    if windows is None:
        return [slice(0, last)]
    within = [slice(max(each.start - frames.start, 0), min(each.stop - frames.start, last)) for each in windows]
    begins = [slice(0, min(2, last))] if frames.start > 0 else []
    ends = [slice(max(last - 2, 0), last)] if frames.stop < count else []
    return [*(each for each in within if each.stop > each.start), *begins, *ends]


def _part(request: AdaptRequest, frames: slice) -> AdaptRequest:
    """Request for the ``frames`` of a part alone."""
    body, last = request.morphology, frames.stop - frames.start - 1
    return replace(
        request,
        motion=replace(request.motion, channels=request.motion.channels[frames], changes=()),
        morphology=AnimatedMorphology(body.rows[frames]) if isinstance(body, AnimatedMorphology) else body,
        contacts=tuple(
            replace(each, first=max(each.first - frames.start, 0), last=min(each.last - frames.start, last))
            for each in request.contacts
            if each.last >= frames.start and each.first < frames.stop
        ),
    )


def join_parts(request: AdaptRequest, parts: Sequence["GroundedMotion"]) -> "GroundedMotion":
    """Grounded motion of the whole ``request`` from its ``parts``, one after the other in time."""
    if len(parts) == 1:
        return parts[0]
    footings = [each.footing for each in parts]
    footing = Footing(
        *(
            np.concatenate([getattr(each, field.name)[:] for each in footings], axis=0 if field.name == "drops" else 1)
            for field in fields(Footing)
        )
    )
    return replace(
        parts[0],
        motion=replace(request.motion, channels=np.concatenate([each.motion.channels for each in parts])),
        morphology=request.morphology,
        contacts=foot_contacts(footing.states),
        ground=next((each.ground for each in parts if not each.ground.is_level), parts[0].ground),
        footing=footing,
        positions=np.concatenate([each.positions[:] for each in parts]),
        rotations=np.concatenate([each.rotations[:] for each in parts]),
    )
