"""Arrays that are kept in 32 bits and read in 64: half the memory for poses that are only shown, or solved on from.

A metre is then known to a ten-thousandth of a millimetre, a turn to some millionths of a degree.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Single:
    """Numbers of any shape; whatever is read of them by an index is a new array of 64 bits."""

    def __init__(self, numbers: FloatArray | NDArray[np.float32]) -> None:
        """Arrays of 32 bits are taken as they are."""
        self._kept = np.asarray(numbers, dtype=np.float32)

    def __getitem__(self, index: Any) -> FloatArray:
        return np.asarray(self._kept[index], dtype=np.float64)

    def __setitem__(self, index: Any, numbers: FloatArray) -> None:
        self._kept[index] = numbers

    def __len__(self) -> int:
        return len(self._kept)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self._kept.astype(dtype or np.float64)

    @property
    def shape(self) -> tuple[int, ...]:
        return self._kept.shape

    def copy(self) -> "Single":
        """The same numbers, to be changed."""
        return Single(self._kept.copy())

    def part(self, rows: slice) -> "Single":
        """Some rows, in place."""
        return Single(self._kept[rows])


PoseArray = FloatArray | Single
"""Numbers that ``[...]`` reads as 64 bits, ``[:]`` all of them."""


def part_of(numbers: PoseArray, rows: slice) -> PoseArray:
    """Some rows of an array, in place."""
    return numbers.part(rows) if isinstance(numbers, Single) else numbers[rows]


def single(numbers: PoseArray) -> Single:
    """An array kept in 32 bits."""
    return numbers if isinstance(numbers, Single) else Single(numbers)
