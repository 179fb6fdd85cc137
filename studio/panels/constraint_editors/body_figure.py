"""Figure of a body seen from behind, with clickable segments; the body's left is at the left."""

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Signal
from PySide6.QtGui import QColor, QHelpEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.document import colours

BODY_FIGURE_WIDTH, BODY_FIGURE_HEIGHT = 104, 172
BODY_FIGURE_SCALE = 0.8
BODY_FIGURE_MIDDLE = BODY_FIGURE_WIDTH / 2


def _mirrored(name: str, left: QRectF) -> dict[BodyPart, QRectF]:
    right = QRectF(2 * BODY_FIGURE_MIDDLE - left.right(), left.y(), left.width(), left.height())
    return {BodyPart(f"left_{name}"): left, BodyPart(f"right_{name}"): right}


SEGMENT_SHAPES: dict[BodyPart, QRectF] = {
    BodyPart.HEAD: QRectF(BODY_FIGURE_MIDDLE - 11, 2, 22, 24),
    BodyPart.THORAX: QRectF(BODY_FIGURE_MIDDLE - 17, 40, 34, 30),
    BodyPart.ABDOMEN: QRectF(BODY_FIGURE_MIDDLE - 14, 72, 28, 14),
    BodyPart.PELVIS: QRectF(BODY_FIGURE_MIDDLE - 16, 88, 32, 15),
    **_mirrored("clavicle", QRectF(BODY_FIGURE_MIDDLE - 24, 30, 21, 8)),
    **_mirrored("upper_arm", QRectF(BODY_FIGURE_MIDDLE - 31, 40, 11, 29)),
    **_mirrored("forearm", QRectF(BODY_FIGURE_MIDDLE - 34, 71, 10, 27)),
    **_mirrored("hand", QRectF(BODY_FIGURE_MIDDLE - 36, 100, 11, 13)),
    **_mirrored("thigh", QRectF(BODY_FIGURE_MIDDLE - 16, 105, 14, 30)),
    **_mirrored("shank", QRectF(BODY_FIGURE_MIDDLE - 15, 137, 12, 24)),
    **_mirrored("foot", QRectF(BODY_FIGURE_MIDDLE - 19, 163, 16, 8)),
}


def _place(point: BodyPoint, shape: QRectF) -> QPointF:
    """Position of the joint of a ``point`` in the rectangle of its segment: limbs hang from their joint, the trunk
    stands on it.
    """
    rises = point.part in (BodyPart.PELVIS, BodyPart.ABDOMEN, BodyPart.THORAX, BodyPart.NECK, BodyPart.HEAD)
    return QPointF(shape.center().x(), shape.top() if point.at_end == rises else shape.bottom())


class BodyFigure(QWidget):
    """Figure whose segments are filled by their weight; segments without a weight cannot be clicked."""

    clicked = Signal(object)

    def __init__(self, name: str = "IK chain: click body segments to lock or free them") -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setMouseTracking(True)
        self._weights: dict[BodyPart, float] = {}
        self._point: QPointF | None = None
        self._under: BodyPart | None = None

    def sizeHint(self) -> QSize:
        return QSize(round(BODY_FIGURE_SCALE * BODY_FIGURE_WIDTH), round(BODY_FIGURE_SCALE * BODY_FIGURE_HEIGHT))

    def show_weights(self, weights: dict[BodyPart, float], point: BodyPoint | None = None) -> None:
        """Show weights by segment, from 0 (locked) to 1 (free), and the constrained point."""
        self._weights = weights
        shape = None if point is None else SEGMENT_SHAPES.get(point.part)
        self._point = None if point is None or shape is None else _place(point, shape)
        self.update()

    def tip(self, part: BodyPart | None) -> str:
        """Tooltip of a segment; of the whole figure for None."""
        if part is None:
            return "Click segments to lock or free them."
        return f"{part.label} {'is free' if self._weights[part] > 0.0 else 'is locked'}. Click to change."

    def part_at(self, position: QPointF) -> BodyPart | None:
        """Clickable segment at a position of the widget; None if there is none."""
        position = position / BODY_FIGURE_SCALE
        grown = ((part, shape.adjusted(-2, -2, 2, 2)) for part, shape in SEGMENT_SHAPES.items())
        return next((part for part, shape in grown if shape.contains(position) and part in self._weights), None)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        part = self.part_at(event.position())
        if part is not None:
            self.clicked.emit(part)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        part = self.part_at(event.position())
        if part != self._under:
            self._under = part
            self.update()

    def leaveEvent(self, _: QEvent) -> None:
        self._under = None
        self.update()

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            part = self.part_at(QPointF(event.pos()))
            QToolTip.showText(event.globalPos(), self.tip(part), self)
            return True
        return bool(super().event(event))

    def paintEvent(self, _: QPaintEvent) -> None:
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.scale(BODY_FIGURE_SCALE, BODY_FIGURE_SCALE)
            for part, shape in SEGMENT_SHAPES.items():
                colour = colours.EDGE
                if self._weights.get(part, 0.0) > 0.0:
                    share = 0.35 + 0.65 * self._weights[part]
                    colour = colours.mixed_colour(colours.EDGE, colours.KIND_COLOURS["position"], share)
                if part == self._under:
                    colour = colours.mixed_colour(colour, "#ffffff", 0.18)
                painter.setPen(QColor(colour))
                painter.setBrush(QColor(colour))
                radius = min(shape.width(), shape.height()) / 2 if part == BodyPart.HEAD else 4
                painter.drawRoundedRect(shape, radius, radius)
            if self._point is not None:
                painter.setPen(QColor(colours.WINDOW))
                painter.setBrush(QColor(colours.SELECTED_HANDLE))
                painter.drawEllipse(self._point, 3.5, 3.5)
            painter.setPen(QColor(colours.TEXT_THIRD))
            font = painter.font()
            font.setPixelSize(12)
            painter.setFont(font)
            painter.drawText(QPointF(8, 24), "L")
            painter.drawText(QPointF(BODY_FIGURE_WIDTH - 14, 24), "R")
