"""Pictures as PNG files."""

from collections.abc import Iterable
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.io.atomic_write import new_folder, write_atomically


def png_bytes(pixels: NDArray[np.uint8]) -> bytes:
    """Bytes of a PNG file with ``pixels`` (height, width, 4) RGBA."""
    from PIL import Image  # late: only few verbs draw

    content = BytesIO()
    Image.fromarray(pixels).save(content, "PNG")
    return content.getvalue()


def write_png(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write a picture, whole or not at all. Raises StudioError when it cannot be written."""
    write_atomically(path, png_bytes(pixels))


def write_pictures(folder: Path, frames: Iterable[NDArray[np.uint8]]) -> None:
    """Write frames as pictures ``name_0001.png`` and on into a new folder, which appears whole or not at all.

    Raises StudioError if the folder is not empty, or cannot be written.
    """
    with new_folder(folder) as part:
        for number, pixels in enumerate(frames, 1):
            write_numbered(part / folder.name, number, pixels)


def write_numbered(stem: Path, number: int, pixels: NDArray[np.uint8]) -> None:
    """Write one of many pictures: ``stem_0001.png`` for the first. Raises OSError."""
    stem.with_name(f"{stem.name}_{number:04d}.png").write_bytes(png_bytes(pixels))
