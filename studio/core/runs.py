"""Runs of frames in which something holds without a break."""

import numpy as np
from numpy.typing import NDArray


def runs_of(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, past the last) of each unbroken run of true in ``mask`` (F,)."""
    edges = np.flatnonzero(np.diff(mask, prepend=False, append=False))
    return [(int(first), int(past)) for first, past in edges.reshape(-1, 2)]
