"""A coarser mesh over the same vertices, for pictures of which the next comes at once."""

from functools import lru_cache
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from studio.core.skin import SkinnedMesh

LEFT_OUT = 0.75
"""Part of the triangles that nobody misses in a body of a few hundred pixels that moves."""
FEW = 2000
"""Triangles of a mesh that is coarse already."""


@lru_cache(maxsize=64)
def coarse_triangles(mesh: SkinnedMesh) -> NDArray[np.integer[Any]]:
    """(T, 3) triangles between some of the vertices of ``mesh``; all of its own where these are few."""
    if len(mesh.triangles) < FEW:
        return mesh.triangles
    faces = np.column_stack([np.full(len(mesh.triangles), 3), mesh.triangles]).ravel()
    thin = pv.PolyData(mesh.vertices, faces).decimate_pro(LEFT_OUT, preserve_topology=True, splitting=False)
    places = {vertex.tobytes(): place for place, vertex in enumerate(mesh.vertices)}  # it leaves out, and moves none
    kept = np.array([places[point.tobytes()] for point in np.asarray(thin.points, dtype=np.float32)])
    return np.asarray(kept[thin.faces.reshape(-1, 4)[:, 1:]])
