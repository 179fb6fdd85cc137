"""Lines and discs over the image, with a dark edge that is visible on any background."""

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter, QPen, QPolygonF

from studio.viewport.camera import FloatArray

STROKE_SHADOW = QColor(12, 14, 17, 170)


def polygon(corners: FloatArray) -> QPolygonF:
    """Qt polygon of pixels ``corners`` (N, 2)."""
    return QPolygonF([QPointF(x, y) for x, y in corners.tolist()])


def draw_disc(painter: QPainter, position: FloatArray, radius: float, colour: QColor) -> None:
    """Draw a filled disc of ``radius`` pixels at pixel ``position`` (2,)."""
    painter.setPen(QPen(STROKE_SHADOW, 1.5))
    painter.setBrush(QBrush(colour))
    painter.drawEllipse(QPointF(*position), radius, radius)


def draw_line(painter: QPainter, begin: FloatArray, end: FloatArray, colour: str, width: float) -> None:
    """Draw a line between pixels ``begin`` and ``end`` (2,)."""
    for hue, extent in ((STROKE_SHADOW, width + 1.5), (QColor(colour), width)):
        painter.setPen(QPen(hue, extent, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(QPointF(*begin), QPointF(*end))
