"""Edit that makes a found strike a clip and a constraint of a performer: one undo step."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from studio.app.capture_import import ReadMotion, add_motion
from studio.app.strike_target import StrikeTarget
from studio.app.workbench import Workbench
from studio.core.captures.capture import Capture
from studio.core.constraints.target import Place
from studio.core.errors import StudioError
from studio.core.mesh.hand_shapes import FIST_GRIP
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clip_halves, frame_at
from studio.core.stage.placement import Placement
from studio.core.stage.project import Performer, Project, new_id, new_ids
from studio.document.clip_edits import MOST_PARTS, ask_also
from studio.document.edited_project import EditedProject

# Here and below: what searches loads the solver, which takes longer than a window.
if TYPE_CHECKING:
    from studio.core.body.morphology import Morphology
    from studio.core.normalized.motion import NormalizedMotion
    from studio.library.searching import Result

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class StrikeRequest:
    """Request to play a found strike: performer, start in seconds of the stage, and target.

    ``frozen`` (3,) is the position of the target on the stage at the request; with None the blow follows it.
    """

    found: "Result"
    performer_id: str
    time: float
    target: StrikeTarget
    frozen: FloatArray | None


def _known_capture(project: Project, capture: Capture) -> str | None:
    """Capture of the project with the same frames and a motion, whether imported or loaded."""
    performed = {motion.capture_id for motion in project.motions.values()}
    for key, each in project.captures.items():
        same = each.skeleton.names == capture.skeleton.names and each.frame_rate == capture.frame_rate
        if key in performed and same and np.array_equal(each.poses.local_rotations, capture.poses.local_rotations):
            return key
    return None


def put_strike(bench: Workbench, wish: StrikeRequest, source: ReadMotion | str) -> None:
    """Let the performer play the strike; ``source`` is its capture as read, or the id of one in the project.

    Raises StudioError, and changes nothing, if the body or target is missing.
    """
    from studio.library.clip_labels import Kind
    from studio.library.striking import EASED_IN, aimed_constraint

    document, found, key = bench.document, wish.found, wish.performer_id
    project = document.project
    if key not in project.performers or project.get(wish.target.collection, wish.target.id) is None:
        raise StudioError("The character or the target no longer exists. Search again.")
    motions = _motions_of(bench, key)
    if wish.frozen is not None and not {clip.motion_id for clip in project.performers[key].clips} <= motions.keys():
        raise StudioError(f"{project.performers[key].name} is still being solved. Try again in a moment.")
    text = f"Strike {wish.target.name(project)}"
    with document.group(text):
        known = _known_capture(project, source.capture) if isinstance(source, ReadMotion) else source
        if known is not None:
            capture_id = known
        elif isinstance(source, ReadMotion):
            capture_id = add_motion(document, source, text)
            bench.sources[capture_id] = Path(found.clip.take.path)
        entries = document.project.motions.items()
        motion_id = next(each for each, motion in entries if motion.capture_id == capture_id)
        performer = document.project.performers[key]
        ease = EASED_IN * found.seconds_to_hit
        label = found.clip.label
        grip = FIST_GRIP if label.kind is Kind.PUNCH else None
        clip = Clip(motion_id, found.start, label.last, wish.time, id=new_id(), ease=ease, grip=grip)
        rates = {each.motion_id: document.project.frame_rate_of(each) for each in performer.clips}
        kept = clips_until(performer, wish.time, rates)
        document.replace("performers", key, replace(performer, clips=(*kept, clip)), text)
        ask_parts(document, performer, kept, text)
        body = document.project.characters[performer.character_id].morphology
        target: Place = wish.target.follow
        if wish.frozen is not None:
            space = space_of_last_frame(document.project, key, {**motions, motion_id: found.clip.take.motion}, body)
            x, y, z = space.to_motion(wish.frozen).tolist()
            target = (x, y, z)
        document.add("constraints", aimed_constraint(found, clip, target, body), text)
    document.selection.set(("performers", key), ("clips", clip.id))


def _motions_of(bench: Workbench, performer_id: str) -> dict[str, "NormalizedMotion"]:
    """Ids of the motions in a performer's row."""
    adapted = bench.live.result(performer_id)
    clips = bench.document.project.performers[performer_id].clips
    played = adapted.composite.played if adapted is not None and adapted.composite is not None else ()
    return {clips[each.piece.origin[0]].motion_id: each.piece.motion for each in played}


def space_of_last_frame(
    project: Project, performer_id: str, motions: Mapping[str, "NormalizedMotion"], body: "Morphology"
) -> Placement:
    """Placement on the stage of the motion of a performer's last clip, joined to the clip before."""
    from studio.core.solver.performers.rows import composite_of

    last = composite_of(project, performer_id, motions.__getitem__).played[-1].placement
    x, y = last.offset
    inner = Placement((body.leg_length * x, body.leg_length * y), last.turn)
    return Placement.of(project.performers[performer_id]).compose(inner)


def clips_until(performer: Performer, time: float, frame_rates: Mapping[str, float]) -> tuple[Clip, ...]:
    """Clips of a performer before ``time`` in seconds; later parts are cut off.

    A loop that is cut in its middle becomes a clip of its own, with a new id, after the whole ones.
    """
    kept: list[Clip] = []
    for clip in performer.clips:
        rate, names = frame_rates[clip.motion_id], new_ids(MOST_PARTS)
        if clip.start >= time:
            continue
        length = clip.length(rate)
        frame = length / max(clip.repeats * (clip.last - clip.first), 1)
        if clip.start + length <= time + frame:
            kept.append(clip)
        elif clip.repeats > 1 and clip.start + frame <= time:
            kept += [each for each in clip_halves(clip, rate, time, iter(names)) if each.start < time - frame / 2]
        else:
            kept.append(replace(clip, repeats=1, last=int(frame_at(clip, rate, time))))
    return tuple(kept)


def ask_parts(document: EditedProject, before: Performer, clips: Sequence[Clip], text: str) -> None:
    """Copy constraints and contacts of the clips ``before`` to the parts of them among ``clips``, which follow them."""
    known, whole = {clip.id for clip in before.clips}, ""
    for clip in clips:
        if clip.id in known:
            whole = clip.id
        else:
            ask_also(document, whole, clip.id, text)
