"""Recorded markers at the playhead in a small 3D view, to be rotated and clicked."""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from studio.core.markers.trial import Trial, label_without_subject, seen_mask
from studio.document import colours
from studio.io.up_axis import turn_to_world

FloatArray = NDArray[np.float64]

CLOUD_WIDTH = 250
CLOUD_MARGIN = 22
CLOUD_DOT_PX = 4.0
CLOUD_PICK_PIXELS = 10.0
RADIANS_PER_PIXEL = 0.012
"""Rotation of the view per pixel of a drag."""
CLICK_PIXELS = 4
"""Maximum distance in pixels between press and release of a click."""


class MarkerCloud(QWidget):
    """Small 3D view of the recorded markers: a drag rotates it about the vertical, a click chooses a marker."""

    marker_chosen = Signal(str)
    """Emitted with the label of the clicked marker, without subject."""

    def __init__(self, trial: Trial, up_axis: str) -> None:
        super().__init__()
        self.setAccessibleName("Recorded markers at the playhead")
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setMouseTracking(True)
        self._trial, self._turn = trial, turn_to_world(up_axis).T
        self._places: tuple[int, ...] = ()
        self._labels: tuple[str, ...] = ()
        self._used: Collection[str] = ()
        self._marked: Collection[str] = ()
        self._frame, self._angle = 0, 0.0
        self._extent = 1.0, 1.0
        self._press: QPointF | None = None
        self._dragged = False
        self._under = ""

    def sizeHint(self) -> QSize:
        return QSize(CLOUD_WIDTH, 2 * CLOUD_WIDTH)

    def show_markers(self, labels: Collection[str], used: Collection[str], marked: Collection[str]) -> None:
        """Show markers by label (with subject); ``used`` are labels in the map and ``marked`` those at the chosen body
        location, both without subject.
        """
        places = tuple(self._trial.labels.index(label) for label in labels)
        if places != self._places:
            self._places = places
            self._labels = tuple(label_without_subject(label) for label in labels)
            self._extent = self._reach()
            self._frame = self._best_frame() if not self._seen(self._frame).any() else self._frame
        self._used, self._marked = used, marked
        self.update()

    def face(self, left: Collection[str], right: Collection[str]) -> None:
        """Rotate the view so that the body is seen from behind, with the markers ``left`` at the left; labels without
        subject.

        If one side has no markers, the view shows the largest extent.
        """
        points = self._at(self._best_frame())
        sides = [points[[k for k, label in enumerate(self._labels) if label in side]] for side in (left, right)]
        sides = [side[seen_mask(side)] for side in sides]
        if all(len(side) for side in sides):
            across = sides[0].mean(axis=0) - sides[1].mean(axis=0)
        else:
            level = points[seen_mask(points)][:, :2]
            across = np.linalg.svd(level - level.mean(axis=0))[2][0] if len(level) > 1 else np.array([0.0, 1.0])
        self._angle = float(np.arctan2(-across[0], across[1]))
        self.update()

    def show_time(self, seconds: float) -> None:
        """Show the markers at the time of the playhead."""
        last = self._trial.frame_count - 1
        self._frame = min(max(round(seconds * self._trial.frame_rate), 0), last)
        self.update()

    def dots(self) -> dict[str, QPointF]:
        """Widget position of each visible marker at the current frame, by label."""
        points = self._at(self._frame)
        seen = seen_mask(points)
        if not seen.any():
            return {}
        points = points - 0.5 * (points[seen].min(axis=0) + points[seen].max(axis=0))
        across = np.cos(self._angle) * points[:, 1] - np.sin(self._angle) * points[:, 0]
        sizes = self.width(), self.height()
        scale = min((size - 2 * CLOUD_MARGIN) / 2 / extent for size, extent in zip(sizes, self._extent, strict=True))
        middle = QPointF(self.width() / 2, self.height() / 2)
        return {
            self._labels[k]: middle + QPointF(-scale * across[k], -scale * points[k, 2]) for k in np.flatnonzero(seen)
        }

    def label_at(self, position: QPointF) -> str:
        """Label of the marker at a position of the widget; empty if there is none."""
        near = {label: (dot - position).manhattanLength() for label, dot in self.dots().items()}
        label = min(near, key=lambda each: near[each], default="")
        return label if label and near[label] < 1.4 * CLOUD_PICK_PIXELS else ""

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._press, self._dragged = event.position(), False

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._press is not None and event.buttons() & Qt.MouseButton.LeftButton:
            moved = event.position() - self._press
            if self._dragged or moved.manhattanLength() > CLICK_PIXELS:
                self._dragged, self._press = True, event.position()
                self._angle -= RADIANS_PER_PIXEL * moved.x()
        self._under = self.label_at(event.position())
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        label = "" if self._dragged else self.label_at(event.position())
        self._press = None
        if label:
            self.marker_chosen.emit(label)

    def leaveEvent(self, _: QEvent) -> None:
        self._under = ""
        self.update()

    def paintEvent(self, _: QPaintEvent) -> None:
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            dots = self.dots()
            for label, dot in dots.items():
                used = label in self._used
                painter.setPen(QPen(QColor(colours.WINDOW), 1.0))
                painter.setBrush(QColor(colours.KIND_COLOURS["position"] if used else colours.TEXT_SECOND))
                painter.drawEllipse(dot, CLOUD_DOT_PX, CLOUD_DOT_PX)
            for label in dict.fromkeys((*self._marked, self._under)):
                if label in dots:
                    painter.setPen(QPen(QColor(colours.SELECTED_HANDLE), 1.5))
                    painter.setBrush(Qt.BrushStyle.NoBrush)
                    painter.drawEllipse(dots[label], CLOUD_DOT_PX + 4, CLOUD_DOT_PX + 4)
                    painter.drawText(dots[label] + QPointF(CLOUD_DOT_PX + 8, 4), label)
            painter.setPen(QColor(colours.TEXT_THIRD))
            words = "Recorded markers. Drag to orbit." if dots else "No marker is visible in this frame."
            painter.drawText(QPointF(8, self.height() - 8), words)

    def _at(self, frame: int) -> FloatArray:
        """(n, 3) positions of the shown markers at a frame, metres, world axes."""
        return np.asarray(self._trial.metres * self._trial.points[frame, list(self._places)] @ self._turn)

    def _seen(self, frame: int) -> NDArray[np.bool_]:
        return seen_mask(self._at(frame)) if self._places else np.zeros(0, dtype=bool)

    def _best_frame(self) -> int:
        return int(np.argmax(seen_mask(self._trial.points[:, list(self._places)]).sum(axis=1)))

    def _reach(self) -> tuple[float, float]:
        """Half of the typical extent of the markers, horizontally and vertically, in metres."""
        frames = np.linspace(0, self._trial.frame_count - 1, 40).astype(int)
        sizes = [
            np.ptp(points[seen_mask(points)], axis=0) for points in map(self._at, frames) if seen_mask(points).any()
        ]
        if not sizes:
            return 1.0, 1.0
        across = float(np.percentile(np.hypot(*np.array(sizes)[:, :2].T), 80))
        return max(0.5 * across, 0.05), max(0.5 * float(np.percentile(np.array(sizes)[:, 2], 90)), 0.05)
