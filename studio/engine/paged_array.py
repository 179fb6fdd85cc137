"""Poses of long takes stored in temporary files, of which the system keeps in memory as much as fits."""

import math
import os
import tempfile
import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.compact_array import CompactArray, PoseArray, compact_array

PAGED_BYTES = 8 << 20
"""Size in bytes from which an array is stored in a file: the rotations of 90 seconds at 120 Hz."""
MOST_PAGE_FILES = 256
"""Maximum number of open files; many systems allow a thousand per process."""
DISK_FOLDER = "/var/tmp"
"""Folder for large temporary files, on a disk even if the usual folder is in memory."""
_ROWS_WRITTEN = 4096


class PageFile:
    """Temporary file without a name, closed when no rows of it are used any more."""

    def __init__(self, numbers: NDArray[np.float64]) -> None:
        """Write ``numbers`` with 32 bits each. Raises OSError if that fails."""
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
    """Rows (F, ...) of 32-bit numbers in a file."""

    file: PageFile
    shape: tuple[int, ...]
    first: int = 0
    """Index in the file of the first row."""

    def part(self, rows: slice) -> "FileRows":
        """Slice of the rows."""
        first, last, _ = rows.indices(self.shape[0])
        return FileRows(self.file, (max(last - first, 0), *self.shape[1:]), self.first + first)

    def read(self) -> NDArray[np.float32]:
        """All rows as one array."""
        rows = np.empty(self.shape, np.float32)
        left, at = rows.reshape(-1).view(np.uint8).data, 4 * self.first * math.prod(self.shape[1:])
        while left:  # a call reads two gigabytes at most
            count = os.preadv(self.file.descriptor, [left], at)
            left, at = left[count:], at + count
        return rows


def paged_rows(numbers: PoseArray) -> CompactArray:
    """Array of 32-bit numbers: in a file if it is large, or in memory if no file can be written."""
    if isinstance(numbers, CompactArray) or numbers.nbytes < 2 * PAGED_BYTES or len(_OPEN) >= MOST_PAGE_FILES:
        return compact_array(numbers)
    if not hasattr(os, "preadv"):  # Windows
        return compact_array(numbers)
    try:
        return CompactArray(FileRows(PageFile(numbers), numbers.shape))
    except OSError:
        return compact_array(numbers)
