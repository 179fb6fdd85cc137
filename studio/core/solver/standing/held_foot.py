"""A foot as one motion takes over from another: it stands where it was seen until it is lifted, turned as it was.

Heel and toes that stand in both do not move at all. What does not, a heel that is up in one of them, goes over from how
it was seen to how the motion has it: between two feet that are on the ground there is none below it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.kernels.support.sole import HEEL_STANDS
from studio.core.normalized.differences import rotation_vectors
from studio.core.normalized.transition import LONGEST, halts_of, pace_left, place_left
from studio.core.rotations import from_matrix, sign_continuous
from studio.core.runs import runs_of
from studio.core.solver.standing.stepping import Flight

FloatArray = NDArray[np.float64]
States = NDArray[np.int64]


FLOWN = 0.3
"""Metres by which a foot that has left the ground goes on at most turned as it stood."""


@dataclass(frozen=True, eq=False)
class FootPath:
    """``ankles`` (F, 3), ``feet`` and ``toes`` (F, 3, 3) of one foot in frames of equal length."""

    ankles: FloatArray
    feet: FloatArray
    toes: FloatArray

    def places(self, pivot: FloatArray) -> FloatArray:
        """(F, 3) of a point of the foot, in its axes from its ankle."""
        return np.asarray(self.ankles + self.feet @ pivot)


@dataclass(frozen=True, eq=False)
class HeldFoot:
    """``own`` is the foot by itself from the change on, which stands as ``states`` (F,) say; it was ``seen`` in the two
    frames before, standing as ``state`` says.

    ``heel`` and ``ball`` (3,) are in its axes from its ankle; ``peaks`` (2,) radians a second squared of foot and toes.
    """

    own: FootPath
    states: States
    seen: FootPath
    state: int
    heel: FloatArray
    ball: FloatArray
    peaks: FloatArray
    rate: float

    @cached_property
    def _whole(self) -> NDArray[np.bool_]:
        """(F,) whether it stands by itself on all on which it was seen to stand."""
        return np.asarray((self.states & self.state) == self.state)

    @cached_property
    def rest(self) -> int:
        """The first frame in which it does; 0 where that comes late, or it is lifted before."""
        rests = int(self._whole.argmax())
        soon = self._whole.any() and 2.0 * rests <= LONGEST * self.rate
        return rests if soon and self.states[:rests].all() else 0

    @property
    def pivot(self) -> FloatArray:
        """(3,) what it turns about: its heel where that alone stands, else its ball."""
        return self.heel if self.states[self.rest] & self.state == HEEL_STANDS else self.ball

    @cached_property
    def aside(self) -> FloatArray:
        """(3,) metres from where it rests by itself to where it was seen."""
        return np.asarray(self.seen.places(self.pivot)[1] - self.own.places(self.pivot)[self.rest])

    def asides(self, flight: Flight) -> FloatArray:
        """(F, 3) the same while it stands: what it turns about moves on where it rolls, turned as the foot is."""
        rolled = self.own.places(self.pivot) - self._came_down(flight.leaves)
        last = min(flight.leaves, len(rolled) - 1)
        flown = rolled[last:] - rolled[last]
        flown /= (1.0 + (np.linalg.norm(flown, axis=1, keepdims=True) / FLOWN) ** 4) ** 0.25
        rolled[last:] = rolled[last] + flown
        return np.asarray(self.aside + Rotation.from_rotvec([0.0, 0.0, self.heading]).apply(rolled) - rolled)

    def _came_down(self, until: int) -> FloatArray:
        """(F, 3) where what it turns about was by itself as the foot came down last before frame ``until``; in the air
        on the way there.
        """
        places = self.own.places(self.pivot)
        there = np.tile(places[self.rest], (len(places), 1))
        for leaves, lands in runs_of(self.states == 0):
            if self.rest < leaves and lands < until:
                going = np.arange(1, lands - leaves + 1) / (lands - leaves)
                way = places[lands] - there[leaves]
                there[leaves:lands] += (1.0 - place_left(going, 1.0))[:, None] * way
                there[lands:] += way
        return there

    @cached_property
    def heading(self) -> float:
        """Radians about Z from how it rests by itself to how it was seen."""
        return float(turns_between(self.own.feet[self.rest : self.rest + 1], self.seen.feet[1:])[0, 2])

    def settling(self, flight: Flight, seconds: float) -> float:
        """Seconds in which it comes to lie as it does by itself: ``seconds``, but not until it has long come to rest.

        Before it lands anywhere, and before heel or toes stand otherwise than where it rests.
        """
        landed = 1 + np.flatnonzero((self.states[1:] != 0) & (self.states[:-1] == 0))
        changes = self.rest + np.flatnonzero(self._whole[self.rest :] != self._whole[self.rest])
        until = min([flight.lands, *landed[:1].tolist(), *changes[:1].tolist()])
        return float(min(max(seconds, 2 * self.rest / self.rate), max(until, 2) / self.rate))

    def path(self, flight: Flight, seconds: float, times: FloatArray) -> tuple[FootPath, FloatArray]:
        """Where it goes, ``times`` (F,) seconds after it was seen last, and (F, 3) how far it stands aside over the
        ground, which the body goes along with.
        """
        lies = self.settling(flight, seconds)
        kept = place_left(times - flight.leaves / self.rate, flight.seconds)
        headings = kept[:, None] * [0.0, 0.0, self.heading]
        feet, toes = (
            self._lain(turned(headings, own), seen, peak, lies, times)
            for own, seen, peak in zip(
                (self.own.feet, self.own.toes), (self.seen.feet, self.seen.toes), self.peaks, strict=True
            )
        )
        aside = kept[:, None] * self.asides(flight) * [1.0, 1.0, 0.0]
        stands = self.own.places(self.pivot) + aside
        stands += place_left(times, lies)[:, None] * (self.seen.places(self.pivot)[1] - stands)
        return FootPath(stands - feet @ self.pivot, feet, toes), aside

    def _lain(self, own: FloatArray, seen: FloatArray, peak: float, lies: float, times: FloatArray) -> FloatArray:
        """(F, 3, 3) from how a part was ``seen`` (2, 3, 3), where it comes to rest, to its ``own`` (F, 3, 3)."""
        speed = turns_between(seen[:1], seen[1:])[0] * self.rate
        halting = float(halts_of(np.array([np.linalg.norm(speed)]), np.array([peak]), lies)[0])
        went = turned(pace_left(times, halting)[:, None] * speed, np.broadcast_to(seen[1], own.shape))
        turns = from_matrix(went @ np.swapaxes(own, 1, 2))
        ways = rotation_vectors(sign_continuous(turns * np.where(turns[:, 3:] < 0.0, -1.0, 1.0)))
        return turned(place_left(times, lies)[:, None] * ways, own)


def turns_between(own: FloatArray, seen: FloatArray) -> FloatArray:
    """(N, 3) rotation vectors from ``own`` turns (N, 3, 3) to how they were ``seen``."""
    return np.asarray(Rotation.from_matrix(seen @ np.swapaxes(own, 1, 2)).as_rotvec())


def turned(vectors: FloatArray, turns: FloatArray) -> FloatArray:
    """``turns`` (F, 3, 3), turned further by rotation ``vectors`` (F, 3)."""
    return np.asarray(Rotation.from_rotvec(vectors).as_matrix() @ turns)
