"""Jacobian of points by brute force: turn a joint a little and look."""

import numpy as np

from studio.core.body.canonical import BodyLayout
from tests.core.twins.body import turn_part
from tests.core.twins.rotation import from_vector

LITTLE = 1e-6


def lever(
    layout: BodyLayout, segment: int, point: int, direction: np.ndarray, positions: np.ndarray, rotations: np.ndarray
) -> np.ndarray:
    """(3,) how far ``point`` goes along ``direction`` for a small turn of ``segment`` about each world axis."""
    moved = [
        turn_part(layout, from_vector(LITTLE * axis), segment, positions, rotations)[0][point] for axis in np.eye(3)
    ]
    return np.array([(each - positions[point]) @ direction / LITTLE for each in moved])
