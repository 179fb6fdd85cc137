"""Ground given by heights on a regular grid."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from studio.core.grounds.ground import FloatArray, Ground
from studio.core.plausible import GROUND_RANGE

if TYPE_CHECKING:
    from scipy.interpolate import RectBivariateSpline

LEAST_SPLINE_HEIGHTS = 4
"""Least number of heights in each direction for a bicubic spline; smaller maps are extended by their edge values."""


@dataclass(frozen=True, eq=False)
class HeightMap(Ground):
    """Ground through ``heights`` (X cells, Y cells) in metres on a regular grid, interpolated by a bicubic spline.

    The points are ``cell`` metres apart, the first at ``origin`` (x, y). Outside the grid, the ground continues with
    the heights of its edge.
    """

    kind: ClassVar[str] = "height_map"
    heights: FloatArray = field(default_factory=lambda: np.zeros((2, 2)))
    cell: float = 0.25
    origin: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        heights = np.array(self.heights, dtype=np.float64)
        if heights.ndim != 2 or min(heights.shape) < 2 or not np.isfinite(heights).all():
            raise ValueError("A height map has at least 2 x 2 finite heights.")
        GROUND_RANGE.check(heights)
        if not (self.cell > 0.0 and all(map(math.isfinite, self.origin))):
            raise ValueError("A height map has cells larger than zero and a finite origin.")
        heights.setflags(write=False)
        object.__setattr__(self, "heights", heights)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, HeightMap)
            and (self.height, self.cell, self.origin) == (other.height, other.cell, other.origin)
            and np.array_equal(self.heights, other.heights)
        )

    def __hash__(self) -> int:
        return hash((self.height, self.cell, self.origin, self.heights.shape))

    def rise_at(self, xy: FloatArray) -> FloatArray:
        cells, _ = self._cells(xy)
        return np.asarray(self._surface.ev(cells[..., 0], cells[..., 1]))

    def slope_at(self, xy: FloatArray) -> FloatArray:
        cells, inside = self._cells(xy)
        x, y = cells[..., 0], cells[..., 1]
        slopes = np.stack([self._surface.ev(x, y, dx=1), self._surface.ev(x, y, dy=1)], axis=-1)
        return np.where(inside, slopes / self.cell, 0.0)

    def _cells(self, xy: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions in units of cells, clamped to the map, and a mask (..., 2) of the axes along which they
        are inside.
        """
        cells = (xy - np.array(self.origin)) / self.cell
        held = np.clip(cells, 0.0, np.array(self.heights.shape) - 1.0)
        return held, held == cells

    @cached_property
    def _surface(self) -> "RectBivariateSpline":
        missing = [(0, max(LEAST_SPLINE_HEIGHTS - count, 0)) for count in self.heights.shape]
        heights = np.pad(self.heights, missing, mode="edge")
        rows, columns = heights.shape
        from scipy.interpolate import RectBivariateSpline

        return RectBivariateSpline(np.arange(rows), np.arange(columns), heights)
