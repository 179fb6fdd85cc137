"""Correction: joints of one performer posed by hand at keys, blended over a range, on top of its motion."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import Vector, finite_vector
from studio.core.constraints.carried_over import MIRROR, other_side, swapped_sides
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace, KeyedTurn, Keys
from studio.core.rotations import from_matrix, from_rotation_vector, to_rotation_vector

FloatArray = NDArray[np.float64]

CORRECTION_SECONDS, CORRECTION_HOLD = 0.5, 0.1
"""Length of the range of a new correction round its first key, and how much of it is at full weight."""
STILL: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PoseOffsets:
    """Offsets of a pose from the motion: a rotation vector (radians) of each part in ``turns``, in the part's own axes.

    The abdomen's is divided among all inner vertebrae. ``hips`` is a displacement in leg lengths, in the axes of the
    body's heading.
    """

    turns: tuple[tuple[BodyPart, Vector], ...] = ()
    hips: Vector = STILL

    def __post_init__(self) -> None:
        turns = {BodyPart(part): finite_vector(turn, f"The rotation of the {part}") for part, turn in self.turns}
        if len(turns) < len(self.turns):
            raise ValueError("A correction key can rotate each segment only once.")
        kept = tuple((part, turns[part]) for part in BodyPart if turns.get(part, STILL) != STILL)
        object.__setattr__(self, "turns", kept)
        object.__setattr__(self, "hips", finite_vector(self.hips, "The displacement of the hips"))

    def turn(self, part: BodyPart) -> Vector:
        """Rotation vector of a part; zero if it is not rotated."""
        return dict(self.turns).get(part, STILL)

    def scaled(self, fraction: float) -> Self:
        """Offsets scaled by a ``fraction``."""
        turns = tuple((part, _times(turn, fraction)) for part, turn in self.turns)
        return replace(self, turns=turns, hips=_times(self.hips, fraction))

    def with_turns(self, turns: Mapping[BodyPart, Vector]) -> Self:
        """Copy with other rotation vectors of some parts; zero removes a part."""
        return replace(self, turns=tuple({**dict(self.turns), **turns}.items()))

    def mirrored(self) -> Self:
        """Mirror image, for the other side of the body."""
        turns = tuple((other_side(part), _mirrored_turn(part, turn)) for part, turn in self.turns)
        x, y, z = self.hips
        return replace(self, turns=turns, hips=(x, -y, z))


def _times(vector: Vector, factor: float) -> Vector:
    x, y, z = vector
    return factor * x, factor * y, factor * z


def _mirrored_turn(part: BodyPart, turn: Vector) -> Vector:
    x, y, z = MIRROR.own_rates(turn, part).tolist()
    return x, y, z


@dataclass(frozen=True)
class KeyedPoses(Keys):
    """Pose offsets over time: rotations interpolated on SO(3), the hips' displacement as a position."""

    size: ClassVar[int] = 1
    times: tuple[float, ...]
    values: tuple[PoseOffsets, ...]

    def _checked(self, value: Any) -> PoseOffsets:
        if not isinstance(value, PoseOffsets):
            raise ValueError(f"The value of a correction key must be a pose, not {value}.")
        return value

    @classmethod
    def dimension(cls) -> int:
        """Zero: poses have no tangents."""
        return 0

    @property
    def parts(self) -> tuple[BodyPart, ...]:
        """Parts that are rotated by any key."""
        turned = {part for pose in self.values for part, _ in pose.turns}
        return tuple(part for part in BodyPart if part in turned)

    @property
    def moves_hips(self) -> bool:
        """True if any key displaces the hips."""
        return any(pose.hips != STILL for pose in self.values)

    def turns_at(self, part: BodyPart, times: ArrayLike) -> FloatArray:
        """Rotations (N, 3, 3) of a part at ``times`` (N,)."""
        turns = from_rotation_vector(np.array([pose.turn(part) for pose in self.values]))
        return KeyedTurn(self.times, tuple(map(tuple, turns.tolist()))).at(times)

    def hips_at(self, times: ArrayLike) -> FloatArray:
        """Displacements (N, 3) of the hips at ``times`` (N,), leg lengths in the axes of the heading."""
        return KeyedPlace(self.times, tuple(pose.hips for pose in self.values)).at(times)

    def value_at(self, time: float) -> PoseOffsets:
        """Offsets at ``time``."""
        place = self.key_at(time)
        if place is not None:
            return self.values[place]
        vectors = {part: to_rotation_vector(from_matrix(self.turns_at(part, [time])))[0] for part in self.parts}
        x, y, z = self.hips_at([time])[0].tolist()
        return PoseOffsets(tuple((part, tuple(turn.tolist())) for part, turn in vectors.items()), (x, y, z))

    def mirrored(self) -> Self:
        """Mirror image, for the other side of the body."""
        return replace(self, values=tuple(pose.mirrored() for pose in self.values))


