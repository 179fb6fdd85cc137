"""Uninterrupted run of the playhead: conversion from clock seconds to stage seconds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class PlaybackRun:
    """Run of the playhead from stage second ``start`` at clock second ``started``, at ``speed`` times real time."""

    started: float
    start: float
    speed: float
    begin: float
    """First stage second of the played range."""
    end: float
    """Stage second of the last frame of the played range."""
    frame: float
    """Seconds for which the last frame is shown before a loop begins again."""
    loop: bool

    def unbounded_seconds(self, clock: FloatArray) -> FloatArray:
        """Stage seconds at ``clock`` seconds (any shape), as if the played range had no end."""
        return np.asarray(self.start + (clock - self.started) * self.speed)

    def stage_seconds(self, clock: FloatArray) -> FloatArray:
        """Stage seconds at ``clock`` seconds, of the same shape; NaN past the end of a range that does not loop."""
        seconds = self.unbounded_seconds(clock)
        outside = (seconds < self.begin) | (seconds > self.end)
        if not self.loop or self.end <= self.begin:
            return np.where(outside, np.nan, seconds)
        around = self.begin + (seconds - self.begin) % (self.end - self.begin + self.frame)
        return np.where(outside, around, seconds)
