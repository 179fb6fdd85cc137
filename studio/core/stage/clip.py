"""Clip: a range of a motion, as a performer plays it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import Speed, check_speed, motion_seconds, playing_seconds
from studio.core.plausible import PLACE_RANGE, TIME_RANGE, TURN_RANGE

FloatArray = NDArray[np.float64]

MOST_REPEATS = 1000
"""Times that a clip may play."""


@dataclass(frozen=True)
class Clip:
    """Range of a motion: frames ``first`` to ``last``, both included, from ``start`` seconds.

    It plays ``speed`` times as fast, which may be keyed over the seconds of the motion, ``repeats`` times, as its
    mirror image if ``mirrored``. ``joined`` begins it where the clip before has ended; ``turn`` (radians) then rotates
    it about its root, ``offset`` moves it, in leg lengths, since a clip has no body. ``ease`` are the seconds of its
    transition if it overlaps nothing; 0 as many as needed. ``grip`` shapes the hands while it plays, from open (-1) to
    fists (1); None keeps the character's.
    """

    motion_id: str
    first: int
    last: int
    start: float = 0.0
    id: str = ""
    """Id used by scopes; a copy with the same id is the same clip on another performer."""
    speed: Speed = 1.0
    repeats: int = 1
    mirrored: bool = False
    joined: bool = True
    turn: float = 0.0
    offset: tuple[float, float] = (0.0, 0.0)
    ease: float = 0.0
    grip: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.first <= self.last:
            raise ValueError(
                f"The last frame of a clip must be after its first frame: {self.first} to {self.last} is empty."
            )
        if not math.isfinite(self.start):
            raise ValueError(f"A clip must start at a finite time, not at {self.start}.")
        TIME_RANGE.check((self.start, self.ease))
        check_speed(self.speed)
        if not 1 <= self.repeats <= MOST_REPEATS:
            raise ValueError(f"The loop count of a clip must be from 1 to {MOST_REPEATS}, not {self.repeats}.")
        if not all(math.isfinite(number) for number in (self.turn, *self.offset)):
            raise ValueError("The rotation and the offset of a clip must be finite numbers.")
        PLACE_RANGE.check(self.offset)
        TURN_RANGE.check(self.turn)
        if not (math.isfinite(self.ease) and self.ease >= 0.0):
            raise ValueError(f"The blend time of a clip must be 0 (automatic) or more seconds, not {self.ease}.")
        if self.grip is not None and not -1.0 <= self.grip <= 1.0:
            raise ValueError(f"The hand pose of a clip must be between -1 (open) and 1 (fists), not {self.grip}.")

    def length(self, frame_rate: float) -> float:
        """Duration in seconds on the stage of the clip of a motion of ``frame_rate``, with all its repeats."""
        if not isinstance(self.speed, KeyedNumber):
            return self.repeats * (self.last - self.first) / (frame_rate * self.speed)
        first, last = playing_seconds(self.speed, (self.first / frame_rate, self.last / frame_rate)).tolist()
        return float(self.repeats * (last - first))

    def stage_seconds(self, seconds: ArrayLike, frame_rate: float) -> FloatArray:
        """Seconds on the stage at which ``seconds`` of the motion play first, as if the clip had no ends."""
        if not isinstance(self.speed, KeyedNumber):
            return np.asarray(self.start + (np.asarray(seconds) - self.first / frame_rate) / self.speed)
        begin = playing_seconds(self.speed, self.first / frame_rate)
        return np.asarray(self.start + (playing_seconds(self.speed, seconds) - begin))

    def motion_seconds(self, seconds: ArrayLike, frame_rate: float) -> FloatArray:
        """Seconds of the motion that play at ``seconds`` of the stage, as if the clip had no ends."""
        since = np.asarray(seconds) - self.start
        if not isinstance(self.speed, KeyedNumber):
            return np.asarray(since * self.speed + self.first / frame_rate)
        begin = playing_seconds(self.speed, self.first / frame_rate)
        return motion_seconds(self.speed, begin + since)

    def repeat_at(self, seconds: float, frame_rate: float) -> int:
        """Number of the repeat at a time of the stage; the first or last one before and after the clip."""
        once = self.length(frame_rate) / self.repeats
        return int(min(max((seconds - self.start) // once, 0), self.repeats - 1)) if once > 0.0 else 0
