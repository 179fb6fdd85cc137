"""Triangle mesh: an imported surface, in metres."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.plausible import MESH_RANGE

MOST_TRIANGLES = 2_000_000


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangle mesh: ``vertices`` (V, 3) in metres and ``triangles`` (T, 3), counter-clockwise seen from outside.

    Coincident vertices are merged, and triangles without area are dropped. Raises ValueError for a mesh without
    triangles, for an index of a missing vertex, and for numbers that are not finite.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.array(self.triangles, dtype=np.int64).reshape(-1, 3)
        if not np.isfinite(vertices).all():
            raise ValueError("A mesh has a vertex that is not finite.")
        MESH_RANGE.check(vertices)
        if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
            raise ValueError("A mesh has a triangle whose corner is not a vertex.")
        if len(triangles) > MOST_TRIANGLES:
            raise ValueError(f"A mesh has {len(triangles)} triangles, more than {MOST_TRIANGLES}. Reduce it first.")
        vertices, triangles = _welded(vertices, triangles)
        if not len(triangles):
            raise ValueError("A mesh needs at least one triangle with an area.")
        for name, array in (("vertices", vertices), ("triangles", triangles)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TriangleMesh) and self._digest == other._digest

    def __hash__(self) -> int:
        return hash(self._digest)

    @cached_property
    def _digest(self) -> bytes:
        return hashlib.sha256(self.vertices.tobytes() + self.triangles.tobytes()).digest()


def _welded(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices, of which those nearer than a millionth of the mesh's size are merged, and the triangles that have an
    area.
    """
    if not len(triangles):
        return vertices, triangles
    size = max(float(np.ptp(vertices, axis=0).max()), 1e-9)
    _, first, merged = np.unique(np.round(vertices / size * 1e6), axis=0, return_index=True, return_inverse=True)
    triangles = merged.reshape(-1)[triangles]
    a, b, c = (vertices[first[triangles[:, corner]]] for corner in range(3))
    kept = triangles[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12 * size * size]
    used, renumbered = np.unique(kept, return_inverse=True)
    return vertices[first[used]], renumbered.reshape(-1, 3)
