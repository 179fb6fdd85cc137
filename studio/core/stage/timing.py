"""Mapping between the frames of a performer's motion and the time of the stage."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Timing:
    """Frame 0 is at ``begin`` seconds of the stage; frames ``first`` to ``last`` play, and hold before and after."""

    begin: float
    frame_rate: float
    first: int
    last: int

    @property
    def start(self) -> float:
        """Seconds on the stage at which it begins to play."""
        return self.stage_time(self.first)

    @property
    def end(self) -> float:
        """Seconds on the stage at which its last frame plays."""
        return self.stage_time(self.last)

    def stage_time(self, frame: float) -> float:
        """Seconds on the stage at which a frame plays."""
        return self.begin + frame / self.frame_rate

    def frame_at(self, seconds: float) -> float:
        """The frame, not rounded, that plays at a time of the stage."""
        return float(self.frames_at([seconds])[0])

    def frames_at(self, seconds: ArrayLike) -> NDArray[np.float64]:
        """(N,) ``frame_at`` of many."""
        frames = (np.asarray(seconds, dtype=np.float64) - self.begin) * self.frame_rate
        return np.asarray(np.clip(frames, self.first, self.last))
