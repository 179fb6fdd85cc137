"""Arrays from ``.npy`` and ``.npz`` files of any source: headers are checked and never evaluated."""

import math
import mmap
import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from studio.io.atomic_write import atomic_replacement
from studio.io.zipped import unzipped_members

Array = NDArray[Any]
Content = bytes | memoryview

_HEADER = re.compile(
    rb"\x93NUMPY\x01\x00..\{'descr': '([^']{1,20})', 'fortran_order': (True|False), "
    rb"'shape': \(((?:[0-9]{1,12}, ?)*[0-9]{0,12})\), *\} *\n",
    re.DOTALL,
)


def array_of(content: Content) -> Array:
    """Read-only array over the bytes of an ``.npy`` file. Raises ValueError if they are no such file."""
    header = _HEADER.match(content)
    if header is None:
        raise ValueError("it is not a plain array")
    kind, fortran, sizes = (group.decode("ascii", "replace") for group in header.groups())
    if re.fullmatch(r"\|[biu]1|<[iuf][248]", kind) is None:
        raise ValueError(f"its numbers are '{kind}', which are not read")
    dtype = np.dtype(kind)
    shape = tuple(int(size) for size in sizes.split(",") if size.strip())
    if len(shape) > 8 or math.prod(shape) * dtype.itemsize != len(content) - header.end():
        raise ValueError("its header does not fit its content")
    order: Literal["F", "C"] = "F" if fortran == "True" else "C"
    return np.frombuffer(content, dtype, offset=header.end()).reshape(shape, order=order)


def arrays_of(content: bytes, most: int) -> dict[str, Array]:
    """Arrays of an ``.npz`` file by name, which unpack to at most ``most`` bytes together. Raises ValueError."""
    return {name.removesuffix(".npy"): array_of(member) for name, member in unzipped_members(content, most).items()}


CHECKSUM_BYTES = 4


@dataclass(frozen=True, eq=False)
class StoredArray:
    """Array that stays on disk until its ``values`` are read."""

    values: Array
    checksum: int | None
    """CRC-32 of the preceding content; None in a file without one."""
    content: Content

    def is_whole(self) -> bool:
        """True unless the content has changed since it was written."""
        return self.checksum is None or zlib.crc32(self.content) == self.checksum


def write_stored(path: Path, values: Array) -> None:
    """Write an ``.npy`` file with its checksum at the end, whole or not at all. Raises StudioError."""
    with atomic_replacement(path) as part:
        with open(part, "wb") as file:
            np.save(file, values, allow_pickle=False)
        with open(part, "r+b") as file:
            checksum = zlib.crc32(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
            file.seek(0, 2)
            file.write(checksum.to_bytes(CHECKSUM_BYTES, "little"))


def stored_array(path: Path) -> StoredArray:
    """Array in a file of ``write_stored``, or in a plain ``.npy`` file. Raises OSError or ValueError."""
    with open(path, "rb") as file:
        content = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    try:
        return StoredArray(array_of(content), None, content)
    except ValueError:
        body, checksum = content[:-CHECKSUM_BYTES], int.from_bytes(content[-CHECKSUM_BYTES:], "little")
        return StoredArray(array_of(body), checksum, body)
