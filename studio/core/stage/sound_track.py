"""Sound tracks on the stage: the waveform and beats of a file, and its start."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.plausible import TIME_RANGE

FloatArray = NDArray[np.float64]

PEAK_RATE = 100.0
"""Number of waveform peaks per second of sound."""
LOUDEST_PEAK = 255
LONGEST_SOUND_SECONDS = 3600.0
"""Maximum length of a sound in seconds."""


@dataclass(frozen=True)
class SoundTrack:
    """Sound of a file that plays from stage second ``start`` on."""

    name: str
    source: str
    """Path of the file."""
    peaks: tuple[int, ...]
    """Loudest sample of each hundredth of a second, 0 to 255."""
    beats: tuple[float, ...] = ()
    """Times of the beats in seconds of the sound, ascending."""
    start: float = 0.0

    def __post_init__(self) -> None:
        if not self.peaks or not all(0 <= peak <= LOUDEST_PEAK for peak in self.peaks):
            raise ValueError(f"The sound '{self.name}' needs at least one peak, from 0 to {LOUDEST_PEAK}.")
        if not all(map(math.isfinite, (self.start, *self.beats))) or list(self.beats) != sorted(self.beats):
            raise ValueError(f"The sound '{self.name}' needs a finite start time and beats in order of time.")
        TIME_RANGE.check((self.start, *self.beats))

    @property
    def end(self) -> float:
        """Stage second at which the sound ends."""
        return self.start + len(self.peaks) / PEAK_RATE

    @property
    def stage_beats(self) -> tuple[float, ...]:
        """Times of the beats in stage seconds."""
        return tuple(self.start + beat for beat in self.beats)

    @cached_property
    def loudness(self) -> FloatArray:
        """Waveform peaks (N,), scaled to 0 to 1."""
        return np.asarray(self.peaks, dtype=np.float64) / LOUDEST_PEAK
