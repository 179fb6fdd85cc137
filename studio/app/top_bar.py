"""The bar at the top: name, menus, tools, the document, the search for actions."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenuBar, QPushButton, QSizePolicy, QToolButton, QWidget

from studio.app.action_set import ActionSet
from studio.document.document import Document

HEIGHT = 34
SEARCH_WIDTH = 232


class TopBar(QWidget):
    """One row that says what is open and holds every way in."""

    def __init__(self, document: Document, actions: ActionSet) -> None:
        super().__init__()
        self.setObjectName("top_bar")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setFixedHeight(HEIGHT)
        self._document = document
        row = QHBoxLayout(self)
        row.setContentsMargins(12, 0, 8, 0)
        row.setSpacing(4)
        product = QLabel("Morpho Studio")
        product.setObjectName("product")
        row.addWidget(product)
        self.menus = QMenuBar()
        self.menus.setNativeMenuBar(False)
        self.menus.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Fixed)
        actions.fill(self.menus)
        row.addWidget(self.menus)
        row.addSpacing(16)
        for action in actions.tools():
            button = QToolButton()
            button.setDefaultAction(action)
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            button.setAccessibleName(action.text())
            row.addWidget(button)
        row.addStretch(1)
        self._label = QLabel()
        self._label.setObjectName("document")
        row.addWidget(self._label)
        row.addSpacing(8)
        row.addWidget(_search_button(actions))

    def refresh(self, name: str, state: str) -> None:
        """Show which project is open and whether it is saved."""
        self._label.setText(f"{name} · {state}")


def _search_button(actions: ActionSet) -> QPushButton:
    button = QPushButton("Search actions")
    button.setObjectName("search")
    button.setAccessibleName("Search actions")
    button.setFixedWidth(SEARCH_WIDTH)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.clicked.connect(actions.by_id["palette"].trigger)
    keys = QLabel("Ctrl K", button)
    keys.setProperty("role", "hint")
    line = QHBoxLayout(button)
    line.setContentsMargins(0, 0, 8, 0)
    line.addStretch(1)
    line.addWidget(keys)
    return button
