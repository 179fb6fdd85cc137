"""Top bar: program name, menus, tools, project name, and the search for actions."""

from dataclasses import dataclass

import qtawesome
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAction, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenuBar, QPushButton, QSizePolicy, QToolButton, QWidget

from studio.app.action_set import ActionSet
from studio.document import colours
from studio.document.document import Document

TOP_BAR_HEIGHT = 34
SEARCH_WIDTH_PX, MIN_SEARCH_WIDTH_PX = 232, 64
SHORTCUT_FROM_WIDTH_PX = 180
"""Width in pixels of the search field from which its shortcut is shown beside its text."""
PRODUCT_NAME_FROM_WIDTH_PX = 1100


@dataclass(frozen=True)
class ToolButton:
    """Tool in the bar: its present key and its name, such as ``Q select``, or the key alone if space is short."""

    button: QToolButton
    action: QAction
    name: str

    def shorten(self, short: bool) -> None:
        """Show the key alone, or the whole text; a tool without a key always has its name."""
        key = self.action.shortcut().toString()
        words = key if short and key else f"{key} {self.name}".strip()
        if self.action.iconText() != words:
            self.action.setIconText(words)
            self.button.setText(words)  # now, and not with the next event: its width is asked at once


class TopBar(QWidget):
    """Bar with the project name, menus and tools."""

    def __init__(self, document: Document, actions: ActionSet) -> None:
        super().__init__()
        self.setObjectName("top_bar")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setFixedHeight(TOP_BAR_HEIGHT)
        self._document = document
        row = self._row = QHBoxLayout(self)
        row.setContentsMargins(12, 0, 8, 0)
        row.setSpacing(4)
        self._product = QLabel("Morpho Studio")
        self._product.setObjectName("product")
        row.addWidget(self._product)
        self.menus = QMenuBar()
        self.menus.setNativeMenuBar(False)
        self.menus.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        actions.fill(self.menus)
        more = self.menus.findChild(QToolButton, "qt_menubar_ext_button")
        if more is not None:  # as narrow as Qt makes it, with a mark that the theme shows
            more.setIcon(qtawesome.icon("mdi6.chevron-double-right", color=colours.TEXT))
            more.setIconSize(QSize(12, 12))
            more.setStyleSheet("padding: 0; border: none")
            more.setToolTip("More menus")
        row.addWidget(self.menus)
        row.addSpacing(16)
        self._tools: list[ToolButton] = []
        for action in actions.tools():
            button = QToolButton()
            self._tools.append(ToolButton(button, action, action.iconText()))
            button.setDefaultAction(action)
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            button.setAccessibleName(action.text())
            row.addWidget(button)
        row.addStretch(1)
        self._label = QLabel()
        self._label.setObjectName("document")
        row.addWidget(self._label)
        row.addSpacing(8)
        self._search, self._keys = _search_button(actions)
        row.addWidget(self._search)
        actions.keys_changed.connect(self._fit)

    def refresh(self, name: str, state: str) -> None:
        """Show the name of the project and if it is saved."""
        words = f"{name} · {state}"
        if self._label.text() != words:
            self._label.setText(words)
            self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Hide parts of a narrow bar in this order: program name, search, texts of tools, project name, tools; never
        the menus.
        """
        super().resizeEvent(event)
        self._fit()

    def showEvent(self, event: QShowEvent) -> None:
        """Fit the parts again, since texts get the theme's sizes only when they are shown."""
        super().showEvent(event)
        self._fit()

    def _fit(self) -> None:
        self._product.setVisible(self.width() >= PRODUCT_NAME_FROM_WIDTH_PX)
        for short, named, tools in ((False, True, True), (True, True, True), (True, False, True), (True, False, False)):
            for tool in self._tools:
                tool.shorten(short)
                tool.button.setVisible(tools)  # the menu View has them, and keys choose them
            self._label.setVisible(named)  # the title of the window says it as well
            if (room := self._room()) >= MIN_SEARCH_WIDTH_PX:
                break
        self._search.setFixedWidth(min(max(room, MIN_SEARCH_WIDTH_PX), SEARCH_WIDTH_PX))
        self._keys.setVisible(room >= SHORTCUT_FROM_WIDTH_PX)
        self._row.activate()  # now: the next event may be seconds away as the 3D view starts

    def _room(self) -> int:
        """Pixels that remain for the search field."""
        others = (self._row.itemAt(index) for index in range(self._row.count() - 1))
        taken = sum(item.sizeHint().width() + self._row.spacing() for item in others if item is not None)
        margins = self._row.contentsMargins()
        return self.width() - taken - margins.left() - margins.right()


def _search_button(actions: ActionSet) -> tuple[QPushButton, QLabel]:
    button = QPushButton("Search actions")
    button.setObjectName("search")
    button.setAccessibleName("Search actions")
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.clicked.connect(actions.by_id["palette"].trigger)
    keys = QLabel("Ctrl K", button)
    keys.setProperty("role", "hint")
    line = QHBoxLayout(button)
    line.setContentsMargins(0, 0, 8, 0)
    line.addStretch(1)
    line.addWidget(keys)
    return button, keys
