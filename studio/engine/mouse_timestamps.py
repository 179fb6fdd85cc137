"""Times of mouse moves during a drag, independent of when the window handles their events."""

import time

from PySide6.QtCore import QCoreApplication, QEvent, QObject, Qt, QTimer, Signal

BUSY_DELAY_SECONDS = 0.1
"""Delay of a timer in seconds from which the window counts as busy."""
MAX_EVENT_DELAY_SECONDS = 1.0
"""Maximum delay of an event in seconds; beyond it the event's time is missing or from another clock."""


class MouseTimestamps(QObject):
    """Event filter for all mouse events of the program, installed only during a drag."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._moved_at: float | None = None

    def set_listening(self, on: bool) -> None:
        """Install the event filter if ``on``, else remove it."""
        self._moved_at = None
        program = QCoreApplication.instance()
        if program is not None and on:
            program.installEventFilter(self)
        elif program is not None:
            program.removeEventFilter(self)

    @property
    def moved_at(self) -> float:
        """Clock time (``time.monotonic``) of the last mouse move with a button pressed; the current time if unknown."""
        return time.monotonic() if self._moved_at is None else self._moved_at

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Store the time of a mouse move; returns False, so that the event is handled as usual."""
        if event.type() == QEvent.Type.MouseMove and event.buttons() != Qt.MouseButton.NoButton:  # type: ignore[attr-defined]
            self._moved_at = monotonic_time(event.timestamp())  # type: ignore[attr-defined]
        return False


class RestTimer(QTimer):
    """Timer that emits ``rested`` when the mouse has not moved for some time.

    If the window was busy then, mouse moves may still be queued, and the timer starts again.
    """

    rested = Signal()

    def __init__(self, milliseconds: int, parent: QObject | None = None) -> None:
        super().__init__(parent, singleShot=True, interval=milliseconds)
        self._due = 0.0
        self.timeout.connect(self._end)

    def begin(self) -> None:
        """Restart the timer after a mouse move."""
        self._due = time.monotonic() + 0.001 * self.interval()
        self.start()

    def _end(self) -> None:
        if time.monotonic() > self._due + BUSY_DELAY_SECONDS:
            self.begin()
        else:
            self.rested.emit()


def monotonic_time(milliseconds: int) -> float:
    """Clock time (``time.monotonic``) of an event with a timestamp in milliseconds since the machine started; the
    current time if that is not plausible.
    """
    now = time.monotonic()
    return 0.001 * milliseconds if 0.0 <= now - 0.001 * milliseconds < MAX_EVENT_DELAY_SECONDS else now
