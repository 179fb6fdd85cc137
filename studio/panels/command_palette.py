"""Command palette: every action by a few letters of its name. And the sheet of all shortcuts."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QAction, QColor, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QFrame,
    QGridLayout,
    QHeaderView,
    QLineEdit,
    QScrollArea,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from studio.document import colours
from studio.panels.fields import labelled

WIDTH, MOST_ROWS, ROW = 480, 12, 28
ACTION = Qt.ItemDataRole.UserRole


def plain_text(action: QAction) -> str:
    """What it is called, without the mark of its mnemonic or its dots."""
    return action.text().replace("&", "").removesuffix("…")


def shortcut_text(action: QAction) -> str:
    """Its first shortcut as the user's keyboard says it."""
    return action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)


def ranked(actions: Iterable[QAction], words: str) -> list[QAction]:
    """Actions that hold all letters of ``words`` in order: those where they stand together, and early, first."""
    wanted = words.casefold().strip()
    found = []
    for place, action in enumerate(actions):
        text = plain_text(action).casefold()
        if wanted in text:
            found.append((0, text.index(wanted), place, action))
        elif _in_order(wanted.replace(" ", ""), text):
            found.append((1, 0, place, action))
    return [action for *_, action in sorted(found, key=lambda each: each[:3])]


def _in_order(letters: str, text: str) -> bool:
    rest = iter(text)
    return all(letter in rest for letter in letters)


class CommandPalette(QFrame):
    """Opens over the window's top, closes with Esc or when it loses the keyboard."""

    def __init__(self, window: QWidget, actions: Sequence[QAction]) -> None:
        super().__init__(window)
        self.setObjectName("command_palette")
        self._actions = actions
        self.field = QLineEdit()
        self.field.setPlaceholderText("Search actions")
        self.field.setAccessibleName("Search actions")
        self.list = QTreeWidget()
        self.list.setColumnCount(2)
        self.list.setHeaderHidden(True)
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.header().setStretchLastSection(False)
        self.list.header().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.list.header().setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.list.setAccessibleName("Found actions")
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        column = QVBoxLayout(self)
        column.setContentsMargins(4, 4, 4, 4)
        column.setSpacing(4)
        column.addWidget(self.field)
        column.addWidget(self.list)
        self.field.textChanged.connect(self._find)
        self.field.installEventFilter(self)
        self.list.itemClicked.connect(self._run)
        self.hide()

    def open(self) -> None:
        """Show it, ready to type."""
        window = self.parentWidget()
        self.field.clear()
        self._find("")
        self.move((window.width() - WIDTH) // 2, 52)
        self.show()
        self.raise_()
        self.field.setFocus()

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Arrow keys walk, Return runs, Esc closes."""
        if event.type() == QEvent.Type.FocusOut:
            self.hide()
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress:
            return self._key(event.key())
        return False

    def _key(self, key: int) -> bool:
        steps = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}
        if key in steps:
            self._walk(steps[Qt.Key(key)])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._run(self.list.currentItem())
        elif key == Qt.Key.Key_Escape:
            self._leave()
        else:
            return False
        return True

    def _walk(self, step: int) -> None:
        count = self.list.topLevelItemCount()
        if count:
            place = self.list.indexOfTopLevelItem(self.list.currentItem())
            self.list.setCurrentItem(self.list.topLevelItem((place + step) % count))

    def _find(self, words: str) -> None:
        self.list.clear()
        for action in ranked(self._actions, words):
            item = QTreeWidgetItem([plain_text(action), shortcut_text(action)])
            item.setData(0, ACTION, action)
            item.setForeground(1, QColor(colours.TEXT_SECOND))
            item.setTextAlignment(1, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            item.setDisabled(not action.isEnabled())
            self.list.addTopLevelItem(item)
        self.list.setCurrentItem(self.list.topLevelItem(0))
        rows = min(max(self.list.topLevelItemCount(), 1), MOST_ROWS)
        self.resize(WIDTH, 48 + rows * ROW)

    def _leave(self) -> None:
        self.hide()
        self.parentWidget().setFocus()

    def _run(self, item: QTreeWidgetItem | None) -> None:
        action = item.data(0, ACTION) if item is not None else None
        self._leave()
        if action is not None:
            action.trigger()


class ShortcutSheet(QDialog):
    """All shortcuts by menu, in columns; not modal."""

    def __init__(self, window: QWidget, menus: dict[str, list[QAction]]) -> None:
        super().__init__(window)
        self.setObjectName("shortcut_sheet")
        self.setWindowTitle("Shortcuts")
        content = QWidget()
        content.setObjectName("panel")
        grid = QGridLayout(content)
        grid.setContentsMargins(24, 16, 24, 24)
        grid.setHorizontalSpacing(24)
        grid.setVerticalSpacing(6)
        for place, (menu, actions) in enumerate(menus.items()):
            column, row = 2 * (place % 2), 30 * (place // 2)
            grid.addWidget(labelled(menu, "head"), row, column)
            for line, action in enumerate((a for a in actions if not a.shortcut().isEmpty()), row + 1):
                grid.addWidget(labelled(plain_text(action), ""), line, column)
                keys = ", ".join(each.toString(QKeySequence.SequenceFormat.NativeText) for each in action.shortcuts())
                grid.addWidget(labelled(keys, "second"), line, column + 1)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setWidget(content)
        column_layout = QVBoxLayout(self)
        column_layout.setContentsMargins(0, 0, 0, 0)
        column_layout.addWidget(area)
        self.resize(720, 640)
