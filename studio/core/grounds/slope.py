"""Ground that rises or falls as a plane from a line on the floor."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from studio.core.grounds.ground import FloatArray, Ground

STEEPEST_GROUND_RADIANS = math.radians(60.0)
"""Greatest slope angle in radians."""


@dataclass(frozen=True)
class Slope(Ground):
    """Ground that is level up to the line through ``foot`` (x, y), then rises at ``angle`` towards ``direction``
    (radians).

    A negative angle goes down. ``direction`` is 0 for X and a quarter turn for Y.
    """

    kind: ClassVar[str] = "slope"
    angle: float = math.radians(10.0)
    direction: float = 0.0
    foot: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (all(map(math.isfinite, self.foot)) and abs(self.angle) <= STEEPEST_GROUND_RADIANS):
            raise ValueError("A slope has a finite foot and an angle of at most 60 degrees.")

    def rise_at(self, xy: FloatArray) -> FloatArray:
        return math.tan(self.angle) * np.maximum(self._beyond(xy), 0.0)

    def slope_at(self, xy: FloatArray) -> FloatArray:
        on = (self._beyond(xy) >= 0.0).astype(np.float64)
        return math.tan(self.angle) * on[..., None] * direction_vector(self.direction)

    def _beyond(self, xy: FloatArray) -> FloatArray:
        return np.asarray((xy - np.array(self.foot)) @ direction_vector(self.direction))


def direction_vector(direction: float) -> FloatArray:
    """Unit vector (2,) at ``direction`` radians from X."""
    return np.array([math.cos(direction), math.sin(direction)])
