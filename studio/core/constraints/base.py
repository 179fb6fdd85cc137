"""Base class of all constraints: the tuple C = {point, type, chain, priority, activation} of [K05]."""

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.constraints.scope import EVERYONE, Scope
from studio.core.curves.activation import ActivationCurve
from studio.core.curves.keyed import KeyedNumber
from studio.core.plausible import PLACE_RANGE, WEIGHT_RANGE

if TYPE_CHECKING:
    from studio.core.constraints.carried_over import ClipTransform

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class BodyPoint:
    """Point fixed to a segment: an offset in metres from the segment's origin, in the segment's axes.

    With ``at_end`` the offset is from the segment's far end, so that "the wrist" is the end of the forearm on a body of
    any size.
    """

    part: BodyPart
    offset: Vector = (0.0, 0.0, 0.0)
    at_end: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "part", BodyPart(self.part))
        object.__setattr__(self, "offset", finite_vector(self.offset, "A point's offset"))


CHAIN_LINKS = ("limb", "end_segment", "clavicle", "trunk", "root", "free_arms", "free_legs")
"""Names of the weights of a chain that apply to groups of segments."""
FREE_LIMBS = ("free_arms", "free_legs")
"""Names of the weights of a chain that only a balance constraint uses."""
TRUNK_PARTS = (BodyPart.PELVIS, BodyPart.ABDOMEN, BodyPart.THORAX)
CLAVICLES = (BodyPart.LEFT_CLAVICLE, BodyPart.RIGHT_CLAVICLE)
UPPER_ARMS = (BodyPart.LEFT_UPPER_ARM, BodyPart.RIGHT_UPPER_ARM)
THIGHS = (BodyPart.LEFT_THIGH, BodyPart.RIGHT_THIGH)
FOREARMS = (BodyPart.LEFT_FOREARM, BodyPart.RIGHT_FOREARM)
SHANKS = (BodyPart.LEFT_SHANK, BodyPart.RIGHT_SHANK)
LIMB_BONE_PARTS = (*UPPER_ARMS, *FOREARMS, *THIGHS, *SHANKS)
WEIGHTED_PARTS = (*TRUNK_PARTS, *CLAVICLES, BodyPart.NECK, BodyPart.HEAD, *LIMB_BONE_PARTS)
"""Body parts that may have a weight of their own in a chain."""
LEAST_CONSTRAINT_WEIGHT = 1e-12
"""Weight that replaces a constraint's weight of 0."""


def limb_bones(part: BodyPart) -> tuple[BodyPart, ...]:
    """Upper and lower segment of the limb to which ``part`` belongs; none for other parts."""
    side, _, bone = part.value.partition("_")
    if bone in ("upper_arm", "forearm", "hand"):
        return BodyPart(f"{side}_upper_arm"), BodyPart(f"{side}_forearm")
    if bone in ("thigh", "shank", "foot", "toe"):
        return BodyPart(f"{side}_thigh"), BodyPart(f"{side}_shank")
    return ()


@dataclass(frozen=True)
class Chain:
    """Weights of the body parts that may move for a constraint: 0 is locked, 1 moves freely, values between are
    stiffer.

    ``segments`` gives single segments a weight of their own in place of that of their group; the abdomen stands for all
    inner vertebrae. For a point on a limb, the weight of the upper segment is the fraction of its unconstrained
    rotation that is used, and that of the lower one the fraction of its unconstrained bend; the rest of the chain does
    the remainder. ``free_arms`` and ``free_legs`` are used by balance constraints only: the weights with which
    unconstrained arms, and the leg in the air, move about shoulders and hips. An upper arm or thigh may have a weight
    of its own there.
    """

    limb: float = 1.0
    end_segment: float = 0.0
    clavicle: float = 1.0
    trunk: float = 0.0
    root: float = 0.0
    segments: tuple[tuple[BodyPart, float], ...] = ()
    free_arms: float = 0.0
    free_legs: float = 0.0

    def __post_init__(self) -> None:
        own = tuple((BodyPart(part), weight) for part, weight in self.segments)
        object.__setattr__(self, "segments", own)
        for name, weight in [*((link, getattr(self, link)) for link in CHAIN_LINKS), *own]:
            if not (math.isfinite(weight) and 0.0 <= weight <= 1.0):
                raise ValueError(f"The weights of an IK chain must be between 0 and 1: {name} is {weight}.")
        parts = [part for part, _ in own]
        for part in parts:
            if part not in WEIGHTED_PARTS:
                raise ValueError(f"The {part.label.lower()} cannot have a weight override: set end_segment instead.")
            if parts.count(part) > 1:
                raise ValueError(f"The {part.label.lower()} has two weight overrides. Keep one of them.")
        if not any(getattr(self, link) for link in CHAIN_LINKS) and not any(weight for _, weight in own):
            raise ValueError("No part of the IK chain may move. Set at least one weight above 0.")

    def weight(self, part: BodyPart) -> float:
        """Weight of a segment: its own, or that of its group.

        The pelvis rotates only with a weight of its own. Neck and head form the group of the head.
        """
        match part:
            case BodyPart.PELVIS:
                usual = 0.0
            case BodyPart.NECK:
                usual = max(self.limb, self.clavicle)
            case BodyPart.HEAD:
                usual = max(self.limb, self.end_segment)
            case _ if part in LIMB_BONE_PARTS:
                usual = self.limb
            case _:
                usual = self.clavicle if part in CLAVICLES else self.trunk
        return dict(self.segments).get(part, usual)

    def recruited(self, part: BodyPart) -> float:
        """Weight with which a balance constraint moves an upper arm or a thigh: its own if its group has any weight,
        else that of its group.
        """
        usual = self.free_arms if part in UPPER_ARMS else self.free_legs
        return dict(self.segments).get(part, usual) if usual > 0.0 else 0.0


