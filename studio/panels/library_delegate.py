"""Painting of the rows of the library: thumbnail, mark, name, detail and eye."""

from pathlib import Path

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QIcon, QPainter
from PySide6.QtWidgets import QAbstractItemView, QStyle, QStyledItemDelegate, QStyleOptionViewItem

from studio.document import colours
from studio.panels.library_rows import SCENE_COLLECTIONS, LibraryRow
from studio.panels.thumbnails import Thumbnails
from studio.resources_folder import resources_folder

LIBRARY_ROW_ROLE = Qt.ItemDataRole.UserRole
LIBRARY_ROW_HEIGHT = 26
PICTURE_SIDE, PICTURE_ROW_HEIGHT = 36, 40
COLLECTIONS_WITH_PICTURE = ("captures", "characters", "performers", *SCENE_COLLECTIONS)
"""Collections whose rows have a thumbnail."""
LIBRARY_HEAD_HEIGHT_PX = 36
LIBRARY_MARK_PX = 12
MARK_SIZE_PX = 8
EYE_SIZE_PX = 16
EYE_COLUMN_PX = 32
HEAD_FONT_PIXELS = 11
DETAIL_FONT_PIXELS = 11
HINT_FONT_PIXELS = 12


class LibraryDelegate(QStyledItemDelegate):
    """Delegate that paints library rows; only characters and constraint kinds are coloured."""

    def __init__(self, view: QAbstractItemView, thumbnails: Thumbnails) -> None:
        super().__init__(view)
        self._view, self._thumbnails = view, thumbnails
        thumbnails.drawn.connect(view.viewport().update)
        icons = resources_folder() / "icons"
        self._eye = _icon(icons / "eye.svg")
        self._closed_eye = _icon(icons / "eye_closed.svg")

    def sizeHint(self, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex) -> QSize:
        row: LibraryRow = index.data(LIBRARY_ROW_ROLE)
        if row.hint:
            width = self._view.viewport().width() - 2 * LIBRARY_MARK_PX
            room = QFontMetrics(_sized(option.font, HINT_FONT_PIXELS)).boundingRect(
                QRect(0, 0, max(width, 1), 0), Qt.TextFlag.TextWordWrap, row.text
            )
            return QSize(0, max(room.height() + 8, LIBRARY_ROW_HEIGHT))
        if row.item is None:
            return QSize(0, LIBRARY_HEAD_HEIGHT_PX)
        return QSize(0, PICTURE_ROW_HEIGHT if row.item[0] in COLLECTIONS_WITH_PICTURE else LIBRARY_ROW_HEIGHT)

    def paint(
        self, painter: QPainter, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        row: LibraryRow = index.data(LIBRARY_ROW_ROLE)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if row.item is None:
            self._paint_head(painter, option.rect, option.font, row)
        else:
            self._paint_ground(painter, option)
            self._paint_row(painter, option.rect, option.font, row)
        painter.restore()

    def _paint_head(self, painter: QPainter, rect: QRect, font: QFont, row: LibraryRow) -> None:
        painter.setPen(QColor(colours.TEXT_THIRD))
        place = rect.adjusted(LIBRARY_MARK_PX, 0, -LIBRARY_MARK_PX, 0)
        if row.hint:
            painter.setFont(_sized(font, HINT_FONT_PIXELS))
            flags = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap
            painter.drawText(place, flags, row.text)
            return
        head = _sized(font, HEAD_FONT_PIXELS)
        head.setWeight(QFont.Weight.DemiBold)
        head.setLetterSpacing(QFont.SpacingType.PercentageSpacing, 106)
        painter.setFont(head)
        place.adjust(0, 12, 0, 0)
        painter.drawText(place, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, row.text.upper())

    def _paint_ground(self, painter: QPainter, option: QStyleOptionViewItem) -> None:
        state = QStyle.StateFlag
        if option.state & state.State_Selected:
            painter.fillRect(option.rect, QColor(colours.SELECTED_ROW))
        elif option.state & state.State_MouseOver:
            painter.fillRect(option.rect, QColor(colours.BAR))
        if option.state & state.State_HasFocus:
            painter.fillRect(
                QRect(option.rect.left(), option.rect.top(), 2, option.rect.height()),
                QColor(colours.KIND_COLOURS["position"]),
            )

    def _paint_row(self, painter: QPainter, rect: QRect, font: QFont, row: LibraryRow) -> None:
        left, right = rect.left() + LIBRARY_MARK_PX, rect.right() - LIBRARY_MARK_PX
        hidden = row.shown is False
        pictured = row.item is not None and row.item[0] in COLLECTIONS_WITH_PICTURE
        if row.item is not None and pictured:
            picture = self._thumbnails.of(*row.item)
            if picture is not None:
                painter.setOpacity(0.5 if hidden else 1.0)
                painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
                painter.drawPixmap(QRect(left, rect.top() + 2, PICTURE_SIDE, PICTURE_SIDE), picture)
                painter.setOpacity(1.0)
            left += PICTURE_SIDE + 8
        if row.colour is not None:
            left += self._paint_mark(painter, left, rect.center().y(), row, hidden)
        if row.shown is not None:
            eye = self._closed_eye if hidden else self._eye
            eye.paint(
                painter,
                QRect(right - EYE_SIZE_PX + 2, rect.center().y() - EYE_SIZE_PX // 2 + 1, EYE_SIZE_PX, EYE_SIZE_PX),
            )
            right -= EYE_SIZE_PX + 6
        lines = QRect(left, rect.top(), right - left, rect.height())
        if pictured:
            upper, lower = lines.adjusted(0, 3, 0, -lines.height() // 2), lines.adjusted(0, lines.height() // 2, 0, -3)
            aligned = Qt.AlignmentFlag.AlignLeft
        else:
            upper = lower = lines
            aligned = Qt.AlignmentFlag.AlignRight
        painter.setFont(_sized(font, DETAIL_FONT_PIXELS))
        painter.setPen(QColor(colours.TEXT_THIRD))
        detail = painter.fontMetrics().elidedText(row.detail, Qt.TextElideMode.ElideRight, lower.width())
        painter.drawText(lower, Qt.AlignmentFlag.AlignVCenter | aligned, detail)
        if not pictured:
            upper = upper.adjusted(0, 0, -painter.fontMetrics().horizontalAdvance(row.detail) - 8, 0)
        name = QFont(font)
        name.setWeight(QFont.Weight.DemiBold if row.strong else QFont.Weight.Normal)
        painter.setFont(name)
        painter.setPen(QColor(colours.TEXT_THIRD if hidden else colours.TEXT))
        text = painter.fontMetrics().elidedText(row.text, Qt.TextElideMode.ElideMiddle, upper.width())
        painter.drawText(upper, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, text)

    def _paint_mark(self, painter: QPainter, left: int, middle: int, row: LibraryRow, hidden: bool) -> int:
        colour = QColor(row.colour)
        painter.setPen(colour if hidden else Qt.PenStyle.NoPen)
        painter.setBrush(Qt.BrushStyle.NoBrush if hidden else colour)
        mark = QRectF(left + 0.5, middle - MARK_SIZE_PX / 2 + 0.5, MARK_SIZE_PX, MARK_SIZE_PX)
        if row.round_mark:
            painter.drawEllipse(mark)
        else:
            painter.drawRoundedRect(mark, 2, 2)
        return MARK_SIZE_PX + 8


def _icon(file: Path) -> QIcon:
    return QIcon(str(file))


def _sized(font: QFont, pixels: int) -> QFont:
    sized = QFont(font)
    sized.setPixelSize(pixels)
    return sized
