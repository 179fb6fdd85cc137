"""Strikes: a search of the motion library for one that hits a prop, ranked with reasons."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from studio.document.document import Document
from studio.panels.fields import SIDE, Choice, Section, labelled, press_button

ROW_HEIGHT = 64
"""Pixels of a name and two lines of reasons."""
ANY = "Any"
EMPTY = "No clips yet. Add a folder of captures: strikes are found in them by themselves."
READY = "Choose a box as the target and press Find. Double-click a strike to play it from the playhead on."
NOTHING = "No clip of the library is of that limb and kind."
NO_TARGET = "Add a box first (Constraint > Add box) and put it where the strike is to hit."


class Strikes(QWidget):
    """The dock's content. ``wanted`` asks to search, ``chosen`` to play the result of that place."""

    folder_wanted = Signal()
    wanted = Signal()
    chosen = Signal(int)

    def __init__(self, document: Document, limbs: Iterable[tuple[object, str]], kinds: Iterable[tuple[object, str]]):
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.document = document
        section = Section("A strike that hits here")
        self.target = Choice("Target", ())
        self.limb, self.kind = Choice("Limb", ((None, ANY), *limbs)), Choice("Kind", ((None, ANY), *kinds))
        for name, field in (("Target", self.target), ("Limb", self.limb), ("Kind", self.kind)):
            section.add_row(name, field)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 4)
        column.addWidget(section)
        column.addLayout(self._buttons())
        self.hint = labelled(EMPTY, "hint")
        self.hint.setContentsMargins(SIDE, 0, SIDE, 0)
        column.addWidget(self.hint)
        self.results = QListWidget()
        self.results.setAccessibleName("Strikes found, the best first")
        self.results.setWordWrap(True)
        self.results.setTextElideMode(Qt.TextElideMode.ElideNone)
        self.results.itemActivated.connect(lambda item: self.chosen.emit(self.results.row(item)))
        column.addWidget(self.results, 1)
        document.entity_changed.connect(lambda collection, _: self.refresh() if collection == "props" else None)
        document.project_opened.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Fetch the props that can be a target; the chosen one stays."""
        before = self.target_id
        props = self.document.project.props
        self.target.clear_all()
        for key, prop in props.items():
            self.target.add(key, prop.name)
        if before is not None and before in props:
            self.target.setCurrentIndex(list(props).index(before))

    @property
    def target_id(self) -> str | None:
        """The prop that is to be hit; None where there is none."""
        return str(self.target.value) if self.target.count() else None

    def show_results(self, results: Sequence[tuple[str, str]], hint: str) -> None:
        """List (name, reasons), the best first."""
        self.results.clear()
        for name, reasons in results:
            item = QListWidgetItem(f"{name}\n{reasons}")
            item.setSizeHint(QSize(0, ROW_HEIGHT))
            item.setToolTip("Double-click to play it from the playhead on, driven to the target")
            self.results.addItem(item)
        self.hint.setText(hint)

    def _buttons(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(SIDE, 4, SIDE, 4)
        for text, signal in (("Add folder…", self.folder_wanted), ("Find", self.wanted)):
            row.addWidget(press_button(text, signal.emit))
        return row
