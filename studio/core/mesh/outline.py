"""Outline of a body at some height: a horizontal cross-section of its mesh."""

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.skin import SkinnedMesh
from studio.core.project_cache import project_cache

FloatArray = NDArray[np.float64]

_SAME = 4
"""Decimals of a metre to which vertices that lie on one another are the same: looks split them."""


def outline_at(height: float, mesh: SkinnedMesh, vertices: FloatArray, shares: FloatArray) -> FloatArray:
    """Points (N, 2) x, y at which edges of ``mesh``, with its ``vertices`` (V, 3), cross ``height``.

    Only the largest closed or open line is used, so that capes, sleeves and hanging arms are left out, and only its
    vertices with ``shares`` (V,) over a half. Edges are cut because a mesh may have few vertices.
    """
    above = vertices[:, 2] > height
    a, b, c = (np.take(above, corner) for corner in _corners(mesh))
    cut = np.flatnonzero((a != b) | (b != c))
    if not len(cut):
        return np.empty((0, 2))
    triangles, rows = mesh.triangles[cut], np.arange(len(cut))
    alone = np.where(a[cut] == b[cut], 2, np.where(a[cut] == c[cut], 1, 0))
    begin = np.tile(triangles[rows, alone], 2)
    end = np.concatenate([triangles[rows, (alone + turn) % 3] for turn in (1, 2)])
    lines = _lines(_welded(mesh)[begin], _welded(mesh)[end], len(triangles))
    part = ((height - vertices[begin, 2]) / (vertices[end, 2] - vertices[begin, 2]))[:, None]
    places = vertices[begin, :2] + part * (vertices[end, :2] - vertices[begin, :2])
    belongs = shares[begin] + part[:, 0] * (shares[end] - shares[begin]) > 0.5
    places, lines = places[belongs], lines[belongs]
    pieces = [places[lines == line] for line in np.unique(lines)]
    return max(pieces, key=lambda piece: float(np.ptp(piece, axis=0).prod()), default=places)


def _lines(begin: NDArray[np.int64], end: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Index (2 T,) of the connected line of each cut edge of ``count`` triangles T: one edge of each, then the other.

    Components are found by their least node; importing a graph library would take longer than finding all outlines.
    """
    edges = (np.minimum(begin, end) << 32) + np.maximum(begin, end)
    nodes = np.unique(edges, return_inverse=True)[1].ravel()
    one, other = nodes[:count], nodes[count:]
    least = np.arange(nodes.max() + 1)
    while True:
        lower = np.minimum(least[one], least[other])
        joined = least.copy()
        for node in (one, other, least[one], least[other]):
            np.minimum.at(joined, node, lower)
        joined = joined[joined]
        if np.array_equal(joined, least):
            return np.asarray(least[nodes], dtype=np.int64)
        least = joined


@project_cache(maxsize=64)
def _corners(mesh: SkinnedMesh) -> NDArray[np.intp]:
    """Vertices (3, T) of all triangles, corner by corner: the layout that is gathered fastest."""
    return np.ascontiguousarray(mesh.triangles.T, dtype=np.intp)


@project_cache(maxsize=64)
def _welded(mesh: SkinnedMesh) -> NDArray[np.int64]:
    """Index (V,) of each vertex, equal for coincident vertices."""
    return np.unique(np.round(mesh.vertices, _SAME), axis=0, return_inverse=True)[1].ravel()
