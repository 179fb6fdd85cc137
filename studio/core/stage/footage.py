"""Reference footage on the stage: a film or numbered pictures, with its start and speed."""

import math
from dataclasses import dataclass

from studio.core.plausible import TIME_RANGE

FOOTAGE_RATES = (0.1, 1000.0)
"""Lowest and highest frame rate at which footage is shown, in frames per second."""


@dataclass(frozen=True)
class Footage:
    """Reference film, or numbered pictures, shown from stage second ``start`` on."""

    name: str
    source: str
    """Path of the film, or of the first picture."""
    frames: int
    file_rate: float
    """Frame rate of the film; for pictures, the rate with which they were added."""
    frame_rate: float
    """Frame rate at which the footage is shown on the stage."""
    start: float = 0.0

    def __post_init__(self) -> None:
        least, most = FOOTAGE_RATES
        if not all(least <= rate <= most for rate in (self.file_rate, self.frame_rate)):
            raise ValueError(f"The frame rate of the footage '{self.name}' must be from {least:g} to {most:g} fps.")
        if self.frames < 1 or not math.isfinite(self.start):
            raise ValueError(f"The footage '{self.name}' needs at least one frame and a finite start time.")
        TIME_RANGE.check((self.start,))

    @property
    def end(self) -> float:
        """Stage second at which the last frame ends."""
        return self.start + self.frames / self.frame_rate

    def frame_at(self, seconds: float) -> int | None:
        """Index of the frame shown at a second of the stage; None before the first frame and after the last."""
        frame = math.floor((seconds - self.start) * self.frame_rate + 1e-6)
        return frame if 0 <= frame < self.frames else None
