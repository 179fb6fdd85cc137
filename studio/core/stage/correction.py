"""Correction: joints of one performer posed by hand at keys, blended over a range, on top of its motion."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve
from studio.core.constraints.base import Vector, finite_vector
from studio.core.constraints.carried_over import MIRROR, other_side, swapped_sides
from studio.core.constraints.keyed import SAME_TIME, KeyedPlace, KeyedTurn
from studio.core.plausible import TIME_RANGE
from studio.core.rotations import from_rotation_vector

FloatArray = NDArray[np.float64]

CORRECTION_SECONDS, CORRECTION_HOLD = 0.5, 0.1
"""Length of the range of a new correction round its first key, and how much of it is at full weight."""
STILL: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PoseKey:
    """Offsets of a pose from the motion at ``time`` seconds of the stage.

    ``turns`` has a rotation vector (radians) for each part, in the part's own axes; the abdomen's is spread over all
    inner vertebrae. ``hips`` is a displacement in leg lengths, in the axes of the body's heading.
    """

    time: float
    turns: tuple[tuple[BodyPart, Vector], ...] = ()
    hips: Vector = STILL

    def __post_init__(self) -> None:
        if not math.isfinite(self.time):
            raise ValueError(f"The time of a key is a finite number of seconds, got {self.time}.")
        TIME_RANGE.check(self.time)
        turns = {BodyPart(part): finite_vector(turn, f"The turn of the {part}") for part, turn in self.turns}
        if len(turns) < len(self.turns):
            raise ValueError("A key turns each part of the body once.")
        kept = tuple((part, turns[part]) for part in BodyPart if turns.get(part, STILL) != STILL)
        object.__setattr__(self, "turns", kept)
        object.__setattr__(self, "hips", finite_vector(self.hips, "The displacement of the hips"))

    def turn(self, part: BodyPart) -> Vector:
        """Rotation vector of a part; zero if the key does not turn it."""
        return dict(self.turns).get(part, STILL)

    def with_turns(self, turns: Mapping[BodyPart, Vector]) -> Self:
        """The same with other rotation vectors of some parts; zero removes a part."""
        return replace(self, turns=tuple({**dict(self.turns), **turns}.items()))

    def mirrored(self) -> Self:
        """The same on the other side of the body."""
        turns = tuple((other_side(part), _mirrored_turn(part, turn)) for part, turn in self.turns)
        x, y, z = self.hips
        return replace(self, turns=turns, hips=(x, -y, z))


def _mirrored_turn(part: BodyPart, turn: Vector) -> Vector:
    x, y, z = MIRROR.own_rates(turn, part).tolist()
    return x, y, z


@dataclass(frozen=True)
class Correction:
    """Pose offsets of one performer, interpolated between ``keys`` and blended by ``activation``.

    Times are seconds of the stage. Below the constraints, these still hold and planted feet stay; with ``above``, it is
    applied to the solved pose, and may take the body away from its constraints and footprints.
    """

    name: str
    performer_id: str
    activation: ActivationCurve
    keys: tuple[PoseKey, ...]
    weight: float = 1.0
    enabled: bool = True
    above: bool = field(default=False, kw_only=True)
    """True if it is applied after the constraints."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "keys", tuple(sorted(self.keys, key=lambda key: key.time)))
        if not self.keys:
            raise ValueError(f"'{self.name}': a correction has at least one key.")
        if any(after.time - key.time < SAME_TIME for key, after in zip(self.keys, self.keys[1:], strict=False)):
            raise ValueError(f"'{self.name}': two keys of a correction cannot stand at the same time.")
        if not (math.isfinite(self.weight) and 0.0 <= self.weight <= 1.0):
            raise ValueError(f"'{self.name}': the weight of a correction lies between 0 and 1, got {self.weight}.")

    @property
    def parts(self) -> tuple[BodyPart, ...]:
        """Parts that any key turns."""
        turned = {part for key in self.keys for part, _ in key.turns}
        return tuple(part for part in BodyPart if part in turned)

    @property
    def moves_hips(self) -> bool:
        """True if any key displaces the hips."""
        return any(key.hips != STILL for key in self.keys)

    def fractions(self, times: ArrayLike) -> FloatArray:
        """Weights (N,) at ``times`` (N,) seconds: activation times weight, 0 if disabled."""
        return self.activation.at(times) * (self.weight * self.enabled)

    def turns_at(self, part: BodyPart, times: ArrayLike) -> FloatArray:
        """Rotations (N, 3, 3) of a part at ``times`` (N,), unblended."""
        values = tuple(map(tuple, from_rotation_vector(np.array([key.turn(part) for key in self.keys])).tolist()))
        return KeyedTurn(tuple(key.time for key in self.keys), values).at(times)

    def hips_at(self, times: ArrayLike) -> FloatArray:
        """Displacements (N, 3) of the hips at ``times`` (N,), unblended, leg lengths in the axes of the heading."""
        return KeyedPlace(tuple(key.time for key in self.keys), tuple(key.hips for key in self.keys)).at(times)

    def key_at(self, time: float) -> int | None:
        """Index of the key at ``time``; None where there is none."""
        return next((place for place, key in enumerate(self.keys) if abs(key.time - time) < SAME_TIME), None)

    def pose_at(self, time: float) -> PoseKey:
        """Key that stands at ``time``, or the interpolated offsets there."""
        place = self.key_at(time)
        if place is not None:
            return self.keys[place]
        from scipy.spatial.transform import Rotation

        turns = {part: Rotation.from_matrix(self.turns_at(part, [time])[0]).as_rotvec() for part in self.parts}
        x, y, z = self.hips_at([time])[0].tolist()
        return PoseKey(time, tuple((part, tuple(turn.tolist())) for part, turn in turns.items()), (x, y, z))

    def with_key(self, key: PoseKey) -> Self:
        """The same with a key, in the place of one at its time; the range grows to reach it at full weight."""
        others = tuple(each for each in self.keys if abs(each.time - key.time) >= SAME_TIME)
        curve, time = self.activation, key.time
        if time < curve.full:
            curve = curve.with_times(min(curve.start, time - (curve.full - curve.start)), time, *curve.times[2:])
        elif time > curve.full_end:
            curve = curve.with_times(*curve.times[:2], time, max(curve.end, time + (curve.end - curve.full_end)))
        return replace(self, keys=(*others, key), activation=curve)

    def without_key(self, place: int) -> Self:
        """The same without one key. Raises ValueError for the last one."""
        return replace(self, keys=(*self.keys[:place], *self.keys[place + 1 :]))

    def without_part(self, part: BodyPart) -> Self:
        """The same without the turns of one part."""
        return replace(self, keys=tuple(key.with_turns({part: STILL}) for key in self.keys))

    def moved(self, seconds: float) -> Self:
        """The same ``seconds`` later."""
        keys = tuple(replace(key, time=key.time + seconds) for key in self.keys)
        return replace(self, activation=self.activation.moved(seconds), keys=keys)

    def mirrored(self) -> Self:
        """The same on the other side of the body; its name says the other side where it says one."""
        return replace(self, name=swapped_sides(self.name), keys=tuple(key.mirrored() for key in self.keys))


def range_around(time: float) -> ActivationCurve:
    """Range of a new correction with its key at ``time`` seconds."""
    half, hold = CORRECTION_SECONDS / 2.0, CORRECTION_HOLD / 2.0
    return ActivationCurve(time - half, time - hold, time + hold, time + half)
