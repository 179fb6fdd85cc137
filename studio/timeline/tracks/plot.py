"""Graph of a quantity with a curve for each performer, drawn by pyqtgraph into the image of the timeline."""

from collections.abc import Callable
from functools import partial

import pyqtgraph as pg
from PySide6.QtCore import QObject, QPointF, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPixmap
from PySide6.QtWidgets import QWidget

from studio.document import colours
from studio.document.length_units import shown_unit
from studio.engine.scheduler import SolveScheduler
from studio.timeline.axis import TimeAxis
from studio.timeline.curves import (
    Curve,
    CurveQuery,
    Plotted,
    Quantity,
    displayed_curve,
    error_measure,
    plotted_constraint,
)
from studio.timeline.shown import ROW_LABEL_WIDTH, RowContext, label_area
from studio.timeline.tracks.brush import font, paint_fold, paint_label, translucent

MIN_PLOT_HEIGHT_PX, MAX_PLOT_HEIGHT_PX, FOLDED_PLOT_HEIGHT = 54, 120, 22
PLOT_HEADROOM = 1.12
CURVE_LINE_PX = 1.25
MOST_FRAMES_AT_ONCE = 10_000
"""Number of frames up to which curves are computed immediately instead of by a worker."""
PLOT_NOISE = 1e-6
"""Maximum value, in any unit, that counts as a rounding error and is plotted as zero."""

CurveInputs = tuple[object, ...]
"""Inputs of a curve; equal inputs give equal curves."""
Known = tuple[CurveInputs, Curve | None]


