"""A coarser mesh over the same vertices, for pictures of which the next comes at once."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.skin import SkinnedMesh

FEW = 2000
"""Triangles of a mesh that is coarse already."""
CELL = 2.8
"""Edges of a mesh that are as long as a cell, whose vertices become one: a quarter of the triangles is left."""


@lru_cache(maxsize=64)
def coarse_triangles(mesh: SkinnedMesh) -> NDArray[np.int32]:
    """(T, 3) triangles between some of the vertices of ``mesh``; all of its own where these are few.

    Vertices of one cell of a grid that move with one segment and face one way become the one nearest to their middle:
    nobody misses the others in a body of a few hundred pixels that moves.
    """
    if len(mesh.triangles) < FEW:
        return mesh.triangles
    places, faces = mesh.vertices.astype(np.float64), mesh.triangles
    edges = np.linalg.norm(places[faces[:, 0]] - places[faces[:, 1]], axis=1)
    cells = np.floor((places - places.min(axis=0)) / (CELL * np.median(edges))).astype(np.int64)
    alike = [*cells.T, *(mesh.normals.T > 0.0), mesh.segments[:, 0]]
    numbers = np.ravel_multi_index(alike, [each.max() + 1 for each in alike])
    _, cell_of, sizes = np.unique(numbers, return_inverse=True, return_counts=True)
    middles = np.stack([np.bincount(cell_of, column) / sizes for column in places.T], axis=1)
    by_distance = np.argsort(np.linalg.norm(places - middles[cell_of], axis=1))
    kept = np.empty(len(sizes), dtype=faces.dtype)
    kept[cell_of[by_distance[::-1]]] = by_distance[::-1]
    fewer = kept[cell_of[faces]]
    corners = np.sort(fewer, axis=1)
    whole = (corners[:, 1:] != corners[:, :-1]).all(axis=1)
    return np.asarray(fewer[whole])
