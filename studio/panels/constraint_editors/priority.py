"""Form section of priorities: a sortable list of the motion's constraints, of which neighbours may share a priority."""

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QAbstractItemView, QListWidget, QListWidgetItem

from studio.core.constraints.base import Constraint
from studio.core.constraints.objections import are_blended
from studio.core.errors import StudioError
from studio.document.priorities import put_priorities, shared_priorities, shared_priorities_after_move
from studio.panels.constraint_editors.target_rows import NumberRows
from studio.panels.editor import Editor
from studio.panels.fields import NumberField, Section, check_box

PRIORITY_ROW_PX = 30
CONSTRAINT_ID_ROLE = Qt.ItemDataRole.UserRole


class OrderList(QListWidget):
    """List whose rows are moved by dragging, or with Alt+Up and Alt+Down."""

    def keyPressEvent(self, event: QKeyEvent) -> None:
        steps = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}
        if event.modifiers() & Qt.KeyboardModifier.AltModifier and event.key() in steps:
            self.move_row(self.currentRow(), self.currentRow() + steps[Qt.Key(event.key())])
        else:
            super().keyPressEvent(event)

    def move_row(self, index: int, goal: int) -> None:
        """Move a row from ``index`` to ``goal``."""
        if 0 <= index < self.count() and 0 <= goal < self.count():
            parent = self.rootIndex()
            self.model().moveRow(parent, index, parent, goal + (1 if goal > index else 0))
            self.setCurrentRow(goal)


class PrioritySection(Section):
    """Form section of the order of priorities, highest first."""

    def __init__(self, editor: Editor[Constraint]) -> None:
        super().__init__("Priority")
        self._editor = editor
        self._list = OrderList()
        self._list.setObjectName("priority")
        self._list.setAccessibleName("Priority: highest first")
        self._list.setToolTip("Drag, or press Alt+Up or Alt+Down, to reorder. Higher priorities are solved first.")
        self._list.setDragDropMode(QAbstractItemView.DragDropMode.InternalMove)
        self._list.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.setUniformItemSizes(True)
        self._list.model().rowsMoved.connect(lambda *_: self._put_order())
        self.add_wide(self._list)
        self._tied = check_box("Same priority as above")
        self._tied.setObjectName("tie")
        self._tied.setToolTip("Same priority: if both cannot be met, the error is shared by weight.")
        self._tied.toggled.connect(self._tie)
        self.add_wide(self._tied)
        self._weight = editor.bind(NumberField("Weight (same priority)", "", 0.0, 10.0, 0.1, 2), self._set_weight)
        self._number = NumberRows(editor, self, "weight")
        self._weight_name = self.add_row("Weight", self._weight, self._number.keyed)

    def refresh(self) -> None:
        """Update the list."""
        project = self._editor.document.shown_project
        constraints = project.constraints_of(self._editor.entity.motion_id)
        places = project.places_of(self._editor.entity.motion_id)
        with QSignalBlocker(self._list), QSignalBlocker(self._list.model()):
            rows = [(key, f"{places[key]}   {each.name}") for key, each in constraints.items()]
            shown = [
                (self._list.item(k).data(CONSTRAINT_ID_ROLE), self._list.item(k).text())
                for k in range(self._list.count())
            ]
            if rows != shown:
                self._fill(rows)
        self._list.setFixedHeight(PRIORITY_ROW_PX * len(rows) + 2 * self._list.frameWidth())
        order = list(constraints)
        index = order.index(self._editor.entity_id)
        ties = shared_priorities(constraints, order)
        with QSignalBlocker(self._tied):
            self._tied.setChecked(ties[index])
        self._tied.setEnabled(index > 0)
        others = (each for key, each in constraints.items() if key != self._editor.entity_id)
        self._shows_weight = any(ties[index : index + 2]) or any(
            are_blended(self._editor.entity, each) for each in others
        )
        self.refresh_weight()

    def refresh_weight(self) -> None:
        """Update the weight, which may be keyed."""
        for widget in (self._weight_name, self._weight):
            widget.setVisible(self._shows_weight)
        self._number.refresh(self._shows_weight)
        self._weight.show_value(self._number.current_number)

    def _fill(self, rows: list[tuple[str, str]]) -> None:
        self._list.clear()
        for key, text in rows:
            item = QListWidgetItem(text)
            item.setData(CONSTRAINT_ID_ROLE, key)
            item.setSizeHint(QSize(0, PRIORITY_ROW_PX))
            self._list.addItem(item)
            if key == self._editor.entity_id:
                self._list.setCurrentItem(item)
        self._list.reset()
        self._list.setCurrentRow([key for key, _ in rows].index(self._editor.entity_id))

    def _put_order(self) -> None:
        order = [self._list.item(index).data(CONSTRAINT_ID_ROLE) for index in range(self._list.count())]
        constraints = self._editor.document.project.constraints
        before = list(self._editor.document.project.constraints_of(self._editor.entity.motion_id))
        current = self._list.currentItem()
        moved = _moved([current.data(CONSTRAINT_ID_ROLE)] if current else [], before, order) or self._editor.entity_id
        ties = shared_priorities_after_move(constraints, order, {moved})
        self._put_places(order, ties, f"Reorder priority of {constraints[moved].name}")

    def _tie(self, tied: bool) -> None:
        constraints = self._editor.document.project.constraints_of(self._editor.entity.motion_id)
        order = list(constraints)
        ties = shared_priorities(constraints, order)
        ties[order.index(self._editor.entity_id)] = tied
        self._put_places(order, ties, f"{'Share' if tied else 'Separate'} priority level of {self._editor.entity.name}")

    def _put_places(self, order: list[str], ties: list[bool], text: str) -> None:
        try:
            put_priorities(self._editor.document, order, ties, text)
        except StudioError as error:
            self._editor.document.problem_reported.emit(f"{error}")
            self.refresh()

    def _set_weight(self, weight: float) -> None:
        self._number.set_number(weight, f"Set weight of {self._editor.entity.name}")


def _moved(likely: list[str], before: list[str], after: list[str]) -> str | None:
    """Id of the row that was moved between the two orders; of two swapped neighbours, the one in ``likely``."""

    def without(order: list[str], moved: str) -> list[str]:
        return [key for key in order if key != moved]

    return next((key for key in (*likely, *before) if without(before, key) == without(after, key)), None)
