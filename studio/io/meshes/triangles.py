"""Points and polygons of a mesh that is read, cut into triangles."""

from array import array
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.triangle_mesh import MOST_TRIANGLES

Points = NDArray[np.float64]
Triangles = NDArray[np.int64]

MAX_INDEX = 1 << 53
"""Greatest index that a float holds exactly."""


class MeshError(ValueError):
    """Error in a mesh file, in words that follow the name of the file."""


class Corners:
    """Polygons, triangulated as fans while they are added."""

    def __init__(self) -> None:
        self._corners = array("q")

    def add(self, polygon: Sequence[int]) -> None:
        """Add a polygon by the indices of its points; one with fewer than three adds nothing."""
        for second, third in pairwise(polygon[1:]):
            self._corners.extend((polygon[0], second, third))
        if len(self._corners) > 3 * MOST_TRIANGLES:
            raise MeshError(f"it has more than {MOST_TRIANGLES} triangles. Reduce it first")

    @property
    def triangles(self) -> Triangles:
        """Triangles (T, 3)."""
        return np.array(self._corners, dtype=np.int64).reshape(-1, 3)


def checked_index(value: float) -> int:
    """Integer of ``value``, if it may be an index."""
    if not (abs(value) < MAX_INDEX and value == int(value)):
        raise MeshError(f"'{str(value)[:20]}' is not the number of a vertex")
    return int(value)
