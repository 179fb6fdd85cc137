"""Solver with a cache of grounded motions."""

import threading
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.target import own_places_of
from studio.core.grounds.ground import Ground
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.engine.paged_array import paged_rows

if TYPE_CHECKING:
    from studio.core.solver.grounding.grounded_motion import GroundedMotion

MAX_CACHED_GROUNDINGS = 16

Body = tuple[NormalizedMotion, AnyMorphology]
"""Motion and body that are grounded."""
Windows = tuple[tuple[int, int], ...]
"""First frame and frame past the last one, of each window."""


class GroundingSolver:
    """Solver that caches the grounded motion of each body, so that a dragged target needs only the rest of the
    solve.

    For a request of some frames, self-contacts are solved only around them; such a result is replaced by that of the
    next image, and never replaces a complete one. If only the height of the ground changes, cached motions are
    translated. Cached values take half of the memory of a solve. Any thread may call the solver.
    """

    def __init__(self) -> None:
        self._whole: dict[Body, CachedGrounding] = {}
        self._partly: dict[Body, CachedGrounding] = {}
        self._lock = threading.Lock()

    def __call__(self, request: AdaptRequest, first: int, last: int | None) -> AdaptedMotion:
        from studio.core.solver.adapt import grounded_motion, solve_request

        standing = self._standing(request, None if last is None else ((first, last + 1), *own_frames(request)))
        return solve_request(grounded_motion(request, standing), request, first, last).kept(paged_rows)

    def forget(self) -> None:
        """Empty the cache."""
        with self._lock:
            self._whole.clear()
            self._partly.clear()

    def _standing(self, request: AdaptRequest, windows: Windows | None) -> "GroundedMotion":
        """Grounded motion of ``request``, at least in the given ``windows``; None for all frames."""
        from studio.core.solver.grounding.grounded_motion import grounded_motion_of
        from studio.core.solver.grounding.moved_ground import moved_to_height

        body, on = (request.motion, request.morphology), GroundingKey.of(request)
        whole, partly = self._whole.get(body), self._partly.get(body)
        if whole is not None and whole.on == on:
            return whole.standing
        if windows is not None and partly is not None and (partly.on, partly.solved_windows) == (on, windows):
            return partly.standing
        if whole is not None and whole.on.at_height(on.ground.height) == on:
            standing = moved_to_height(whole.standing, on.ground.height)
        else:
            wanted = None if windows is None else [slice(*each) for each in windows]
            standing = grounded_motion_of(request, wanted).kept(paged_rows)
        with self._lock:
            if windows is None:
                self._partly.clear()  # the hand rests
            held = self._whole if windows is None else self._partly
            while len(held) >= MAX_CACHED_GROUNDINGS:
                held.pop(next(iter(held)))
            held[body] = CachedGrounding(on, windows, standing)
        return standing


@dataclass(frozen=True)
class GroundingKey:
    """Part of a request on which its grounded motion depends, apart from motion and body."""

    ground: Ground
    rest: tuple[object, ...]

    @staticmethod
    def of(request: AdaptRequest) -> "GroundingKey":
        bound = request.limited, request.clears
        return GroundingKey(request.ground, (request.contacts, request.volume, request.actor, *bound))

    def at_height(self, height: float) -> "GroundingKey":
        """Copy with another ground height in metres."""
        return replace(self, ground=self.ground.at_height(height))


@dataclass(frozen=True, eq=False)
class CachedGrounding:
    """Grounded motion of a body, solved in ``solved_windows`` or, if None, in all frames."""

    on: GroundingKey
    solved_windows: Windows | None
    standing: "GroundedMotion"


def own_frames(request: AdaptRequest) -> Windows:
    """Windows (first frame and frame past the last one) of the frames at the reference times of per-character
    targets.
    """
    rate, last = request.motion.frame_rate, request.motion.frame_count - 1
    places = (place for each in request.constraints for place in own_places_of(each))
    rows = sorted({min(max(round(place.time * rate), 0), last) for place in places})
    return tuple((row, row + 1) for row in rows)
