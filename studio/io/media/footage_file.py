"""Frames of reference footage: films are decoded by ffmpeg, numbered pictures by Pillow."""

import re
import subprocess
from collections.abc import Generator
from pathlib import Path
from typing import IO

import numpy as np
from imageio_ffmpeg import count_frames_and_secs, get_ffmpeg_exe, read_frames
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.names import readable_name
from studio.core.stage.footage import FOOTAGE_RATES, Footage
from studio.io.child_process import child_process

Picture = NDArray[np.uint8]
"""Pixels (height, width, 3), red, green and blue."""

FILM_SUFFIXES = (".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".mpeg", ".wmv", ".gif")
PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp")
MOST_FOOTAGE_SIDE_PIXELS = 960
"""Longest side of a frame in pixels; larger frames are reduced."""
USUAL_PICTURES_RATE = 30.0
"""Frame rate of numbered pictures until the user sets another."""
_NUMBER = re.compile(r"(\d+)$")


def is_sequence(path: Path) -> bool:
    """True if ``path`` belongs to numbered pictures, and is no film."""
    return path.suffix.lower() in PICTURE_SUFFIXES


def read_footage(path: Path) -> Footage:
    """Footage of a film, or of the pictures to which ``path`` belongs, with its frame count and rate. Raises
    StudioError.
    """
    if is_sequence(path):
        files = sequence_of(path)
        if not files:
            raise StudioError(f"{path.name} is not there any more. Choose another file.")
        next(footage_frames(files[0], USUAL_PICTURES_RATE, 0))
        return Footage(_name_of(files[0]), str(files[0]), len(files), USUAL_PICTURES_RATE, USUAL_PICTURES_RATE)
    if not path.is_file():
        raise StudioError(f"{path.name} is not there any more. Choose another file.")
    try:
        frames, seconds = count_frames_and_secs(str(path))  # first: it leaves nothing open where there is no film
        probe = read_frames(str(path))
        rate = float(next(probe)["fps"])
        probe.close()
    except (OSError, RuntimeError, StopIteration) as error:
        raise StudioError(f"{path.name} has no frames that can be read. Choose an MP4, MOV or WebM file.") from error
    least, most = FOOTAGE_RATES
    rate = min(max(rate, least), most)
    # Frames of a telephone's film may last unequally long: those that are shown last equally long.
    return Footage(
        readable_name(path.stem), str(path), max(round(seconds * rate), 1) if seconds else frames, rate, rate
    )


def sequence_of(path: Path) -> tuple[Path, ...]:
    """Files of the folder that differ from ``path`` only in the number at the end of their stem, in order of this
    number.
    """
    stem, suffix, alike = _NUMBER.sub("", path.stem), path.suffix.lower(), []
    for each in path.parent.glob("*") if path.parent.is_dir() else ():
        number = _NUMBER.search(each.stem)
        if number and (each.stem[: number.start()], each.suffix.lower()) == (stem, suffix) and each.is_file():
            alike.append((int(number.group()), each.name, each))
    if not alike and path.is_file():
        return (path,)
    return tuple(each for _, _, each in sorted(alike))


def footage_frames(path: Path, file_rate: float, first: int) -> Generator[Picture, None, None]:
    """Frames of a film or of numbered pictures from ``first`` on, no side longer than ``MOST_FOOTAGE_SIDE_PIXELS``.

    Raises StudioError if a picture cannot be read; a damaged film just ends.
    """
    return _picture_frames(sequence_of(path)[first:]) if is_sequence(path) else _film_frames(path, file_rate, first)


def _picture_frames(files: tuple[Path, ...]) -> Generator[Picture, None, None]:
    from PIL import Image, UnidentifiedImageError

    for file in files:
        try:
            with Image.open(file) as image:
                image.draft("RGB", (MOST_FOOTAGE_SIDE_PIXELS, MOST_FOOTAGE_SIDE_PIXELS))
                pixels = image.convert("RGB")
        except (OSError, UnidentifiedImageError, Image.DecompressionBombError) as error:
            raise StudioError(f"The image {file.name} cannot be read. Choose a PNG or JPEG file.") from error
        pixels.thumbnail((MOST_FOOTAGE_SIDE_PIXELS, MOST_FOOTAGE_SIDE_PIXELS))
        yield np.asarray(pixels)


def _film_frames(path: Path, file_rate: float, first: int) -> Generator[Picture, None, None]:
    """Frames as ffmpeg writes them in succession, each preceded by its size (PPM)."""
    side = MOST_FOOTAGE_SIDE_PIXELS
    size = f"'min({side},iw)':'min({side},ih)':force_original_aspect_ratio=decrease"
    even = f"fps={file_rate:.6f}:start_time=0,scale={size}"
    seek = ["-ss", f"{first / file_rate:.6f}"] if first else []
    command = [get_ffmpeg_exe(), "-v", "error", "-nostdin", *seek, "-i", str(path), "-an", "-vf", even]
    with child_process(
        [*command, "-f", "image2pipe", "-c:v", "ppm", "-"], subprocess.DEVNULL, subprocess.PIPE, subprocess.DEVNULL
    ) as process:
        assert process.stdout is not None
        while (picture := _next_ppm(process.stdout)) is not None:
            yield picture


def _next_ppm(stream: IO[bytes]) -> Picture | None:
    if stream.readline() != b"P6\n":
        return None
    width, height = map(int, stream.readline().split())
    stream.readline()  # the greatest value, which is 255
    pixels = stream.read(3 * width * height)
    return np.frombuffer(pixels, np.uint8).reshape(height, width, 3) if len(pixels) == 3 * width * height else None


def _name_of(file: Path) -> str:
    return _NUMBER.sub("", file.stem).rstrip(" _.-") or file.parent.name
