"""Distance constraints between two points of a body, or one point and a position."""

import math
from dataclasses import dataclass
from typing import ClassVar

from studio.core.constraints.base import BodyPoint, Constraint, KindInfo
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.target import Place, checked_place
from studio.core.curves.keyed import KeyedNumber
from studio.core.plausible import PLACE_RANGE


@dataclass(frozen=True)
class DistanceConstraint(Constraint):
    """Constraint that keeps ``point`` at ``distance`` metres from ``other``.

    ``other`` is a point of the same body, or a fixed, keyed or followed position. A distance of zero makes the points
    touch: a clap, both hands on a box of any size, a hand on the own thigh. Raises ValueError for a distance below zero
    or between a point and itself.
    """

    kind: ClassVar[str] = "distance"
    shown: ClassVar[KindInfo] = KindInfo(
        "Add distance constraint",
        "Keep the distance between both wrists or hands, or from another picked joint to a position",
        "#C78BD0", held_by="other", handle="other end", picks=True,
    )  # fmt: skip
    other: BodyPoint | Place = (0.0, 0.0, 0.0)
    distance: float | KeyedNumber = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.other, FollowBody):
            object.__setattr__(self, "other", self.other.point)
        if not isinstance(self.other, BodyPoint):
            object.__setattr__(self, "other", checked_place(self.other, self, "the fixed position"))
        elif self.other == self.point:
            raise ValueError(
                f"'{self.name}': the distance of a point from itself cannot be constrained. Choose another point."
            )
        distances = self.distance.values if isinstance(self.distance, KeyedNumber) else (self.distance,)
        for distance in distances:
            if not (math.isfinite(distance) and distance >= 0.0):
                raise ValueError(f"'{self.name}': the distance must be 0 or more metres, not {distance}.")
        PLACE_RANGE.check(distances, f"'{self.name}': a distance")
