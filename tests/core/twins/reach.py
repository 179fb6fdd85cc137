"""Reaching by trying: the best of many angles, sought ever more finely."""

from collections.abc import Callable

import numpy as np

from tests.core.twins.rotation import from_vector


def best_angle(miss: Callable[[float], float], low: float = -np.pi, high: float = np.pi) -> float:
    """The angle in [low, high] with the least ``miss``."""
    for _ in range(12):
        angles = np.linspace(low, high, 101)
        best = angles[np.argmin([miss(angle) for angle in angles])]
        width = (high - low) / 50
        low, high = best - width, best + width
    return best


def turned(point: np.ndarray, pivot: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    return pivot + from_vector(axis * angle) @ (point - pivot)


def greatest_distance(root: np.ndarray, middle: np.ndarray, hinge: np.ndarray, point: np.ndarray) -> float:
    def nearness(angle: float) -> float:
        return -float(np.linalg.norm(turned(point, middle, hinge, angle) - root))

    return -nearness(best_angle(nearness))
