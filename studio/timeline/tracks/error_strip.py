"""Painting of an error strip: coloured by state, and higher for larger residuals, so that it can be read without
colour.
"""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter

from studio.document import colours
from studio.timeline.shown import ROW_LABEL_WIDTH, RowContext
from studio.timeline.strip_states import ErrorStrip, strip_heights
from studio.timeline.tracks.brush import paint_dot, translucent

STRIP_SPACING_PIXELS = 5
STRIP_DOT_WIDTH_PX = 10
FIRST_MISSED_STATE = 3
"""Index in ``STATES`` from which the height of the strip shows the size of the residual."""
STRIP_COLOURS = (
    colours.PANEL,
    colours.PANEL,
    colours.HELD,
    colours.PARTLY,
    colours.NOT_REACHED,
)


def paint_unknown(painter: QPainter, axis_right: float, left: float, right: float, top: int, colour: str) -> None:
    """Paint a hatched line for residuals that are not solved yet."""
    begin, end = max(left, ROW_LABEL_WIDTH + STRIP_DOT_WIDTH_PX), min(right, axis_right + 20)
    if begin < end:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        hatch = QBrush(translucent(colours.TEXT_THIRD, 0.7), Qt.BrushStyle.BDiagPattern)
        painter.fillRect(QRectF(begin, top + 1, end - begin, STRIP_SPACING_PIXELS - 1), hatch)
        paint_dot(
            painter, QPointF(max(left - 8.0, ROW_LABEL_WIDTH + 4.0), top + STRIP_SPACING_PIXELS - 0.5), 2.0, colour
        )


def paint_strip(
    painter: QPainter, shown: RowContext, strip: ErrorStrip, left: float, right: float, top: int, colour: str
) -> None:
    """Paint an error strip from pixel ``left`` to ``right``, after the dot in the performer's ``colour``."""
    xs = np.arange(round(max(left, ROW_LABEL_WIDTH + STRIP_DOT_WIDTH_PX)), round(min(right, shown.axis.right + 20)) + 1)
    active = np.flatnonzero(strip.state_indices)
    if not len(xs) or not len(active):
        return
    states, heights = _columns(shown, strip, xs, int(active[0]), int(active[-1]))
    # On whole pixels of the screen, so that all lines are equally thick at any scale.
    scale = painter.device().devicePixelRatio()
    bottom = round((top + STRIP_SPACING_PIXELS) * scale) / scale
    edges = np.flatnonzero((np.diff(states) != 0) | (np.diff(heights) != 0)) + 1
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    for begin, end in zip([0, *edges.tolist()], [*edges.tolist(), len(xs)], strict=True):
        height = max(round(float(heights[begin]) * scale), 1) / scale
        area = QRectF(float(xs[begin]), bottom - height, end - begin, height)
        painter.fillRect(area, QColor(STRIP_COLOURS[states[begin]]))
    paint_dot(painter, QPointF(max(left - 8.0, ROW_LABEL_WIDTH + 4.0), top + STRIP_SPACING_PIXELS - 0.5), 2.0, colour)


def _columns(
    shown: RowContext, strip: ErrorStrip, xs: NDArray[np.int64], first: int, last: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """State and height of each pixel column: the worst of the frames ``first`` to ``last`` in the column."""
    stage_seconds = shown.axis.start + (xs - shown.axis.left) / shown.axis.scale
    starts = np.clip(strip.frames_at(stage_seconds), first, last)
    errors = np.nan_to_num(strip.errors)[: last + 1]
    states = np.maximum.reduceat(strip.state_indices[: last + 1], starts)
    heights = strip_heights(np.maximum.reduceat(errors, starts), STRIP_SPACING_PIXELS, strip.measure)
    return states, np.where(states >= FIRST_MISSED_STATE, heights, 1)
