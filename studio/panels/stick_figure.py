"""Small stick figures of a body, for views without 3D."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

FloatArray = NDArray[np.float64]

DEPTH_FORESHORTENING = 0.35
"""Foreshortening of the depth axis in the oblique projection, so that legs and arms do not hide each other."""
STICK_FIGURE_MARGIN = 4.0


@dataclass(frozen=True)
class FigureView:
    """Oblique projection of figures: the direction ``heading`` (2,) points to the right, and ``height`` metres fill the
    box.
    """

    heading: tuple[float, float]
    height: float

    def projected(self, points: FloatArray, box: QRectF) -> FloatArray:
        """Pixels (P, 2) of ``points`` (P, 3) in metres, centred in ``box`` and standing on its lower edge."""
        along = np.array(self.heading) / max(float(np.hypot(*self.heading)), 1e-9)
        across = np.array([-along[1], along[0]])
        middle = points[:, :2].mean(axis=0)
        right = (points[:, :2] - middle) @ (along - DEPTH_FORESHORTENING * across)
        scale = (box.height() - 2.0 * STICK_FIGURE_MARGIN) / self.height
        return np.column_stack(
            [box.center().x() + scale * right, box.bottom() - STICK_FIGURE_MARGIN - scale * points[:, 2]]
        )


def paint_sticks(
    painter: QPainter,
    points: FloatArray,
    pairs: NDArray[np.intp],
    look: FigureView,
    box: QRectF,
    colour: str,
    width: float,
) -> None:
    """Paint the figure with ``points`` (P, 3) in metres, joined by ``pairs`` (B, 2), into ``box``."""
    places = look.projected(points, box)
    sticks = [QLineF(QPointF(*places[begin]), QPointF(*places[end])) for begin, end in pairs]
    painter.setPen(QPen(QColor(colour), width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    painter.drawLines(sticks)
