"""Painting of gizmos: arrows, rings, boxes, and the amount of a drag."""

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen

from studio.document import colours
from studio.viewport.camera import FloatArray
from studio.viewport.gizmo import BALL_HANDLE, GIZMO_AXES, PLANE_NORMAL_AXES, Gizmo, GizmoFrame
from studio.viewport.mouse_gestures import EditDrag, RotateDrag, ViewportGesture
from studio.viewport.rotate_gizmo import SCREEN_PART, TRACKBALL, RotateGizmo
from studio.viewport.scale_gizmo import ScaleGizmo
from studio.viewport.strokes import STROKE_SHADOW, draw_disc, draw_line, polygon

AXIS_COLOURS = {"x": "#e8675f", "y": "#7cc47a", "z": "#5f9fe8"}
HOVERED_COLOUR, MIDDLE_COLOUR = "#ffe08a", "#f4f7fb"
ARROW_LENGTH, ARROW_WIDTH = 13.0, 5.5
HALF_BOX_PIXELS = 5.0
"""Half of the side of a box in pixels."""
HIDDEN_RING_OPACITY = 0.16
"""Opacity of the rear half of a ring."""
WORDS_HEIGHT = 22.0


class GizmoPainter:
    """Painter of gizmos; ``hot`` is the part under the mouse or being dragged."""

    def __init__(self, painter: QPainter) -> None:
        self._painter = painter
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)

    def paint(self, gizmo: GizmoFrame, hot: str | None, gesture: ViewportGesture | None) -> None:
        """Paint a gizmo, and beside it the amount of a drag."""
        match gizmo:
            case RotateGizmo():
                self._rotate(gizmo, hot, gesture if isinstance(gesture, RotateDrag) else None)
            case ScaleGizmo():
                self._scale(gizmo, hot)
            case Gizmo():
                self._move(gizmo, hot)
        if isinstance(gesture, EditDrag) and gesture.words:
            self._words(gizmo, gesture.words)

    def _move(self, gizmo: Gizmo, hot: str | None) -> None:
        """Paint planes, arrows and ball."""
        for name, across in PLANE_NORMAL_AXES.items():
            if gizmo.usable(name):
                self._square(gizmo.squares[name], AXIS_COLOURS[GIZMO_AXES[across]], name == hot)
        for axis, tip in _back_to_front(gizmo):
            if gizmo.usable(axis):
                self._arrow(gizmo.centre, tip, HOVERED_COLOUR if axis == hot else AXIS_COLOURS[axis])
        draw_disc(self._painter, gizmo.centre, 6.0, QColor(HOVERED_COLOUR if hot == BALL_HANDLE else MIDDLE_COLOUR))

    def _scale(self, gizmo: ScaleGizmo, hot: str | None) -> None:
        """Paint lines that end in boxes, and the box in the middle."""
        for axis, tip in _back_to_front(gizmo):
            if gizmo.usable(axis):
                colour = HOVERED_COLOUR if axis == hot else AXIS_COLOURS[axis]
                draw_line(self._painter, gizmo.centre, tip, colour, 2.2)
                self._box(tip, QColor(colour))
        self._box(gizmo.centre, QColor(HOVERED_COLOUR if hot == BALL_HANDLE else MIDDLE_COLOUR))

    def _rotate(self, gizmo: RotateGizmo, hot: str | None, drag: RotateDrag | None) -> None:
        """Paint rings with faint rear halves; during a drag, only the dragged ring and the angle."""
        if drag is not None and drag.part != TRACKBALL:
            self._sector(gizmo, drag)
            return
        if not gizmo.heading_only:
            self._globe(gizmo, hot == TRACKBALL)
        for part in gizmo.parts:
            colour = QColor(HOVERED_COLOUR if part == hot else AXIS_COLOURS.get(part, MIDDLE_COLOUR))
            self._ring(gizmo, part, colour, 2.4 if part == hot else 1.2 if part == SCREEN_PART else 1.8)
        draw_disc(self._painter, gizmo.centre, 2.5, QColor(MIDDLE_COLOUR))

    def _globe(self, gizmo: RotateGizmo, hot: bool) -> None:
        fill = QColor(HOVERED_COLOUR if hot else MIDDLE_COLOUR)
        fill.setAlphaF(0.10 if hot else 0.04)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(fill)
        self._painter.drawEllipse(QPointF(*gizmo.centre), gizmo.radius, gizmo.radius)

    def _ring(self, gizmo: RotateGizmo, part: str, colour: QColor, width: float) -> None:
        corners, front = gizmo.ring(part), gizmo.in_front(part)
        for strength, chosen in ((HIDDEN_RING_OPACITY, ~front), (1.0, front)):
            for begin, end in _runs(chosen.tolist()):
                self._polyline(corners[np.arange(begin, end + 1) % len(front)], colour, width, strength)

    def _polyline(self, corners: FloatArray, colour: QColor, width: float, strength: float = 1.0) -> None:
        line = polygon(corners)
        self._painter.setBrush(Qt.BrushStyle.NoBrush)
        for hue, extent in ((STROKE_SHADOW, width + 1.6), (colour, width)):
            faint = QColor(hue)
            faint.setAlphaF(hue.alphaF() * strength)
            self._painter.setPen(QPen(faint, extent, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
            self._painter.drawPolyline(line)

    def _sector(self, gizmo: RotateGizmo, drag: RotateDrag) -> None:
        """Paint the dragged ring, with the sector of the rotation."""
        held = drag.gizmo
        colour = QColor(AXIS_COLOURS.get(drag.part, MIDDLE_COLOUR))
        shift = gizmo.centre - held.centre
        corners = held.sector(drag.part, drag.begin, drag.angle) + shift
        fill = QColor(colour)
        fill.setAlphaF(0.28)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(fill)
        self._painter.drawPolygon(polygon(corners))
        draw_line(self._painter, corners[0], corners[1], colour.name(), 1.2)
        draw_line(self._painter, corners[0], corners[-1], HOVERED_COLOUR, 1.8)
        self._polyline(held.ring(drag.part) + shift, QColor(HOVERED_COLOUR), 1.8)
        draw_disc(self._painter, gizmo.centre, 2.5, QColor(MIDDLE_COLOUR))

    def _words(self, gizmo: GizmoFrame, words: str) -> None:
        font = self._painter.font()
        font.setPixelSize(13)
        self._painter.setFont(font)
        width = self._painter.fontMetrics().horizontalAdvance(words) + 20.0
        x, y = gizmo.centre
        plate = QRectF(x - width / 2, y + gizmo.pixels * 1.18, width, WORDS_HEIGHT)
        self._painter.setPen(Qt.PenStyle.NoPen)
        self._painter.setBrush(QColor(22, 25, 29, 225))
        self._painter.drawRoundedRect(plate, 8.0, 8.0)
        self._painter.setPen(QColor(colours.STAGE_TEXT))
        self._painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, words)

    def _arrow(self, begin: FloatArray, tip: FloatArray, colour: str) -> None:
        way = tip - begin
        length = float(np.hypot(*way))
        if length < 1.0:
            return
        way = way / length
        across = np.array([-way[1], way[0]])
        base = tip - way * min(ARROW_LENGTH, length)
        draw_line(self._painter, begin + way * min(9.0, length), base, colour, 2.6)
        self._painter.setPen(QPen(STROKE_SHADOW, 1.0))
        self._painter.setBrush(QBrush(QColor(colour)))
        corners = np.array([tip, base + ARROW_WIDTH * across, base - ARROW_WIDTH * across])
        self._painter.drawPolygon(polygon(corners))

    def _box(self, position: FloatArray, colour: QColor) -> None:
        self._painter.setPen(QPen(STROKE_SHADOW, 1.5))
        self._painter.setBrush(QBrush(colour))
        self._painter.drawRect(
            QRectF(
                position[0] - HALF_BOX_PIXELS,
                position[1] - HALF_BOX_PIXELS,
                2.0 * HALF_BOX_PIXELS,
                2.0 * HALF_BOX_PIXELS,
            )
        )

    def _square(self, corners: FloatArray, colour: str, hot: bool) -> None:
        fill = QColor(HOVERED_COLOUR if hot else colour)
        fill.setAlpha(190 if hot else 80)
        self._painter.setPen(QPen(QColor(HOVERED_COLOUR if hot else colour), 1.2))
        self._painter.setBrush(QBrush(fill))
        self._painter.drawPolygon(polygon(corners))


def _back_to_front(gizmo: GizmoFrame) -> list[tuple[str, FloatArray]]:
    """Axes with their end pixels, the farthest first."""
    order = np.argsort(gizmo.axes @ gizmo.camera.axes[2])
    return [(GIZMO_AXES[place], gizmo.tips[place]) for place in order.tolist()]


def _runs(chosen: list[bool]) -> list[tuple[int, int]]:
    """Start and end of each run of True sides of a closed line; an end may exceed the last side."""
    count = len(chosen)
    if all(chosen):
        return [(0, count)]
    runs = []
    for begin in range(count):
        if chosen[begin] and not chosen[begin - 1]:
            end = begin
            while chosen[end % count]:
                end += 1
            runs.append((begin, end))
    return runs
