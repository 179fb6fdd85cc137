"""A foot during an inertialised transition, which keeps its previous contact until it is lifted.

The *own* motion is the new one by itself; the *previous* poses (``seen``) are those shown before the transition. Heel
and toes in contact in both do not move at all. The rest, such as a heel that is raised in one of them, blends from the
previous pose to the own one.
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
from studio.core.solver.grounding.stepping import FootFlight

FloatArray = NDArray[np.float64]
States = NDArray[np.int64]


MAX_FLOWN_DISTANCE = 0.3
"""Greatest distance in metres by which a lifted foot's path keeps the rotation of its contact, approached softly."""
FLAT_TOE_PITCH = 1e-3
"""Downward pitch in radians up to which toes count as flat."""


class Pivot(NamedTuple):
    """Point of a foot about which it rotates in contact."""

    in_foot: FloatArray
    """(3,) metres from the ankle, in the foot's axes."""
    in_toes: FloatArray
    """(3,) metres from there, in the axes of the toes."""
    ahead: float = 0.0
    """Metres from there along the foot's horizontal heading."""

    def offsets(self, feet: FloatArray, toes: FloatArray) -> FloatArray:
        """World vectors (..., 3) in metres from the ankle to the pivot, for rotations (..., 3, 3) of foot and toes."""
        headings = feet[..., 0] * [1.0, 1.0, 0.0]
        headings /= np.maximum(np.linalg.norm(headings, axis=-1, keepdims=True), 1e-9)
        return np.asarray(feet @ self.in_foot + toes @ self.in_toes + self.ahead * headings)


def heel_pivot(measures: FloatArray) -> Pivot:
    """Pivot of a foot that stands on its heel alone: the middle of the heel's pad, at the height of its lower edge.

    ``measures`` (1, 6) of the foot (``kernels.support.sole``).
    """
    heel, *_ = sole_arms(measures)
    return Pivot(heel[0], np.zeros(3), -HEEL_PAD_FRACTION * float(heel[0, 0]))


def toe_pivot(measures: FloatArray, *toes: FloatArray) -> Pivot:
    """Pivot of a foot that stands on its toes: their tip if any of the rotations ``toes`` (3, 3) points down, else the
    sole below the ball.
    """
    _, joint, thickness, tip = sole_arms(measures)
    return Pivot(joint[0], tip[0] if min(each[2, 0] for each in toes) < -FLAT_TOE_PITCH else -thickness[0])


class SoleArms(NamedTuple):
    """Vectors along a foot, in metres in the axes of foot or toes."""

    heel: FloatArray
    """(F or 1, 3) from the ankle to the lower edge of the heel, in the foot's axes."""
    joint: FloatArray
    """(F or 1, 3) from the ankle to the toe joint, in the foot's axes."""
    thickness: FloatArray
    """(F or 1, 3) from the sole to the toe joint."""
    tip: FloatArray
    """(F or 1, 3) from the toe joint to the sole of the tip, in the axes of the toes."""


def sole_arms(measures: FloatArray) -> SoleArms:
    """``SoleArms`` of a foot with ``measures`` (F or 1, 6) (``kernels.support.sole``)."""
    arms = SoleArms(*np.zeros((4, len(measures), 3)))
    down, height = measures[:, 2], measures[:, 3]
    arms.heel[:, 0], arms.heel[:, 2] = -measures[:, 4], -height
    arms.joint[:] = measures[:, :3]
    arms.thickness[:, 2] = height + down
    arms.tip[:, 0], arms.tip[:, 2] = measures[:, 5], -height - down
    return arms


@dataclass(frozen=True, eq=False)
class FootPath:
    """Path of one foot over F frames."""

    ankles: FloatArray
    """(F, 3) metres."""
    feet: FloatArray
    """(F, 3, 3) in the world."""
    toes: FloatArray
    """(F, 3, 3) in the world."""

    def places(self, pivot: Pivot) -> FloatArray:
        """Positions (F, 3) in metres of a pivot of the foot."""
        return np.asarray(self.ankles + pivot.offsets(self.feet, self.toes))


