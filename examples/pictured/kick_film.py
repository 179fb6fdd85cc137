"""The film: five bodies kick one target; it is dragged, and all five follow."""

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPen, QPolygonF
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from pictured.session import KICK_TIME, PATIENCE, Session, kick_target

FRAME_RATE = 20
WINDOW, TIMELINE_HEIGHT = (960, 700), 262
BEGIN, END = 1.75, 3.35
SIDEWAYS = 0.1
WAY = ((0.72, 0.84), (0.74, 1.05), (0.86, 1.26), (1.08, 1.2), (1.05, 0.95), (0.95, 1.15))
"""Forward and up in metres: where the target is at first, and through where it is dragged."""
PLANE = "zx"
DRAG_FRAMES, HOLD_FRAMES = 44, 5
LEFT, NO_KEY = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
ARROW = ((0, 0), (0, 17), (4, 13), (7, 20), (10, 19), (7, 12), (12, 12))


class KickFilm:
    """Plays, holds at the kick, drags, plays on; ``images`` has every frame."""

    def __init__(self) -> None:
        self._session = Session("front_kick", WINDOW)
        self.images: list[QImage] = []
        self._prepare()
        self._play(BEGIN, KICK_TIME)
        self._drag()
        self._play(KICK_TIME, END)
        self._session.close()

    def _prepare(self) -> None:
        session, window = self._session, self._session.window
        for name in ("Outliner", "History", "Inspector"):
            window.docks[name].hide()
        window.resizeDocks([window.docks["Timeline"]], [TIMELINE_HEIGHT], Qt.Orientation.Vertical)
        key = session.document.add("constraints", kick_target(_target(WAY[0])), "Add 'Kick target'")
        session.document.selection.set(("performers", "stocky_man"), ("constraints", key))
        session.document.playhead.set_time(KICK_TIME)
        session.settle()
        session.look(35, 8, 1.22, (0.0, -0.16))

    def _play(self, begin: float, end: float) -> None:
        for time in np.arange(begin, end, 1 / FRAME_RATE):
            self._session.document.playhead.set_time(float(time))
            self._take()

    def _drag(self) -> None:
        viewport = self._session.bench.viewport
        gizmo = viewport.gizmo()
        begin = gizmo.squares[PLANE].mean(axis=0)
        grip = gizmo.grip(PLANE, *begin)
        steps = [np.array(_target(place)) - _target(WAY[0]) for place in _through(WAY, DRAG_FRAMES)]
        places = [viewport.camera.project(grip + step, viewport.view_size)[0][0] for step in steps]
        for _ in range(HOLD_FRAMES):
            self._take(begin)
        QTest.mousePress(viewport, LEFT, NO_KEY, _pixel(begin))
        for place in places:
            _move(viewport, place)
            assert self._session.bench.live.wait_until_solved(PATIENCE)
            self._take(place)
        QTest.mouseRelease(viewport, LEFT, NO_KEY, _pixel(place))
        self._session.settle()
        for _ in range(HOLD_FRAMES):
            self._take(place)

    def _take(self, mouse: np.ndarray | None = None) -> None:
        session = self._session
        session.rest(0.03)
        window, viewport = session.window, session.bench.viewport
        top = viewport.mapTo(window, QPoint(0, 0))
        bottom = window.status.mapTo(window, QPoint(0, 0)).y()
        image = session.picture(part=QRect(0, top.y(), window.width(), bottom - top.y()))
        if mouse is not None:
            _paint_mouse(image, QPointF(*mouse) + QPointF(top.x(), 0))
        self.images.append(image)


def _target(place: tuple[float, float]) -> tuple[float, float, float]:
    forward, up = place
    return float(forward), SIDEWAYS, float(up)


def _through(way: tuple[tuple[float, float], ...], count: int) -> np.ndarray:
    """(count, 2) points on a smooth curve through the points of ``way``, beginning and ending at rest."""
    from scipy.interpolate import CubicSpline

    share = np.linspace(0.0, 1.0, count)
    eased = share * share * (3 - 2 * share)
    return CubicSpline(np.linspace(0.0, 1.0, len(way)), np.array(way), bc_type="clamped")(eased)


def _pixel(place: np.ndarray) -> QPoint:
    return QPoint(*(round(float(number)) for number in place))


def _move(viewport, place: np.ndarray) -> None:
    local = QPointF(*place)
    event = QMouseEvent(
        QEvent.Type.MouseMove, local, viewport.mapToGlobal(local), Qt.MouseButton.NoButton, LEFT, NO_KEY
    )
    QApplication.sendEvent(viewport, event)


def _paint_mouse(image: QImage, place: QPointF) -> None:
    with QPainter(image) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor("#101214"), 1.2))
        painter.setBrush(QColor("#ffffff"))
        painter.drawPolygon(QPolygonF([place + QPointF(*corner) for corner in ARROW]))
