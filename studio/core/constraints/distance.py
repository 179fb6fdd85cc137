"""Distance: two points of the body, or one and a place outside, are to be so far apart."""

import math
from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import BodyPoint, Constraint, Vector, finite_vector


@dataclass(frozen=True)
class DistanceConstraint(Constraint):
    """``point`` is to be ``distance`` metres from ``other``, a point of the same body or, as three numbers, a place.

    Zero makes them touch: a clap, both hands on a box of any size, a hand on the own thigh. Raises ValueError for a
    distance below zero or a point with itself.
    """

    kind: ClassVar[str] = "distance"
    other: BodyPoint | Vector = (0.0, 0.0, 0.0)
    distance: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.other, BodyPoint):
            object.__setattr__(self, "other", finite_vector(self.other, f"'{self.name}': the place outside"))
        elif self.other == self.point:
            raise ValueError(f"'{self.name}': a point has no distance from itself. Choose another point.")
        if not (math.isfinite(self.distance) and self.distance >= 0.0):
            raise ValueError(f"'{self.name}': a distance is zero or more metres, got {self.distance}.")
