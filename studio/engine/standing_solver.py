"""StandingSolver: the solver, which keeps how each body stands on the ground."""

import threading
from typing import TYPE_CHECKING

from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.target import own_places_of
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest

if TYPE_CHECKING:
    from studio.core.solver.adapt import Standing

KEPT_STANDING = 16

Windows = tuple[tuple[int, int], ...]
"""First frames and those past the last."""


class StandingSolver:
    """The solver; it keeps how each body stands on the ground, so that a dragged target asks only for the rest.

    Asked for some frames it puts only the arms right that these have to do with: the rest of a body that is dragged
    is not seen. What it keeps, and its answers, take half the memory that solving takes. Any thread may call it.
    """

    def __init__(self) -> None:
        self._kept: dict[tuple[NormalizedMotion, AnyMorphology], tuple[object, Windows, Standing]] = {}
        self._lock = threading.Lock()

    def __call__(self, request: AdaptRequest, first: int, last: int | None) -> AdaptedMotion:
        from studio.core.solver.adapt import hold, stand_but_for_arms

        key, count = (request.motion, request.morphology), request.motion.frame_count
        ground = (
            *(request.contacts, request.ground, request.volume, request.actor),
            *(request.limited, request.clears),
        )
        whole: Windows = ((0, count),)
        windows = whole if last is None else ((first, last + 1), *own_frames(request))
        kept = self._kept.get(key)
        if kept is None or kept[0] != ground or kept[1] not in (whole, windows):
            standing = stand_but_for_arms(request).with_arms_right([slice(*each) for each in windows])
            kept = ground, windows, standing.kept()
            with self._lock:
                while len(self._kept) >= KEPT_STANDING:
                    self._kept.pop(next(iter(self._kept)))
                self._kept[key] = kept
        return hold(kept[2], request.constraints, first, last, request.tracks, eased=request.eased).kept()

    def forget(self) -> None:
        """Let go of all that is kept."""
        with self._lock:
            self._kept.clear()


def own_frames(request: AdaptRequest) -> Windows:
    """The frames, first and past the last, that the body's own places are of which constraints ask."""
    rate, last = request.motion.frame_rate, request.motion.frame_count - 1
    places = (place for each in request.constraints for place in own_places_of(each))
    rows = sorted({min(max(round(place.time * rate), 0), last) for place in places})
    return tuple((row, row + 1) for row in rows)
