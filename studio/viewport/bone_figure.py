"""Bones shading: one slender octahedron for each segment."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout
from studio.core.body.sticks import bone_pairs
from studio.viewport.live_mesh import LiveMesh

THICKEST_AT = 0.18
THICKNESS = 0.11
_WAIST = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
_FACETS = np.array([[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [5, 1, 2], [5, 2, 3], [5, 3, 4], [5, 4, 1]])
"""Vertices of each facet, counter-clockwise from outside: 0 start, 1 to 4 waist, 5 end."""


class BoneFigure:
    """Mesh of octahedra between the points of a body."""

    def __init__(self, layout: BodyLayout) -> None:
        self._pairs = bone_pairs(layout)
        corners = 24 * len(self._pairs)
        # Every facet has its own corners, so that facets are flat.
        self.mesh = LiveMesh(corners, np.arange(corners).reshape(-1, 3))

    def pose(self, positions: NDArray[np.float64]) -> None:
        """Move the octahedra to the body points ``positions`` (N, 3)."""
        begin, end = positions[self._pairs[:, 0]], positions[self._pairs[:, 1]]
        along = end - begin
        length = np.linalg.norm(along, axis=1, keepdims=True)
        direction = along / np.maximum(length, 1e-9)
        side = np.cross(direction, np.where(np.abs(direction[:, :1]) < 0.8, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
        side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
        across = np.stack([side, np.cross(direction, side)], axis=1)
        radius = np.clip(THICKNESS * length, 0.008, 0.05)[:, :, None]
        waist = begin[:, None] + THICKEST_AT * along[:, None] + radius * (_WAIST @ across)
        corners = np.concatenate([begin[:, None], waist, end[:, None]], axis=1)[:, _FACETS]
        normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
        self.mesh.points[:] = corners.reshape(-1, 3)
        self.mesh.normals[:] = np.repeat(normals.reshape(-1, 3), 3, axis=0)
        self.mesh.touch()
