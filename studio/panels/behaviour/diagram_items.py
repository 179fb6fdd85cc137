"""Graphics items of the behaviour diagram: boxes of states, arrows of transitions, and labels with their conditions."""

import math
from dataclasses import dataclass

from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPainterPathStroker, QPen, QPolygonF
from PySide6.QtWidgets import QGraphicsItem, QStyleOptionGraphicsItem, QWidget

from studio.document import colours

STATE_WIDTHS = (132.0, 220.0)
"""Minimum and maximum width of a box, in scene units."""
TITLE_PX, LINE_PX, PADDING_PX = 20.0, 15.0, 9.0
BOX_CORNER_RADIUS = 5.0
BOX_RIM_WIDTH = 7.0
"""Width in scene units of the rim of a box, from which an arrow can be drawn; half of it is also sensitive outside the
box.
"""
ARROW_BOW, NEXT_ARROW_BOW = 22.0, 34.0
"""Sideways offset of an arrow that has a counterpart in the other direction, and additional offset per further arrow,
in scene units.
"""
ARROW_PX, ARROW_REACH_PX = 9.0, 12.0
LABEL_POSITION_FRACTION = 0.58
"""Position of the label along an arrow, as a fraction of its length, so that the labels of both directions do not
overlap.
"""
LOOP_ARROW_SIZE = 44.0
GLOW_WIDTH = 4


def font(pixels: int, bold: bool = False) -> QFont:
    """Application font in a size in pixels."""
    made = QFont()
    made.setPixelSize(pixels)
    if bold:
        made.setWeight(QFont.Weight.DemiBold)
    return made


@dataclass(frozen=True)
class StateBox:
    """State as displayed: ``lit`` is the colour of the performer that is in this state, ``dots`` are the colours of
    other performers.
    """

    name: str
    plays: str
    manners: tuple[str, ...]
    place: tuple[float, float]
    starts: bool = False
    selected: bool = False
    lit: str = ""
    dots: tuple[str, ...] = ()

    @property
    def rect(self) -> QRectF:
        """Rectangle of the box in the scene."""
        lines = (self.plays, *self.manners)
        title = QFontMetricsF(font(13, bold=True)).horizontalAdvance(self.name) + 10.0 * len(self.dots)
        widest = max(title, *(QFontMetricsF(font(11)).horizontalAdvance(each) for each in lines))
        width = min(max(widest + 2 * PADDING_PX + 6.0, STATE_WIDTHS[0]), STATE_WIDTHS[1])
        height = TITLE_PX + LINE_PX * len(lines) + PADDING_PX + 3.0
        return QRectF(self.place[0] - width / 2, self.place[1] - height / 2, width, height)


