"""Films: MP4 files, written by the ffmpeg of imageio-ffmpeg, or folders of pictures."""

import subprocess
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.atomic_write import atomic_replacement
from studio.io.child_process import Streams, child_process, wait_for
from studio.io.png import write_pictures

_QUALITY = 15
"""The constant rate factor of H.264: 0 loses nothing, 51 is the worst."""


def is_film(path: Path) -> bool:
    """True if ``path`` names a film, and not a folder of pictures."""
    return path.suffix.lower() == ".mp4"


def write_moving(path: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], frame_rate: float) -> None:
    """Write a film if ``path`` ends with .mp4, else a new folder with a picture for each frame. Raises StudioError."""
    if is_film(path):
        write_film(path, frames, size, frame_rate)
    else:
        write_pictures(path, frames)


def write_film(path: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], frame_rate: float) -> None:
    """Write frames of (height, width, 4) RGBA bytes as H.264; ``size`` is width and height, both even.

    The film appears whole or not at all. Raises StudioError when it cannot be written.
    """
    with film_encoder(path, subprocess.PIPE, size, frame_rate) as encoder:
        count = 0
        for frame in frames:
            encoder.take(frame)
            count += 1
        encoder.finish(count)


class FilmEncoder:
    """Running ffmpeg process that writes a film beside its final path."""

    def __init__(self, process: "subprocess.Popen[bytes]", path: Path, part: Path) -> None:
        self._process, self._path, self._part = process, path, part

    def take(self, frame: NDArray[np.uint8]) -> None:
        """Write the next frame to ffmpeg, unless it reads the frames from another process."""
        assert self._process.stdin is not None
        self._process.stdin.write(np.ascontiguousarray(frame).data)

    def finish(self, frames: int, alive: Callable[[], object] = lambda: None) -> None:
        """Wait until the film is written. Raises StudioError unless it has all its ``frames``.

        ``alive`` is called while waiting and may raise an exception to cancel.
        """
        if self._process.stdin is not None:
            self._process.stdin.close()
        wait_for(self._process, alive)
        if _frames_in(self._part) != frames:
            raise StudioError(
                f"'{self._path}' could not be written completely. Make room on the disk or choose another one."
            )


@contextmanager
def film_encoder(path: Path, source: Streams, size: tuple[int, int], frame_rate: float) -> Iterator[FilmEncoder]:
    """Context with an encoder of RGBA frames, which come from ``source``, or from ``FilmEncoder.take`` if that is a
    pipe.

    The film appears whole or not at all; if the block raises, the encoder is stopped at once. Raises StudioError.
    """
    if size[0] % 2 or size[1] % 2:
        raise StudioError(f"A video's width and height are even numbers, not {size[0]}x{size[1]}.")
    with atomic_replacement(path) as part, child_process(_command(part, size, frame_rate), source) as process:
        yield FilmEncoder(process, path, part)


def _command(part: Path, size: tuple[int, int], frame_rate: float) -> list[str]:
    """Command of ffmpeg, with halved colour resolution for all players, and the rate as a fraction because 29.97 is
    inexact.
    """
    from imageio_ffmpeg import get_ffmpeg_exe

    rate = str(Fraction(frame_rate).limit_denominator())
    frames = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}", "-r", rate, "-i", "-"]
    film = ["-an", "-vcodec", "libx264", "-pix_fmt", "yuv420p", "-crf", str(_QUALITY), "-f", "mp4", str(part)]
    return [get_ffmpeg_exe(), "-v", "fatal", "-y", *frames, *film]


def _frames_in(part: Path) -> int:
    """Number of frames in the file; ffmpeg does not report a full disk."""
    from imageio_ffmpeg import count_frames_and_secs

    try:
        return int(count_frames_and_secs(str(part))[0])
    except RuntimeError:  # it is no film at all
        return -1
