"""Frame rate of recent images, and latency from the mouse to the displayed pose."""

import math
import time
from collections import deque
from collections.abc import Callable

PACE_SECONDS = 1.0
"""Length in seconds of the window over which images are counted."""
STATS_UPDATE_SECONDS = 0.25
"""Seconds between two updates of the displayed figures."""


class FrameStats:
    """Statistics of the images during motion."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._pictures: deque[float] = deque()
        self._begun: float | None = None
        self._asked_at: float | None = None
        self._behind: float | None = None
        self._posed: tuple[float | None] | None = None
        self._words, self._said_at = "", -math.inf

    def note_rest(self) -> None:
        """Record that nothing moves any more."""
        self._pictures.clear()
        self._begun = self._asked_at = self._behind = None
        self._words, self._said_at = "", -math.inf

    def note_posed(self, asked_at: float | None) -> None:
        """Record that an image is about to be rendered; ``asked_at`` is the clock time of the request that its pose
        answers, None for playback.
        """
        self._posed = (asked_at,)

    def note_painted(self, moving: bool) -> None:
        """Record that the image is painted, with the age of its pose; repeated paints count once."""
        if not moving:
            self.note_rest()
        elif self._posed is not None:
            self.note_picture(*self._posed)
        self._posed = None

    def note_picture(self, asked_at: float | None) -> None:
        """Record that an image is rendered; ``asked_at`` is the clock time of the request that its pose answers, None
        for playback.

        A pose for a request before the motion began does not count as late, since nothing newer was requested.
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
    def text(self) -> str:
        """Statistics as text, ``12 fps · latency 85 ms``, updated a few times a second; empty at rest."""
        now = self._clock()
        if not self._words or now - self._said_at >= STATS_UPDATE_SECONDS:
            self._words, self._said_at = self._now, now
        return self._words

    @property
    def _now(self) -> str:
        if len(self._pictures) < 2:
            return ""
        count = (len(self._pictures) - 1) / (self._pictures[-1] - self._pictures[0])
        behind = "" if self._behind is None else f" · latency {1000 * self._behind:.0f} ms"
        return f"{count:.0f} fps{behind}"