class StateItem(QGraphicsItem):
    """Graphics item of a state's box; while ``ready`` is True it shows the rim from which an arrow can be drawn."""

    def __init__(self, box: StateBox) -> None:
        super().__init__()
        self.box, self.rect, self.ready = box, box.rect, False
        self.setZValue(2.0)

    def boundingRect(self) -> QRectF:
        """Bounds of the box with its glow, its rim and the mark of the start state."""
        return self.rect.adjusted(-30.0, -12.0, 12.0, 12.0)

    def on_rim(self, position: QPointF) -> bool:
        """True if a drag from ``position`` draws an arrow instead of moving the box."""
        inner = self.rect.adjusted(BOX_RIM_WIDTH, BOX_RIM_WIDTH, -BOX_RIM_WIDTH, -BOX_RIM_WIDTH)
        return self.contains_point(position) and not inner.contains(position)

    def contains_point(self, position: QPointF) -> bool:
        """True if ``position`` is on the box or just outside its edge."""
        return self.rect.adjusted(
            -BOX_RIM_WIDTH / 2, -BOX_RIM_WIDTH / 2, BOX_RIM_WIDTH / 2, BOX_RIM_WIDTH / 2
        ).contains(position)

    def paint(self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None) -> None:
        """Draw the box and its texts."""
        box, rect = self.box, self.rect
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for step in range(GLOW_WIDTH if box.lit else 0):
            grown = rect.adjusted(-step * 2.0, -step * 2.0, step * 2.0, step * 2.0)
            painter.setPen(QPen(_faint(box.lit, 0.34 - 0.07 * step), 2.5))
            painter.drawRoundedRect(grown, BOX_CORNER_RADIUS + step * 2.0, BOX_CORNER_RADIUS + step * 2.0)
        ground = colours.SELECTED_ROW if box.selected else colours.CONTROL
        painter.setBrush(QColor(colours.mixed_colour(ground, box.lit, 0.35) if box.lit else ground))
        edge = colours.SELECTED_HANDLE if box.selected else box.lit or "#3f4852"
        painter.setPen(QPen(QColor(edge), 1.6 if box.selected or box.lit else 1.0))
        painter.drawRoundedRect(rect, BOX_CORNER_RADIUS, BOX_CORNER_RADIUS)
        if self.ready:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(colours.kind_colour("position")), 2.0))
            painter.drawRoundedRect(rect.adjusted(-2, -2, 2, 2), BOX_CORNER_RADIUS + 2, BOX_CORNER_RADIUS + 2)
        self._paint_start(painter)
        self._paint_words(painter)
        self._paint_dots(painter)

    def _paint_start(self, painter: QPainter) -> None:
        if self.box.starts:
            colour = QColor(colours.TEXT_SECOND)
            tip = QPointF(self.rect.left() - 2.0, self.rect.center().y())
            painter.setPen(QPen(colour, 1.5))
            painter.setBrush(colour)
            painter.drawEllipse(tip - QPointF(22.0, 0.0), 4.0, 4.0)
            painter.drawLine(QLineF(tip - QPointF(18.0, 0.0), tip - QPointF(6.0, 0.0)))
            _paint_head(painter, tip, 0.0)

    def _paint_words(self, painter: QPainter) -> None:
        inner = self.rect.adjusted(PADDING_PX, 5.0, -PADDING_PX, 0.0)
        title = QRectF(inner.left(), inner.top(), inner.width() - 10.0 * len(self.box.dots), TITLE_PX)
        _write(painter, title, self.box.name, font(13, bold=True), colours.TEXT)
        inks = (colours.TEXT_SECOND, *(colours.kind_colour("distance") for _ in self.box.manners))
        for index, (text, ink) in enumerate(zip((self.box.plays, *self.box.manners), inks, strict=True)):
            line = QRectF(inner.left(), inner.top() + TITLE_PX + index * LINE_PX, inner.width(), LINE_PX)
            _write(painter, line, text, font(11), ink)

    def _paint_dots(self, painter: QPainter) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        for index, colour in enumerate(self.box.dots):
            painter.setBrush(QColor(colour))
            centre = QPointF(self.rect.right() - PADDING_PX - 3.0 - 10.0 * index, self.rect.top() + 14.0)
            painter.drawEllipse(centre, 3.5, 3.5)


@dataclass(frozen=True)
class Arrow:
    """Transition as displayed: an arrow between two boxes, whose middle is offset sideways by ``bow``."""

    place: int
    source: QRectF
    target: QRectF
    words: tuple[str, ...]
    bow: float
    selected: bool = False


class TransitionItem(QGraphicsItem):
    """Graphics item of a transition's arrow; its label is a separate ``WordsItem`` above all arrows."""

    def __init__(self, arrow: Arrow) -> None:
        super().__init__()
        self.arrow, self.hovered = arrow, False
        self._path, self._angle = _path_of(arrow)
        self.label = _label(arrow, self._path.pointAtPercent(LABEL_POSITION_FRACTION))
        self.words = WordsItem(self)
        self.setZValue(1.1 if arrow.selected else 1.0)

    def boundingRect(self) -> QRectF:
        """Bounds of the arrow and its head."""
        return self._path.boundingRect().adjusted(-ARROW_REACH_PX, -ARROW_REACH_PX, ARROW_REACH_PX, ARROW_REACH_PX)

    def contains_point(self, position: QPointF) -> bool:
        """True if ``position`` is on the arrow or its label."""
        stroker = QPainterPathStroker()
        stroker.setWidth(ARROW_REACH_PX)
        return self.label.contains(position) or stroker.createStroke(self._path).contains(position)

    def paint(self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None) -> None:
        """Draw the arrow."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ink = QColor(self.colour)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(ink, 2.0 if self.arrow.selected else 1.4))
        painter.drawPath(self._path)
        painter.setBrush(ink)
        _paint_head(painter, self._path.currentPosition(), self._angle)

    @property
    def colour(self) -> str:
        """Colour of the arrow."""
        if self.arrow.selected:
            return colours.SELECTED_HANDLE
        return colours.TEXT_SECOND if self.hovered else "#66707c"


class WordsItem(QGraphicsItem):
    """Graphics item of an arrow's label, with the conditions of the transition."""

    def __init__(self, of: TransitionItem) -> None:
        super().__init__()
        self._of = of
        self.setZValue(3.0 if of.arrow.selected else 1.5)

    def boundingRect(self) -> QRectF:
        """Bounds of the label and its frame."""
        return self._of.label.adjusted(-1.0, -1.0, 1.0, 1.0)

    def paint(self, painter: QPainter, _option: QStyleOptionGraphicsItem, _widget: QWidget | None = None) -> None:
        """Draw the label on its background."""
        arrow, label = self._of.arrow, self._of.label
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        framed = arrow.selected or self._of.hovered
        painter.setPen(QPen(QColor(self._of.colour), 1.0) if framed else Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colours.SELECTED_ROW if arrow.selected else colours.PANEL))
        painter.drawRoundedRect(label, 4.0, 4.0)
        for index, text in enumerate(arrow.words):
            line = QRectF(label.left() + 6.0, label.top() + 2.0 + index * LINE_PX, label.width(), LINE_PX)
            _write(painter, line, text, font(11), colours.TEXT if arrow.selected else colours.TEXT_SECOND)


