"""Films as MP4 files, written by the ffmpeg that imageio-ffmpeg brings along."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError


def write_film(path: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], frame_rate: float) -> None:
    """Write frames of (height, width, 4) RGBA bytes as H.264; ``size`` is width and height, both even.

    The film appears whole or not at all. Raises StudioError when it cannot be written.
    """
    if size[0] % 2 or size[1] % 2:
        raise StudioError(f"A film's width and height are even numbers, not {size[0]}x{size[1]}.")
    from imageio_ffmpeg import write_frames

    part = path.with_name(f".{path.stem}.part{path.suffix}")
    options = {"fps": frame_rate, "pix_fmt_in": "rgba", "macro_block_size": 2, "quality": 7}
    try:
        writer = write_frames(str(part), size, **options)
        writer.send(None)
        try:
            for frame in frames:
                writer.send(np.ascontiguousarray(frame))
        finally:
            writer.close()
        part.replace(path)
    except OSError as error:
        raise StudioError(f"{path} could not be written: {error}. Choose another folder.") from error
    finally:
        part.unlink(missing_ok=True)
