"""Run of a playhead: conversion from seconds of a clock to seconds on the stage."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class PlaybackRun:
    """A playhead at stage second ``start`` when the clock was at ``started``, running ``speed`` times as fast."""

    started: float
    start: float
    speed: float
    begin: float
    """First second of the range that is played."""
    end: float
    """Second of the last frame of that range."""
    frame: float
    """Seconds for which the last frame is shown before a loop begins again."""
    loop: bool

    def unbounded_seconds(self, clock: FloatArray) -> FloatArray:
        """Seconds on the stage at the seconds ``clock``, as if the range had no end."""
        return np.asarray(self.start + (clock - self.started) * self.speed)

    def stage_seconds(self, clock: FloatArray) -> FloatArray:
        """Seconds on the stage at the seconds ``clock``, of the same shape; NaN beyond a range that does not loop."""
        seconds = self.unbounded_seconds(clock)
        outside = (seconds < self.begin) | (seconds > self.end)
        if not self.loop or self.end <= self.begin:
            return np.where(outside, np.nan, seconds)
        around = self.begin + (seconds - self.begin) % (self.end - self.begin + self.frame)
        return np.where(outside, around, seconds)
