"""Films: MP4 files, written by the ffmpeg that imageio-ffmpeg brings along, or folders of pictures."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.png import write_pictures
from studio.io.replacing import replacing


def write_moving(path: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], frame_rate: float) -> None:
    """A film where ``path`` ends with .mp4, else a new folder of pictures, one a frame. Raises StudioError."""
    if path.suffix.lower() == ".mp4":
        write_film(path, frames, size, frame_rate)
    else:
        write_pictures(path, frames)


def write_film(path: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], frame_rate: float) -> None:
    """Write frames of (height, width, 4) RGBA bytes as H.264; ``size`` is width and height, both even.

    The film appears whole or not at all. Raises StudioError when it cannot be written.
    """
    if size[0] % 2 or size[1] % 2:
        raise StudioError(f"A film's width and height are even numbers, not {size[0]}x{size[1]}.")
    with replacing(path) as part:
        written = _encode(part, frames, size, frame_rate)
        if _frames_in(part) != written:
            raise StudioError(f"'{path}' could not be written whole. Make room on the disk or choose another one.")


def _encode(part: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], frame_rate: float) -> int:
    """Returns the number of frames. Raises OSError when ffmpeg takes no more of them."""
    from imageio_ffmpeg import write_frames

    options = {"fps": frame_rate, "pix_fmt_in": "rgba", "macro_block_size": 2, "quality": 7, "ffmpeg_timeout": 0}
    writer = write_frames(str(part), size, **options, output_params=["-f", "mp4"])
    writer.send(None)
    count = 0
    try:
        for frame in frames:
            try:
                writer.send(np.ascontiguousarray(frame))
            except OSError as error:  # its text holds the whole command line
                raise OSError(str(error).partition("\n")[0]) from error
            count += 1
    finally:
        writer.close()
    return count


def _frames_in(part: Path) -> int:
    """How many frames are really in the file: ffmpeg does not say that it ran out of room."""
    from imageio_ffmpeg import count_frames_and_secs

    try:
        return int(count_frames_and_secs(str(part))[0])
    except RuntimeError:  # it is no film at all
        return -1
