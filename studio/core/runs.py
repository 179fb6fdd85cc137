"""Runs of consecutive frames in which a mask is true."""

import numpy as np
from numpy.typing import NDArray


def runs_of(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, past the last) of each unbroken run of true in ``mask`` (F,)."""
    edges = np.flatnonzero(np.diff(mask, prepend=False, append=False))
    return [(int(first), int(past)) for first, past in edges.reshape(-1, 2)]


def runs_in(window: slice, mask: NDArray[np.bool_], apart: int) -> list[slice]:
    """Runs of frames of a ``window`` where ``mask`` (F,) is true; runs no more than ``apart`` frames from each other
    are joined.
    """
    frames = window.start + np.flatnonzero(mask[window])
    runs = np.split(frames, np.flatnonzero(np.diff(frames) > apart) + 1)
    return [slice(int(run[0]), int(run[-1]) + 1) for run in runs if len(run)]
