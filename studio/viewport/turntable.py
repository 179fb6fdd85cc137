"""Turntable: the camera orbits its target at a constant speed."""

import math
import time
from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer

TURN_SECONDS = 12.0
TURN_RATE = 2.0 * math.pi / TURN_SECONDS
"""Radians per second."""
STEP_MILLISECONDS = 16


class Turntable(QObject):
    """Timer that calls ``turn`` with the radians since the last call while it runs."""

    def __init__(self, turn: Callable[[float], object], parent: QObject) -> None:
        super().__init__(parent)
        self._turn = turn
        self._last = 0.0
        self._timer = QTimer(self, interval=STEP_MILLISECONDS)
        self._timer.timeout.connect(self._step)

    @property
    def running(self) -> bool:
        """True while the camera orbits."""
        return self._timer.isActive()

    def start(self) -> None:
        """Start to orbit."""
        self._last = time.monotonic()
        self._timer.start()

    def stop(self) -> None:
        """Stop the camera."""
        self._timer.stop()

    def _step(self) -> None:
        now = time.monotonic()
        self._turn(TURN_RATE * (now - self._last))
        self._last = now
