"""Fonts, pens and shapes shared by all tracks."""

from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QGuiApplication, QPainter, QPen, QPolygonF

from studio.document import colours
from studio.timeline.shown import ROW_LABEL_WIDTH

LABEL_INDENT = 14
KEY_REACH = 5.0
"""Pixels from the centre of a key's diamond to its corners."""


def font(pixels: int = 12) -> QFont:
    """Font of the timeline in a size in pixels, with tabular figures."""
    chosen = QFont(QGuiApplication.font())
    chosen.setPixelSize(pixels)
    chosen.setFeature(QFont.Tag("tnum"), 1)
    return chosen


def translucent(colour: str, share: float) -> QColor:
    """``colour`` with the opacity ``share``, 0 to 1."""
    result = QColor(colour)
    result.setAlphaF(share)
    return result


def hairline(colour: str | QColor, width: float = 1.0) -> QPen:
    """Pen with a width in logical pixels."""
    return QPen(QColor(colour), width)


def paint_label(painter: QPainter, area: QRect, text: str, colour: str, pixels: int = 12) -> None:
    """Paint one line of text in the column of names, elided if it does not fit."""
    painter.setFont(font(pixels))
    painter.setPen(QColor(colour))
    room = area.adjusted(LABEL_INDENT, 0, -8, 0)
    line = QFontMetrics(painter.font()).elidedText(text, Qt.TextElideMode.ElideRight, room.width())
    painter.drawText(room, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, line)


def paint_fold(painter: QPainter, line: QRect, folded: bool) -> None:
    """Paint the arrow that collapses a track: to the right if it is collapsed, else down."""
    x, y = line.left() + 7.0, line.center().y() + 0.5
    ways = ((-2.0, -3.0), (2.0, 0.0), (-2.0, 3.0)) if folded else ((-3.0, -2.0), (0.0, 2.0), (3.0, -2.0))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(QColor(colours.TEXT_THIRD), 1.3))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawPolyline([QPointF(x + dx, y + dy) for dx, dy in ways])


def paint_dot(painter: QPainter, centre: QPointF, radius: float, fill: str, edge: str | None = None) -> None:
    """Paint a round mark with an edge."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(hairline(edge, 1.5) if edge else Qt.PenStyle.NoPen)
    painter.setBrush(QColor(fill))
    painter.drawEllipse(centre, radius, radius)


def paint_key(painter: QPainter, position: QPointF, colour: str, selected: bool = False) -> None:
    """Paint the diamond of a key, with a light edge if selected."""
    x, y, reach = position.x(), position.y(), KEY_REACH + (1.0 if selected else 0.0)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(hairline(colours.SELECTED_HANDLE, 2.0) if selected else hairline(colours.PANEL, 1.0))
    painter.setBrush(QColor(colour))
    corners = ((x, y - reach), (x + reach, y), (x, y + reach), (x - reach, y))
    painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in corners]))


def paint_bar(painter: QPainter, bar: QRectF, fill: QColor, radius: float, edge: str | None = None) -> None:
    """Paint a bar with rounded corners."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(fill)
    painter.setPen(hairline(edge, 1.5) if edge else Qt.PenStyle.NoPen)
    painter.drawRoundedRect(bar, radius, radius)


def time_area(row: QRect) -> QRect:
    """Rectangle of a track to the right of its name."""
    return row.adjusted(ROW_LABEL_WIDTH, 0, 0, 0)
