"""Ground given by triangles: scanned floors, ramps and blocks made elsewhere."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from studio.core.grounds.ground import FloatArray, Ground
from studio.core.plausible import MESH_RANGE

if TYPE_CHECKING:
    from studio.core.kernels.support.triangle_grid import TriangleGrid

MOST_GRID_CELLS = 512
"""Maximum number of cells of the search grid along its longer side."""


@dataclass(frozen=True, eq=False)
class SurfaceMesh(Ground):
    """Ground of triangles: ``vertices`` (V, 3) in metres and ``triangles`` (T, 3); the highest over a position counts.

    Where there is no triangle, the ground is level at ``height``.
    """

    kind: ClassVar[str] = "mesh"
    vertices: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    triangles: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))

    def __post_init__(self) -> None:
        super().__post_init__()
        vertices = np.array(self.vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.array(self.triangles, dtype=np.int64).reshape(-1, 3)
        if not np.isfinite(vertices).all():
            raise ValueError("A ground mesh has a vertex that is not finite.")
        MESH_RANGE.check(vertices)
        if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
            raise ValueError("A ground mesh has a triangle whose corner is not a vertex.")
        for name, array in (("vertices", vertices), ("triangles", triangles)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, SurfaceMesh)
            and self.height == other.height
            and np.array_equal(self.vertices, other.vertices)
            and np.array_equal(self.triangles, other.triangles)
        )

    def __hash__(self) -> int:
        return hash((self.height, self.vertices.shape, self.triangles.shape))

    def rise_at(self, xy: FloatArray) -> FloatArray:
        return self._look(xy)[0]

    def slope_at(self, xy: FloatArray) -> FloatArray:
        return self._look(xy)[1]

    def _look(self, xy: FloatArray) -> tuple[FloatArray, FloatArray]:
        places = np.ascontiguousarray(xy, dtype=np.float64).reshape(-1, 2)
        heights, slopes = np.zeros(len(places)), np.zeros((len(places), 2))
        if len(self.triangles):
            from studio.core.kernels.support.triangle_grid import highest_triangles  # late: it loads numba

            found = np.zeros(len(places), dtype=np.bool_)
            highest_triangles(places, self._grid, heights, slopes, found)
        return heights.reshape(xy.shape[:-1]), slopes.reshape(xy.shape)

    @cached_property
    def _grid(self) -> "TriangleGrid":
        """Triangles over each cell of a horizontal grid; a cell has about the size of a triangle."""
        from studio.core.kernels.support.triangle_grid import TriangleGrid  # late: it loads numba

        corners = np.ascontiguousarray(self.vertices[self.triangles])
        low, high = corners[..., :2].min(axis=1), corners[..., :2].max(axis=1)
        origin, end = low.min(axis=0), high.max(axis=0)
        size = max(
            math.sqrt(float(np.prod(end - origin)) / len(corners)), float((end - origin).max()) / MOST_GRID_CELLS
        )
        size = max(size, 1e-3)
        rows, columns = (np.floor((end - origin) / size).astype(int) + 1).tolist()
        first, last = (np.floor((ends - origin) / size).astype(int) for ends in (low, high))
        wide = last - first + 1
        owners = np.repeat(np.arange(len(corners)), wide.prod(axis=1))
        place = np.arange(len(owners)) - np.repeat(np.cumsum(wide.prod(axis=1)) - wide.prod(axis=1), wide.prod(axis=1))
        cells = (first[owners, 0] + place // wide[owners, 1]) * columns + first[owners, 1] + place % wide[owners, 1]
        order = np.argsort(cells, kind="stable")
        starts = np.searchsorted(cells[order], np.arange(rows * columns + 1))
        return TriangleGrid(corners, starts, owners[order], origin, size, rows, columns)
