"""A standing motion led on from where a body was: what was decided as it plays takes over without a jump.

A motion on the ground looks ahead: where a foot stands, how low hips are and how arms keep clear has to do with what
comes. So the motion that takes over has the body a little elsewhere at the change than the one that played. What is
different there dies away as in ``normalized.transition``; a foot that stands stays where it stands until it is lifted.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.kernels.adapt import place_frames
from studio.core.kernels.support.sole import HEEL
from studio.core.normalized.transition import pace_left, place_left
from studio.core.solver.standing.blends import GOES_ALONG
from studio.core.solver.standing.stand import legs_of
from studio.core.solver.standing.swing import HURRIED

if TYPE_CHECKING:
    from studio.core.solver.standing.stand import Standing

FloatArray = NDArray[np.float64]

HALTING = 0.25
"""Seconds in which a speed that is different dies away; a place takes ``GOES_ALONG``."""


@dataclass(frozen=True, eq=False)
class Stance:
    """A body in two frames, the last ones that were seen, before anything is asked of it.

    ``positions`` (2, P, 3), ``rotations`` (2, S, 3, 3); ``ankles`` (2, 2, 3), ``feet`` and ``toes`` (2, 2, 3, 3) of
    each side in each frame.
    """

    positions: FloatArray
    rotations: FloatArray
    ankles: FloatArray
    feet: FloatArray
    toes: FloatArray

    @classmethod
    def of(cls, standing: "Standing", frames: NDArray[np.int64]) -> "Stance":
        """In the last two of ``frames``."""
        rows, footing = frames[-2:], standing.footing
        legs = footing.ankles[:, rows, :3], footing.feet[:, rows], footing.toes[:, rows]
        return cls(standing.positions[rows], standing.rotations[rows], *legs)


def led_from(standing: "Standing", first: int, seen: Stance) -> "Standing":
    """``standing`` from frame ``first`` on led from the body as it was ``seen`` until then."""
    footing, count = standing.footing, standing.motion.frame_count
    times = np.arange(1, count - first + 1) / standing.motion.frame_rate
    change = _Change(standing, first, times, Stance.of(standing, np.arange(first - 2, first)), seen)
    positions, rotations = standing.positions[:].copy(), standing.rotations[:].copy()
    ankles, feet, toes = footing.ankles.copy(), footing.feet[:].copy(), footing.toes[:].copy()
    asides = []
    for side in range(2):
        aside, ankles[side, first:, :3], feet[side, first:], toes[side, first:] = change.foot(side)
        asides.append(aside)
    goes = np.mean(asides, axis=0)
    goes += change.left(seen.positions[:, 0] - change.own.positions[:, 0] - goes[0])
    change.lead_body(goes, positions, rotations)
    led = replace(footing, ankles=ankles, feet=feet, toes=toes)
    legs = legs_of(led, standing.motion, slice(None))
    place_frames(standing.morphology.rows, np.zeros(count), legs, positions, rotations)
    return replace(standing, footing=led, positions=positions, rotations=rotations)


@dataclass(frozen=True, eq=False)
class _Change:
    """``standing`` takes over at ``first``; ``times`` (F,) seconds after what was seen last, where it is at its
    ``own``, and was ``seen``.
    """

    standing: "Standing"
    first: int
    times: FloatArray
    own: Stance
    seen: Stance

    @property
    def rate(self) -> float:
        return self.standing.motion.frame_rate

    def left(self, gaps: FloatArray, seconds: float = GOES_ALONG) -> FloatArray:
        """(F, N) what is left of ``gaps`` (2, N), the last two that were seen."""
        speed, halting = (gaps[1] - gaps[0]) * self.rate, min(HALTING, seconds)
        place, pace = place_left(self.times, seconds), pace_left(self.times, halting)
        return np.asarray(place[:, None] * gaps[1] + pace[:, None] * speed)

    def foot(self, side: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """How far a foot is aside over the ground (F, 3), and its ankles, feet and toes.

        It is turned about its ball or, while that does not stand, about its heel.
        """
        footing, first, own, seen = self.standing.footing, self.first, self.own, self.seen
        pivot = self._pivot(side)
        places = footing.ankles[side, first:, :3] + footing.feet[side, first:] @ pivot
        gaps = seen.ankles[side] + seen.feet[side] @ pivot - own.ankles[side] - own.feet[side] @ pivot
        turns, bends = _gaps(own.feet[side], seen.feet[side]), _gaps(own.toes[side], seen.toes[side])
        lifted, seconds = _flight(footing.states[side, first - 1 :] != 0, self.rate)
        off, of_foot, of_toes = (self.left(each, GOES_ALONG if lifted else seconds) for each in (gaps, turns, bends))
        if lifted:
            kept = place_left(self.times - lifted / self.rate, seconds)
            off[:, :2] = kept[:, None] * gaps[1, :2]
            of_foot[:, 2] = of_toes[:, 2] = kept * turns[1, 2]
        feet, toes = _turn(of_foot, footing.feet[side, first:]), _turn(of_toes, footing.toes[side, first:])
        return off * [1.0, 1.0, 0.0], places + off - feet @ pivot, feet, toes

    def _pivot(self, side: int) -> FloatArray:
        """(3,) in the foot's axes, from its ankle."""
        body, state = self.standing.morphology.still, self.standing.footing.states[side, self.first - 1]
        if state == HEEL:
            return np.array([-body.heel_length[side], 0.0, -body.ankle_height[side]])
        return np.asarray(body.foot[side])

    def lead_body(self, goes: FloatArray, positions: FloatArray, rotations: FloatArray) -> None:
        """Root by ``goes`` (F, 3), trunk, head and arms joint by joint, in place; legs are put later."""
        layout, own, seen = self.standing.morphology.layout, self.own.rotations, self.seen.rotations
        parents, proximal = layout.parent_segments(), layout.proximal_points()
        near = slice(self.first, self.first + int(np.searchsorted(self.times, GOES_ALONG, "right")) + 1)
        led = _Led(positions[near].copy(), rotations[near].copy(), positions[near], rotations[near])
        count = len(led.places)
        led.places[:, 0] += goes[:count]
        led.turns[:, 0] = self._turned(led.old_turns[:, 0], own[:, 0], seen[:, 0])
        for segment in range(1, layout.spine_count + 10):
            carrier = parents[segment]
            led.carry(proximal[segment], carrier, proximal[carrier])
            local = (_local(each, carrier, segment) for each in (led.old_turns, own, seen))
            led.turns[:, segment] = led.turns[:, carrier] @ self._turned(*local)
        hands = ((layout.wrist(side) + 1, layout.spine_count + 5 + 4 * side) for side in range(2))
        for end, segment in ((layout.head_end, layout.spine_count + 1), *hands):
            led.carry(end, segment, proximal[segment])
        positions[near.stop :] += goes[count:, None]

    def _turned(self, turns: FloatArray, own: FloatArray, seen: FloatArray) -> FloatArray:
        """``turns`` (N, 3, 3) led from how they were ``seen`` (2, 3, 3)."""
        return _turn(self.left(_gaps(own, seen))[: len(turns)], turns)


