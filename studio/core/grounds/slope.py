"""A plane that rises or falls from a line on the floor."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from studio.core.grounds.ground import FloatArray, Ground

STEEPEST_GROUND = math.radians(60.0)


@dataclass(frozen=True)
class Slope(Ground):
    """Level up to the line through ``foot`` (x, y), then rising at ``angle`` towards ``direction``, both radians.

    A negative angle goes down. ``direction`` 0 is X, a quarter turn Y.
    """

    kind: ClassVar[str] = "slope"
    angle: float = math.radians(10.0)
    direction: float = 0.0
    foot: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (all(map(math.isfinite, self.foot)) and abs(self.angle) <= STEEPEST_GROUND):
            raise ValueError("A slope has a finite foot and an angle of at most 60 degrees.")

    def rise_at(self, xy: FloatArray) -> FloatArray:
        return math.tan(self.angle) * np.maximum(self._beyond(xy), 0.0)

    def slope_at(self, xy: FloatArray) -> FloatArray:
        on = (self._beyond(xy) >= 0.0).astype(np.float64)
        return math.tan(self.angle) * on[..., None] * direction_vector(self.direction)

    def _beyond(self, xy: FloatArray) -> FloatArray:
        return np.asarray((xy - np.array(self.foot)) @ direction_vector(self.direction))


def direction_vector(direction: float) -> FloatArray:
    """(2,) unit vector at ``direction`` radians from X."""
    return np.array([math.cos(direction), math.sin(direction)])
