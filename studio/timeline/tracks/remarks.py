"""Marks on the ruler for remarks on the capture, at their frames."""

from collections.abc import Iterator

from PySide6.QtCore import QPointF, QRect, Qt
from PySide6.QtGui import QColor, QPainter, QPolygonF

from studio.core.captures.remarks import Remark
from studio.document import colours
from studio.timeline.shown import ROW_LABEL_WIDTH, RowContext

REMARK_HALF_WIDTH, REMARK_LINE_PX = 4.0, 2
"""Half of the width in pixels of a mark's head, and height of the line along the frames of the remark."""


def paint_remarks(painter: QPainter, ruler: QRect, shown: RowContext) -> None:
    """Paint a small head at the start of each remark, and a line for its duration."""
    painter.save()
    painter.setClipRect(ruler.adjusted(ROW_LABEL_WIDTH, 0, 0, 0), Qt.ClipOperation.IntersectClip)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(colours.PARTLY))
    low, seen = ruler.bottom() + 1.0 - REMARK_LINE_PX, -REMARK_HALF_WIDTH
    for _, left, right in _marks(shown):
        painter.fillRect(
            round(left), round(low), max(round(right - left), REMARK_LINE_PX), REMARK_LINE_PX, QColor(colours.PARTLY)
        )
        if left - seen >= REMARK_HALF_WIDTH:  # of hundreds in a row not every head is drawn
            corners = (
                (-REMARK_HALF_WIDTH, -2.0 * REMARK_HALF_WIDTH),
                (REMARK_HALF_WIDTH, -2.0 * REMARK_HALF_WIDTH),
                (0.0, 0.0),
            )
            painter.drawPolygon(QPolygonF([QPointF(left + dx, low + dy) for dx, dy in corners]))
            seen = left
    painter.restore()


def remark_text(shown: RowContext, x: float) -> str:
    """Sentences of the remarks at the pixel ``x``; empty if there are none."""
    there = (
        remark.sentence
        for remark, left, right in _marks(shown)
        if left - REMARK_HALF_WIDTH <= x <= right + REMARK_HALF_WIDTH
    )
    return "\n".join(dict.fromkeys(there))


def _marks(shown: RowContext) -> Iterator[tuple[Remark, float, float]]:
    """Each remark with its first and last pixel; remarks on the whole capture cover the clip."""
    clip = shown.subject.clip
    for remark in shown.remarks:
        for first, last in remark.spans or ((clip.first, clip.last),):
            if first <= clip.last and last >= clip.first:
                yield (
                    remark,
                    shown.x_of_frame(max(first, clip.first) - 0.5),
                    shown.x_of_frame(min(last, clip.last) + 0.5),
                )