@dataclass(frozen=True)
class Correction:
    """Pose offsets of one performer, interpolated between ``keys`` and blended by ``activation``.

    Times are seconds of the stage. Below the constraints, these still hold and planted feet stay; with ``above``, it is
    applied to the solved pose, and may take the body away from its constraints and footprints.
    """

    name: str
    performer_id: str
    activation: ActivationCurve
    keys: KeyedPoses
    weight: float = 1.0
    enabled: bool = True
    above: bool = field(default=False, kw_only=True)
    """True if it is applied after the constraints."""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.weight) and 0.0 <= self.weight <= 1.0):
            raise ValueError(f"'{self.name}': the weight of a correction must be between 0 and 1, not {self.weight}.")

    def fractions(self, times: ArrayLike) -> FloatArray:
        """Weights (N,) at ``times`` (N,) seconds: activation times weight, 0 if disabled."""
        return self.activation.at(times) * (self.weight * self.enabled)

    def pose_at(self, time: float) -> PoseOffsets:
        """Offsets for a key at full activation that leaves the pose at ``time`` unchanged."""
        return self.keys.value_at(time).scaled(float(self.activation.at(time)))

    def with_key(self, time: float, pose: PoseOffsets) -> Self:
        """Copy with a key, which replaces one at its time; the range is extended to include it at full weight."""
        curve = self.activation
        if time < curve.full:
            curve = curve.with_times(min(curve.start, time - (curve.full - curve.start)), time, *curve.times[2:])
        elif time > curve.full_end:
            curve = curve.with_times(*curve.times[:2], time, max(curve.end, time + (curve.end - curve.full_end)))
        return replace(self, keys=self.keys.with_key(time, pose), activation=curve)

    def without_part(self, part: BodyPart) -> Self:
        """Copy without the rotations of one part."""
        values = tuple(pose.with_turns({part: STILL}) for pose in self.keys.values)
        return replace(self, keys=replace(self.keys, values=values))

    def moved(self, seconds: float) -> Self:
        """Copy shifted ``seconds`` later."""
        return replace(self, activation=self.activation.moved(seconds), keys=self.keys.moved(seconds))

    def mirrored(self) -> Self:
        """Mirror image, for the other side of the body; a side in its name is exchanged."""
        return replace(self, name=swapped_sides(self.name), keys=self.keys.mirrored())


def range_around(time: float) -> ActivationCurve:
    """Range of a new correction with its key at ``time`` seconds."""
    half, hold = CORRECTION_SECONDS / 2.0, CORRECTION_HOLD / 2.0
    return ActivationCurve(time - half, time - hold, time + hold, time + half)


def new_correction(name: str, performer_id: str, time: float, pose: PoseOffsets = PoseOffsets()) -> Correction:
    """A correction with its first key at ``time`` seconds, in the usual range around it."""
    return Correction(name, performer_id, range_around(time), KeyedPoses((time,), (pose,)))
