"""Curves through keys: what an animator sets by hand, and the small life that no hold is without."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

FloatArray = NDArray[np.float64]
Keys = Mapping[float, float | Sequence[float] | FloatArray]

_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(17)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


def curve(times: FloatArray, keys: Keys, soft: float = 0.05, delay: float = 0.0) -> FloatArray:
    """Values (F,) or (F, n) through ``keys`` (seconds: value), held before the first and after the last.

    Monotone cubics, so a hold stays a hold, seen through a Gaussian of ``soft`` seconds, which rounds off the
    changes of acceleration at the keys. ``delay`` lets a part follow the one that leads it.
    """
    moments = np.array(sorted(keys))
    values = np.array([keys[moment] for moment in moments], dtype=np.float64)
    if len(moments) == 1:
        return np.repeat(values, len(times), axis=0)
    slopes = PchipInterpolator(moments, values)(moments, nu=1)
    slopes[[0, -1]] = 0.0
    spline = CubicHermiteSpline(moments, values, slopes)
    sampled = spline(np.clip(times[:, None] - delay + soft * _NODES, moments[0], moments[-1]))
    return np.einsum("fk...,k->f...", sampled, _WEIGHTS)


def drift(times: FloatArray, seed: int, period: float = 2.6) -> FloatArray:
    """Wandering (F,) of amplitude about 1: sines that never meet again, the quicker the smaller, as people sway."""
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, 5)
    rates = 2 * np.pi / period * np.array([1.0, 0.618, 1.732, 3.1, 5.3])
    return np.sin(times[:, None] * rates + phases) @ np.array([0.6, 0.5, 0.25, 0.12, 0.06])


def breath(times: FloatArray, period: float = 3.6) -> FloatArray:
    """Breathing (F,) from 0, out, to 1, in: in is quicker than out."""
    phase = 2 * np.pi * times / period
    return 0.5 - 0.5 * np.cos(phase + 0.35 * np.sin(phase))


def spring(times: FloatArray, values: FloatArray, frequency: float, damping: float) -> FloatArray:
    """``values`` (F, ...) as a loose part follows them: late, a little beyond, then settling.

    A damped oscillator of ``frequency`` Hz drawn to the values (semi-implicit Euler, eight steps a frame).
    """
    stiffness, friction = (2 * np.pi * frequency) ** 2, 4 * np.pi * frequency * damping
    place, speed, followed = values[0].copy(), np.zeros_like(values[0]), np.empty_like(values)
    steps = 8
    for frame, step in enumerate(np.diff(times, prepend=times[0]) / steps):
        for k in range(1, steps + 1):
            goal = values[max(frame - 1, 0)] * (1 - k / steps) + values[frame] * (k / steps)
            speed = speed + step * (stiffness * (goal - place) - friction * speed)
            place = place + step * speed
        followed[frame] = place
    return followed
