"""For how long a window does not answer, and how a script lets it live meanwhile."""

import time
from pathlib import Path

from PySide6.QtCore import QEventLoop, QTimer

TICK = 2
"""Milliseconds after which the window is asked again."""


class Silences:
    """The longest time for which the window did not answer, beyond what only a busy machine made of it.

    Not counted is the time in which the window's thread was ready and waited for a processor, nor more than all threads
    of the program computed meanwhile: who held Python's lock may have waited for a processor, too.
    """

    def __init__(self) -> None:
        self._timer = QTimer(interval=TICK)
        self._timer.timeout.connect(self._tick)
        self.begun = time.perf_counter()
        self._last = self._now()
        self.longest = (0.0, 0.0)
        """Seconds, and when, from the beginning."""
        self._timer.start()

    def _now(self) -> tuple[float, float]:
        """Clock without the wait for a processor, and what was computed, seconds."""
        return time.perf_counter() - queued(), time.process_time()

    def _tick(self) -> None:
        now = self._now()
        silence = min(now[0] - self._last[0], now[1] - self._last[1])
        self.longest = max(self.longest, (silence, time.perf_counter() - self.begun))
        self._last = now

    def stop(self) -> None:
        """Listen no more."""
        self._timer.stop()


def run_window(milliseconds: int) -> None:
    """The window's own loop; waiting as tests do keeps Python's lock from those who compute."""
    loop = QEventLoop()
    QTimer.singleShot(milliseconds, loop.quit)
    loop.exec()


def queued() -> float:
    """Seconds for which this thread was ready and had no processor; 0 where the system does not tell."""
    told = Path("/proc/thread-self/schedstat")
    return int(told.read_text().split()[1]) / 1e9 if told.exists() else 0.0
