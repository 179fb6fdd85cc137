"""Height of triangle meshes: the highest triangle over a position, by a grid of cells (METHOD 5)."""

import math
from typing import NamedTuple

from studio.core.kernels.compiling import kernel
from studio.core.kernels.records import Array


class TriangleGrid(NamedTuple):
    """T triangles indexed by the cells of a horizontal grid."""

    corners: Array
    """(T, 3, 3) metres."""
    starts: Array
    """(rows * columns + 1,) first index in ``members`` of each cell c = i * columns + j, and the number of members."""
    members: Array
    """Indices of the triangles over each cell c: ``members[starts[c] : starts[c + 1]]``."""
    origin: Array
    """(2,) position of the first cell's corner, metres."""
    size: float
    """Edge of a square cell, metres."""
    rows: int
    columns: int


@kernel
def highest_triangles(xy, grid, out_heights, out_slopes, out_found):
    """Write height (N,), slope (N, 2) and presence (N,) of the highest triangle over each position ``xy`` (N, 2).

    Heights and slopes of positions without a triangle are not changed.
    """
    corners, starts, members, origin, size, rows, columns = grid
    for n in range(xy.shape[0]):
        out_found[n] = False
        i, j = math.floor((xy[n, 0] - origin[0]) / size), math.floor((xy[n, 1] - origin[1]) / size)
        if i < 0 or j < 0 or i >= rows or j >= columns:
            continue
        c = int(i * columns + j)
        for m in range(starts[c], starts[c + 1]):
            a, b, d = corners[members[m], 0], corners[members[m], 1], corners[members[m], 2]
            ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], d[0] - a[0], d[1] - a[1]
            area = ux * vy - uy * vx
            if abs(area) < 1e-12:
                continue
            px, py = xy[n, 0] - a[0], xy[n, 1] - a[1]
            s, t = (px * vy - py * vx) / area, (ux * py - uy * px) / area
            if s < -1e-9 or t < -1e-9 or s + t > 1.0 + 1e-9:
                continue
            rise, run = b[2] - a[2], d[2] - a[2]
            height = a[2] + s * rise + t * run
            if not out_found[n] or height > out_heights[n]:
                out_found[n] = True
                out_heights[n] = height
                out_slopes[n, 0] = (rise * vy - run * uy) / area
                out_slopes[n, 1] = (run * ux - rise * vx) / area