@dataclass(frozen=True, eq=False)
class _Led:
    """Frames of a body as they were, and as they are led, which are written."""

    old_places: FloatArray
    old_turns: FloatArray
    places: FloatArray
    turns: FloatArray

    def carry(self, point: int, segment: int, origin: int) -> None:
        """A point goes with the segment that carries it and turns about ``origin``."""
        arm = self.old_places[:, point] - self.old_places[:, origin]
        turn = self.turns[:, segment] @ np.swapaxes(self.old_turns[:, segment], 1, 2)
        self.places[:, point] = self.places[:, origin] + (turn @ arm[:, :, None])[:, :, 0]


def _flight(stands: NDArray[np.bool_], rate: float) -> tuple[int, float]:
    """After how many frames a foot that ``stands`` (1 + F,) is lifted, 0 for one in the air, and its seconds until it
    is where the motion has it: before it stands again.
    """
    changes = np.flatnonzero(np.diff(stands)) + 1
    ends = [*changes.tolist(), len(stands), len(stands), len(stands)]
    at = int(bool(stands[0]))
    if not stands[0] and ends[0] / rate < HURRIED:
        at = 2
    lifted = ends[at - 1] if at else 0
    return lifted, min(GOES_ALONG, max(ends[at] - 1 - lifted, 2) / rate)


def _local(turns: FloatArray, carrier: int, segment: int) -> FloatArray:
    """(N, 3, 3) a segment in the axes of its carrier."""
    return np.asarray(np.swapaxes(turns[:, carrier], 1, 2) @ turns[:, segment])


def _gaps(own: FloatArray, seen: FloatArray) -> FloatArray:
    """(2, 3) rotation vectors from ``own`` turns (2, 3, 3) to how they were ``seen``."""
    return np.asarray(Rotation.from_matrix(seen @ np.swapaxes(own, 1, 2)).as_rotvec())


def _turn(vectors: FloatArray, turns: FloatArray) -> FloatArray:
    """``turns`` (F, 3, 3), turned further by rotation ``vectors`` (F, 3)."""
    return np.asarray(Rotation.from_rotvec(vectors).as_matrix() @ turns)
