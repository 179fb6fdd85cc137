"""Figure of a capture's reference pose as interpreted: from behind and from the left, with sides, front and up
labelled.
"""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.kinematics import joint_positions, rest_poses
from studio.core.captures.capture import Capture
from studio.core.rotations import normalized
from studio.document import colours

FloatArray = NDArray[np.float64]

_HEIGHT, _MARGIN, _CAPTION = 150, 10.0, 16.0
_WIDTH = 2.0
_CHAINS = (
    ("CLAVICLE", "UPPER_ARM", "FOREARM", "HAND"),
    ("THIGH", "SHANK", "FOOT", "TOE"),
)


class ReferenceFigure(QWidget):
    """Two views of a capture's reference pose, in which left and right have different colours."""

    def __init__(self, capture: Capture, body_map: BodyMap) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName("Reference pose")
        self.setToolTip("Interpreted reference pose; if sides, front or up are wrong, correct the body map")
        self._points = _standing(capture, body_map)
        self._chains = _chains(capture, body_map)
        self._drawn = sorted({joint for _, joints in self._chains for joint in joints})

    def sizeHint(self) -> QSize:
        """Preferred width of the panel."""
        return QSize(200, _HEIGHT)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the view from behind at the left, and the view of the body's left side at the right."""
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            half = self.width() / 2.0
            views = (
                ("Back view", -self._points[:, 1], "L", "R"),
                ("Left view", -self._points[:, 0], "Front", "Back"),
            )
            for number, (caption, across, *sides) in enumerate(views):
                box = QRectF(number * half, 0.0, half, self.height())
                self._paint_view(painter, across, box)
                painter.setPen(QColor(colours.TEXT_SECOND))
                painter.drawText(box, Qt.AlignmentFlag.AlignBottom | Qt.AlignmentFlag.AlignHCenter, caption)
                if not number:
                    painter.drawText(box.adjusted(6.0, 0.0, -6.0, 0.0), Qt.AlignmentFlag.AlignVCenter, "↑ Up")
                for text, side in zip(sides, (Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight), strict=True):
                    painter.drawText(box.adjusted(6.0, 0.0, -6.0, 0.0), Qt.AlignmentFlag.AlignTop | side, text)

    def _paint_view(self, painter: QPainter, across: FloatArray, box: QRectF) -> None:
        heights = self._points[:, 2]
        low, wide = heights[self._drawn].min(), across[self._drawn]
        room = box.height() - 2.0 * _MARGIN - _CAPTION
        tall, broad = float(np.ptp(heights[self._drawn])), float(np.ptp(wide))
        span = max(tall, broad * room / max(box.width() - 4.0 * _MARGIN, 1.0), 1e-6)
        scale = room / span
        middle = 0.5 * (wide.min() + wide.max())
        xs = box.center().x() + scale * (across - middle)
        floor = box.bottom() - _MARGIN - _CAPTION
        ys = floor - scale * (heights - low)
        painter.setPen(QColor(colours.TEXT_SECOND))
        painter.drawLine(QPointF(box.left() + _MARGIN, floor), QPointF(box.right() - _MARGIN, floor))
        for colour, joints in self._chains:
            painter.setPen(QPen(QColor(colour), _WIDTH, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawPolyline([QPointF(float(xs[joint]), float(ys[joint])) for joint in joints])


def _standing(capture: Capture, body_map: BodyMap) -> FloatArray:
    """Joint positions (J, 3) in the reference pose, rotated so that the body faces +X with Z up."""
    points: FloatArray = joint_positions(capture.skeleton, rest_poses(capture.skeleton, capture.reference_rotations))[0]
    left = points[body_map[BodyPart.LEFT_THIGH]] - points[body_map[BodyPart.RIGHT_THIGH]]
    left = normalized(left * [1.0, 1.0, 0.0])
    return np.asarray(points @ np.stack([np.cross(left, [0.0, 0.0, 1.0]), left, [0.0, 0.0, 1.0]], axis=1))


def _chains(capture: Capture, body_map: BodyMap) -> list[tuple[str, list[int]]]:
    """Colour and joint indices of each chain: trunk and head, then arms and legs with all their end joints."""
    top = [joint for part in (BodyPart.NECK, BodyPart.HEAD) if (joint := body_map.get(part)) is not None]
    chains = [(colours.TEXT, _to_the_end(capture, [*body_map.spine, *top]))]
    for side, colour in (("RIGHT", colours.RIGHT), ("LEFT", colours.LEFT)):  # the left is nearer in its view
        for names, root in zip(_CHAINS, (body_map.spine[-1], body_map.spine[0]), strict=True):
            joints = [joint for name in names if (joint := body_map.get(BodyPart[f"{side}_{name}"])) is not None]
            chains.append((colour, _to_the_end(capture, [root, *joints])))
    return chains


def _to_the_end(capture: Capture, joints: list[int]) -> list[int]:
    """``joints`` extended by the farthest descendant of the last one, so that its direction is visible."""
    children = capture.skeleton.children[joints[-1]]
    if not children:
        return joints
    return [*joints, max(children, key=lambda child: float(np.linalg.norm(capture.skeleton.offsets[child])))]
