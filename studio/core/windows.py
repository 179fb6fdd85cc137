"""Sliding windows over the frames of a track; at both ends the last frame is held.

SciPy has the same, but importing it would take a third of the time that ``info`` may need.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
T = TypeVar("T", np.float64, np.bool_)

BELL_DEVIATIONS = 4.0
"""Half width of a Gaussian window in standard deviations."""


def bell_average(track: ArrayLike, sigma: float) -> FloatArray:
    """Gaussian moving average of ``track`` (F,) or (F, 3), of the same shape; ``sigma`` is in frames."""
    values = np.asarray(track, dtype=float)
    reach = int(BELL_DEVIATIONS * sigma + 0.5)
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(sigma, 1e-9)) ** 2)
    bell /= bell.sum()
    held = _held(values, reach)
    columns = [np.convolve(column, bell, mode="valid") for column in held.reshape(len(held), -1).T]
    return np.stack(columns, axis=-1).reshape(values.shape)


def sliding_maximum(track: NDArray[T], reach: int) -> NDArray[T]:
    """Maximum (F,) of ``track`` (F,) within ``reach`` frames before and after each frame; for booleans,
    True if any is.
    """
    return np.asarray(np.lib.stride_tricks.sliding_window_view(_held(track, reach), 2 * reach + 1).max(axis=1))


def sliding_minimum(track: NDArray[T], reach: int) -> NDArray[T]:
    """Minimum (F,) of ``track`` (F,) within ``reach`` frames before and after each frame; for booleans, True if all
    are.
    """
    return np.asarray(np.lib.stride_tricks.sliding_window_view(_held(track, reach), 2 * reach + 1).min(axis=1))


def _held(track: NDArray[T], reach: int) -> NDArray[T]:
    return np.concatenate([np.repeat(track[:1], reach, axis=0), track, np.repeat(track[-1:], reach, axis=0)])
