"""Pictures as PNG files."""

import struct
import zlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.io.replacing import new_folder, write_whole

_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def png_bytes(pixels: NDArray[np.uint8]) -> bytes:
    """A picture of (height, width, 4) RGBA bytes as a PNG file."""
    height, width = pixels.shape[:2]
    rows = np.zeros((height, 1 + 4 * width), dtype=np.uint8)  # a leading 0 says: this row is not filtered
    rows[:, 1:] = pixels.reshape(height, -1)
    header = struct.pack(">2I5B", width, height, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes(), 6)), (b"IEND", b""))
    return _SIGNATURE + b"".join(_chunk(kind, content) for kind, content in chunks)


def write_png(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write a picture, whole or not at all. Raises StudioError when it cannot be written."""
    write_whole(path, png_bytes(pixels))


def write_pictures(folder: Path, frames: Iterable[NDArray[np.uint8]]) -> None:
    """A new folder of pictures ``name_0001.png`` and on, one a frame; it appears whole or not at all.

    Raises StudioError when there is something in it already, or it cannot be written.
    """
    with new_folder(folder) as part:
        for number, pixels in enumerate(frames, 1):
            write_numbered(part / folder.name, number, pixels)


def write_numbered(stem: Path, number: int, pixels: NDArray[np.uint8]) -> None:
    """Write one of many pictures: ``stem_0001.png`` for the first. Raises OSError."""
    stem.with_name(f"{stem.name}_{number:04d}.png").write_bytes(png_bytes(pixels))


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
