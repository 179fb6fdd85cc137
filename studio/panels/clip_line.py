"""Small timeline of a library clip: speeds of hands and feet, trim range, and hit frame."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from studio.document import colours
from studio.library.clip_labels import ClipLabel

CLIP_LINE_HEIGHT, CLIP_LINE_HEAD, CLIP_LINE_FOOT, CLIP_LINE_SIDE = 116, 18, 18, 10
MARK_GRAB_PIXELS = 8.0
"""Distance in pixels within which a press grabs a mark."""
SECONDS_AROUND_CUT = 0.75
"""Seconds that are shown before and after the trim range."""


class ClipMark(StrEnum):
    """Marks on the timeline that can be dragged: first frame, hit, last frame."""

    FIRST = "first"
    HIT = "hit"
    LAST = "last"


@dataclass(frozen=True, eq=False)
class FrameScale:
    """Mapping of the frames ``first`` to ``last`` to ``width`` pixels."""

    first: int
    last: int
    width: float

    def x(self, frame: float) -> float:
        """Pixel position of a frame."""
        return CLIP_LINE_SIDE + (frame - self.first) / max(self.last - self.first, 1) * (
            self.width - 2 * CLIP_LINE_SIDE
        )

    def frame(self, x: float) -> int:
        """Visible frame nearest to the pixel position ``x``."""
        share = (x - CLIP_LINE_SIDE) / max(self.width - 2 * CLIP_LINE_SIDE, 1.0)
        return round(self.first + min(max(share, 0.0), 1.0) * (self.last - self.first))


class ClipLine(QWidget):
    """Small timeline of a library clip, with marks that can be dragged.

    ``begun`` is emitted at the start of a drag, ``dragged`` with each intermediate label, ``marked`` with the mark
    under the mouse. If a mark is dragged to the edge, more of the take is shown on release.
    """

    begun = Signal()
    dragged = Signal(object)
    marked = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.setAccessibleName("Speed of hands and feet; drag the trim handles and the hit marker")
        self.setToolTip("Speed of each hand and foot. Drag the trim handles and the hit marker.")
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)  # keys are meant for what was dragged last
        self.setFixedHeight(CLIP_LINE_HEIGHT)
        self._speeds: NDArray[np.float64] = np.zeros((4, 2))
        self._rate = 30.0
        self._label: ClipLabel | None = None
        self._proposed: ClipLabel | None = None
        self._seen = FrameScale(0, 1, 100.0)
        self._held: ClipMark | None = None
        self._under: ClipMark | None = None

    def sizeHint(self) -> QSize:
        return QSize(200, CLIP_LINE_HEIGHT)

    def open(self, speeds: NDArray[np.float64], rate: float, proposed: ClipLabel) -> None:
        """Show another take with the ``speeds`` (4, F) of hands and feet; its ``proposed`` label stays visible."""
        self._speeds, self._rate, self._proposed = speeds, rate, proposed
        self.show_label(proposed)

    def show_label(self, label: ClipLabel) -> None:
        """Show the trim range and the hit of a label; the visible frames do not change during a drag."""
        self._label = label
        if self._held is None:
            self._look()
        self.update()

    def place_of(self, mark: ClipMark) -> QPointF:
        """Position in the widget at which a mark can be grabbed."""
        frame = 0 if self._label is None else getattr(self._label, mark)
        return QPointF(
            self._seen.x(frame),
            CLIP_LINE_HEIGHT - CLIP_LINE_FOOT - 6.0 if mark is ClipMark.HIT else CLIP_LINE_HEAD + 6.0,
        )

    def caption(self, mark: ClipMark, width: float) -> QRectF:
        """Rectangle of a caption ``width`` pixels wide: centred on its mark, but within the widget."""
        left = min(max(self.place_of(mark).x() - 0.5 * width, 0.0), self.width() - width)
        return QRectF(
            left,
            *(
                (CLIP_LINE_HEIGHT - CLIP_LINE_FOOT, width, CLIP_LINE_FOOT)
                if mark is ClipMark.HIT
                else (0.0, width, CLIP_LINE_HEAD)
            ),
        )

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Grab the mark under the mouse."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._held = self._mark_at(event.position().x())
            if self._held is not None:
                self.begun.emit()
                self.marked.emit(self._held)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the grabbed mark, or highlight the mark under the mouse."""
        if self._held is None:
            self._point_at(self._mark_at(event.position().x()))
            return
        label = self._label
        if label is not None:
            moved = with_mark(label, self._held, self._seen.frame(event.position().x()), self._speeds.shape[1])
            if moved != label:
                self.dragged.emit(moved)

    def mouseReleaseEvent(self, _: QMouseEvent) -> None:
        """Release the mark, and fit the visible frames to the trim range."""
        self._held = None
        self._look()
        self.update()

    def leaveEvent(self, _: QEvent) -> None:
        """Remove the highlight."""
        self._point_at(None)

    def resizeEvent(self, _: QEvent) -> None:
        """Fit the visible frames to the new width."""
        self._look()

    def _point_at(self, mark: ClipMark | None) -> None:
        if mark != self._under:
            self._under = mark
            self.setCursor(Qt.CursorShape.ArrowCursor if mark is None else Qt.CursorShape.SizeHorCursor)
            self.marked.emit(mark)
            self.update()

    def _mark_at(self, x: float) -> ClipMark | None:
        if self._label is None:
            return None
        away = {
            mark: abs(self._seen.x(getattr(self._label, mark)) - x)
            for mark in (ClipMark.HIT, ClipMark.FIRST, ClipMark.LAST)
        }
        nearest = min(away, key=lambda mark: away[mark])
        return nearest if away[nearest] <= MARK_GRAB_PIXELS else None

    def _look(self) -> None:
        if self._label is not None:
            beside, end = round(SECONDS_AROUND_CUT * self._rate), self._speeds.shape[1] - 1
            first, last = max(self._label.first - beside, 0), min(self._label.last + beside, end)
            self._seen = FrameScale(first, last, float(self.width()))

    def paintEvent(self, _: QPaintEvent) -> None:
        label = self._label
        if label is None:
            return
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            font = painter.font()
            font.setPixelSize(11)
            painter.setFont(font)
            field = QRectF(0.0, CLIP_LINE_HEAD, self.width(), CLIP_LINE_HEIGHT - CLIP_LINE_HEAD - CLIP_LINE_FOOT)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(colours.WELL))
            painter.drawRoundedRect(field, 5.0, 5.0)
            begin, end = self._seen.x(label.first), self._seen.x(label.last)
            painter.setBrush(QColor(colours.SELECTED_ROW))
            painter.drawRect(QRectF(begin, field.top(), end - begin, field.height()))
            self._paint_speeds(painter, field, label)
            self._paint_marks(painter, field, label)

    def _paint_speeds(self, painter: QPainter, field: QRectF, label: ClipLabel) -> None:
        frames = np.arange(self._seen.first, self._seen.last + 1)
        most = max(float(self._speeds[:, frames].max()), 1e-6)
        for limb in [each for each in range(4) if each != label.limb] + [int(label.limb)]:
            heights = field.bottom() - 3.0 - (field.height() - 8.0) * self._speeds[limb, frames] / most
            curve = QPolygonF(
                [QPointF(self._seen.x(frame), y) for frame, y in zip(frames.tolist(), heights, strict=True)]
            )
            own = limb == label.limb
            painter.setPen(QPen(QColor(colours.TEXT if own else colours.TEXT_THIRD), 1.8 if own else 0.7))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawPolyline(curve)

    def _paint_marks(self, painter: QPainter, field: QRectF, label: ClipLabel) -> None:
        if self._proposed is not None and self._proposed != label:
            painter.setPen(QPen(QColor(colours.TEXT_THIRD), 1.0, Qt.PenStyle.DotLine))
            for mark in ClipMark:
                x = self._seen.x(getattr(self._proposed, mark))
                painter.drawLine(QPointF(x, field.top()), QPointF(x, field.bottom()))
        for mark in ClipMark:
            frame = getattr(label, mark)
            x, strong = self._seen.x(frame), mark in (self._held, self._under)
            plain = colours.kind_colour("position") if mark is ClipMark.HIT else colours.TEXT_SECOND
            colour = QColor(colours.SELECTED_HANDLE if strong else plain)
            painter.setPen(QPen(colour, 2.0 if strong or mark is ClipMark.HIT else 1.4))
            painter.drawLine(QPointF(x, field.top()), QPointF(x, field.bottom()))
            painter.setBrush(colour)
            painter.drawEllipse(self.place_of(mark), 4.0, 4.0)
            painter.setPen(colour)
            words = f"hit {frame}" if mark is ClipMark.HIT else str(frame)
            row = self.caption(mark, painter.fontMetrics().horizontalAdvance(words))
            painter.drawText(row, Qt.AlignmentFlag.AlignCenter, words)


def with_mark(label: ClipLabel, mark: ClipMark, frame: int, frame_count: int) -> ClipLabel:
    """Label with a mark moved to ``frame``, clamped to the order of the marks and the length of the take."""
    match mark:
        case ClipMark.FIRST:
            return replace(label, first=min(max(frame, 0), label.hit - 1))
        case ClipMark.HIT:
            return replace(label, hit=min(max(frame, label.first + 1), label.last))
        case ClipMark.LAST:
            return replace(label, last=min(max(frame, label.hit), frame_count - 1))