class PlotPicture(QObject):
    """Hidden pyqtgraph plot that is rendered into the timeline."""

    arrived = Signal()
    """Emitted when a worker has computed a curve."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.quantity: Plotted = Quantity.FOOT_SPEED
        self.curves: list[Curve] = []
        self.top = 1.0
        self._widget = pg.PlotWidget(parent, background=None)
        self._widget.hide()
        item = self._widget.getPlotItem()
        item.hideAxis("left")
        item.hideAxis("bottom")
        item.hideButtons()
        item.layout.setContentsMargins(0, 0, 0, 0)
        item.getViewBox().setDefaultPadding(0.0)
        item.getViewBox().setBorder(None)
        self._item = item
        self._lines: list[pg.PlotCurveItem] = []
        self._known: dict[str, Known] = {}
        self._asked: dict[str, CurveInputs] = {}
        self._worker: SolveScheduler | None = None
        self._order = 0
        self._drawn: tuple[object, ...] = ()
        self._image = QPixmap()
        """Drawing of the curves with the inputs ``_drawn``, because a picture may change beside them."""

    def fetch(self, shown: RowContext) -> None:
        """Update the curves of changed results.

        Those of long motions are computed by a worker; the old ones are shown until then.
        """
        project, constraint_id = shown.project, plotted_constraint(shown)
        asked = CurveQuery(project, shown.subject, self.quantity, constraint_id)
        revision = shown.document.revision if self.quantity.asks_document else 0
        known: dict[str, Known] = {}
        for body in shown.subject.bodies:
            key, adapted = body.performer_id, shown.result(body.performer_id)
            basis = (self.quantity, shown.subject, revision, constraint_id, adapted)
            before = self._known.get(key)
            if adapted is None or (before is not None and before[0] == basis):
                known |= {key: before} if adapted is not None and before is not None else {}
            elif adapted.frame_count <= MOST_FRAMES_AT_ONCE:
                known[key] = basis, asked.curve(body, adapted)
            else:
                self._ask_worker(key, basis, partial(asked.curve, body, adapted))
                if before is not None and before[0][:2] == basis[:2]:
                    known[key] = before
        self._known = known
        self.curves = [curve for _, curve in known.values() if curve is not None]
        self.top = max((curve.top for curve in self.curves), default=0.0)
        self.top = self.top if self.top > PLOT_NOISE else 1.0
        while len(self._lines) < len(self.curves):
            line = pg.PlotCurveItem(antialias=True)
            line.setSegmentedLineMode("on")  # Qt strokes a long path of its own some fifty times slower
            self._item.addItem(line)
            self._lines.append(line)
        for index, line in enumerate(self._lines):
            line.setVisible(index < len(self.curves))

    def _ask_worker(self, performer_id: str, basis: CurveInputs, make: Callable[[], Curve | None]) -> None:
        if self._asked.get(performer_id) == basis:
            return
        if self._worker is None:
            self._worker = SolveScheduler(workers=1)
            self._worker.answered.connect(self._take)
            self._worker.failed.connect(self._fail)
        self._asked[performer_id] = basis
        self._order += 1
        self._worker.request(performer_id, self._order, lambda: (basis, make()))

    def _take(self, performer_id: str, _order: int, answer: Known) -> None:
        self._known[performer_id] = answer
        if self._asked.get(performer_id) == answer[0]:
            del self._asked[performer_id]
        self.arrived.emit()

    def _fail(self, _performer_id: str, _order: int, error: Exception) -> None:
        raise error

    def paint(self, painter: QPainter, row: QRect, shown: RowContext) -> None:
        """Paint the curves over the visible time range, aligned with the tracks to the pixel."""
        area = row.adjusted(ROW_LABEL_WIDTH, 4, 0, -3)
        axis, image = shown.axis, painter.device()
        for y in (self.y_of(row, 0.0), self.y_of(row, self.top)):
            painter.fillRect(area.left(), round(y), area.width(), 1, translucent(colours.EDGE, 0.7))
        size, scale = QSize(image.width(), image.height()), image.devicePixelRatio()
        drawn = (area, axis.start, axis.scale, self.top, size, scale, self.curves)
        if drawn != self._drawn:
            self._drawn = drawn
            self._image = QPixmap(size)  # as large as the picture, so that it begins on whole pixels at any scale
            self._image.setDevicePixelRatio(scale)
            self._image.fill(Qt.GlobalColor.transparent)
            with QPainter(self._image) as curves:
                self._paint_curves(curves, area, axis)
        painter.drawPixmap(QPointF(), self._image)

    def _paint_curves(self, painter: QPainter, area: QRect, axis: TimeAxis) -> None:
        if self._widget.size() != area.size():
            self._widget.resize(area.size())
            self._widget.resizeEvent(None)  # Qt keeps it back from a widget that is not on the screen
        self._item.setXRange(axis.time_at(area.left()), axis.time_at(area.left() + area.width()), padding=0)
        self._item.setYRange(-0.04 * self.top, self.top * PLOT_HEADROOM, padding=0)
        for line, curve in zip(self._lines, self.curves, strict=False):
            pen = pg.mkPen(QColor(curve.colour), width=CURVE_LINE_PX * painter.device().devicePixelRatio())
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)  # other caps would show where segments meet
            line.setPen(pen)
            times, values = displayed_curve(curve, axis)
            line.setData(
                times, values, antialias=len(times) <= axis.width
            )  # smooth steep lines take Qt five times longer
        scene = self._widget.scene()
        scene.prepareForPaint()
        scene.render(painter, QRectF(area), QRectF(0, 0, area.width(), area.height()))

    def y_of(self, row: QRect, value: float) -> float:
        """Vertical pixel of a value."""
        area = QRectF(row.adjusted(0, 4, 0, -3))
        span = self.top * (PLOT_HEADROOM + 0.04)
        return area.bottom() - (value + 0.04 * self.top) / span * area.height()

    def paint_label(self, painter: QPainter, row: QRect, shown: RowContext) -> None:
        """Paint the name of the quantity, its unit, and its maximum at the corresponding height."""
        area, folded = label_area(row), row.height() <= FOLDED_PLOT_HEIGHT
        line = QRect(0, row.top() + (1 if folded else 4), ROW_LABEL_WIDTH - 44, 20)
        paint_fold(painter, line, folded)
        if folded:
            paint_label(painter, line, self.title(shown), colours.TEXT)
            return
        paint_label(painter, QRect(0, row.top() + 4, ROW_LABEL_WIDTH - 44, 20), self.title(shown), colours.TEXT)
        count = len(self.curves)
        unit = shown_unit(self.quantity.unit(shown))
        note = f"{unit.symbol} · {count} character{'' if count == 1 else 's'}"
        paint_label(painter, QRect(0, row.top() + 22, ROW_LABEL_WIDTH, 18), note, colours.TEXT_THIRD, 11)
        painter.setFont(font(10))
        painter.setPen(QColor(colours.TEXT_THIRD))
        for value in (0.0, self.top) if self.curves else ():
            place = QRect(area.right() - 60, round(self.y_of(row, value)) - 8, 54, 16)
            painter.drawText(
                place, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, _figure(unit.factor * value)
            )

    def title(self, shown: RowContext) -> str:
        """Title of the graph: ``Foot speed`` or ``Error: Kick target``."""
        constraint_id = plotted_constraint(shown) if self.quantity is Quantity.ERROR else None
        name = f": {shown.project.constraints[constraint_id].name}" if constraint_id else ""
        return self.quantity.value + name

    def words(self, shown: RowContext, value: float) -> str:
        """Plotted value as text with its unit."""
        if self.quantity is not Quantity.ERROR:
            unit = shown_unit(self.quantity.unit(shown))
            return f"{value * unit.factor:.2f} {unit.symbol}"
        measure = error_measure(shown)
        return measure.text_of(value / measure.factor)

    def nearest(self, row: QRect, seconds: float, y: float) -> tuple[Curve, float] | None:
        """Curve nearest to the pixel ``y`` at the stage time ``seconds``, with its value there; None if there is
        none.
        """
        values = [(curve, curve.at(seconds)) for curve in self.curves]
        return min(values, key=lambda pair: abs(self.y_of(row, pair[1]) - y), default=None)

    def drop_curves(self) -> None:
        """Discard the curves of results that are no longer shown."""
        self._known, self._asked, self.curves = {}, {}, []

    def close(self) -> None:
        """Wait for the worker, and release the plot."""
        if self._worker is not None:
            self._worker.close()
        self._widget.close()


def _figure(value: float) -> str:
    return "0" if value == 0.0 else f"{value:.3g}"
