"""The plot: speeds, slide, balance or error of every body, drawn by pyqtgraph into the tracks' picture."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QRect, QRectF, Qt
from PySide6.QtGui import QColor, QPainter
from PySide6.QtWidgets import QWidget

from studio.core.canonical import BodyLayout
from studio.core.solver.request import AdaptedMotion
from studio.document import colours
from studio.engine.measures import LENGTH, Measure, measure_of
from studio.timeline.axis import MARGIN, TimeAxis
from studio.timeline.shown import LABEL_WIDTH, Shown, label_area
from studio.timeline.subject import Body
from studio.timeline.tracks.brush import font, paint_label, translucent

LEAST_HEIGHT, MOST_HEIGHT = 54, 120
HEADROOM = 1.12
LINE = 1.25
PIECES = 1
"""Stretches of a pixel that are told apart where it has more frames."""


class Quantity(StrEnum):
    """What may be plotted."""

    FOOT_SPEED = "Foot speed"
    LEFT_FOOT_SPEED = "Left foot speed"
    RIGHT_FOOT_SPEED = "Right foot speed"
    KNEE_SPEED = "Knee speed"
    SLIDE = "Slide of contacts"
    OFF_SUPPORT = "Mass beyond support"
    ERROR = "Error"

    def unit(self, shown: Shown) -> str:
        """The unit of the values drawn: an error's is that of the constraint."""
        if self is Quantity.ERROR:
            return error_measure(shown).sign.strip()
        return {Quantity.KNEE_SPEED: "°/s", Quantity.SLIDE: "mm", Quantity.OFF_SUPPORT: "mm"}.get(self, "m/s")

    @property
    def asks_document(self) -> bool:
        """Whether it depends on more than the poses: on contacts, the ground or a constraint."""
        return self in (Quantity.ERROR, Quantity.SLIDE, Quantity.OFF_SUPPORT)


@dataclass(frozen=True, eq=False)
class Curve:
    """One body's values over stage times, both (F,)."""

    name: str
    colour: str
    times: NDArray[np.float64]
    values: NDArray[np.float64]
    top: float
    """The greatest value, 0 at least."""

    def at(self, seconds: float) -> float:
        """The value of the frame nearest to a time."""
        return float(self.values[np.argmin(np.abs(self.times - seconds))])


def foot_speed(adapted: AdaptedMotion, sides: tuple[int, ...] = (0, 1)) -> NDArray[np.float64]:
    """(F,) metres a second of the ball of the faster of the feet, by central differences."""
    layout = BodyLayout(len(adapted.morphology.spine))
    if adapted.frame_count < 2:
        return np.zeros(adapted.frame_count)
    balls = adapted.positions[:, [layout.toe(side) for side in sides]]
    steps = np.concatenate([2.0 * (balls[1:2] - balls[:1]), balls[2:] - balls[:-2], 2.0 * (balls[-1:] - balls[-2:-1])])
    squares = np.einsum("fsi,fsi->fs", steps, steps).max(axis=1)
    return np.asarray(0.5 * adapted.frame_rate * np.sqrt(squares))


def curve_of(shown: Shown, quantity: Quantity, body: Body, adapted: AdaptedMotion) -> Curve | None:
    """The curve of a body's result; None where it says nothing of that."""
    values = _values(shown, quantity, body.performer_id, adapted)
    if values is None:
        return None
    frames = adapted.first_frame + np.arange(adapted.frame_count)
    times = frames / shown.subject.frame_rate + shown.subject.offset
    return Curve(body.name, body.colour, times, values, float(values.max(initial=0.0)))


