"""Track of labels, the names of frames and frame ranges of the motion, as flags."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from PySide6.QtCore import QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPolygonF

from studio.document import colours
from studio.timeline.shown import Hit, ItemPart, RowContext, label_area
from studio.timeline.tracks.brush import font, paint_label, translucent

LABEL_ROW_HEIGHT = 20
LABEL_POLE_PX, LABEL_GRIP_PX, LABEL_MARGIN_PX = 2.0, 5.0, 4.0
"""Width in pixels of a flag's pole, of the area at its ends that can be grabbed, and of the margin around the name."""
LABEL_FONT_PIXELS = 11


def rows_of(shown: RowContext) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the track of labels; empty without labels."""
    return [("labels", "", LABEL_ROW_HEIGHT)] if shown.project.labels_of(shown.subject.motion_id) else []


class Flag(NamedTuple):
    """Rectangles of a label: the whole flag, and its name."""

    area: QRectF
    name: QRectF


def flags(shown: RowContext, row: QRect) -> dict[str, Flag]:
    """Flag of each label by id; a name ends where the next flag begins."""
    labels = sorted(shown.project.labels_of(shown.subject.motion_id).items(), key=lambda each: each[1].first)
    lefts = [shown.x_of_frame(label.first) for _, label in labels]
    metrics, made = QFontMetrics(font(LABEL_FONT_PIXELS)), {}
    for (key, label), left, following in zip(labels, lefts, [*lefts[1:], math.inf], strict=True):
        name = metrics.horizontalAdvance(label.name) + 2 * LABEL_MARGIN_PX + LABEL_POLE_PX
        width, span = min(name, following - left), shown.x_of_frame(label.last) - left
        area = QRectF(left, row.top() + 3.0, max(width, span), row.height() - 6.0)
        made[key] = Flag(area, QRectF(left, area.top(), width, area.height()).adjusted(LABEL_MARGIN_PX, 0, 0, 0))
    return made


def paint_labels(painter: QPainter, row: QRect, shown: RowContext) -> None:
    """Paint each label: a pole at its first frame, its range as a band, and its name; lighter if selected."""
    painter.setFont(font(LABEL_FONT_PIXELS))
    labels, metrics = shown.project.labels_of(shown.subject.motion_id), QFontMetrics(font(LABEL_FONT_PIXELS))
    for key, (area, name) in flags(shown, row).items():
        label = labels[key]
        selected = shown.is_selected("labels", key)
        colour = colours.SELECTED_HANDLE if selected else colours.kind_colour("label")
        end = shown.x_of_frame(label.last)
        painter.fillRect(area, translucent(colour, 0.12))
        painter.fillRect(QRectF(area.left(), area.top(), end - area.left(), area.height()), translucent(colour, 0.25))
        painter.fillRect(
            QRectF(area.left() - LABEL_POLE_PX / 2, row.top() + 1.0, LABEL_POLE_PX, row.height() - 2.0), QColor(colour)
        )
        if label.last > label.first:
            corners = ((end, area.top()), (end, area.bottom()), (end - LABEL_GRIP_PX, area.bottom()))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(colour))
            painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in corners]))
        painter.setPen(QColor(colours.TEXT))
        side = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft
        painter.drawText(name, side, metrics.elidedText(label.name, Qt.TextElideMode.ElideRight, int(name.width())))


def paint_labels_label(painter: QPainter, row: QRect) -> None:
    """Draw the name of the row."""
    paint_label(painter, label_area(row), "Labels", colours.TEXT_SECOND)


def labels_hit(shown: RowContext, row: QRect, point: QPointF) -> Hit:
    """Label under ``point``, or an end of it, of overlapping ones the last to begin; else the empty track."""
    found = max(_parts(shown, row, point.x()), default=None, key=lambda each: each[0])
    return Hit("labels", found[1], found[2]) if found else Hit("labels", "", ItemPart.EMPTY)


def _parts(shown: RowContext, row: QRect, x: float) -> Iterator[tuple[float, str, ItemPart]]:
    """First frame, id and part of each label at the pixel ``x``."""
    labels = shown.project.labels_of(shown.subject.motion_id)
    for key, (area, _) in flags(shown, row).items():
        label, end = labels[key], shown.x_of_frame(labels[key].last)
        if not area.left() - LABEL_GRIP_PX <= x <= max(area.right(), end + LABEL_GRIP_PX):
            continue
        part = ItemPart.BODY
        if label.last > label.first and abs(x - end) <= LABEL_GRIP_PX:
            part = ItemPart.LAST
        elif label.last > label.first and abs(x - area.left()) <= LABEL_GRIP_PX:
            part = ItemPart.FIRST
        yield label.first, key, part
