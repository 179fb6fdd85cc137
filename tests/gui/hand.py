"""A mouse on the timeline, and where things are on it."""

from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.core.curves.activation import ActivationCurve

RATE = 60.0
LEFT = Qt.MouseButton.LeftButton
NONE = Qt.KeyboardModifier.NoModifier


def curve(start, full, full_end, end):
    return ActivationCurve(start / RATE, full / RATE, full_end / RATE, end / RATE)


def frames(activation):
    times = (activation.start, activation.full, activation.full_end, activation.end)
    return tuple(round(time * RATE, 6) for time in times)


class Hand:
    """A mouse on the rows, with a button that stays down from ``press`` to ``release``."""

    def __init__(self, timeline):
        self.rows = timeline.tracks
        self.at = QPoint()

    def press(self, point):
        self.at = QPoint(point)
        QTest.mousePress(self.rows, LEFT, NONE, self.at)

    def move(self, dx, modifiers=NONE, dy=0):
        for step in (0.5, 1.0):
            place = QPointF(self.at) + QPointF(dx, dy) * step
            event = QMouseEvent(QEvent.Type.MouseMove, place, self.rows.mapToGlobal(place), LEFT, LEFT, modifiers)
            QApplication.sendEvent(self.rows, event)
        self.at = QPoint(round(self.at.x() + dx), self.at.y() + dy)

    def release(self):
        QTest.mouseRelease(self.rows, LEFT, NONE, self.at)

    def drag(self, point, dx):
        self.press(point)
        self.move(dx)
        self.release()

    def wheel(self, point, degrees, modifiers):
        place = QPointF(point)
        event = QWheelEvent(
            place,
            self.rows.mapToGlobal(place),
            QPoint(),
            QPoint(0, round(degrees * 8)),
            Qt.MouseButton.NoButton,
            modifiers,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(self.rows, event)


def pixels(timeline, count):
    return timeline.x_of_frame(count) - timeline.x_of_frame(0)


def in_lane(timeline, frame, toe=False):
    row = timeline.row_rect("lane", "left foot")
    return QPoint(round(timeline.x_of_frame(frame)), row.center().y() + (4 if toe else -4))
