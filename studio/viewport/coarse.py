"""Coarse skins with fewer vertices, for images during motion."""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.hand_shapes import HandShapes
from studio.core.mesh.skin import SkinnedMesh
from studio.core.project_cache import project_cache

COARSE_TRIANGLES = 2000
"""Number of triangles up to which a mesh is not simplified."""
CLUSTER_EDGES = 2.8
"""Edge length of a grid cell, whose vertices become one, in mean edges of the mesh; a quarter of the triangles
remains.
"""

_beside = ThreadPoolExecutor(1, thread_name_prefix="coarse skins")


def coarse_skin_beside(mesh: SkinnedMesh) -> Future[SkinnedMesh]:
    """Future of ``coarse_skin``, which takes a tenth of a second for a body of 100,000 triangles."""
    return _beside.submit(coarse_skin, mesh)


@project_cache(maxsize=64)
def coarse_skin(mesh: SkinnedMesh) -> SkinnedMesh:
    """``mesh`` with the triangles of ``coarse_triangles`` and only their vertices; a skin with materials is
    unchanged.
    """
    triangles = coarse_triangles(mesh)
    if mesh.appearance is not None or triangles is mesh.triangles:
        return mesh
    kept, corners = np.unique(triangles, return_inverse=True)
    hands = mesh.hands
    if hands is not None:
        own = kept[kept >= len(mesh.vertices) - hands.count] - (len(mesh.vertices) - hands.count)
        hands = HandShapes(hands.vertices[:, own], hands.normals[:, own])
    rig = mesh.rig
    if rig is not None:
        rig = replace(rig, joints=rig.joints[kept], weights=rig.weights[kept])
    rows = {name: getattr(mesh, name)[kept] for name in ("vertices", "normals", "centres", "segments", "weights")}
    faces = np.asarray(corners, dtype=np.int32).reshape(-1, 3)
    return replace(mesh, triangles=faces, hands=hands, rig=rig, **rows)


def coarse_triangles(mesh: SkinnedMesh) -> NDArray[np.int32]:
    """(T, 3) triangles between a subset of the vertices of ``mesh``; its own triangles if it has few.

    Vertices in one grid cell with the same segment and a similar normal are merged into the one nearest to their mean,
    which is invisible on a moving body a few hundred pixels high.
    """
    if len(mesh.triangles) < COARSE_TRIANGLES:
        return mesh.triangles
    places, faces = mesh.vertices.astype(np.float64), mesh.triangles
    edges = np.linalg.norm(places[faces[:, 0]] - places[faces[:, 1]], axis=1)
    cells = np.floor((places - places.min(axis=0)) / (CLUSTER_EDGES * np.median(edges))).astype(np.int64)
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
