"""Sound tracks on the stage: the waveform and beats of a file, and its start."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.plausible import TIME_RANGE

FloatArray = NDArray[np.float64]

PEAK_RATE = 100.0
"""Peaks of a waveform a second."""
LOUDEST_PEAK = 255
MOST_SOUND_SECONDS = 3600.0


@dataclass(frozen=True)
class SoundTrack:
    """Sound of a file from second ``start`` of the stage on."""

    name: str
    source: str
    """Path of the file."""
    peaks: tuple[int, ...]
    """Loudest value of each hundredth of a second, 0 to 255."""
    beats: tuple[float, ...] = ()
    """Seconds of the sound at which it sets in anew, ascending."""
    start: float = 0.0

    def __post_init__(self) -> None:
        if not self.peaks or not all(0 <= peak <= LOUDEST_PEAK for peak in self.peaks):
            raise ValueError(f"The sound '{self.name}' needs at least one peak, from 0 to {LOUDEST_PEAK}.")
        if not all(map(math.isfinite, (self.start, *self.beats))) or list(self.beats) != sorted(self.beats):
            raise ValueError(f"The sound '{self.name}' needs a finite start time and beats in order of time.")
        TIME_RANGE.check((self.start, *self.beats))

    @property
    def end(self) -> float:
        """Second of the stage at which it ends."""
        return self.start + len(self.peaks) / PEAK_RATE

    @property
    def stage_beats(self) -> tuple[float, ...]:
        """Times of its beats in seconds of the stage."""
        return tuple(self.start + beat for beat in self.beats)

    @cached_property
    def loudness(self) -> FloatArray:
        """(N,) peaks from 0 to 1."""
        return np.asarray(self.peaks, dtype=np.float64) / LOUDEST_PEAK
