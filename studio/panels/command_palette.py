"""Command palette, which finds actions by a few letters of their names, and the list of all shortcuts."""

import re
from collections.abc import Iterable, Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt
from PySide6.QtGui import QAction, QColor, QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLineEdit,
    QScrollArea,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from studio.document import colours
from studio.panels.fields import room_on_screen, styled_label

PALETTE_WIDTH, MAX_PALETTE_ROWS, PALETTE_ROW_PX = 480, 12, 28
SCROLL_BAR_PX = 12
ACTION_ROLE = Qt.ItemDataRole.UserRole
ROW_STEPS = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}
PALETTE_KEYS = {*ROW_STEPS, Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Escape}
"""Keys that the palette handles itself; other keys go to the text field."""


def plain_text(action: QAction) -> str:
    """Text of an action without mnemonic mark and ellipsis."""
    return re.sub("&(.)", r"\1", action.text()).removesuffix("…")


def lasting_text(action: QAction) -> str:
    """Constant name of an action, without the changing part of its text: ``Undo`` for ``Undo move target``."""
    return str(action.property("name") or plain_text(action)).removesuffix("…")


def shortcut_text(action: QAction) -> str:
    """First shortcut of an action in the notation of the platform; empty without one."""
    return action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)


def detail_text(action: QAction) -> str:
    """Text at the right of an action's row: its ``data`` if set, else its shortcut."""
    return str(action.data() or shortcut_text(action))


def ranked_actions(actions: Iterable[QAction], words: str) -> list[QAction]:
    """Actions that match ``words``: those whose text contains them, earliest position first; then by tooltip; then
    those whose text has all letters in order.
    """
    wanted = words.casefold().strip()
    found = []
    for index, action in enumerate(actions):
        text = plain_text(action).casefold()
        if wanted in text:
            found.append((0, text.index(wanted), index, action))
        elif wanted in action.toolTip().casefold():
            found.append((1, 0, index, action))
        elif _in_order(wanted.replace(" ", ""), text):
            found.append((2, 0, index, action))
    return [action for *_, action in sorted(found, key=lambda each: each[:3])]


def _in_order(letters: str, text: str) -> bool:
    rest = iter(text)
    return all(letter in rest for letter in letters)


class CommandPalette(QFrame):
    """Palette at the top of the window; it closes with Esc or when it loses the focus."""

    def __init__(self, window: QWidget, actions: Sequence[QAction]) -> None:
        super().__init__(window)
        self.setObjectName("command_palette")
        self._window, self._actions = window, actions
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
        """Show the palette with the focus in its text field."""
        self.field.clear()
        self._find("")
        self.move((self._window.width() - PALETTE_WIDTH) // 2, 52)
        self.show()
        self.raise_()
        self.field.setFocus()

    def offer(self, title: str, actions: Sequence[QAction]) -> None:
        """Show ``actions`` as choices under a title, instead of the window's actions."""
        for action in self._actions:
            action.deleteLater()
        self._actions = actions
        self.field.setPlaceholderText(title)
        self.field.setAccessibleName(title)
        self.open()

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Move through the list with the arrow keys, run the current row with Return, close with Esc."""
        if event.type() == QEvent.Type.FocusOut:
            self.hide()
        if not isinstance(event, QKeyEvent):
            return False
        if event.type() == QEvent.Type.ShortcutOverride and event.key() in PALETTE_KEYS:
            event.accept()  # arrows are shortcuts of the timeline everywhere else
            return True
        return event.type() == QEvent.Type.KeyPress and self._key(event.key())

    def _key(self, key: int) -> bool:
        if key in ROW_STEPS:
            self._walk(ROW_STEPS[Qt.Key(key)])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._run(self.list.currentItem())
        elif key == Qt.Key.Key_Escape:
            self._leave()
        else:
            return False
        return True

    def _walk(self, step: int) -> None:
        count = self.list.topLevelItemCount()
        here = self.list.currentItem()
        if here is not None:
            self._go_to((self.list.indexOfTopLevelItem(here) + step) % count)

    def _go_to(self, index: int) -> None:
        item = self.list.topLevelItem(index)
        if item is not None:
            self.list.setCurrentItem(item)

    def _find(self, words: str) -> None:
        self.list.clear()
        for action in ranked_actions(self._actions, words):
            item = QTreeWidgetItem([plain_text(action), detail_text(action)])
            item.setData(0, ACTION_ROLE, action)
            item.setForeground(1, QColor(colours.TEXT_SECOND))
            item.setTextAlignment(1, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            item.setDisabled(not action.isEnabled())
            self.list.addTopLevelItem(item)
        if not self.list.topLevelItemCount():
            item = QTreeWidgetItem([f"Nothing matches “{words.strip()}”" if words.strip() else "Nothing to choose", ""])
            item.setDisabled(True)
            self.list.addTopLevelItem(item)
        self._go_to(0)
        rows = min(max(self.list.topLevelItemCount(), 1), MAX_PALETTE_ROWS)
        self.resize(PALETTE_WIDTH, 48 + rows * PALETTE_ROW_PX)

    def _leave(self) -> None:
        self.hide()
        self._window.setFocus()

    def _run(self, item: QTreeWidgetItem | None) -> None:
        action = item.data(0, ACTION_ROLE) if item is not None else None
        self._leave()
        if action is not None:
            action.trigger()


class ShortcutSheet(QDialog):
    """Non-modal dialog of all shortcuts by menu, in two columns."""

    def __init__(self, window: QWidget, menus: dict[str, list[QAction]]) -> None:
        super().__init__(window)
        self.setObjectName("shortcut_sheet")
        self.setWindowTitle("Shortcuts")
        content = QWidget()
        content.setObjectName("panel")
        row = QHBoxLayout(content)
        row.setContentsMargins(24, 12, 24, 24)
        row.setSpacing(48)
        named = {menu: [each for each in actions if not each.shortcut().isEmpty()] for menu, actions in menus.items()}
        for part in _halves(named):
            row.addLayout(_sheet_column({menu: named[menu] for menu in part}), 1)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setWidget(content)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(area)
        wanted = content.sizeHint() + QSize(2, 2)
        room = room_on_screen(window)
        self.resize(wanted.boundedTo(room) + QSize(SCROLL_BAR_PX if wanted.height() > room.height() else 0, 0))


def _halves(menus: dict[str, list[QAction]]) -> tuple[list[str], list[str]]:
    """Names of the menus, in order, for two columns of about equal height."""
    names = [menu for menu, actions in menus.items() if actions]
    heights = [len(menus[menu]) + 2 for menu in names]
    at = min(range(len(names) + 1), key=lambda k: max(sum(heights[:k]), sum(heights[k:])))
    return names[:at], names[at:]


def _sheet_column(menus: dict[str, list[QAction]]) -> QGridLayout:
    grid = QGridLayout()
    grid.setHorizontalSpacing(16)
    grid.setVerticalSpacing(6)
    for menu, actions in menus.items():
        head = styled_label(menu, "head")
        head.setContentsMargins(0, 12, 0, 0)
        grid.addWidget(head, grid.rowCount(), 0)
        for action in actions:
            line = grid.rowCount()
            grid.addWidget(styled_label(lasting_text(action), ""), line, 0)
            grid.addWidget(styled_label("  ".join(_keys(action)), "second"), line, 1)
    grid.setRowStretch(grid.rowCount(), 1)
    return grid


def _keys(action: QAction) -> list[str]:
    return [each.toString(QKeySequence.SequenceFormat.NativeText) for each in action.shortcuts()]
