"""Figure of all joints of a body in its rest pose, seen from behind, which can be clicked."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QLineF, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.skeleton import Skeleton
from studio.document import colours

FloatArray = NDArray[np.float64]

JOINT_FIGURE_HEIGHT = 190
_MARGIN, _LETTER_MARGIN, _NEAR, _DOT = 10.0, 6.0, 12.0, 2.5


class JointFigure(QWidget):
    """Figure of joints: those assigned to a body part are filled, the joint of the selected part has a ring."""

    clicked = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Joints (back view): click the joint for the selected part")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._names: tuple[str, ...] = ()
        self._parents: tuple[int, ...] = ()
        self._flat = np.zeros((0, 2))
        self._colours: dict[int, str] = {}
        self._body: list[int] = []
        self._ringed: int | None = None

    def sizeHint(self) -> QSize:
        """Preferred width of the panel."""
        return QSize(120, JOINT_FIGURE_HEIGHT)

    def show_body(self, skeleton: Skeleton, positions: FloatArray, body_map: BodyMap, ringed: int | None) -> None:
        """Show joints at ``positions`` (J, 3), Z up, with a body map; the joint with the index ``ringed`` gets a
        ring.
        """
        left = positions[body_map[BodyPart.LEFT_THIGH]] - positions[body_map[BodyPart.RIGHT_THIGH]]
        left = left * [1.0, 1.0, 0.0]
        left = left / max(float(np.linalg.norm(left)), 1e-9)
        self._flat = np.column_stack([-positions @ left, positions[:, 2]])
        self._body = body_map.with_descendants(skeleton)
        self._names, self._parents = skeleton.names, tuple(skeleton.parents.tolist())
        sides = {"LEFT": colours.LEFT, "RIGHT": colours.RIGHT}
        self._colours = dict.fromkeys(body_map.spine, colours.TEXT) | {
            joint: sides.get(part.name.partition("_")[0], colours.TEXT) for part, joint in body_map.parts.items()
        }
        self._ringed = ringed
        self.update()

    def place_of(self, name: str) -> QPointF:
        """Position in the widget at which a joint is drawn."""
        return QPointF(*self._places()[self._names.index(name)])

    def joint_at(self, point: QPointF) -> str | None:
        """Name of the joint nearest to ``point``; None if none is near."""
        if not self._names:
            return None
        away = np.linalg.norm(self._places() - [point.x(), point.y()], axis=1)
        nearest = int(away.argmin())
        return self._names[nearest] if away[nearest] <= _NEAR else None

    def _places(self) -> FloatArray:
        """(J, 2) pixel positions of the joints."""
        body = self._flat[self._body]
        low, high = body.min(axis=0), body.max(axis=0)
        room = np.array([self.width(), self.height()]) - 2.0 * _MARGIN
        scale = float((room / np.maximum(high - low, 1e-6)).min())
        centre = 0.5 * np.array([self.width(), self.height()])
        return np.asarray(centre + scale * (self._flat - 0.5 * (low + high)) * [1.0, -1.0])

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Emit the joint under the mouse."""
        if (name := self.joint_at(event.position())) is not None:
            self.clicked.emit(name)

    def event(self, event: QEvent) -> bool:
        """Show the name of the joint under the mouse as tooltip."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), self.joint_at(QPointF(event.pos())) or "Click a joint.", self)
            return True
        return bool(super().event(event))

    def paintEvent(self, _: QPaintEvent) -> None:
        """Paint bones, then joints."""
        if not self._names:
            return
        points = [QPointF(*place) for place in self._places()]
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(QPen(QColor(colours.EDGE), 1.5))
            painter.drawLines([QLineF(points[up], points[k]) for k, up in enumerate(self._parents) if up >= 0])
            for joint, point in enumerate(points):
                colour = QColor(self._colours.get(joint, colours.TEXT_THIRD))
                painter.setPen(QPen(colour, 1.0))
                painter.setBrush(colour if joint in self._colours else Qt.BrushStyle.NoBrush)
                painter.drawEllipse(point, _DOT, _DOT)
            if self._ringed is not None:
                painter.setPen(QPen(QColor(colours.SELECTED_HANDLE), 2.0))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.drawEllipse(points[self._ringed], 3.0 * _DOT, 3.0 * _DOT)
            corners = QRectF(self.rect()).adjusted(_LETTER_MARGIN, 0.0, -_LETTER_MARGIN, 0.0)
            sides = ("L", Qt.AlignmentFlag.AlignLeft, colours.LEFT), ("R", Qt.AlignmentFlag.AlignRight, colours.RIGHT)
            for letter, side, shown in sides:
                painter.setPen(QColor(shown))
                painter.drawText(corners, Qt.AlignmentFlag.AlignTop | side, letter)
