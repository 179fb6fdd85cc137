"""Arrays stored with 32 bits and read with 64: half the memory for poses that are only shown, or solved again.

The resolution is a ten-thousandth of a millimetre in a metre, and some millionths of a degree.
"""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class StoredRows(Protocol):
    """Rows of 32-bit numbers that are stored outside memory, for example on disk."""

    @property
    def shape(self) -> tuple[int, ...]: ...

    def part(self, rows: slice) -> "StoredRows":
        """Slice of the rows; nothing is read yet."""

    def read(self) -> NDArray[np.float32]:
        """All rows in one array."""


class CompactArray:
    """Array stored with 32 bits; an index returns a new array with 64 bits.

    A copy shares with the original all rows but those that are written to it, so an edit of some seconds of a take
    needs only the memory of these seconds.
    """

    def __init__(
        self,
        numbers: FloatArray | NDArray[np.float32] | StoredRows,
        written: Sequence[tuple[int, NDArray[np.float32]]] = (),
    ) -> None:
        """Use ``numbers`` without a copy if they have 32 bits; they are never written to.

        ``written`` are rows that replace rows of ``numbers``, each with the index of the first one; later ones replace
        earlier ones.
        """
        self._kept: NDArray[np.float32] | StoredRows = (
            np.asarray(numbers, np.float32) if isinstance(numbers, np.ndarray) else numbers
        )
        self._written = tuple(written)

    def __getitem__(self, index: Any) -> FloatArray:
        if isinstance(self._kept, np.ndarray) and not self._written:
            return np.asarray(self._kept[index], dtype=np.float64)
        rows, *columns = index if isinstance(index, tuple) else (index,)
        if isinstance(rows, int | np.integer):
            row = range(len(self))[rows]
            return np.asarray(self[row : row + 1][(0, *columns)])
        if isinstance(rows, slice) and rows.step in (None, 1) and all(map(_is_basic, columns)):
            part = self.part(rows)
            found = _read(part._kept)[:, *columns].astype(np.float64)
            for first, numbers in part._written:
                found[first : first + len(numbers)] = numbers[:, *columns]
            return found
        return np.asarray(self._whole()[index], dtype=np.float64)

    def __setitem__(self, index: Any, numbers: FloatArray) -> None:
        if isinstance(index, slice) and index.step in (None, 1):
            first, last, _ = index.indices(len(self))
            rows = np.array(np.broadcast_to(numbers, (max(last - first, 0), *self.shape[1:])), dtype=np.float32)
            if len(rows) == len(self):
                self._kept, self._written = rows, ()
            elif len(rows):
                self._written = (*self._written, (first, rows))
            return
        whole = self._whole().copy()
        whole[index] = numbers
        self._kept, self._written = whole, ()

    def __len__(self) -> int:
        return self.shape[0]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self._whole().astype(dtype or np.float64)

    @property
    def shape(self) -> tuple[int, ...]:
        return self._kept.shape

    def copy(self) -> "CompactArray":
        """Copy that may be written to."""
        return CompactArray(self._kept, self._written)

    def part(self, rows: slice) -> "CompactArray":
        """Slice of the rows, which shares their memory."""
        first, last, _ = rows.indices(len(self))
        written = [
            (max(begin - first, 0), numbers[max(first - begin, 0) : max(last - begin, 0)])
            for begin, numbers in self._written
            if begin < last and begin + len(numbers) > first
        ]
        kept = self._kept[rows] if isinstance(self._kept, np.ndarray) else self._kept.part(rows)
        return CompactArray(kept, written)

    def _whole(self) -> NDArray[np.float32]:
        """All numbers in one read-only array."""
        kept = _read(self._kept)
        if not self._written:
            return kept
        whole = kept.copy()
        for first, numbers in self._written:
            whole[first : first + len(numbers)] = numbers
        return whole


def _read(kept: NDArray[np.float32] | StoredRows) -> NDArray[np.float32]:
    return kept if isinstance(kept, np.ndarray) else kept.read()


def _is_basic(index: Any) -> bool:
    return isinstance(index, int | np.integer | slice)


PoseArray = FloatArray | CompactArray
"""Array of 64 bits, or stored with 32 bits and read with 64 by an index; ``[:]`` reads all of it."""


def part_of(numbers: PoseArray, rows: slice) -> PoseArray:
    """Slice of the rows of an array, which shares their memory."""
    return numbers.part(rows) if isinstance(numbers, CompactArray) else numbers[rows]


def compact_array(numbers: PoseArray) -> CompactArray:
    """Array stored with 32 bits."""
    return numbers if isinstance(numbers, CompactArray) else CompactArray(numbers)