def seen_curve(curve: Curve, axis: TimeAxis) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times and values to be drawn of a curve over the visible stretch, and a frame more on each side.

    Where a pixel has many frames, as in a capture of an hour, the least and the greatest stand for all.
    """
    first, last = np.searchsorted(curve.times, [axis.time_at(axis.left), axis.time_at(axis.right + MARGIN)])
    seen = slice(max(int(first) - 1, 0), int(last) + 1)
    times, values = curve.times[seen], curve.values[seen]
    size = int(len(times) / (PIECES * axis.width)) if axis.width else 0
    if size < 2:
        return times, values
    pieces = len(times) // size
    heights = values[: pieces * size].reshape(pieces, size)
    extremes = np.stack([heights.min(axis=1), heights.max(axis=1)], axis=1).reshape(-1)
    return (
        np.append(np.repeat(times[: pieces * size : size], 2), times[pieces * size :]),
        np.append(extremes, values[pieces * size :]),
    )


def _values(shown: Shown, quantity: Quantity, performer_id: str, adapted: AdaptedMotion) -> NDArray[np.float64] | None:
    match quantity:
        case Quantity.FOOT_SPEED:
            return foot_speed(adapted)
        case Quantity.LEFT_FOOT_SPEED:
            return foot_speed(adapted, (0,))
        case Quantity.RIGHT_FOOT_SPEED:
            return foot_speed(adapted, (1,))
        case Quantity.KNEE_SPEED:
            from studio.core.metrics import knee_speeds  # not before a result is there: it loads kernels

            return np.degrees(knee_speeds(adapted).max(axis=0))
        case Quantity.SLIDE:
            return slide(shown, performer_id, adapted)
        case Quantity.OFF_SUPPORT:
            return beyond_support(shown, adapted)
    constraint_id = plotted_constraint(shown)
    strip = shown.strip(constraint_id, performer_id) if constraint_id else None
    return None if strip is None else np.nan_to_num(strip.errors) * strip.measure.factor


def slide(shown: Shown, performer_id: str, adapted: AdaptedMotion) -> NDArray[np.float64]:
    """(F,) millimetres that the point of a body that slides most has slid since its contact began."""
    from studio.core.metrics import contact_tracks  # as above

    performer = shown.project.performers[performer_id]
    ground = shown.project.ground.seen_from(performer.position, performer.heading)
    contacts = tuple(shown.project.contacts_of(shown.subject.motion_id).values())
    slides, _ = contact_tracks(adapted, contacts, ground)
    return np.asarray(1000.0 * np.nan_to_num(slides).max(axis=0))


def beyond_support(shown: Shown, adapted: AdaptedMotion) -> NDArray[np.float64]:
    """(F,) millimetres by which the centre of mass lies outside what is stood on; 0 within, and in flight."""
    from studio.core.solver.support import mass_path, outlines, standing_points, support_margins  # as above

    contacts = tuple(shown.project.contacts_of(shown.subject.motion_id).values())
    stop = adapted.first_frame + adapted.frame_count
    stands = standing_points(contacts, stop)[:, adapted.first_frame :]
    areas = outlines(adapted.positions, adapted.rotations, stands, adapted.morphology)
    margins = support_margins(areas, mass_path(adapted.positions, adapted.morphology)[:, :2])
    return np.asarray(1000.0 * np.maximum(-np.nan_to_num(margins), 0.0))


def plotted_constraint(shown: Shown) -> str | None:
    """The selected constraint, else the first one."""
    own = shown.project.constraints_of(shown.subject.motion_id)
    selected = [key for key in shown.document.selection.of("constraints") if key in own]
    return next(iter((*reversed(selected), *own)), None)


def error_measure(shown: Shown) -> Measure:
    """What the error that is plotted is."""
    constraint_id = plotted_constraint(shown)
    return measure_of(shown.project.constraints[constraint_id]) if constraint_id else LENGTH


class PlotPicture:
    """A pyqtgraph plot that is never shown itself: it is drawn where the rows want it."""

    def __init__(self, parent: QWidget) -> None:
        self.quantity = Quantity.FOOT_SPEED
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
        self._known: dict[str, tuple[tuple[object, ...], Curve | None]] = {}

    def fetch(self, shown: Shown) -> None:
        """Take the newest results; of a body whose result is that of the last time, the curve of the last time."""
        revision = shown.document.revision if self.quantity.asks_document else 0
        basis = (self.quantity, shown.subject, revision, plotted_constraint(shown))
        known: dict[str, tuple[tuple[object, ...], Curve | None]] = {}
        for body in shown.subject.bodies:
            adapted = shown.result(body.performer_id)
            before = self._known.get(body.performer_id)
            if before is not None and before[0] == (*basis, adapted):
                known[body.performer_id] = before
            elif adapted is not None:
                known[body.performer_id] = (*basis, adapted), curve_of(shown, self.quantity, body, adapted)
        self._known = known
        self.curves = [curve for _, curve in known.values() if curve is not None]
        self.top = max((curve.top for curve in self.curves), default=0.0) or 1.0
        while len(self._lines) < len(self.curves):
            line = pg.PlotCurveItem(antialias=True)
            line.setSegmentedLineMode("on")  # Qt strokes a long path of its own some fifty times slower
            self._item.addItem(line)
            self._lines.append(line)
        for place, line in enumerate(self._lines):
            line.setVisible(place < len(self.curves))

    def paint(self, painter: QPainter, row: QRect, shown: Shown) -> None:
        """The curves over the axis' own stretch of time, so that they line up with the bars to the pixel."""
        area = row.adjusted(LABEL_WIDTH, 4, 0, -3)
        axis = shown.axis
        if self._widget.size() != area.size():
            self._widget.resize(area.size())
            self._widget.resizeEvent(None)  # Qt keeps it back from a widget that is not on the screen
        self._item.setXRange(axis.time_at(area.left()), axis.time_at(area.left() + area.width()), padding=0)
        self._item.setYRange(-0.04 * self.top, self.top * HEADROOM, padding=0)
        low, high = self.y_of(row, 0.0), self.y_of(row, self.top)
        for y in (low, high):
            painter.fillRect(area.left(), round(y), area.width(), 1, translucent(colours.EDGE, 0.7))
        for line, curve in zip(self._lines, self.curves, strict=False):
            pen = pg.mkPen(QColor(curve.colour), width=LINE * painter.device().devicePixelRatio())
            pen.setCapStyle(Qt.PenCapStyle.FlatCap)  # other caps would show where segments meet
            line.setPen(pen)
            line.setData(*seen_curve(curve, axis))
        scene = self._widget.scene()
        scene.prepareForPaint()
        scene.render(painter, QRectF(area), QRectF(0, 0, area.width(), area.height()))

    def y_of(self, row: QRect, value: float) -> float:
        """Pixel of a value."""
        area = QRectF(row.adjusted(0, 4, 0, -3))
        span = self.top * (HEADROOM + 0.04)
        return area.bottom() - (value + 0.04 * self.top) / span * area.height()

    def paint_label(self, painter: QPainter, row: QRect, shown: Shown) -> None:
        """What is plotted, its unit and its greatest value, at the height where that lies."""
        area = label_area(row)
        paint_label(painter, QRect(0, row.top() + 4, LABEL_WIDTH - 44, 20), self.title(shown), colours.TEXT)
        count = len(self.curves)
        note = f"{self.quantity.unit(shown)} · {count} {'body' if count == 1 else 'bodies'}"
        paint_label(painter, QRect(0, row.top() + 22, LABEL_WIDTH, 18), note, colours.TEXT_THIRD, 11)
        painter.setFont(font(10))
        painter.setPen(QColor(colours.TEXT_THIRD))
        for value in (0.0, self.top) if self.curves else ():
            place = QRect(area.right() - 60, round(self.y_of(row, value)) - 8, 54, 16)
            painter.drawText(place, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, _figure(value))

    def title(self, shown: Shown) -> str:
        """``Foot speed`` or ``Error: Kick target``."""
        constraint_id = plotted_constraint(shown) if self.quantity is Quantity.ERROR else None
        name = f": {shown.project.constraints[constraint_id].name}" if constraint_id else ""
        return self.quantity.value + name

    def words(self, shown: Shown, value: float) -> str:
        """A value that is drawn, with its unit."""
        if self.quantity is not Quantity.ERROR:
            return f"{value:.2f} {self.quantity.unit(shown)}"
        measure = error_measure(shown)
        return measure.words(value / measure.factor)

    def nearest(self, row: QRect, seconds: float, y: float) -> tuple[Curve, float] | None:
        """The curve that passes nearest to a height at a time, with its value there."""
        values = [(curve, curve.at(seconds)) for curve in self.curves]
        return min(values, key=lambda pair: abs(self.y_of(row, pair[1]) - y), default=None)

    def close(self) -> None:
        """Let go of the plot."""
        self._widget.close()


def _figure(value: float) -> str:
    return "0" if value == 0.0 else f"{value:.3g}"
