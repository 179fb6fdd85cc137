"""Tracks seen through a window that slides over their frames; at both ends the last frame is held.

What reads captures takes these: SciPy's do the same, and importing them takes a third of the time that ``info`` may.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
T = TypeVar("T", np.float64, np.bool_)

BELL_DEVIATIONS = 4.0
"""Standard deviations after which a bell ends."""


def bell_average(track: ArrayLike, sigma: float) -> FloatArray:
    """(F,) or (F, 3) averaged under a bell of ``sigma`` frames."""
    values = np.asarray(track, dtype=float)
    reach = int(BELL_DEVIATIONS * sigma + 0.5)
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(sigma, 1e-9)) ** 2)
    bell /= bell.sum()
    held = _held(values, reach)
    columns = [np.convolve(column, bell, mode="valid") for column in held.reshape(len(held), -1).T]
    return np.stack(columns, axis=-1).reshape(values.shape)


def highest(track: NDArray[T], reach: int) -> NDArray[T]:
    """(F,) the highest of each frame and of those up to ``reach`` frames from it; of truths, whether one is."""
    return np.asarray(np.lib.stride_tricks.sliding_window_view(_held(track, reach), 2 * reach + 1).max(axis=1))


def lowest(track: NDArray[T], reach: int) -> NDArray[T]:
    """As ``highest``, the other way."""
    return np.asarray(np.lib.stride_tricks.sliding_window_view(_held(track, reach), 2 * reach + 1).min(axis=1))


def _held(track: NDArray[T], reach: int) -> NDArray[T]:
    return np.concatenate([np.repeat(track[:1], reach, axis=0), track, np.repeat(track[-1:], reach, axis=0)])
