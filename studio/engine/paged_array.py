"""Poses of long takes kept in temporary files, of which the system holds in memory as much as there is room for."""

import math
import os
import tempfile
import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.compact_array import CompactArray, PoseArray, compact_array

PAGED_BYTES = 8 << 20
"""Bytes from which an array is kept in a file: the rotations of a minute and a half at 120 Hz."""
MOST_PAGE_FILES = 256
"""Files that are open at a time: many systems allow a process a thousand."""
DISK_FOLDER = "/var/tmp"
"""Folder of large temporary files, on a disk also where the usual one is in memory."""
_ROWS_WRITTEN = 4096


class PageFile:
    """Temporary file without a name, closed with the last rows of it."""

    def __init__(self, numbers: NDArray[np.float64]) -> None:
        """Write ``numbers`` in 32 bits; OSError if that fails."""
        with tempfile.TemporaryFile(dir=DISK_FOLDER if os.path.isdir(DISK_FOLDER) else None) as file:
            flat = numbers.reshape(-1, numbers.shape[-1])
            for first in range(0, len(flat), _ROWS_WRITTEN):
                file.write(flat[first : first + _ROWS_WRITTEN].astype(np.float32).tobytes())
            file.flush()
            self.descriptor = os.dup(file.fileno())
        weakref.finalize(self, os.close, self.descriptor)
        _OPEN.add(self)


_OPEN: weakref.WeakSet[PageFile] = weakref.WeakSet()


@dataclass(frozen=True, eq=False)
class FileRows:
    """Rows (F, ...) in 32 bits of a file."""

    file: PageFile
    shape: tuple[int, ...]
    first: int = 0
    """Row of the file with which they begin."""

    def part(self, rows: slice) -> "FileRows":
        """Slice of the rows."""
        first, last, _ = rows.indices(self.shape[0])
        return FileRows(self.file, (max(last - first, 0), *self.shape[1:]), self.first + first)

    def read(self) -> NDArray[np.float32]:
        """All rows in one array."""
        rows = np.empty(self.shape, np.float32)
        left, at = rows.reshape(-1).view(np.uint8).data, 4 * self.first * math.prod(self.shape[1:])
        while left:  # a call reads two gigabytes at most
            count = os.preadv(self.file.descriptor, [left], at)
            left, at = left[count:], at + count
        return rows


def paged_rows(numbers: PoseArray) -> CompactArray:
    """Array stored in 32 bits: a long one in a file, or in memory where no file can be written."""
    if isinstance(numbers, CompactArray) or numbers.nbytes < 2 * PAGED_BYTES or len(_OPEN) >= MOST_PAGE_FILES:
        return compact_array(numbers)
    if not hasattr(os, "preadv"):  # Windows
        return compact_array(numbers)
    try:
        return CompactArray(FileRows(PageFile(numbers), numbers.shape))
    except OSError:
        return compact_array(numbers)
