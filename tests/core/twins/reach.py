"""Reaching by trying: the best of many angles, sought ever more finely."""

from collections.abc import Callable

import numpy as np

from tests.core.twins.rotation import from_vector


def best_angle(miss: Callable[[np.ndarray], np.ndarray], low: float = -np.pi, high: float = np.pi) -> float:
    """The angle in [low, high] with the least ``miss``, which takes many angles at once."""
    for _ in range(12):
        angles = np.linspace(low, high, 101)
        best = float(angles[np.argmin(miss(angles))])
        width = (high - low) / 50
        low, high = best - width, best + width
    return best


def turned(point: np.ndarray, pivot: np.ndarray, axis: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Positions (N, 3) of a point turned about an axis by each of N angles."""
    return np.asarray(pivot + from_vector(axis * angles[:, None]) @ (point - pivot))


def greatest_distance(root: np.ndarray, middle: np.ndarray, hinge: np.ndarray, point: np.ndarray) -> float:
    """The greatest distance from the root to the point over all angles of the hinge."""

    def distances(angles: np.ndarray) -> np.ndarray:
        return np.asarray(np.linalg.norm(turned(point, middle, hinge, angles) - root, axis=1))

    return float(distances(np.array([best_angle(lambda angles: -distances(angles))]))[0])
