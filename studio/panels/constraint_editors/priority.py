"""Priorities as an order: the list of the motion's constraints, to be dragged."""

from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QAbstractItemView, QListWidget, QListWidgetItem

from studio.panels.editor import Editor
from studio.panels.fields import Section

ROW = 30
ID = Qt.ItemDataRole.UserRole


class OrderList(QListWidget):
    """Rows that the mouse drags, and Alt with the arrow keys moves."""

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}
        if event.modifiers() & Qt.KeyboardModifier.AltModifier and event.key() in steps:
            self.move_row(self.currentRow(), self.currentRow() + steps[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def move_row(self, place: int, goal: int) -> None:
        """Put a row elsewhere, as a drag would."""
        if 0 <= place < self.count() and 0 <= goal < self.count():
            parent = self.rootIndex()
            self.model().moveRow(parent, place, parent, goal + (1 if goal > place else 0))
            self.setCurrentRow(goal)


class PrioritySection(Section):
    """The first is kept exactly before anything is spent on the second."""

    def __init__(self, editor: Editor) -> None:
        super().__init__("Priority")
        self._editor = editor
        self._list = OrderList()
        self._list.setObjectName("priority")
        self._list.setAccessibleName("Priority: highest first")
        self._list.setToolTip("Drag to reorder, or Alt+Up and Alt+Down. A higher one is kept before a lower one.")
        self._list.setDragDropMode(QAbstractItemView.DragDropMode.InternalMove)
        self._list.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.setUniformItemSizes(True)
        self._list.model().rowsMoved.connect(lambda *_: self._put_order())
        self.add_wide(self._list)

    def refresh(self) -> None:
        """Fetch the order."""
        constraints = self._editor.document.project.constraints_of(self._editor.entity.motion_id)
        with QSignalBlocker(self._list), QSignalBlocker(self._list.model()):
            rows = [(key, f"{place}   {each.name}") for place, (key, each) in enumerate(constraints.items(), 1)]
            shown = [(self._list.item(k).data(ID), self._list.item(k).text()) for k in range(self._list.count())]
            if rows != shown:
                self._fill(rows)
        self._list.setFixedHeight(ROW * len(rows))

    def _fill(self, rows: list[tuple[str, str]]) -> None:
        self._list.clear()
        for key, text in rows:
            item = QListWidgetItem(text)
            item.setData(ID, key)
            item.setSizeHint(QSize(0, ROW))
            self._list.addItem(item)
            if key == self._editor.entity_id:
                self._list.setCurrentItem(item)
        self._list.reset()
        self._list.setCurrentRow([key for key, _ in rows].index(self._editor.entity_id))

    def _put_order(self) -> None:
        document = self._editor.document
        order = [self._list.item(place).data(ID) for place in range(self._list.count())]
        with document.group(f"Reorder priority of {self._editor.entity.name}"):
            for priority, key in enumerate(order):
                constraint = document.project.constraints[key]
                document.replace("constraints", key, replace(constraint, priority=priority), "Reorder")
