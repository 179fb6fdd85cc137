"""A foot during an inertialised transition: it keeps its previous contact until it is lifted.

Heel and toes in contact in both motions do not move at all. The rest, such as a heel that is raised in one of them,
blends from the previous pose to the own pose.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.kernels.support.sole import HEEL_PAD_FRACTION, HEEL_STANDS
from studio.core.normalized.differences import rotation_vectors
from studio.core.normalized.transition import (
    MOST_TRANSITION_SECONDS,
    remaining_offset_fraction,
    remaining_speed_offset,
    speed_decay_times,
)
from studio.core.rotations import from_matrix, sign_continuous
from studio.core.runs import runs_of
from studio.core.solver.standing.stepping import FootFlight

FloatArray = NDArray[np.float64]
States = NDArray[np.int64]


FLOWN = 0.3
"""Saturation in metres of the distance over which a lifted foot keeps its contact rotation."""
FLAT_TOE = 1e-3
"""Downward pitch in radians up to which toes lie flat."""


class Pivot(NamedTuple):
    """Contact point of a foot: ``in_foot`` (3,) metres from the ankle in the foot's axes, then ``in_toes`` (3,) in
    those of its toes, and ``ahead`` metres along the foot's level heading.
    """

    in_foot: FloatArray
    in_toes: FloatArray
    ahead: float = 0.0

    def offsets(self, feet: FloatArray, toes: FloatArray) -> FloatArray:
        """Vectors (..., 3) from the ankle in the world, for rotations (..., 3, 3) of foot and toes."""
        headings = feet[..., 0] * [1.0, 1.0, 0.0]
        headings /= np.maximum(np.linalg.norm(headings, axis=-1, keepdims=True), 1e-9)
        return np.asarray(feet @ self.in_foot + toes @ self.in_toes + self.ahead * headings)


def heel_pivot(measures: FloatArray) -> Pivot:
    """Pivot of a foot that stands on its heel alone: the middle of its pad, at the height of its lower edge.

    ``measures`` (1, 6) as in ``sole_arms``.
    """
    heel, *_ = sole_arms(measures)
    return Pivot(heel[0], np.zeros(3), -HEEL_PAD_FRACTION * float(heel[0, 0]))


def toe_pivot(measures: FloatArray, *toes: FloatArray) -> Pivot:
    """Pivot of a foot that stands on its toes: their tip if any of the rotations ``toes`` (3, 3) points down, else the
    sole below the ball.
    """
    _, joint, thickness, tip = sole_arms(measures)
    return Pivot(joint[0], tip[0] if min(each[2, 0] for each in toes) < -FLAT_TOE else -thickness[0])


class SoleArms(NamedTuple):
    """Vectors (F or 1, 3) from the ankle to the ``heel`` and the toe ``joint``, the sole's ``thickness``, and from the
    joint to the ``tip``.
    """

    heel: FloatArray
    joint: FloatArray
    thickness: FloatArray
    tip: FloatArray


def sole_arms(measures: FloatArray) -> SoleArms:
    """Vectors of a foot of ``measures`` (F or 1, 6) as in ``morphology.sole_rows``."""
    arms = SoleArms(*np.zeros((4, len(measures), 3)))
    down, height = measures[:, 2], measures[:, 3]
    arms.heel[:, 0], arms.heel[:, 2] = -measures[:, 4], -height
    arms.joint[:] = measures[:, :3]
    arms.thickness[:, 2] = height + down
    arms.tip[:, 0], arms.tip[:, 2] = measures[:, 5], -height - down
    return arms


@dataclass(frozen=True, eq=False)
class FootPath:
    """Path of one foot: ``ankles`` (F, 3), ``feet`` and ``toes`` (F, 3, 3) in frames of equal length."""

    ankles: FloatArray
    feet: FloatArray
    toes: FloatArray

    def places(self, pivot: Pivot) -> FloatArray:
        """Positions (F, 3) of a pivot of the foot."""
        return np.asarray(self.ankles + pivot.offsets(self.feet, self.toes))


@dataclass(frozen=True, eq=False)
class HeldFoot:
    """Foot with its ``own`` path from the transition on and ``states`` (F,), and its previous path ``seen`` in the two
    frames before, with ``state``. ``measures`` (1, 6) as in ``sole_arms``; ``peaks`` (2,) in rad/s2 of foot and
    toes.
    """

    own: FootPath
    states: States
    seen: FootPath
    state: int
    measures: FloatArray
    peaks: FloatArray
    rate: float

    @cached_property
    def _whole(self) -> NDArray[np.bool_]:
        """(F,) true where its own contact includes all of the previous one."""
        return np.asarray((self.states & self.state) == self.state)

    @cached_property
    def rest(self) -> int:
        """First such frame; 0 if it comes late, or after a flight."""
        rests = int(self._whole.argmax())
        soon = self._whole.any() and 2.0 * rests <= MOST_TRANSITION_SECONDS * self.rate
        return rests if soon and self.states[:rests].all() else 0

    @cached_property
    def pivot(self) -> Pivot:
        """Pivot of the contact: the heel if that alone stands, else the ball or the tip of the toes."""
        if self.states[self.rest] & self.state == HEEL_STANDS:
            return heel_pivot(self.measures)
        return toe_pivot(self.measures, self.seen.toes[1], self.own.toes[self.rest])

    @cached_property
    def aside(self) -> FloatArray:
        """Offset (3,) in metres from its own resting position to the previous one."""
        return np.asarray(self.seen.places(self.pivot)[1] - self.own.places(self.pivot)[self.rest])

    def asides(self, flight: FootFlight) -> FloatArray:
        """Offsets (F, 3) during the contact: the pivot moves where it rolls, rotated with the foot."""
        rolled = self.own.places(self.pivot) - self._came_down(flight.leaves)
        last = min(flight.leaves, len(rolled) - 1)
        flown = rolled[last:] - rolled[last]
        flown /= (1.0 + (np.linalg.norm(flown, axis=1, keepdims=True) / FLOWN) ** 4) ** 0.25
        rolled[last:] = rolled[last] + flown
        return np.asarray(self.aside + Rotation.from_rotvec([0.0, 0.0, self.heading]).apply(rolled) - rolled)

    def _came_down(self, until: int) -> FloatArray:
        """Own position (F, 3) of the pivot at the last landing before frame ``until``; interpolated in the air."""
        places = self.own.places(self.pivot)
        there = np.tile(places[self.rest], (len(places), 1))
        for leaves, lands in runs_of(self.states == 0):
            if self.rest < leaves and lands < until:
                going = np.arange(1, lands - leaves + 1) / (lands - leaves)
                displacement = places[lands] - there[leaves]
                there[leaves:lands] += (1.0 - remaining_offset_fraction(going, 1.0))[:, None] * displacement
                there[lands:] += displacement
        return there

    @cached_property
    def heading(self) -> float:
        """Angle in radians about Z from its own resting heading to the previous one."""
        return float(turns_between(self.own.feet[self.rest : self.rest + 1], self.seen.feet[1:])[0, 2])

    def settling(self, flight: FootFlight, seconds: float) -> float:
        """Seconds in which it blends to its own pose: ``seconds``, extended while it comes to rest, but ending before
        it lands elsewhere, and before its contact changes.
        """
        landed = 1 + np.flatnonzero((self.states[1:] != 0) & (self.states[:-1] == 0))
        changes = self.rest + np.flatnonzero(self._whole[self.rest :] != self._whole[self.rest])
        until = min([flight.lands, *landed[:1].tolist(), *changes[:1].tolist()])
        return float(min(max(seconds, 2 * self.rest / self.rate), max(until, 2) / self.rate))

    def path(self, flight: FootFlight, seconds: float, times: FloatArray) -> tuple[FootPath, FloatArray]:
        """Path ``times`` (F,) seconds after the previous pose, and its horizontal offset (F, 3), which the body
        follows.
        """
        lies = self.settling(flight, seconds)
        kept = remaining_offset_fraction(times - flight.leaves / self.rate, flight.seconds)
        headings = kept[:, None] * [0.0, 0.0, self.heading]
        feet, toes = (
            self._lain(turned(headings, own), seen, peak, lies, times)
            for own, seen, peak in zip(
                (self.own.feet, self.own.toes), (self.seen.feet, self.seen.toes), self.peaks, strict=True
            )
        )
        aside = kept[:, None] * self.asides(flight) * [1.0, 1.0, 0.0]
        stands = self.own.places(self.pivot) + aside
        stands += remaining_offset_fraction(times, lies)[:, None] * (self.seen.places(self.pivot)[1] - stands)
        return FootPath(stands - self.pivot.offsets(feet, toes), feet, toes), aside

    def _lain(self, own: FloatArray, seen: FloatArray, peak: float, lies: float, times: FloatArray) -> FloatArray:
        """Rotations (F, 3, 3) of a part from its previous rotations ``seen`` (2, 3, 3) to its ``own`` (F, 3, 3)."""
        speed = turns_between(seen[:1], seen[1:])[0] * self.rate
        halting = float(speed_decay_times(np.array([np.linalg.norm(speed)]), np.array([peak]), lies)[0])
        went = turned(remaining_speed_offset(times, halting)[:, None] * speed, np.broadcast_to(seen[1], own.shape))
        rotation_matrices = from_matrix(went @ np.swapaxes(own, 1, 2))
        displacements = rotation_vectors(
            sign_continuous(rotation_matrices * np.where(rotation_matrices[:, 3:] < 0.0, -1.0, 1.0))
        )
        return turned(remaining_offset_fraction(times, lies)[:, None] * displacements, own)


def turns_between(own: FloatArray, seen: FloatArray) -> FloatArray:
    """Rotation vectors (N, 3) from rotations ``own`` (N, 3, 3) to ``seen``."""
    return np.asarray(Rotation.from_matrix(seen @ np.swapaxes(own, 1, 2)).as_rotvec())


def turned(vectors: FloatArray, rotation_matrices: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) followed by rotation ``vectors`` (F, 3)."""
    return np.asarray(Rotation.from_rotvec(vectors).as_matrix() @ rotation_matrices)
