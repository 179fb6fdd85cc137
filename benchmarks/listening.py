"""For how long a window does not answer, and how a script lets it live meanwhile."""

import ctypes
import os
import threading
import time
from functools import cache
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


_TOLD = 100
"""Bytes of what the system tells of a thread at most."""
_read = ctypes.PyDLL(None).pread
"""Without giving Python's lock away, as ``os.pread`` does: what measures a wait for the lock would wait for it."""
_read.argtypes = ctypes.c_int, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_long


def queued() -> float:
    """Seconds for which this thread was ready and had no processor; 0 where the system does not tell."""
    told = _told_of(threading.get_native_id())
    if told is None:
        return 0.0
    buffer = ctypes.create_string_buffer(_TOLD)
    _read(told, buffer, _TOLD - 1, 0)
    return int(buffer.value.split()[1]) / 1e9


@cache
def _told_of(thread: int) -> int | None:
    """The open file in which the system tells how long a thread ran and waited."""
    path = Path(f"/proc/self/task/{thread}/schedstat")
    return os.open(path, os.O_RDONLY) if path.exists() else None
