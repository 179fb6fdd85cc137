"""Sliding windows over the frames of a track; at both ends the last frame is held.

SciPy has the same, but importing it would take a third of the time that ``info`` may need.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
T = TypeVar("T", np.float64, np.bool_)

BELL_DEVIATIONS = 4.0
"""Standard deviations after which a bell ends."""


def bell_average(track: ArrayLike, sigma: float) -> FloatArray:
    """(F,) or (F, 3) Gaussian average of ``sigma`` frames."""
    values = np.asarray(track, dtype=float)
    reach = int(BELL_DEVIATIONS * sigma + 0.5)
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(sigma, 1e-9)) ** 2)
    bell /= bell.sum()
    held = _held(values, reach)
    columns = [np.convolve(column, bell, mode="valid") for column in held.reshape(len(held), -1).T]
    return np.stack(columns, axis=-1).reshape(values.shape)


def highest(track: NDArray[T], reach: int) -> NDArray[T]:
    """(F,) maximum over the frames up to ``reach`` frames from each; of booleans, true if any is."""
    return np.asarray(np.lib.stride_tricks.sliding_window_view(_held(track, reach), 2 * reach + 1).max(axis=1))


def lowest(track: NDArray[T], reach: int) -> NDArray[T]:
    """(F,) minimum over the frames up to ``reach`` frames from each."""
    return np.asarray(np.lib.stride_tricks.sliding_window_view(_held(track, reach), 2 * reach + 1).min(axis=1))


def _held(track: NDArray[T], reach: int) -> NDArray[T]:
    return np.concatenate([np.repeat(track[:1], reach, axis=0), track, np.repeat(track[-1:], reach, axis=0)])
