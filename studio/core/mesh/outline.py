"""Where a mesh is cut across, level: the outline of a body at some height."""

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.skin import SkinnedMesh
from studio.core.project_cache import project_cache

FloatArray = NDArray[np.float64]

_SAME = 4
"""Decimals of a metre to which vertices that lie on one another are the same: looks split them."""


def outline_at(height: float, mesh: SkinnedMesh, vertices: FloatArray, shares: FloatArray) -> FloatArray:
    """(N, 2) places x, y at which edges of ``mesh``, with its ``vertices`` (V, 3), go through a ``height``.

    Those of the largest closed or open line alone, so that capes, sleeves and hanging arms are none of it; and of that
    but where ``shares`` (V,) are over a half. Edges are cut, however few vertices a mesh has.
    """
    above = vertices[:, 2] > height
    a, b, c = (above[corner] for corner in mesh.triangles.T)
    cut = (a != b) | (b != c)
    if not cut.any():
        return np.empty((0, 2))
    triangles, rows = mesh.triangles[cut], np.arange(np.count_nonzero(cut))
    alone = np.where(a == b, 2, np.where(a == c, 1, 0))[cut]
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
    """(2 T,) the line that each cut edge of ``count`` triangles T is on: one edge of each, then the other of each.

    A union-find over the few edges that are cut: a graph library takes longer to load than all outlines to be found.
    """
    edges = (np.minimum(begin, end) << 32) + np.maximum(begin, end)
    nodes: list[int] = np.unique(edges, return_inverse=True)[1].ravel().tolist()
    parents = list(range(max(nodes) + 1))

    def root(node: int) -> int:
        while parents[node] != node:
            parents[node] = node = parents[parents[node]]
        return node

    for one, other in zip(nodes[:count], nodes[count:], strict=True):
        first, second = sorted((root(one), root(other)))
        parents[second] = first
    return np.array([root(node) for node in nodes])


@project_cache(maxsize=64)
def _welded(mesh: SkinnedMesh) -> NDArray[np.int64]:
    """(V,) the same number for vertices that lie on one another."""
    return np.unique(np.round(mesh.vertices, _SAME), axis=0, return_inverse=True)[1].ravel()
