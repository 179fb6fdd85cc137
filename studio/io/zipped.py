"""ZIP files: written in pieces, with progress and cancellation; read within bounds."""

import lzma
import struct
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.io.atomic_write import atomic_replacement
from studio.io.registry import Progress

_PIECE = 1 << 20
_ALIGNMENT, _HEADER = 64, 30
_FIELD, _UNREAD = struct.Struct("<HH"), 0x1986
MOST_REASON_CHARACTERS = 200
"""Maximum number of characters of an error message of zipfile, which may quote the rest of the file."""
_DAMAGE = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error, EOFError, OSError),
    *(KeyError, OverflowError, NotImplementedError, RuntimeError, MemoryError),
)
"""Errors that zipfile and its decompressors raise over bytes that are no archive."""


class UnpacksTooFarError(ValueError):
    """Archive whose unpacked size exceeds the limit."""


def write_zip(path: Path, members: Mapping[str, bytes], level: int | None, progress: Progress) -> None:
    """Write ``members``, deflated at ``level`` (0 to 9), whole or not at all; equal members give equal bytes.

    Without a level they are stored, each aligned to 64 bytes, as USDZ requires. Raises StudioError if the file cannot
    be written; ``progress`` may raise an exception to cancel.
    """
    total, done = sum(map(len, members.values())) or 1, 0
    method = zipfile.ZIP_STORED if level is None else zipfile.ZIP_DEFLATED
    with atomic_replacement(path) as part, zipfile.ZipFile(part, "w", method, compresslevel=level) as archive:
        for name, content in members.items():
            with archive.open(name if level is not None else _aligned(name, archive.start_dir), "w") as stream:
                for first in range(0, len(content), _PIECE):
                    progress(done / total, f"Writing {path.name}")
                    stream.write(memoryview(content)[first : first + _PIECE])
                    done += min(_PIECE, len(content) - first)


def _aligned(name: str, start: int) -> zipfile.ZipInfo:
    """Member whose header begins at byte ``start``, padded in its extra field so that its data are aligned."""
    gap = -(start + _HEADER + len(name.encode()) + _FIELD.size) % _ALIGNMENT
    member = zipfile.ZipInfo(name)
    member.extra = _FIELD.pack(_UNREAD, gap) + bytes(gap)
    return member


def unzipped_members(content: bytes, most: int, names: Sequence[str] = ()) -> dict[str, bytes]:
    """Members of an archive by name, or those in ``names``, which unpack to at most ``most`` bytes together.

    Raises ValueError with the fault, and UnpacksTooFarError before anything is unpacked.
    """
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            entries = [archive.getinfo(name) for name in names] or archive.infolist()
            if sum(entry.file_size for entry in entries) > most:
                raise UnpacksTooFarError(f"would unpack to more than {most // 1_000_000} MB")
            return {entry.filename: archive.read(entry) for entry in entries if not entry.is_dir()}
    except _DAMAGE as error:
        reason = str(error.args[0] if error.args else error)[:MOST_REASON_CHARACTERS]
        raise ValueError(reason or "it is not an archive") from error


def npy_file(array: NDArray[Any]) -> bytes:
    """Bytes of an ``.npy`` file with an array."""
    stream = BytesIO()
    np.lib.format.write_array(stream, array, version=(1, 0), allow_pickle=False)
    return stream.getvalue()
