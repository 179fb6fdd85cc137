"""Sound files, read by the ffmpeg that imageio-ffmpeg brings along; the sound of a film as well."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe

from studio.core.errors import StudioError
from studio.core.names import readable
from studio.core.stage.beats import beats_of
from studio.core.stage.sound_track import LOUDEST_PEAK, MOST_SOUND_SECONDS, PEAK_RATE, SoundTrack
from studio.io.child_process import child_process

SOUND_SUFFIXES = (".wav", ".mp3", ".m4a", ".aac", ".ogg", ".flac", ".aiff", ".mp4", ".mov", ".webm")
SOUND_RATE = 11_000
"""Hz at which a sound is read: enough for its waveform and beats."""
_PIECE = 1 << 18


def read_sound(path: Path, alive: Callable[[], object] = lambda: None) -> SoundTrack:
    """The waveform and beats of a file; ``alive`` raises to break off. Raises StudioError."""
    if not path.is_file():
        raise StudioError(f"{path.name} is not there any more. Choose another file.")
    command = [get_ffmpeg_exe(), "-v", "error", "-nostdin", "-t", str(MOST_SOUND_SECONDS), "-i", str(path)]
    pieces = []
    with child_process(
        [*command, "-vn", "-ac", "1", "-ar", str(SOUND_RATE), "-f", "f32le", "-"],
        subprocess.DEVNULL,
        subprocess.PIPE,
        subprocess.DEVNULL,
    ) as process:
        assert process.stdout is not None
        while piece := process.stdout.read(_PIECE):
            pieces.append(piece)
            alive()
    samples = np.frombuffer(b"".join(pieces)[: sum(map(len, pieces)) // 4 * 4], dtype="<f4").astype(np.float64)
    if not samples.size:
        raise StudioError(f"{path.name} has no sound that can be read. Choose a WAV, MP3, OGG or FLAC file.")
    samples = np.nan_to_num(samples)
    step = round(SOUND_RATE / PEAK_RATE)
    loud = np.abs(np.pad(samples, (0, -len(samples) % step))).reshape(-1, step).max(axis=1)
    peaks = np.round(LOUDEST_PEAK * np.clip(loud / max(float(loud.max()), 1e-9), 0.0, 1.0)).astype(int)
    return SoundTrack(
        readable(path.stem), str(path), tuple(peaks.tolist()), tuple(beats_of(samples, SOUND_RATE).tolist())
    )
