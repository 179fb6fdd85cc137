"""Mapping between the frames of a performer's motion and the time of the stage."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Timing:
    """Times of a motion on the stage: frame 0 is at second ``begin``, and the frames ``first`` to ``last`` play.

    The poses of these two frames are held before and after.
    """

    begin: float
    frame_rate: float
    first: int
    last: int

    @property
    def start(self) -> float:
        """Stage second of the first frame."""
        return self.stage_time(self.first)

    @property
    def end(self) -> float:
        """Stage second of the last frame."""
        return self.stage_time(self.last)

    def stage_time(self, frame: float) -> float:
        """Stage second of ``frame``."""
        return self.begin + frame / self.frame_rate

    def frame_at(self, seconds: float) -> float:
        """Frame, with a fraction, at stage second ``seconds``."""
        return float(self.frames_at([seconds])[0])

    def frames_at(self, seconds: ArrayLike) -> NDArray[np.float64]:
        """Frames (N,), with fractions, at stage ``seconds`` (N,)."""
        frames = (np.asarray(seconds, dtype=np.float64) - self.begin) * self.frame_rate
        return np.asarray(np.clip(frames, self.first, self.last))