@dataclass(frozen=True)
class KindInfo:
    """Labels of a kind of constraint in menus and forms."""

    action: str
    """Label of the command that adds a constraint of this kind."""
    hint: str
    colour: str
    held_by: str = ""
    """Name of the field with the position of its handle; empty if it has no handle."""
    handle: str = "target"
    """Label of the handle."""
    about: str = ""
    """Label of its subject if the subject is no point."""
    picks: bool = False
    """True if it is made for a picked joint."""


@dataclass(frozen=True)
class Constraint:
    """Constraint of the user on a motion; base class of all kinds. Priority 0 is the highest."""

    kind: ClassVar[str]
    unit: ClassVar[str] = "m"
    """Unit of its residual: metres, or radians (``rad``)."""
    shown: ClassVar[KindInfo]
    motion_id: str
    name: str
    point: BodyPoint
    chain: Chain
    priority: int
    activation: ActivationCurve
    enabled: bool = True
    weight: float | KeyedNumber = field(default=1.0, kw_only=True)
    """Weight among constraints of the same priority that cannot all be met; only ratios matter. If one is keyed,
    targets of one point, or rotations of one segment, are blended by the weights. For two bodies that meet, the weight
    is the fraction of the distance that each moves.
    """
    scope: Scope = field(default=EVERYONE, kw_only=True)
    """Performers to which it applies: all of the motion, one performer, or one clip."""

    def __post_init__(self) -> None:
        if self.priority < 0:
            raise ValueError(f"'{self.name}': the priority must be 0 (highest) or more, not {self.priority}.")
        if self.kind != "balance" and any(getattr(self.chain, link) > 0.0 for link in FREE_LIMBS):
            raise ValueError(
                f"'{self.name}': only a balance constraint can use the other arms and legs. Set free_arms and free_legs"
                " to 0."
            )
        weights = self.weight.values if isinstance(self.weight, KeyedNumber) else (self.weight,)
        for weight in weights:
            if not (math.isfinite(weight) and weight >= 0.0):
                raise ValueError(f"'{self.name}': the weight must be a finite number of 0 or more, not {weight}.")
        WEIGHT_RANGE.check(weights)

    def weights_at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Weights (F,), or (1,) if constant, at ``times`` (F,) seconds; above 0 so that weighted means exist."""
        keyed = self.weight.at(times)[:, 0] if isinstance(self.weight, KeyedNumber) else np.array([self.weight])
        return np.asarray(np.maximum(keyed, LEAST_CONSTRAINT_WEIGHT))

    def carried(self, carry: "ClipTransform") -> dict[str, Any]:
        """Values, by field name, of the fields that ``carry`` changes (``constraints.carried_over``)."""
        return {}

    def sketch(self, position: NDArray[np.float64], turn: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Polylines (N, 3) that draw the constraint.

        ``position`` (3,) is that of its point, and ``turn`` (3, 3) the rotation of its segment.
        """
        return ()


def finite_vector(values: object, what: str) -> Vector:
    """Three finite floats from any sequence, within the range of positions. Raises ValueError, which names ``what``."""
    numbers = tuple(float(value) for value in values)  # type: ignore[attr-defined]
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"{what} must be three finite numbers in metres, not {values}.")
    PLACE_RANGE.check(numbers, what)
    return numbers
