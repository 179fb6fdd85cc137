"""Signed distance field of a mesh: built once, evaluated in every frame."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, spline_filter

from studio.core.kernels.tasks import mesh_distance_field as kernel
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.project_cache import project_cache

FloatArray = NDArray[np.float64]

FIELD_NODES = 300_000
"""Approximate number of nodes of the grid, which determines its resolution."""
LEAST_CELL_METRES = 0.003
"""Least distance in metres between nodes: finer than a hand can feel."""
FIELD_MARGIN_CELLS = 4
"""Margin of the grid around the mesh, in cells."""
FIELD_NEAR_CELLS = 3
"""Distance from the mesh in cells within which distances are exact."""


@project_cache(maxsize=8)
def distance_field(mesh: TriangleMesh) -> FloatArray:
    """Signed distance field of ``mesh`` for ``kernels.tasks.mesh_distance_field``: a grid in the mesh's own space."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    cell = _cell(high - low)
    counts = np.ceil((high - low) / cell).astype(int) + 2 * FIELD_MARGIN_CELLS + 1
    origin = 0.5 * (low + high) - 0.5 * (counts - 1) * cell
    corners, normals = np.ascontiguousarray(mesh.vertices[mesh.triangles]), _part_normals(mesh)
    distances, owners = np.full(counts, np.inf), np.zeros(counts, dtype=np.int64)
    kernel.measure_near(corners, normals, origin, cell, FIELD_NEAR_CELLS, distances, owners)
    # Further away a triangle that was found need not be the nearest, and the side of another one says nothing: the
    # side is that of the nearest node that is sure.
    far = np.abs(distances) > (FIELD_NEAR_CELLS - 1) * cell
    nearest = tuple(distance_transform_edt(far, return_distances=False, return_indices=True))
    sides = np.sign(distances[nearest])
    kernel.measure_far(corners, normals, origin, cell, far, np.ascontiguousarray(owners[nearest]), distances)
    distances[far] = np.abs(distances[far]) * sides[far]
    field = np.concatenate([origin, [cell], counts, spline_filter(distances, 3, mode="mirror").ravel()])
    field.setflags(write=False)
    return field


def _cell(size: FloatArray) -> float:
    """Distance in metres between nodes of a grid of about ``FIELD_NODES`` over ``size`` (3,) metres and its margin."""
    cell = max(float(size.max()) / 20.0, LEAST_CELL_METRES)
    while cell > LEAST_CELL_METRES and math.prod(size / cell + 2 * FIELD_MARGIN_CELLS + 1) < FIELD_NODES:
        cell *= 0.97
    return cell


def _part_normals(mesh: TriangleMesh) -> FloatArray:
    """Normals (T, 7, 3) of face, three edges and three corners of each triangle; those of corners are weighted by
    angle.
    """
    corners = mesh.vertices[mesh.triangles]
    along = np.roll(corners, -1, axis=1) - corners
    faces = np.cross(along[:, 0], along[:, 1])
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    unit = along / np.linalg.norm(along, axis=2, keepdims=True)
    angles = np.arccos(np.clip(-np.einsum("tci,tci->tc", unit, np.roll(unit, 1, axis=1)), -1.0, 1.0))
    at_vertices = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(at_vertices, mesh.triangles[:, corner], angles[:, corner, None] * faces)
    ends = np.sort(np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    _, edge = np.unique(ends, axis=0, return_inverse=True)
    edge = edge.reshape(-1, 3)
    at_edges = np.zeros((edge.max() + 1, 3))
    for side in range(3):
        np.add.at(at_edges, edge[:, side], faces)
    return np.concatenate([faces[:, None], at_edges[edge], at_vertices[mesh.triangles]], axis=1)
