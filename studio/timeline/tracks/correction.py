"""Track of a correction layer: its range as a curve with four handles, below the clips of its performer."""

import numpy as np
from PySide6.QtCore import QPointF, QRect, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPolygonF

from studio.core.curves.activation import ActivationCurve
from studio.document import colours
from studio.timeline.shown import HANDLE_PARTS, Hit, ItemPart, RowContext, clipped_span, label_area
from studio.timeline.tracks.brush import hairline, paint_dot, paint_label, translucent
from studio.timeline.tracks.layer import LAYER_INDENT_PX

CORRECTION_ROW_HEIGHT = 26
CORRECTION_MARGIN_PX, CORRECTION_HANDLE_REACH, CORRECTION_RAMP_POINTS = 4.0, 5.0, 32


def rows_of(shown: RowContext, performer_id: str) -> list[tuple[str, str, int]]:
    """Kind, id and height in pixels of the tracks of a performer's corrections."""
    return [("corrections", key, CORRECTION_ROW_HEIGHT) for key in shown.project.corrections_of(performer_id)]


def handle_points(shown: RowContext, row: QRect, curve: ActivationCurve) -> dict[ItemPart, QPointF]:
    """Pixel positions of the four handles."""
    low, high = row.bottom() - CORRECTION_MARGIN_PX, row.top() + CORRECTION_MARGIN_PX
    xs = map(shown.axis.x_of_time, curve.times)
    return {part: QPointF(x, y) for part, x, y in zip(HANDLE_PARTS, xs, (low, high, high, low), strict=True)}


def paint_correction(painter: QPainter, row: QRect, shown: RowContext, correction_id: str) -> None:
    """Paint the range, as high as the weight; dashed if the correction is disabled."""
    correction, line = shown.project.corrections[correction_id], line_colour(shown, correction_id)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(hairline(line, 1.5))
    if not correction.enabled:
        painter.setPen(Qt.PenStyle.DashLine)
    painter.setBrush(translucent(key_colour(shown, correction_id), 0.4 if correction.enabled else 0.1))
    painter.drawPath(_curve_path(shown, row, correction.activation, correction.weight))


def paint_correction_handles(painter: QPainter, row: QRect, shown: RowContext, correction_id: str) -> None:
    """Draw the four handles of the range."""
    curve, line = shown.project.corrections[correction_id].activation, line_colour(shown, correction_id)
    for point in handle_points(shown, row, curve).values():
        paint_dot(painter, point, 4.0 if shown.is_selected("corrections", correction_id) else 3.0, line, colours.PANEL)


def paint_correction_label(painter: QPainter, row: QRect, shown: RowContext, correction_id: str) -> None:
    """Paint the name, and if the correction is above the constraints."""
    correction = shown.project.corrections[correction_id]
    text = f"{correction.name} · above" if correction.above else correction.name
    colour = colours.TEXT_SECOND if correction.enabled else colours.TEXT_THIRD
    paint_label(painter, label_area(row).adjusted(LAYER_INDENT_PX, 0, 0, 0), text, colour)


def key_colour(shown: RowContext, correction_id: str) -> str:
    """Colour of a correction's keys."""
    return colours.kind_colour("correction") if shown.project.corrections[correction_id].enabled else colours.TEXT_THIRD


def line_colour(shown: RowContext, correction_id: str) -> str:
    """Colour of the curve and its handles."""
    selected = shown.is_selected("corrections", correction_id)
    return colours.SELECTED_HANDLE if selected else key_colour(shown, correction_id)


def correction_hit(shown: RowContext, row: QRect, correction_id: str, point: QPointF) -> Hit:
    """Nearest handle within reach, else the bar, else the empty space of the track."""
    curve = shown.project.corrections[correction_id].activation
    near = {
        part: (place - point).manhattanLength()
        for part, place in handle_points(shown, row, curve).items()
        if clipped_span(point, place.x(), place.y(), CORRECTION_HANDLE_REACH)
    }
    if near:
        return Hit("corrections", correction_id, min(near, key=lambda part: near[part]))
    start, end = map(shown.axis.x_of_time, (curve.start, curve.end))
    return Hit("corrections", correction_id, ItemPart.BODY if start <= point.x() <= end else ItemPart.EMPTY)


def _curve_path(shown: RowContext, row: QRect, curve: ActivationCurve, weight: float) -> QPainterPath:
    """Path of the range over time, closed along the bottom of the track."""
    low, high = row.bottom() - CORRECTION_MARGIN_PX, row.top() + CORRECTION_MARGIN_PX
    start, full, full_end, end = curve.times
    ramps = [np.linspace(*ramp, CORRECTION_RAMP_POINTS) for ramp in ((start, full), (full_end, end))]
    times = np.concatenate(ramps)
    heights = low - weight * (low - high) * curve.at(times)
    outline = [QPointF(shown.axis.x_of_time(time), y) for time, y in zip(times.tolist(), heights.tolist(), strict=True)]
    path = QPainterPath()
    path.addPolygon(QPolygonF([QPointF(outline[0].x(), low), *outline, QPointF(outline[-1].x(), low)]))
    path.closeSubpath()
    return path
