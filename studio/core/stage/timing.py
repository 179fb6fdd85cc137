"""Mapping between the frames of a performer's motion and the time of the stage."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Timing:
    """Frame 0 is at ``begin`` seconds of the stage; frames ``first`` to ``last`` play, and their poses are held before
    and after.
    """

    begin: float
    frame_rate: float
    first: int
    last: int

    @property
    def start(self) -> float:
        """Time on the stage of its first frame, seconds."""
        return self.stage_time(self.first)

    @property
    def end(self) -> float:
        """Time on the stage of its last frame, seconds."""
        return self.stage_time(self.last)

    def stage_time(self, frame: float) -> float:
        """Time on the stage of a frame, seconds."""
        return self.begin + frame / self.frame_rate

    def frame_at(self, seconds: float) -> float:
        """Frame, with a fraction, at a time of the stage."""
        return float(self.frames_at([seconds])[0])

    def frames_at(self, seconds: ArrayLike) -> NDArray[np.float64]:
        """(N,) frames, with fractions, at times of the stage."""
        frames = (np.asarray(seconds, dtype=np.float64) - self.begin) * self.frame_rate
        return np.asarray(np.clip(frames, self.first, self.last))
