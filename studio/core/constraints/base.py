"""What every kind of constraint has: the paper's C = {point, type, chain, priority, activation}."""

import math
from dataclasses import dataclass, fields
from typing import ClassVar

from studio.core.canonical import BodyPart
from studio.core.constraints.activation import ActivationCurve

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class BodyPoint:
    """A point fixed to a segment: an offset in metres from the segment's origin, in the segment's axes.

    ``at_end`` counts the offset from the segment's far end instead, so that "the wrist" is the end of the
    forearm on a body of any size.
    """

    part: BodyPart
    offset: Vector = (0.0, 0.0, 0.0)
    at_end: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "part", BodyPart(self.part))
        object.__setattr__(self, "offset", finite_vector(self.offset, "A point's offset"))


@dataclass(frozen=True)
class Chain:
    """Which parts may move for a constraint, as weights: 0 is locked, 1 moves freely, between is stiffer."""

    limb: float = 1.0
    end_segment: float = 0.0
    clavicle: float = 1.0
    trunk: float = 0.0
    root: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            weight = getattr(self, field.name)
            if not (math.isfinite(weight) and 0.0 <= weight <= 1.0):
                raise ValueError(f"A chain's weight lies between 0 and 1: {field.name} is {weight}.")
        if not any(getattr(self, field.name) for field in fields(self)):
            raise ValueError("A chain without any free part cannot move its point.")


@dataclass(frozen=True)
class Constraint:
    """What the user asks of a motion, apart from its kind. Priority 0 is the highest."""

    kind: ClassVar[str]
    unit: ClassVar[str] = "m"
    """What its residual is counted in: metres, or radians (``rad``)."""
    motion_id: str
    name: str
    point: BodyPoint
    chain: Chain
    priority: int
    activation: ActivationCurve
    enabled: bool = True

    def __post_init__(self) -> None:
        if self.priority < 0:
            raise ValueError(f"'{self.name}': a priority is 0 (highest) or more, got {self.priority}.")


def finite_vector(values: object, what: str) -> Vector:
    """Three finite floats from any sequence; ValueError beginning with ``what`` otherwise."""
    numbers = tuple(float(value) for value in values)  # type: ignore[attr-defined]
    if len(numbers) != 3 or not all(math.isfinite(number) for number in numbers):
        raise ValueError(f"{what} is three finite numbers in metres, got {values}.")
    return numbers