@dataclass(frozen=True, eq=False)
class HeldFoot:
    """Foot that keeps its previous contact during an inertialised transition."""

    own: FootPath
    """Own path from the transition on."""
    states: States
    """(F,) own states from the transition on."""
    seen: FootPath
    """Previous path, the two frames before the transition."""
    state: int
    """Previous state."""
    measures: FloatArray
    """(1, 6) measures of the foot (``kernels.support.sole``)."""
    peaks: FloatArray
    """(2,) acceleration peaks of foot and toes, rad/s2."""
    rate: float
    """Frames a second."""

    @cached_property
    def _whole(self) -> NDArray[np.bool_]:
        """(F,) True where the own contact includes all of the previous one."""
        return np.asarray((self.states & self.state) == self.state)

    @cached_property
    def rest(self) -> int:
        """First frame whose own contact includes the previous one; 0 if that is late, or after a flight."""
        rests = int(self._whole.argmax())
        soon = self._whole.any() and 2.0 * rests <= MOST_TRANSITION_SECONDS * self.rate
        return rests if soon and self.states[:rests].all() else 0

    @cached_property
    def pivot(self) -> Pivot:
        """Pivot of the common contact: the heel if that stands alone, else the ball or the tip of the toes."""
        if self.states[self.rest] & self.state == HEEL_STANDS:
            return heel_pivot(self.measures)
        return toe_pivot(self.measures, self.seen.toes[1], self.own.toes[self.rest])

    @cached_property
    def aside(self) -> FloatArray:
        """Offset (3,) in metres of the pivot from its own resting position to the previous one."""
        return np.asarray(self.seen.places(self.pivot)[1] - self.own.places(self.pivot)[self.rest])

    def asides(self, flight: FootFlight) -> FloatArray:
        """Offsets (F, 3) in metres of the pivot from its own path during the contact.

        The path of a pivot that rolls is rotated with the foot's heading.
        """
        rolled = self.own.places(self.pivot) - self._came_down(flight.leaves)
        last = min(flight.leaves, len(rolled) - 1)
        flown = rolled[last:] - rolled[last]
        flown /= (1.0 + (np.linalg.norm(flown, axis=1, keepdims=True) / MAX_FLOWN_DISTANCE) ** 4) ** 0.25
        rolled[last:] = rolled[last] + flown
        return np.asarray(self.aside + Rotation.from_rotvec([0.0, 0.0, self.heading]).apply(rolled) - rolled)

    def _came_down(self, until: int) -> FloatArray:
        """Own position (F, 3) of the pivot at its last landing before frame ``until``; interpolated in the air."""
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
        """Angle in radians about Z from the own resting heading to the previous one."""
        return float(rotation_vectors_between(self.own.feet[self.rest : self.rest + 1], self.seen.feet[1:])[0, 2])

    def settling(self, flight: FootFlight, seconds: float) -> float:
        """Seconds in which the foot blends to its own pose.

        They are ``seconds``, extended while the foot comes to rest, but end before it lands elsewhere, and before its
        contact changes.
        """
        landed = 1 + np.flatnonzero((self.states[1:] != 0) & (self.states[:-1] == 0))
        changes = self.rest + np.flatnonzero(self._whole[self.rest :] != self._whole[self.rest])
        until = min([flight.lands, *landed[:1].tolist(), *changes[:1].tolist()])
        return float(min(max(seconds, 2 * self.rest / self.rate), max(until, 2) / self.rate))

    def path(self, flight: FootFlight, seconds: float, times: FloatArray) -> tuple[FootPath, FloatArray]:
        """Path of the foot ``times`` (F,) seconds after the previous pose, and its horizontal offset (F, 3), which the
        body follows.
        """
        lies = self.settling(flight, seconds)
        kept = remaining_offset_fraction(times - flight.leaves / self.rate, flight.seconds)
        headings = kept[:, None] * [0.0, 0.0, self.heading]
        feet, toes = (
            self._lain(rotated_by_vectors(headings, own), seen, peak, lies, times)
            for own, seen, peak in zip(
                (self.own.feet, self.own.toes), (self.seen.feet, self.seen.toes), self.peaks, strict=True
            )
        )
        aside = kept[:, None] * self.asides(flight) * [1.0, 1.0, 0.0]
        stands = self.own.places(self.pivot) + aside
        stands += remaining_offset_fraction(times, lies)[:, None] * (self.seen.places(self.pivot)[1] - stands)
        return FootPath(stands - self.pivot.offsets(feet, toes), feet, toes), aside

    def _lain(self, own: FloatArray, seen: FloatArray, peak: float, lies: float, times: FloatArray) -> FloatArray:
        """Rotations (F, 3, 3) of foot or toes, from the previous rotations ``seen`` (2, 3, 3) to the ``own`` ones (F,
        3, 3).
        """
        speed = rotation_vectors_between(seen[:1], seen[1:])[0] * self.rate
        halting = float(speed_decay_times(np.array([np.linalg.norm(speed)]), np.array([peak]), lies)[0])
        went = rotated_by_vectors(
            remaining_speed_offset(times, halting)[:, None] * speed, np.broadcast_to(seen[1], own.shape)
        )
        rotation_matrices = from_matrix(went @ np.swapaxes(own, 1, 2))
        displacements = rotation_vectors(
            sign_continuous(rotation_matrices * np.where(rotation_matrices[:, 3:] < 0.0, -1.0, 1.0))
        )
        return rotated_by_vectors(remaining_offset_fraction(times, lies)[:, None] * displacements, own)


def rotation_vectors_between(own: FloatArray, seen: FloatArray) -> FloatArray:
    """Rotation vectors (N, 3), radians, from rotations ``own`` (N, 3, 3) to ``seen`` (N, 3, 3)."""
    return np.asarray(Rotation.from_matrix(seen @ np.swapaxes(own, 1, 2)).as_rotvec())


def rotated_by_vectors(vectors: FloatArray, rotation_matrices: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3): ``rotation_matrices`` (F, 3, 3) followed by the rotation ``vectors`` (F, 3)."""
    return np.asarray(Rotation.from_rotvec(vectors).as_matrix() @ rotation_matrices)
