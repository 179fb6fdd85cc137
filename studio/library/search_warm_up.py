"""Warm-up of the search: its kernels are compiled, or loaded from the cache, before the first search."""

import numpy as np

from studio.core.clip_search import PoseQuery, SearchTable, search
from studio.core.kernels import pose_search as at


def warm_up() -> None:
    """Search a library of one clip with two frames, which compiles or loads the kernels."""
    one = np.ones(1, dtype=np.int64)
    table = SearchTable(np.zeros((2, at.POSE_WIDTH), np.float32), 2 * one, np.zeros((1, 3)), one, 0 * one, 0 * one)
    search(table, PoseQuery(np.zeros((1, at.POSE_WIDTH), np.float32), np.zeros((1, 4, 3))))
