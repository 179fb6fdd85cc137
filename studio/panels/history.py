"""History panel: the list of undo steps; a click undoes or redoes up to a step."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QUndoStack
from PySide6.QtWidgets import QUndoView, QVBoxLayout, QWidget

from studio.panels.fields import FIELD_ICON_PX, styled_label


class History(QWidget):
    """List of all undo steps."""

    def __init__(self, undo_stack: QUndoStack) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 12, 0, 0)
        column.setSpacing(4)
        self.head = styled_label("History", "head")
        """Heading of the panel, shown while it has no title bar."""
        self.head.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        column.addWidget(self.head)
        self.view = QUndoView(undo_stack)
        self.view.setEmptyLabel("Opened")
        self.view.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.view.setAccessibleName("History of edits")
        column.addWidget(self.view)
