"""Sound files, and the sound of films, decoded by ffmpeg."""

import os
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.names import readable_name
from studio.core.stage.beats import beats_of
from studio.core.stage.sound_track import LONGEST_SOUND_SECONDS, LOUDEST_PEAK, PEAK_RATE, SoundTrack
from studio.io.child_process import child_process, wait_for
from studio.io.media.sound_output import HEARD_CHANNELS, HEARD_RATE

SOUND_SUFFIXES = (".wav", ".mp3", ".m4a", ".aac", ".ogg", ".flac", ".aiff", ".mp4", ".mov", ".webm")
_FRAME_BYTES = 4
"""Bytes of a moment of either form that is decoded: one float, or two channels of 16 bits."""
SOUND_RATE = 11_000
"""Sample rate in Hz for reading: enough for the waveform and beats."""


def read_sound(path: Path, alive: Callable[[], object] = lambda: None) -> SoundTrack:
    """Sound track of a file with its waveform and beats; ``alive`` may raise an exception to cancel. Raises
    StudioError.
    """
    with tempfile.TemporaryFile() as decoded:
        _decode(path, decoded, ("-ac", "1", "-ar", str(SOUND_RATE), "-f", "f32le"), alive)
        decoded.seek(0)
        samples = np.frombuffer(decoded.read(), dtype="<f4").astype(np.float64)
    samples = np.nan_to_num(samples, posinf=0.0, neginf=0.0)
    step = round(SOUND_RATE / PEAK_RATE)
    loud = np.abs(np.pad(samples, (0, -len(samples) % step))).reshape(-1, step).max(axis=1)
    peaks = np.round(LOUDEST_PEAK * np.clip(loud / max(float(loud.max()), 1e-9), 0.0, 1.0)).astype(int)
    return SoundTrack(
        readable_name(path.stem), str(path), tuple(peaks.tolist()), tuple(beats_of(samples, SOUND_RATE).tolist())
    )


def read_samples(path: Path, alive: Callable[[], object] = lambda: None) -> NDArray[np.int16]:
    """Samples (N, 2) of a file for playback, in a temporary file, so that an hour needs no memory.

    ``alive`` may raise an exception to cancel. Raises StudioError.
    """
    with tempfile.TemporaryFile() as decoded:
        _decode(path, decoded, ("-ac", str(HEARD_CHANNELS), "-ar", str(HEARD_RATE), "-f", "s16le"), alive)
        return np.memmap(decoded, dtype="<i2", mode="r").reshape(-1, HEARD_CHANNELS)


def _decode(path: Path, decoded: IO[bytes], form: Sequence[str], alive: Callable[[], object]) -> None:
    """Write the sound of a file as bare samples to ``decoded``. Raises StudioError if it has none."""
    if not path.is_file():
        raise StudioError(f"{path.name} is not there any more. Choose another file.")
    command = [get_ffmpeg_exe(), "-v", "error", "-nostdin", "-t", str(LONGEST_SOUND_SECONDS), "-i", str(path), "-vn"]
    with child_process([*command, *form, "-"], subprocess.DEVNULL, decoded, subprocess.DEVNULL) as process:
        wait_for(process, alive)
    size = os.fstat(decoded.fileno()).st_size
    decoded.truncate(size - size % _FRAME_BYTES)  # where the disk was full, it ends anywhere
    if size < _FRAME_BYTES:
        raise StudioError(f"{path.name} has no sound that can be read. Choose a WAV, MP3, OGG or FLAC file.")
