"""A skin: a mesh bound to the segments of a body."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class SkinnedMesh:
    """A triangle mesh in the rest pose of its build, each vertex bound to up to four segments.

    ``vertices`` (V, 3) metres, world space of the rest pose; ``triangles`` (T, 3); ``segments`` (V, 4) indices in
    the canonical layout; ``weights`` (V, 4), each row summing to 1.
    """

    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    segments: NDArray[np.int32]
    weights: NDArray[np.float32]
