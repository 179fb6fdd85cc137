"""Corrections: offsets of joints of one performer, posed by hand at keys and blended over a range, on top of its
motion.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import Vector, finite_vector
from studio.core.constraints.carried_over import MIRROR_TRANSFORM, other_side, swapped_sides
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedPlace, KeyedTurn, Keys
from studio.core.rotations import from_matrix, from_rotation_vector, to_rotation_vector

FloatArray = NDArray[np.float64]

CORRECTION_SECONDS, CORRECTION_HOLD = 0.5, 0.1
"""Length in seconds of the range of a new correction around its first key, and of its part at full weight."""
NO_OFFSET: Vector = (0.0, 0.0, 0.0)
"""Rotation vector or displacement of zero."""


@dataclass(frozen=True)
class PoseOffsets:
    """Offsets of a pose from the motion: in ``turns``, a rotation vector (radians) of each part in the part's own axes.

    The rotation of the abdomen is divided among all inner vertebrae. ``hips`` is a displacement in leg lengths, in the
    axes of the body's heading.
    """

    turns: tuple[tuple[BodyPart, Vector], ...] = ()
    hips: Vector = NO_OFFSET

    def __post_init__(self) -> None:
        turns = {BodyPart(part): finite_vector(turn, f"The rotation of the {part}") for part, turn in self.turns}
        if len(turns) < len(self.turns):
            raise ValueError("A correction key can rotate each segment only once.")
        kept = tuple((part, turns[part]) for part in BodyPart if turns.get(part, NO_OFFSET) != NO_OFFSET)
        object.__setattr__(self, "turns", kept)
        object.__setattr__(self, "hips", finite_vector(self.hips, "The displacement of the hips"))

    def turn(self, part: BodyPart) -> Vector:
        """Rotation vector of a part; zero if it is not rotated."""
        return dict(self.turns).get(part, NO_OFFSET)

    def scaled(self, fraction: float) -> Self:
        """Offsets multiplied by ``fraction``."""
        turns = tuple((part, _times(turn, fraction)) for part, turn in self.turns)
        return replace(self, turns=turns, hips=_times(self.hips, fraction))

    def with_turns(self, turns: Mapping[BodyPart, Vector]) -> Self:
        """Copy in which ``turns`` replace the rotation vectors of some parts; a zero vector removes its part."""
        return replace(self, turns=tuple({**dict(self.turns), **turns}.items()))

    def mirrored(self) -> Self:
        """Mirror image of the offsets, for the other side of the body."""
        turns = tuple((other_side(part), _mirrored_turn(part, turn)) for part, turn in self.turns)
        x, y, z = self.hips
        return replace(self, turns=turns, hips=(x, -y, z))


def _times(vector: Vector, factor: float) -> Vector:
    x, y, z = vector
    return factor * x, factor * y, factor * z


def _mirrored_turn(part: BodyPart, turn: Vector) -> Vector:
    x, y, z = MIRROR_TRANSFORM.own_rates(turn, part).tolist()
    return x, y, z


@dataclass(frozen=True)
class KeyedPoses(Keys):
    """Pose offsets over time: rotations are interpolated on SO(3), the displacement of the hips as a position."""

    size: ClassVar[int] = 1
    times: tuple[float, ...]
    values: tuple[PoseOffsets, ...]

    def _checked(self, value: Any) -> PoseOffsets:
        if not isinstance(value, PoseOffsets):
            raise ValueError(f"The value of a correction key must be a pose, not {value}.")
        return value

    @classmethod
    def dimension(cls) -> int:
        """Number of components of a tangent: zero, because poses have no tangents."""
        return 0

    @property
    def parts(self) -> tuple[BodyPart, ...]:
        """Parts that are rotated by any key."""
        turned = {part for pose in self.values for part, _ in pose.turns}
        return tuple(part for part in BodyPart if part in turned)

    @property
    def moves_hips(self) -> bool:
        """True if any key displaces the hips."""
        return any(pose.hips != NO_OFFSET for pose in self.values)

    def turns_at(self, part: BodyPart, times: ArrayLike) -> FloatArray:
        """Rotation matrices (N, 3, 3) of a part at ``times`` (N,) seconds."""
        turns = from_rotation_vector(np.array([pose.turn(part) for pose in self.values]))
        return KeyedTurn(self.times, tuple(map(tuple, turns.tolist()))).at(times)

    def hips_at(self, times: ArrayLike) -> FloatArray:
        """Displacements (N, 3) of the hips at ``times`` (N,), in leg lengths and the axes of the heading."""
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
        """Mirror image of the poses, for the other side of the body."""
        return replace(self, values=tuple(pose.mirrored() for pose in self.values))


@dataclass(frozen=True)
class Correction:
    """Pose offsets of one performer, interpolated between ``keys`` and blended by ``activation``, in stage seconds.

    A correction is applied before the constraints, which still hold, and planted feet stay planted. With ``above`` it
    is applied to the solved pose, and may move the body away from its constraints and footprints.
    """

    name: str
    performer_id: str
    activation: ActivationCurve
    keys: KeyedPoses
    weight: float = 1.0
    enabled: bool = True
    above: bool = field(default=False, kw_only=True)
    """True to apply the offsets after the constraints are solved."""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.weight) and 0.0 <= self.weight <= 1.0):
            raise ValueError(f"'{self.name}': the weight of a correction must be between 0 and 1, not {self.weight}.")

    def fractions(self, times: ArrayLike) -> FloatArray:
        """Weights (N,) at ``times`` (N,) seconds: activation times ``weight``; 0 if the correction is disabled."""
        return self.activation.at(times) * (self.weight * self.enabled)

    def acts_at(self, time: float) -> bool:
        """True if ``time`` is in the range of a correction that is enabled and has weight."""
        return self.enabled and self.weight > 0.0 and self.activation.start <= time <= self.activation.end

    def pose_at(self, time: float) -> PoseOffsets:
        """Offsets that, as a key at full activation, leave the pose at ``time`` unchanged."""
        return self.keys.value_at(time).scaled(float(self.activation.at(time)))

    def with_key(self, time: float, pose: PoseOffsets) -> Self:
        """Copy with a key at ``time``, in place of a key at that time; the range is extended to give it full weight."""
        curve = self.activation
        if time < curve.full:
            curve = curve.with_times(min(curve.start, time - (curve.full - curve.start)), time, *curve.times[2:])
        elif time > curve.full_end:
            curve = curve.with_times(*curve.times[:2], time, max(curve.end, time + (curve.end - curve.full_end)))
        return replace(self, keys=self.keys.with_key(time, pose), activation=curve)

    def without_part(self, part: BodyPart) -> Self:
        """Copy without the rotations of one part."""
        values = tuple(pose.with_turns({part: NO_OFFSET}) for pose in self.keys.values)
        return replace(self, keys=replace(self.keys, values=values))

    def moved(self, seconds: float) -> Self:
        """Copy shifted in time by ``seconds``; positive is later."""
        return replace(self, activation=self.activation.moved(seconds), keys=self.keys.moved(seconds))

    def mirrored(self) -> Self:
        """Mirror image of the correction, for the other side of the body; a side in its name is exchanged."""
        return replace(self, name=swapped_sides(self.name), keys=self.keys.mirrored())


def new_correction_range(time: float) -> ActivationCurve:
    """Activation of a new correction whose first key is at ``time`` seconds."""
    half, hold = CORRECTION_SECONDS / 2.0, CORRECTION_HOLD / 2.0
    return ActivationCurve(time - half, time - hold, time + hold, time + half)


def new_correction(name: str, performer_id: str, time: float, pose: PoseOffsets = PoseOffsets()) -> Correction:
    """Correction with one key ``pose`` at ``time`` seconds, in a range of default length around it."""
    return Correction(name, performer_id, new_correction_range(time), KeyedPoses((time,), (pose,)))
