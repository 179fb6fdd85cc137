"""Painting over the tracks: the playhead, the snapped time of a drag, and its hint."""

from PySide6.QtCore import QPointF, QRect, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPolygonF

from studio.document import colours
from studio.timeline.gestures.gesture import DragHint
from studio.timeline.shown import ROW_LABEL_WIDTH, RowContext
from studio.timeline.tracks import ruler
from studio.timeline.tracks.brush import font, hairline, paint_bar, translucent

PROGRESS_BAR_WIDTH = 200.0
PLAYHEAD_HALF_WIDTH = 6.0


def playhead_area(shown: RowContext, height: int) -> QRect:
    """Rectangle that the playhead covers."""
    x = round(shown.axis.x_of_time(shown.document.playhead.time))
    return QRect(x - 8, 0, 17, height)


def paint_playhead(painter: QPainter, shown: RowContext, height: int) -> None:
    """Paint the playhead: a head on the ruler with a thin line below."""
    x = round(shown.axis.x_of_time(shown.document.playhead.time))
    if x < ROW_LABEL_WIDTH:
        return
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    painter.fillRect(x, ruler.RULER_HEIGHT - 6, 1, height, QColor(colours.PLAYHEAD))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colours.PLAYHEAD))
    middle, top, tip = x + 0.5, ruler.RULER_HEIGHT - 16.0, ruler.RULER_HEIGHT - 1.0
    corners = (
        (-PLAYHEAD_HALF_WIDTH, top),
        (PLAYHEAD_HALF_WIDTH, top),
        (PLAYHEAD_HALF_WIDTH, tip - 6),
        (0.0, tip),
        (-PLAYHEAD_HALF_WIDTH, tip - 6),
    )
    painter.drawPolygon(QPolygonF([QPointF(middle + dx, y) for dx, y in corners]))


def paint_mark(painter: QPainter, shown: RowContext, mark: DragHint, mouse: QPointF, area: QRect) -> None:
    """Paint a line at the snapped time of a drag, and its hint beside the mouse."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    if mark.magnet is not None:
        x = round(shown.axis.x_of_time(mark.magnet))
        painter.setPen(hairline(colours.SELECTED_HANDLE))
        painter.drawLine(x, ruler.RULER_HEIGHT, x, area.bottom())
    painter.setFont(font(11))
    width = QFontMetrics(painter.font()).horizontalAdvance(mark.text) + 14
    left = shown.axis.x_of_time(mark.time) + 10
    if left + width > area.right():
        left -= width + 20
    top = mouse.y() - 32 if mouse.y() > ruler.RULER_HEIGHT + 32 else mouse.y() + 14
    chip = QRectF(round(max(left, ROW_LABEL_WIDTH + 4.0)) + 0.5, round(top) + 0.5, width, 20)
    paint_bar(painter, chip, QColor(colours.WINDOW), 4, colours.EDGE)
    painter.setPen(QColor(colours.TEXT))
    painter.drawText(chip, Qt.AlignmentFlag.AlignCenter, mark.text)


def paint_box(painter: QPainter, box: QRectF) -> None:
    """Paint the selection box for keys."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    painter.setPen(hairline(colours.SELECTED_HANDLE))
    painter.setBrush(translucent(colours.SELECTED_HANDLE, 0.15))
    painter.drawRect(box)


def paint_focus(painter: QPainter, area: QRect) -> None:
    """Paint a thin frame that shows the keyboard focus."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    painter.setPen(hairline(colours.SELECTED_CONTROL))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawRect(area.adjusted(0, 0, -1, -1))


def paint_prompt(painter: QPainter, area: QRect, text: str, share: float | None = None) -> None:
    """Paint a text on an empty timeline: what to do next, or the running task with its progress ``share`` (0 to 1)."""
    painter.fillRect(area, QColor(colours.PANEL))
    painter.setFont(font(13))
    painter.setPen(QColor(colours.TEXT_SECOND))
    painter.drawText(area, Qt.AlignmentFlag.AlignCenter, text)
    if share is not None:
        bar = QRectF(area.center().x() - PROGRESS_BAR_WIDTH / 2, area.center().y() + 22.0, PROGRESS_BAR_WIDTH, 4.0)
        paint_bar(painter, bar, QColor(colours.CONTROL), 2)
        paint_bar(
            painter,
            QRectF(bar.topLeft(), QSizeF(PROGRESS_BAR_WIDTH * share, 4.0)),
            QColor(colours.KIND_COLOURS["position"]),
            2,
        )
