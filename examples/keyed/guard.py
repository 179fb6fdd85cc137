"""The fighting stance that kick and punch begin and end in: left foot in front, hands before the chin."""

import numpy as np

from .curves import FloatArray, Keys, curve, drift, spring
from .performer import STANDING

FRONT, REAR = (0.23, 0.10), (-0.23, -0.14)
"""Under the ankles of the left foot in front and the right foot behind."""
FRONT_YAW, REAR_YAW = -14.0, -47.0
REAR_HEEL = 9.0
"""Degrees by which the heel behind is off the ground."""
HEIGHT = STANDING - 0.070
LEFT_GUARD, RIGHT_GUARD = (0.29, -0.08, 0.03), (0.19, 0.10, 0.0)
"""Wrists from their shoulders, in the axes of the chest."""
LEFT_ELBOW, RIGHT_ELBOW = np.array([-0.35, 0.45, -1.0]), np.array([-0.35, -0.35, -1.0])


def bounce(times: FloatArray, ease: Keys, period: float = 0.58) -> FloatArray:
    """Springing on both knees (F,), from 0, low, to 1, high, as strong as ``ease`` says; no two alike."""
    beat = 2 * np.pi * times / period + 0.5 * drift(times, 11)
    strength = curve(times, ease, soft=0.1) * (0.85 + 0.2 * drift(times, 12, 1.9))
    return strength * (0.5 - 0.5 * np.cos(beat + 0.4 * np.sin(beat)))


def rocking(times: FloatArray, seed: int) -> FloatArray:
    """Weight going from foot to foot, forward and left in metres (F, 2)."""
    return np.stack([0.012 * drift(times, seed, 1.7), 0.006 * drift(times, seed + 1, 2.3)], axis=1)


def guarding(times: FloatArray, place: tuple[float, float, float], beat: FloatArray, seed: int) -> FloatArray:
    """A wrist (F, 3) in guard: it hangs behind the bounce a little and wanders."""
    wander = np.stack([drift(times, seed + k, 2.0) for k in range(3)], axis=1)
    heavy = spring(times, beat, 2.6, 0.5)
    return np.array(place) + 0.007 * wander + (heavy - beat)[:, None] * [0.006, 0.0, 0.022]


def moved(times: FloatArray, wrist: FloatArray, keys: Keys, soft: float = 0.03, delay: float = 0.0) -> FloatArray:
    """``wrist`` (F, 3) with keyed offsets in metres."""
    return wrist + curve(times, keys, soft, delay)
