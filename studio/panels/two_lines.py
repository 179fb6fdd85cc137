"""List row with a name, and below it wrapped text."""

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem

from studio.document import colours
from studio.panels.fields import FIELD_ICON_PX

LINE_TOP_PX, LINE_GAP_PX, DETAIL_FONT_PX = 7, 2, 12
WRAPPED_TEXT = Qt.TextFlag.TextWordWrap
Index = QModelIndex | QPersistentModelIndex


class TwoLines(QStyledItemDelegate):
    """Delegate that paints the first line of an item's text as name, and the rest wrapped below it."""

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:
        """Size of the wrapped text in the width of the list."""
        return QSize(0, self._words(option, index, QRect(0, 0, option.rect.width(), 0)).bottom() + LINE_TOP_PX)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Paint background, name and text."""
        name, _, words = str(index.data()).partition("\n")
        hovered = option.state & QStyle.StateFlag.State_MouseOver
        if option.state & QStyle.StateFlag.State_Selected:
            painter.fillRect(option.rect, QColor(colours.SELECTED_ROW))
        elif hovered:
            painter.fillRect(option.rect, QColor(colours.BAR))
        painter.setFont(option.font)
        painter.setPen(QColor(colours.TEXT))
        painter.drawText(self._name(option, option.rect), Qt.AlignmentFlag.AlignLeft, name)
        painter.setFont(_small(option.font))
        painter.setPen(QColor(colours.TEXT_SECOND))
        painter.drawText(self._words(option, index, option.rect), WRAPPED_TEXT, words)

    def _name(self, option: QStyleOptionViewItem, row: QRect) -> QRect:
        height = option.fontMetrics.height()
        return QRect(row.left() + FIELD_ICON_PX, row.top() + LINE_TOP_PX, row.width() - 2 * FIELD_ICON_PX, height)

    def _words(self, option: QStyleOptionViewItem, index: Index, row: QRect) -> QRect:
        above, words = self._name(option, row), str(index.data()).partition("\n")[2]
        room = QRect(above.left(), above.bottom() + LINE_GAP_PX, above.width(), 1000)
        return QFontMetrics(_small(option.font)).boundingRect(room, int(WRAPPED_TEXT), words)


def _small(font: QFont) -> QFont:
    small = QFont(font)
    small.setPixelSize(DETAIL_FONT_PX)
    return small
