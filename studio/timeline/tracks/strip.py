"""One body's error strip: coloured by state, and higher the farther off, to be read without colour."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QPainter

from studio.document import colours
from studio.timeline.shown import LABEL_WIDTH, Shown
from studio.timeline.strips import Strip, strip_heights
from studio.timeline.tracks.brush import paint_dot

PITCH = 5
COLOURS = (
    colours.PANEL,
    colours.mixed(colours.HELD, colours.EDGE, 0.6),
    colours.HELD,
    colours.PARTLY,
    colours.NOT_REACHED,
)


def paint_strip(painter: QPainter, shown: Shown, strip: Strip, top: int, colour: str) -> None:
    """The strip's line lies at the bottom of its five pixels; the body's dot stands before it."""
    left, states, heights = _columns(shown, strip)
    edges = np.flatnonzero(np.diff(states) | np.diff(heights)) + 1
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    begin_of_line: int | None = None
    for begin, end in zip([0, *edges], [*edges, len(states)], strict=True):
        if end > begin and states[begin] > 0:
            begin_of_line = left + int(begin) if begin_of_line is None else begin_of_line
            height = int(heights[begin])
            area = (left + int(begin), top + PITCH - height, int(end - begin), height)
            painter.fillRect(*area, QColor(COLOURS[states[begin]]))
    if begin_of_line is not None:
        x = max(begin_of_line - 6.5, LABEL_WIDTH + 3.5)
        paint_dot(painter, QPointF(x, top + PITCH - 1.0), 2.0, colour)


def _columns(shown: Shown, strip: Strip) -> tuple[int, NDArray[np.int64], NDArray[np.int64]]:
    """First pixel, and of each pixel column the state and height of the worst frame that falls into it."""
    count = len(strip.errors)
    first, last = strip.first_frame, strip.first_frame + count - 1
    left = round(max(shown.x_of_frame(first), LABEL_WIDTH))
    right = round(min(shown.x_of_frame(last), shown.axis.right + 12))
    if right <= left:
        return left, np.zeros(0, np.int64), np.zeros(0, np.int64)
    xs = np.arange(left, right + 1)
    seconds = shown.axis.start + (xs - shown.axis.left) / shown.axis.scale - shown.subject.offset
    frames = np.rint(seconds * shown.subject.frame_rate).astype(np.int64) - first
    starts = np.clip(frames, 0, count - 1)
    errors = np.where(np.isfinite(strip.errors), strip.errors, 0.0)
    last_frame = starts[-1] + 1  # the last column ends with its own frame, not with the clip
    states = np.maximum.reduceat(strip.state_indices[:last_frame], starts)
    worst = np.maximum.reduceat(errors[:last_frame], starts)
    return left, states, np.where(states >= 3, strip_heights(worst, PITCH), 1)
