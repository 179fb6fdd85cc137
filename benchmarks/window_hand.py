"""A hand on the mouse: it moves by its own clock, whatever the window does, and its newest move alone waits."""

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from benchmarks.listening import queued

RATE = 60.0
ROUND = 1.3
"""Seconds of one turn to and fro."""
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton


@dataclass(frozen=True)
class Move:
    """Places of the mouse, their times (``time.monotonic``), and those at which the window took notice.

    ``waited``: seconds until then for which the window's thread was ready and had no processor.
    """

    place: QPointF
    at: float
    taken: float
    waited: float


class Hand(QObject):
    """Drags on ``widget`` from ``start`` round or along by ``reach`` pixels; ``moved`` hears of every move taken.

    Like a window system it hands over the newest place alone where the window has not taken the last one yet.
    """

    _waiting = Signal()

    def __init__(self, widget: QWidget, start: QPointF, reach: QPointF, moved: Callable[[Move], None]) -> None:
        super().__init__()
        self._widget, self._start, self._reach, self._moved = widget, start, reach, moved
        self._lock, self._stopped = threading.Lock(), threading.Event()
        self._newest: tuple[QPointF, float] | None = None
        self._waiting.connect(self._take, Qt.ConnectionType.QueuedConnection)
        self._thread = threading.Thread(target=self._run, name="hand")

    def press(self) -> None:
        """Take hold, and begin to move."""
        self._send(QEvent.Type.MouseButtonPress, self._start, LEFT)
        self._thread.start()

    def release(self) -> None:
        """Rest, and let go."""
        self._stopped.set()
        self._thread.join()
        self._take()
        self._send(QEvent.Type.MouseButtonRelease, self._place(time.monotonic() - self._begun), LEFT)

    def _run(self) -> None:
        self._begun = time.monotonic()
        tick = 0
        while not self._stopped.wait(max(self._begun + tick / RATE - time.monotonic(), 0.0)):
            now = time.monotonic()
            with self._lock:
                free = self._newest is None
                self._newest = self._place(now - self._begun), now
            if free:
                self._waiting.emit()
            tick += 1

    def _place(self, seconds: float) -> QPointF:
        turn = 2 * math.pi * seconds / ROUND
        return self._start + QPointF(self._reach.x() * math.sin(turn), self._reach.y() * (math.cos(turn) - 1.0))

    def _take(self) -> None:
        with self._lock:
            newest, self._newest = self._newest, None
        if newest is not None:
            self._moved(Move(*newest, time.monotonic(), queued()))
            self._send(QEvent.Type.MouseMove, newest[0], NONE)

    def _send(self, kind: QEvent.Type, place: QPointF, button: Qt.MouseButton) -> None:
        down = NONE if kind == QEvent.Type.MouseButtonRelease else LEFT
        there = self._widget.mapToGlobal(place)
        QApplication.sendEvent(self._widget, QMouseEvent(kind, place, there, button, down, Qt.KeyboardModifier(0)))
