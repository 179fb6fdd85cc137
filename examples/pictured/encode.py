"""Pictures and films as small files, by the ffmpeg that imageio-ffmpeg brings along."""

import subprocess
from collections.abc import Sequence
from pathlib import Path

from imageio_ffmpeg import get_ffmpeg_exe
from PySide6.QtGui import QImage

FILM = (
    "split[a][b];[a]palettegen=max_colors=256:stats_mode=full[p];"
    "[b][p]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle"
)


def write_picture(path: Path, image: QImage) -> None:
    """A PNG file without transparency, packed as small as Qt can."""
    path.parent.mkdir(parents=True, exist_ok=True)
    assert image.convertToFormat(QImage.Format.Format_RGB888).save(str(path), "PNG", 0)
    _tell(path, image, 1)


def write_film(path: Path, images: Sequence[QImage], frame_rate: int, width: int) -> None:
    """An endless GIF file ``width`` pixels wide, with one palette for all of it."""
    size = f"{images[0].width()}x{images[0].height()}"
    filters = f"scale={width}:-2:flags=lanczos,{FILM}"
    taken = ["-f", "rawvideo", "-pix_fmt", "bgr0", "-s", size, "-r", str(frame_rate), "-i", "-"]
    path.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(
        [get_ffmpeg_exe(), "-v", "error", "-y", *taken, "-filter_complex", filters, "-loop", "0", str(path)],
        input=b"".join(_bytes(image) for image in images),
        check=True,
    )
    _tell(path, images[0], len(images))


def _tell(path: Path, image: QImage, frames: int) -> None:
    print(f"{path.name}: {image.width()}x{image.height()}, {frames} frames, {path.stat().st_size // 1000} kB")


def _bytes(image: QImage) -> bytes:
    return bytes(image.convertToFormat(QImage.Format.Format_RGB32).constBits())
