"""Hand: when the mouse that drags something was moved last, whenever the window comes to hear of it."""

import time

from PySide6.QtCore import QCoreApplication, QEvent, QObject, Qt, QTimer, Signal

BUSY = 0.1
"""Seconds by which a timer is late when the window was busy."""
LATEST_EVENT = 1.0
"""Seconds after which an event comes at most; one that seems later has no time, or that of another clock."""


class Hand(QObject):
    """Listens to all mouse events of the program, but only while something is dragged."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._moved_at: float | None = None

    def listen(self, on: bool) -> None:
        """Begin, or end."""
        self._moved_at = None
        program = QCoreApplication.instance()
        if program is not None and on:
            program.installEventFilter(self)
        elif program is not None:
            program.removeEventFilter(self)

    @property
    def moved_at(self) -> float:
        """When (``time.monotonic``) the mouse was moved last with a button down; now where that is not known."""
        return time.monotonic() if self._moved_at is None else self._moved_at

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Notes the time and takes nothing."""
        if event.type() == QEvent.Type.MouseMove and event.buttons() != Qt.MouseButton.NoButton:  # type: ignore[attr-defined]
            self._moved_at = when(event.timestamp())  # type: ignore[attr-defined]
        return False


class Rest(QTimer):
    """Tells when a hand has rested for some time.

    Where the window was busy at that time, moves of the hand may still wait to be taken: then the time begins again.
    """

    rested = Signal()

    def __init__(self, milliseconds: int, parent: QObject | None = None) -> None:
        super().__init__(parent, singleShot=True, interval=milliseconds)
        self._due = 0.0
        self.timeout.connect(self._end)

    def begin(self) -> None:
        """The hand has moved."""
        self._due = time.monotonic() + 0.001 * self.interval()
        self.start()

    def _end(self) -> None:
        if time.monotonic() > self._due + BUSY:
            self.begin()
        else:
            self.rested.emit()


def when(milliseconds: int) -> float:
    """The ``time.monotonic`` of an event, whose own clock begins with the machine; now where that cannot be."""
    now = time.monotonic()
    return 0.001 * milliseconds if 0.0 <= now - 0.001 * milliseconds < LATEST_EVENT else now
