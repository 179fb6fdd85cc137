"""StandingSolver: the solver, which keeps how each body stands on the ground."""

import threading
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from studio.core.body.morphology import AnyMorphology
from studio.core.constraints.target import own_places_of
from studio.core.grounds.ground import Ground
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.request import AdaptedMotion, AdaptRequest

if TYPE_CHECKING:
    from studio.core.solver.standing.stand import Standing

KEPT_STANDING = 16

Body = tuple[NormalizedMotion, AnyMorphology]
"""Motion and body of a grounding."""
Windows = tuple[tuple[int, int], ...]
"""First frames and those past the last."""


class StandingSolver:
    """The solver; it keeps how each body stands on the ground, so that a dragged target asks only for the rest.

    Asked for some frames it puts only the arms right that these have to do with: the rest of a body that is dragged
    is not seen. Such a body is another one in every picture and takes the place of no body that stands wholly. With a
    ground that goes up or down bodies go along as they stand. What is kept, and the answers, take half the memory that
    solving takes. Any thread may call it.
    """

    def __init__(self) -> None:
        self._whole: dict[Body, Kept] = {}
        self._partly: dict[Body, Kept] = {}
        self._lock = threading.Lock()

    def __call__(self, request: AdaptRequest, first: int, last: int | None) -> AdaptedMotion:
        from studio.core.solver.adapt import grounded, solve

        standing = self._standing(request, None if last is None else ((first, last + 1), *own_frames(request)))
        return solve(grounded(request, standing), request, first, last).kept()

    def forget(self) -> None:
        """Let go of all that is kept."""
        with self._lock:
            self._whole.clear()
            self._partly.clear()

    def _standing(self, request: AdaptRequest, windows: Windows | None) -> "Standing":
        """Grounded motion of ``request``, in some ``windows`` at least."""
        from studio.core.solver.standing.lifted import lifted
        from studio.core.solver.standing.stand import standing_of

        body, on = (request.motion, request.morphology), GroundingKey.of(request)
        whole, partly = self._whole.get(body), self._partly.get(body)
        if whole is not None and whole.on == on:
            return whole.standing
        if windows is not None and partly is not None and (partly.on, partly.windows) == (on, windows):
            return partly.standing
        if whole is not None and whole.on.at_height(on.ground.height) == on:
            standing = lifted(whole.standing, on.ground.height)
        else:
            wanted = None if windows is None else [slice(*each) for each in windows]
            standing = standing_of(request, wanted).kept()
        with self._lock:
            if windows is None:
                self._partly.clear()  # the hand rests
            held = self._whole if windows is None else self._partly
            while len(held) >= KEPT_STANDING:
                held.pop(next(iter(held)))
            held[body] = Kept(on, windows, standing)
        return standing


@dataclass(frozen=True)
class GroundingKey:
    """All of a request that a standing depends on, but for motion and body."""

    ground: Ground
    rest: tuple[object, ...]

    @staticmethod
    def of(request: AdaptRequest) -> "GroundingKey":
        bound = request.limited, request.clears
        return GroundingKey(request.ground, (request.contacts, request.volume, request.actor, *bound))

    def at_height(self, height: float) -> "GroundingKey":
        """The same with its ground higher or lower."""
        return replace(self, ground=self.ground.at_height(height))


@dataclass(frozen=True, eq=False)
class Kept:
    """Grounded motion of a body, in some ``windows`` or, None, in all frames."""

    on: GroundingKey
    windows: Windows | None
    standing: "Standing"


def own_frames(request: AdaptRequest) -> Windows:
    """The frames, first and past the last, that the body's own places are of which constraints ask."""
    rate, last = request.motion.frame_rate, request.motion.frame_count - 1
    places = (place for each in request.constraints for place in own_places_of(each))
    rows = sorted({min(max(round(place.time * rate), 0), last) for place in places})
    return tuple((row, row + 1) for row in rows)
