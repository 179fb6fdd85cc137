"""ZIP files written in pieces, so that long ones can be followed and cancelled."""

import struct
import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.io.registry import Progress
from studio.io.replacing import replacing

_PIECE = 1 << 20
_ALIGNMENT, _HEADER = 64, 30
_FIELD, _UNREAD = struct.Struct("<HH"), 0x1986


def write_zip(path: Path, members: Mapping[str, bytes], level: int | None, progress: Progress) -> None:
    """Write ``members``, deflated at ``level`` (0 to 9), whole or not at all; equal members give equal bytes.

    Without a level they are stored, each from a multiple of 64 bytes on, as a USDZ has them. Raises StudioError when
    it cannot be written; ``progress`` may raise to cancel.
    """
    total, done = sum(map(len, members.values())) or 1, 0
    method = zipfile.ZIP_STORED if level is None else zipfile.ZIP_DEFLATED
    with replacing(path) as part, zipfile.ZipFile(part, "w", method, compresslevel=level) as archive:
        for name, content in members.items():
            with archive.open(name if level is not None else _aligned(name, archive.start_dir), "w") as stream:
                for first in range(0, len(content), _PIECE):
                    progress(done / total, f"Writing {path.name}")
                    stream.write(memoryview(content)[first : first + _PIECE])
                    done += min(_PIECE, len(content) - first)


def _aligned(name: str, start: int) -> zipfile.ZipInfo:
    """A member whose header begins at byte ``start``, filled up by a field that nobody reads."""
    gap = -(start + _HEADER + len(name.encode()) + _FIELD.size) % _ALIGNMENT
    member = zipfile.ZipInfo(name)
    member.extra = _FIELD.pack(_UNREAD, gap) + bytes(gap)
    return member


def npy(array: NDArray[Any]) -> bytes:
    """An array as a ``.npy`` file."""
    stream = BytesIO()
    np.lib.format.write_array(stream, array, version=(1, 0), allow_pickle=False)
    return stream.getvalue()
