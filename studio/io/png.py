"""Pictures as PNG files."""

import struct
import zlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError

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
    """Write a picture beside ``path``, then rename. Raises StudioError when it cannot be written."""
    part = path.with_name(f".{path.name}.part")
    try:
        part.write_bytes(png_bytes(pixels))
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise StudioError(f"{path} could not be written: {error.strerror}. Choose another folder.") from error


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
