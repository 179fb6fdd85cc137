"""Objects of ufbx in the child process that reads FBX: kept alive, as lists, as numbers.

In ufbx 0.0.5 a released object frees memory that others still need: ``_kept`` holds all of them.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_kept: list[Any] = []


def keep(thing: Any) -> Any:
    """The object ``thing`` itself, kept alive until the process ends."""
    _kept.append(thing)
    return thing


def all_of(things: Any) -> list[Any]:
    """Elements of a list of objects of ufbx."""
    keep(things)
    return [keep(things[index]) for index in range(len(things))]


def numbers_of(things: Any) -> list[Any]:
    """Elements of a list of numbers or vectors of ufbx."""
    keep(things)
    return [things[index] for index in range(len(things))]


def matrix_of(matrix: Any) -> FloatArray:
    """Matrix (3, 4) whose last column is the position."""
    return np.array([matrix.c0, matrix.c1, matrix.c2, matrix.c3], dtype=np.float64).T
