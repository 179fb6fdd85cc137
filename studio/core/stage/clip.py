"""Clip: a range of a motion, as a performer plays it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.keyed import KeyedNumber
from studio.core.curves.retiming import Speed, check_speed, motion_seconds, playing_seconds
from studio.core.plausible import PLACE_RANGE, TIME_RANGE, TURN_RANGE

FloatArray = NDArray[np.float64]

MOST_CLIP_REPEATS = 1000
"""Maximum number of times that a clip may play in succession."""


@dataclass(frozen=True)
class Clip:
    """Range of a motion that a performer plays: frames ``first`` to ``last``, both included, from ``start`` seconds on.

    ``speed`` is a factor, which may be keyed over the seconds of the motion. The range plays ``repeats`` times, as its
    mirror image if ``mirrored``. If ``joined``, the clip begins at the position where the previous clip has ended;
    ``turn`` (radians) then rotates it about its root, and ``offset`` (leg lengths, since a clip has no body) moves it.
    ``ease`` is the length in seconds of the transition from the previous clip if the two do not overlap; 0 lets it take
    as long as needed. ``grip`` shapes the hands from open (-1) to fists (1); None keeps the grip of the character.
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
                f"The last frame of a clip must not be before its first frame: {self.first} to {self.last} is empty."
            )
        if not math.isfinite(self.start):
            raise ValueError(f"A clip must start at a finite time, not at {self.start}.")
        TIME_RANGE.check((self.start, self.ease))
        check_speed(self.speed)
        if not 1 <= self.repeats <= MOST_CLIP_REPEATS:
            raise ValueError(f"The loop count of a clip must be from 1 to {MOST_CLIP_REPEATS}, not {self.repeats}.")
        if not all(math.isfinite(number) for number in (self.turn, *self.offset)):
            raise ValueError("The rotation and the offset of a clip must be finite numbers.")
        PLACE_RANGE.check(self.offset)
        TURN_RANGE.check(self.turn)
        if not (math.isfinite(self.ease) and self.ease >= 0.0):
            raise ValueError(f"The blend time of a clip must be 0 (automatic) or more seconds, not {self.ease}.")
        if self.grip is not None and not -1.0 <= self.grip <= 1.0:
            raise ValueError(f"The hand pose of a clip must be between -1 (open) and 1 (fists), not {self.grip}.")

    def length(self, frame_rate: float) -> float:
        """Duration on the stage in seconds, all repeats included, for a motion of ``frame_rate``."""
        if not isinstance(self.speed, KeyedNumber):
            return self.repeats * (self.last - self.first) / (frame_rate * self.speed)
        first, last = playing_seconds(self.speed, (self.first / frame_rate, self.last / frame_rate)).tolist()
        return float(self.repeats * (last - first))

    def stage_seconds(self, seconds: ArrayLike, frame_rate: float) -> FloatArray:
        """Stage seconds at which ``seconds`` of the motion first play, as if the clip had no ends."""
        if not isinstance(self.speed, KeyedNumber):
            return np.asarray(self.start + (np.asarray(seconds) - self.first / frame_rate) / self.speed)
        begin = playing_seconds(self.speed, self.first / frame_rate)
        return np.asarray(self.start + (playing_seconds(self.speed, seconds) - begin))

    def motion_seconds(self, seconds: ArrayLike, frame_rate: float) -> FloatArray:
        """Motion seconds that play at stage ``seconds``, as if the clip had no ends."""
        since = np.asarray(seconds) - self.start
        if not isinstance(self.speed, KeyedNumber):
            return np.asarray(since * self.speed + self.first / frame_rate)
        begin = playing_seconds(self.speed, self.first / frame_rate)
        return motion_seconds(self.speed, begin + since)

    def repeat_at(self, seconds: float, frame_rate: float) -> int:
        """Index of the repeat that plays at ``seconds`` of the stage; the first before the clip, the last after it."""
        once = self.length(frame_rate) / self.repeats
        return int(min(max((seconds - self.start) // once, 0), self.repeats - 1)) if once > 0.0 else 0
