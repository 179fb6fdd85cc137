"""Pictures a second of late, and latency from the hand to its pose."""

import math
import time
from collections import deque
from collections.abc import Callable

PACE_SECONDS = 1.0
"""Seconds over which pictures are counted."""
SAID_EVERY = 0.25
"""Seconds between one figure and the next."""


class Pace:
    """Hears of every picture while something moves."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._pictures: deque[float] = deque()
        self._begun: float | None = None
        self._asked_at: float | None = None
        self._behind: float | None = None
        self._posed: tuple[float | None] | None = None
        self._words, self._said_at = "", -math.inf

    def rest(self) -> None:
        """Nothing moves any more."""
        self._pictures.clear()
        self._begun = self._asked_at = self._behind = None
        self._words, self._said_at = "", -math.inf

    def posed(self, asked_at: float | None) -> None:
        """A picture is about to be made; ``asked_at`` as ``picture`` has it."""
        self._posed = (asked_at,)

    def seen(self, moving: bool) -> None:
        """It is painted, or the same once more: it counts once, and its pose is as old as it is now."""
        if not moving:
            self.rest()
        elif self._posed is not None:
            self.picture(*self._posed)
        self._posed = None

    def picture(self, asked_at: float | None) -> None:
        """A picture is made; ``asked_at`` (by the clock) that was asked which its pose answers, None for playback.

        A pose that answers what was asked before anything moved is not behind: nobody has asked anything else of it.
        """
        now = self._clock()
        self._begun = now if self._begun is None else self._begun
        self._pictures.append(now)
        while now - self._pictures[0] > PACE_SECONDS:
            self._pictures.popleft()
        if asked_at is None or asked_at < self._begun - PACE_SECONDS:
            self._behind = None
        elif asked_at != self._asked_at:  # the same answer seen again is no older for that
            self._behind = now - asked_at
        self._asked_at = asked_at

    @property
    def words(self) -> str:
        """``12 pictures/s · 85 ms latency``, anew some times a second, to be read; nothing at rest."""
        now = self._clock()
        if not self._words or now - self._said_at >= SAID_EVERY:
            self._words, self._said_at = self._now, now
        return self._words

    @property
    def _now(self) -> str:
        if len(self._pictures) < 2:
            return ""
        count = (len(self._pictures) - 1) / (self._pictures[-1] - self._pictures[0])
        behind = "" if self._behind is None else f" · latency {1000 * self._behind:.0f} ms"
        return f"{count:.0f} pictures/s{behind}"
