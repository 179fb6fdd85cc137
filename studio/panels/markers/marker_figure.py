"""Figure of a body with the locations of markers: filled if a marker is assigned, hollow if not."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QMouseEvent, QPainter, QPainterPath, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from studio.core.markers.roles import ROLES, ROLES_BY_ID
from studio.document import colours

ROLE_FIGURE_WIDTH, ROLE_FIGURE_HEIGHT = 300, 520
ROLE_FIGURE_MARGIN = 24
ROLE_DOT_PX = 5.0
ROLE_PICK_PIXELS = 11.0
"""Distance in pixels from a dot within which a click chooses it."""

_LIMBS: tuple[tuple[tuple[float, float], tuple[float, float], float], ...] = (
    ((0.21, 0.8), (0.39, 0.645), 26.0),
    ((0.39, 0.645), (0.54, 0.535), 21.0),
    ((0.54, 0.535), (0.585, 0.455), 17.0),
    ((0.12, 0.51), (0.115, 0.3), 40.0),
    ((0.115, 0.3), (0.11, 0.085), 30.0),
    ((0.11, 0.06), (0.17, 0.02), 17.0),
)
"""Ends and width in pixels of each limb of the left side, in fractions of the figure."""


class MarkerFigure(QWidget):
    """Figure on which a click chooses a body location; the body's left is at the left, as on all figures."""

    role_chosen = Signal(str)
    """Emitted with the id of the chosen body location."""

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Body locations of markers; filled ones are assigned")
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self._markers: Mapping[str, Sequence[str]] = {}
        self._role = ""
        self._under = ""

    def sizeHint(self) -> QSize:
        return QSize(ROLE_FIGURE_WIDTH, ROLE_FIGURE_HEIGHT)

    def show_map(self, markers: Mapping[str, Sequence[str]], role: str) -> None:
        """Show the assigned labels by body location, and the chosen location ``role``."""
        self._markers, self._role = markers, role
        self.update()

    def place_of(self, role: str) -> QPointF:
        """Widget position of a body location."""
        return _place(*ROLES_BY_ID[role].spot)

    def role_at(self, point: QPointF) -> str:
        """Id of the body location at a position of the widget; empty if there is none."""
        role, distance = min(
            ((role.id, (self.place_of(role.id) - point).manhattanLength()) for role in ROLES), key=lambda pair: pair[1]
        )
        return role if distance < 1.4 * ROLE_PICK_PIXELS else ""

    def mousePressEvent(self, event: QMouseEvent) -> None:
        role = self.role_at(event.position())
        if role:
            self.role_chosen.emit(role)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        under = self.role_at(event.position())
        if under != self._under:
            self._under = under
            self.update()

    def leaveEvent(self, _: QEvent) -> None:
        self._under = ""
        self.update()

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            role = self.role_at(QPointF(event.pos()))
            if role:
                labels = ", ".join(self._markers.get(role, ())) or "no marker"
                QToolTip.showText(event.globalPos(), f"{ROLES_BY_ID[role].words}: {labels}", self)
            else:
                QToolTip.hideText()
            return True
        return bool(super().event(event))

    def paintEvent(self, _: QPaintEvent) -> None:
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._paint_body(painter)
            for role in ROLES:
                self._paint_dot(painter, role.id)
            painter.setPen(QColor(colours.TEXT_THIRD))
            painter.drawText(QPointF(ROLE_FIGURE_MARGIN - 10, ROLE_FIGURE_MARGIN + 4), "L")
            painter.drawText(QPointF(ROLE_FIGURE_WIDTH - ROLE_FIGURE_MARGIN, ROLE_FIGURE_MARGIN + 4), "R")

    def _paint_body(self, painter: QPainter) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(colours.EDGE))
        head = _place(0.0, 0.93)
        painter.drawEllipse(head, 29.0, 36.0)
        painter.drawRoundedRect(QRectF(head.x() - 13, head.y() + 26, 26, 34), 8, 8)
        trunk = QPainterPath()
        shoulders, hips = _place(0.24, 0.825), _place(0.2, 0.49)
        right, low = _place(-0.24, 0.825), _place(-0.2, 0.49)
        trunk.moveTo(shoulders)
        waist = _place(0.15, 0.62)
        trunk.cubicTo(waist, waist, hips)
        trunk.lineTo(low)
        waist = _place(-0.15, 0.62)
        trunk.cubicTo(waist, waist, right)
        trunk.closeSubpath()
        painter.setPen(QPen(QColor(colours.EDGE), 18.0, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap,
                            Qt.PenJoinStyle.RoundJoin))  # fmt: skip
        painter.drawPath(trunk)
        for side in (1.0, -1.0):
            for (across, up), (far_across, far_up), thick in _LIMBS:
                painter.setPen(QPen(QColor(colours.EDGE), thick, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
                painter.drawLine(_place(side * across, up), _place(side * far_across, far_up))

    def _paint_dot(self, painter: QPainter, role: str) -> None:
        place = self.place_of(role)
        filled = bool(self._markers.get(role))
        if role == self._role:
            painter.setPen(QPen(QColor(colours.SELECTED_HANDLE), 2.0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(place, ROLE_DOT_PX + 5, ROLE_DOT_PX + 5)
        edge = colours.SELECTED_HANDLE if role == self._under else colours.TEXT_THIRD
        painter.setPen(QPen(QColor(colours.WINDOW if filled else edge), 1.2))
        painter.setBrush(QColor(colours.KIND_COLOURS["position"]) if filled else QColor(colours.PANEL))
        size = ROLE_DOT_PX if filled else ROLE_DOT_PX - 1.5
        painter.drawEllipse(place, size, size)


def _place(across: float, up: float) -> QPointF:
    width = (ROLE_FIGURE_WIDTH - 2 * ROLE_FIGURE_MARGIN) / 2
    return QPointF(
        ROLE_FIGURE_WIDTH / 2 - across * width * 1.55,
        ROLE_FIGURE_MARGIN + (1.0 - up) * (ROLE_FIGURE_HEIGHT - 2 * ROLE_FIGURE_MARGIN),
    )
