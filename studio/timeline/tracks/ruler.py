"""Ruler: frame numbers and ticks at readable distances, and the play range."""

from collections.abc import Iterator
from itertools import count
from math import ceil, floor

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QPainter

from studio.document import colours
from studio.document.playhead import Playhead
from studio.timeline.axis import TimeAxis
from studio.timeline.shown import ROW_LABEL_WIDTH
from studio.timeline.tracks.brush import font, translucent

RULER_HEIGHT = 24
MAJOR_SPACING = 64
MINOR_SPACING = 7


def major_step(axis: TimeAxis) -> int:
    """Frames between two numbers: 1, 2 or 5 times a power of ten."""
    return _step(axis, MAJOR_SPACING)


def major_frames(axis: TimeAxis) -> range:
    """Frames with a number in the visible range."""
    return _multiples(axis, major_step(axis))


def paint_ruler(painter: QPainter, area: QRect, axis: TimeAxis, playhead: Playhead, live: bool = False) -> None:
    """Paint numbers and ticks; the ruler is dim outside of the play range.

    During ``live`` play it shows that the playhead is paused.
    """
    painter.fillRect(area, QColor(colours.mixed_colour(colours.BAR, colours.LIVE, 0.22) if live else colours.BAR))
    if live:
        painter.setFont(font(11))
        painter.setPen(QColor(colours.LIVE))
        label = QRect(area.left(), area.top(), ROW_LABEL_WIDTH, area.height())
        painter.drawText(label, Qt.AlignmentFlag.AlignCenter, "LIVE (playhead paused)")
    painter.save()
    painter.setClipRect(area.adjusted(ROW_LABEL_WIDTH, 0, 0, 0), Qt.ClipOperation.IntersectClip)
    _paint_overview(painter, area, axis)
    for x in _ticks(axis, _multiples(axis, _step(axis, MINOR_SPACING))):
        painter.fillRect(x, area.bottom() - 3, 1, 4, translucent(colours.TEXT_THIRD, 0.45))
    _paint_range(painter, area, axis, playhead)
    painter.setFont(font(11))
    for frame in major_frames(axis):
        x = round(axis.x_of_frame(frame))
        painter.fillRect(x, area.bottom() - 6, 1, 7, QColor(colours.TEXT_THIRD))
        painter.setPen(QColor(colours.TEXT_SECOND))
        number = QRect(x - 30, area.top(), 61, area.height() - 7)
        painter.drawText(number, Qt.AlignmentFlag.AlignCenter, str(frame))
    painter.restore()


def _paint_range(painter: QPainter, area: QRect, axis: TimeAxis, playhead: Playhead) -> None:
    first, last = round(axis.x_of_frame(playhead.first)), round(axis.x_of_frame(playhead.last))
    shade = translucent(colours.WINDOW, 0.55)
    painter.fillRect(ROW_LABEL_WIDTH, area.top(), max(first - ROW_LABEL_WIDTH, 0), area.height(), shade)
    painter.fillRect(last + 1, area.top(), max(area.right() - last, 0), area.height(), shade)


def _paint_overview(painter: QPainter, area: QRect, axis: TimeAxis) -> None:
    """Paint the visible part of the extent as a thin line at the top, unless all is visible."""
    share = axis.width / axis.scale / (axis.end - axis.begin)
    if share < 1.0:
        begin = (axis.start - axis.begin) / (axis.end - axis.begin)
        painter.fillRect(ROW_LABEL_WIDTH, area.top(), area.width(), 2, QColor(colours.CONTROL))
        left, width = ROW_LABEL_WIDTH + round(begin * axis.width), max(round(share * axis.width), 8)
        painter.fillRect(left, area.top(), width, 2, QColor(colours.TEXT_THIRD))


def _ticks(axis: TimeAxis, frames: range) -> Iterator[int]:
    return (round(axis.x_of_frame(frame)) for frame in frames)


def _step(axis: TimeAxis, spacing: int) -> int:
    least = spacing / axis.pixels_per_frame
    steps: Iterator[int] = (digit * 10**power for power in count() for digit in (1, 2, 5))
    return next(step for step in steps if step >= least)


def _multiples(axis: TimeAxis, step: int) -> range:
    begin = max(axis.frame_at(axis.left), axis.begin * axis.frame_rate)
    end = min(axis.frame_at(axis.right), axis.end * axis.frame_rate)
    return range(ceil(begin / step - 1e-6) * step, floor(end + 1e-6) + 1, step)
