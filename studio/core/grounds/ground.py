"""Ground under the performers: a height and a slope at every position.

The base class is level. Other kinds (``studio.core.grounds``) derive from it and add to its height. A project has one
ground.
"""

import math
from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.plausible import GROUND_RANGE

FloatArray = NDArray[np.float64]
LEVEL_TOLERANCE_METRES = 1e-9
"""Difference in metres, by rounding, of heights that count as one level."""


@dataclass(frozen=True)
class Ground:
    """Level ground at ``height`` metres; for other kinds the level from which they rise and sink."""

    kind: ClassVar[str] = "flat"
    height: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.type is float and isinstance(value, int):
                value = float(value)  # kernels are compiled once more for an int
                object.__setattr__(self, field.name, value)
            if isinstance(value, int | float) and not math.isfinite(value):
                raise ValueError(f"The ground's {field.name} is a finite number of metres, got {value}.")
            if isinstance(value, float | tuple):
                GROUND_RANGE.check(value)

    @property
    def is_level(self) -> bool:
        """True if the ground has one height everywhere."""
        return type(self) is Ground

    def height_at(self, positions: ArrayLike) -> FloatArray:
        """Heights (...) in metres at ``positions`` (..., 2 or 3)."""
        xy = np.asarray(positions, dtype=np.float64)[..., :2]
        return self.height + self.rise_at(xy)

    def normal_at(self, positions: ArrayLike) -> FloatArray:
        """Unit normals (..., 3), pointing up, at ``positions`` (..., 2 or 3)."""
        slope = self.slope_at(np.asarray(positions, dtype=np.float64)[..., :2])
        normal = np.concatenate([-slope, np.ones((*slope.shape[:-1], 1))], axis=-1)
        return np.asarray(normal / np.linalg.norm(normal, axis=-1, keepdims=True))

    def rise_at(self, xy: FloatArray) -> FloatArray:
        """Heights (...) in metres above ``height`` at positions ``xy`` (..., 2)."""
        return np.zeros(xy.shape[:-1])

    def slope_at(self, xy: FloatArray) -> FloatArray:
        """Slopes (..., 2), metres per metre along X and Y, at positions ``xy`` (..., 2)."""
        return np.zeros(xy.shape)

    def foothold_offsets(self, soles: FloatArray) -> FloatArray:
        """Horizontal displacements (N, 2) in metres of soles (N, 3, 2: heel, ball, tip) to better footholds; zero by
        default.
        """
        return np.zeros((len(soles), 2))

    def felt_at(self, positions: ArrayLike) -> "Ground":
        """This ground, or a level one if the ground has one height at all ``positions`` (..., 2 or 3)."""
        if self.is_level or np.abs(self.height_at(positions) - self.height).max() > LEVEL_TOLERANCE_METRES:
            return self
        return Ground(self.height)

    def at_height(self, height: float) -> "Ground":
        """Copy of the ground at another height, in metres."""
        return replace(self, height=height)

    def seen_from(self, position: tuple[float, float], heading: float) -> "Ground":
        """This ground in the axes of a performer at ``position`` (metres) with ``heading`` (radians)."""
        return self if self.is_level else PlacedGround(self.height, self, position, heading)


@dataclass(frozen=True)
class PlacedGround(Ground):
    """Ground in the axes of a performer's motion; made for solving, never stored."""

    kind: ClassVar[str] = "placed"
    ground: Ground = Ground()
    position: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0

    def at_height(self, height: float) -> Ground:
        return replace(self, height=height, ground=self.ground.at_height(height))

    def rise_at(self, xy: FloatArray) -> FloatArray:
        return self.ground.rise_at(self._outside(xy))

    def slope_at(self, xy: FloatArray) -> FloatArray:
        return self.ground.slope_at(self._outside(xy)) @ self._turn

    def foothold_offsets(self, soles: FloatArray) -> FloatArray:
        return self.ground.foothold_offsets(self._outside(soles)) @ self._turn

    @property
    def _turn(self) -> FloatArray:
        c, s = math.cos(self.heading), math.sin(self.heading)
        return np.array([[c, -s], [s, c]])

    def _outside(self, xy: FloatArray) -> FloatArray:
        return np.asarray(xy @ self._turn.T + np.array(self.position))
