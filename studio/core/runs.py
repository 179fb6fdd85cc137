"""Runs of consecutive frames in which a mask is true."""

import numpy as np
from numpy.typing import NDArray


def runs_of(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Runs of consecutive True in ``mask`` (F,), each as its first index and the index past its last."""
    edges = np.flatnonzero(np.diff(mask, prepend=False, append=False))
    return [(int(first), int(past)) for first, past in edges.reshape(-1, 2)]


def runs_in(window: slice, mask: NDArray[np.bool_], apart: int) -> list[slice]:
    """Slices of the frames of ``window`` where ``mask`` (F,) is True; runs at most ``apart`` frames apart
    are joined.
    """
    frames = window.start + np.flatnonzero(mask[window])
    runs = np.split(frames, np.flatnonzero(np.diff(frames) > apart) + 1)
    return [slice(int(run[0]), int(run[-1]) + 1) for run in runs if len(run)]