def bow_of(order: int, returns: bool) -> float:
    """Sideways offset of the ``order``-th arrow between two boxes; ``returns`` is True if an arrow in the other
    direction exists.
    """
    return (ARROW_BOW if returns else 0.0) + NEXT_ARROW_BOW * order


def exit_point(rect: QRectF, position: QPointF) -> QPointF:
    """Point at which the line from the centre of a box to ``position`` leaves the box."""
    centre = rect.center()
    dx, dy = position.x() - centre.x(), position.y() - centre.y()
    share = max(abs(dx) / (rect.width() / 2 + 2.0), abs(dy) / (rect.height() / 2 + 2.0), 1e-6)
    return QPointF(centre.x() + dx / share, centre.y() + dy / share)


def _label(arrow: Arrow, middle: QPointF) -> QRectF:
    """Rectangle of the label: centred on a straight arrow, outside of a bent one, so that labels do not overlap."""
    metrics = QFontMetricsF(font(11))
    width = max(metrics.horizontalAdvance(each) for each in arrow.words) + 12.0
    height = LINE_PX * len(arrow.words) + 4.0
    aside = _aside(arrow)
    share = 1.0 if arrow.bow else 0.0
    middle = middle + QPointF(aside.x() * (width / 2 - 8.0), aside.y() * (height / 2 - 4.0)) * share
    return QRectF(middle.x() - width / 2, middle.y() - height / 2, width, height)


def _aside(arrow: Arrow) -> QPointF:
    """Unit vector perpendicular to the line between the boxes, on the side to which the arrow bends."""
    line = QLineF(arrow.source.center(), arrow.target.center())
    length = max(line.length(), 1e-6)
    return QPointF(-line.dy() / length, line.dx() / length)


def _path_of(arrow: Arrow) -> tuple[QPainterPath, float]:
    """Path of the arrow, and its direction at the target in radians."""
    if arrow.source == arrow.target:
        return _loop(arrow)
    start, end = arrow.source.center(), arrow.target.center()
    control = (start + end) / 2 + _aside(arrow) * arrow.bow * 2.0
    begin, finish = exit_point(arrow.source, control), exit_point(arrow.target, control)
    path = QPainterPath(begin)
    path.quadTo(control, finish)
    angle = math.atan2(finish.y() - control.y(), finish.x() - control.x())
    return path, angle


def _loop(arrow: Arrow) -> tuple[QPainterPath, float]:
    rect, height = arrow.source, LOOP_ARROW_SIZE + arrow.bow
    begin = QPointF(rect.center().x() - rect.width() / 6, rect.top() - 2.0)
    finish = QPointF(rect.center().x() + rect.width() / 6, rect.top() - 2.0)
    path = QPainterPath(begin)
    path.cubicTo(begin + QPointF(-24.0, -height), finish + QPointF(24.0, -height), finish)
    return path, math.radians(112.0)


def _paint_head(painter: QPainter, tip: QPointF, angle: float) -> None:
    back = [QPointF(math.cos(angle + turn), math.sin(angle + turn)) * ARROW_PX for turn in (2.7, -2.7)]
    painter.save()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.drawPolygon(QPolygonF([tip, tip + back[0], tip + back[1]]))
    painter.restore()


def _faint(colour: str, share: float) -> QColor:
    made = QColor(colour)
    made.setAlphaF(share)
    return made


def _write(painter: QPainter, rect: QRectF, text: str, face: QFont, ink: str) -> None:
    painter.setFont(face)
    painter.setPen(QColor(ink))
    shown = QFontMetricsF(face).elidedText(text, Qt.TextElideMode.ElideRight, rect.width())
    painter.drawText(rect, int(Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft), shown)
