"""Map of the poses in the motion library: one figure per group of poses, with lines between similar groups."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHideEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QShowEvent
from PySide6.QtWidgets import QWidget

from studio.document import colours
from studio.panels.stick_figure import FigureView, paint_sticks

FloatArray = NDArray[np.float64]

FIGURE_CELL_PX, FIGURE_CAPTION_PX, FIGURE_MARGIN_PX = 92.0, 16.0, 8.0
"""Minimum width in pixels of a figure's cell, height of the text below it, and margin around the map."""
NO_CLIPS_HINT = "The motion library has no clips yet. Add a folder of captures in the Strikes panel."
FIGURE_FACING = (1.0, 0.35)
"""Direction that the figures face: to the right, and slightly towards the viewer."""
LETTER_PX, LETTER_AWAY_PX = 9, 6.0
"""Height of the letters at the ends of limbs, and their distance from the ends, in pixels."""
MAX_LISTED_CLIPS = 4
"""Number of clips that a tooltip names."""
SIDES_HINT = "L and R mark left and right."


@dataclass(frozen=True, eq=False)
class PoseGroup:
    """Group of similar poses: the typical pose (P, 3) in metres, its forward direction (2,), its map position (2,),
    similar groups, a caption, and the names of its clips, those with most poses first.
    """

    points: FloatArray
    forward: FloatArray
    place: FloatArray
    links: tuple[int, ...]
    words: str
    clips: tuple[str, ...]


class PoseMapView(QWidget):
    """Map of pose groups. ``group_highlighted`` carries the group under the mouse (-1: none), ``pose_chosen`` the
    clicked one; ``opened`` is emitted when the map becomes visible.
    """

    opened = Signal()
    group_highlighted = Signal(int)
    pose_chosen = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setAccessibleName("Pose map")
        self.setMouseTracking(True)
        self._groups: Sequence[PoseGroup] = ()
        self._sticks: NDArray[np.intp] = np.empty((0, 2), dtype=np.intp)
        self._sides: NDArray[np.intp] = np.empty(0, dtype=np.intp)
        self._cells: list[QRectF] = []
        self._under = self._clicked = -1

    def sizeHint(self) -> QSize:
        return QSize(900, 260)

    def show_groups(self, groups: Sequence[PoseGroup], sticks: NDArray[np.intp], sides: NDArray[np.intp]) -> None:
        """Show groups; ``sticks`` (S, 2) are pairs of points to be joined, and ``sides`` (S,) their side: -1 middle, 0
        left, 1 right.
        """
        self._groups, self._sticks, self._sides = groups, sticks, sides
        self._under = self._clicked = -1
        self._arrange()
        self.update()

    def cell(self, group: int) -> QRectF:
        """Rectangle in which a group is drawn."""
        return self._cells[group]

    def resizeEvent(self, _: QEvent) -> None:
        """Arrange the figures in as many columns as fit."""
        self._arrange()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Highlight the group under the mouse."""
        self._look(self._at(event.position()))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose the group under the mouse."""
        found = self._at(event.position())
        if found >= 0 and event.button() == Qt.MouseButton.LeftButton:
            self._clicked = found
            self.pose_chosen.emit(found)
            self.update()

    def leaveEvent(self, _: QEvent) -> None:
        """Emit that no group is under the mouse."""
        self._look(-1)

    def showEvent(self, event: QShowEvent) -> None:
        """Emit ``opened``, so that the groups are computed."""
        super().showEvent(event)
        self.opened.emit()

    def hideEvent(self, event: QHideEvent) -> None:
        """Emit that no group is under the mouse."""
        self._look(-1)
        super().hideEvent(event)

    def _look(self, group: int) -> None:
        if group != self._under:
            self._under = group
            self.setCursor(Qt.CursorShape.PointingHandCursor if group >= 0 else Qt.CursorShape.ArrowCursor)
            self.setToolTip(self._hint(group))
            self.group_highlighted.emit(group)
            self.update()

    def _hint(self, group: int) -> str:
        """Tooltip of a group: its clips, and the meaning of the letters."""
        if group < 0:
            return ""
        names = self._groups[group].clips
        more = [f"and {len(names) - MAX_LISTED_CLIPS} more"] if len(names) > MAX_LISTED_CLIPS else []
        return "\n".join([self._groups[group].words, *names[:MAX_LISTED_CLIPS], *more, SIDES_HINT])

    def _at(self, position: QPointF) -> int:
        return next((number for number, cell in enumerate(self._cells) if cell.contains(position)), -1)

    def _arrange(self) -> None:
        """Arrange the cells in columns along the first axis of largest variation between poses, in rows along the
        second.
        """
        count = len(self._groups)
        if not count:
            self._cells = []
            return
        room = QRectF(self.rect()).adjusted(FIGURE_MARGIN_PX, FIGURE_MARGIN_PX, -FIGURE_MARGIN_PX, -FIGURE_MARGIN_PX)
        columns = min(max(int(room.width() // FIGURE_CELL_PX), 1), count)
        rows = -(-count // columns)
        columns = -(-count // rows)
        width, height = room.width() / columns, room.height() / rows
        places = np.array([group.place for group in self._groups])
        self._cells = [QRectF()] * count
        for column, members in enumerate(np.array_split(np.argsort(places[:, 0], kind="stable"), columns)):
            above = members[np.argsort(-places[members, 1], kind="stable")]
            for row, number in enumerate(above.tolist()):
                corner = QPointF(room.left() + column * width, room.top() + row * height)
                self._cells[number] = QRectF(corner.x(), corner.y(), width, height)

    def paintEvent(self, _: QPaintEvent) -> None:
        with QPainter(self) as painter:
            self._paint_all(painter)

    def _paint_all(self, painter: QPainter) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        font = painter.font()
        font.setPixelSize(11)
        painter.setFont(font)
        if not self._groups:
            painter.setPen(QColor(colours.TEXT_THIRD))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, NO_CLIPS_HINT)
        looked = self._under if self._under >= 0 else self._clicked
        if looked >= 0:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(colours.SELECTED_ROW))
            painter.drawRoundedRect(self._cells[looked].adjusted(1.0, 1.0, -1.0, -1.0), 5.0, 5.0)
        links = [
            (number == looked, number, other) for number, group in enumerate(self._groups) for other in group.links
        ]
        for strong, number, other in sorted(links):
            self._paint_link(painter, number, other, strong)
        near = set(self._groups[looked].links) if looked >= 0 else set()
        tallest = max((float(group.points[:, 2].max()) for group in self._groups), default=1.0)
        for number, group in enumerate(self._groups):
            self._paint_group(painter, group, self._cells[number], tallest, number == looked, number in near)

    def _paint_link(self, painter: QPainter, begin: int, end: int, strong: bool) -> None:
        colour = colours.SELECTED_CONTROL if strong else colours.CONTROL
        painter.setPen(QPen(QColor(colour), 1.6 if strong else 1.0))
        painter.drawLine(self._cells[begin].center(), self._cells[end].center())

    def _paint_group(
        self, painter: QPainter, group: PoseGroup, cell: QRectF, tallest: float, looked: bool, near: bool
    ) -> None:
        x, y = group.forward.tolist()
        turned = (FIGURE_FACING[0] * x - FIGURE_FACING[1] * y, FIGURE_FACING[1] * x + FIGURE_FACING[0] * y)
        figure = cell.adjusted(0.0, 0.0, 0.0, -FIGURE_CAPTION_PX)
        colour = colours.TEXT if looked or near else colours.TEXT_SECOND
        paint_sticks(painter, group.points, self._sticks, FigureView(turned, tallest), figure, colours.PANEL, 5.0)
        for side, hue in ((-1, colour), (1, colours.RIGHT), (0, colours.LEFT)):
            sticks = self._sticks[self._sides == side]
            paint_sticks(painter, group.points, sticks, FigureView(turned, tallest), figure, hue, 2.0)
            if side >= 0:
                self._paint_letters(
                    painter, FigureView(turned, tallest).projected(group.points, figure), sticks, "LR"[side], hue
                )
        painter.setPen(QColor(colours.TEXT if looked else colours.TEXT_THIRD))
        words = QRectF(cell.left(), cell.bottom() - FIGURE_CAPTION_PX, cell.width(), FIGURE_CAPTION_PX)
        painter.drawText(words, Qt.AlignmentFlag.AlignCenter, group.words)

    def _paint_letters(
        self, painter: QPainter, positions: FloatArray, sticks: NDArray[np.intp], letter: str, colour: str
    ) -> None:
        """Paint the letter of a side at the ends of its limbs, since colour alone is not enough to tell left from
        right.
        """
        ends = {end: begin for begin, end in sticks.tolist()}
        painter.save()
        font = painter.font()
        font.setPixelSize(LETTER_PX)
        font.setBold(True)
        painter.setFont(font)
        painter.setPen(QColor(colour))
        for end in ends.keys() - ends.values():
            along = positions[end] - positions[ends[end]]
            at = positions[end] + LETTER_AWAY_PX * along / max(float(np.hypot(*along)), 1e-9)
            box = QRectF(0.0, 0.0, 2.0 * LETTER_PX, 2.0 * LETTER_PX)
            box.moveCenter(QPointF(*at))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, letter)
        painter.restore()
