"""Strikes: a search of the motion library for one that hits a prop, ranked with reasons."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtGui import QHideEvent
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QSizePolicy, QVBoxLayout, QWidget

from studio.document.document import Document
from studio.panels.fields import SIDE, Choice, Section, labelled, press_button

ROW_HEIGHT = 64
"""Pixels of a name and two lines of reasons."""
ANY = "Any"
EMPTY = "No clips yet. Add a folder of captures: strikes are found in them by themselves."
READY = "Point at a strike to see it in the 3D view. Use it, or double-click it, to play it from the playhead on."
NOTHING = "No clip of the library is of that limb and kind."
NO_TARGET = "Add a box first (Constraint > Add box) and put it where the strike is to hit."


class Strikes(QWidget):
    """The dock's content. ``wanted`` asks to search, ``chosen`` to play the result of that place, ``looked_at`` tells
    that the mouse is over it or the keys are at it; -1 when over none.
    """

    folder_wanted = Signal()
    wanted = Signal()
    chosen = Signal(int)
    looked_at = Signal(int)

    def __init__(self, document: Document, limbs: Iterable[tuple[object, str]], kinds: Iterable[tuple[object, str]]):
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.document = document
        self._looked = -1
        section = Section("A strike that hits here")
        self.target = Choice("Target", ())
        self.limb, self.kind = Choice("Limb", ((None, ANY), *limbs)), Choice("Kind", ((None, ANY), *kinds))
        for name, field in (("Target", self.target), ("Limb", self.limb), ("Kind", self.kind)):
            section.add_row(name, field)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 4)
        section.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)  # rows do not overlap
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
        self.results.setMouseTracking(True)
        self.results.itemEntered.connect(lambda item: self._look(self.results.row(item)))
        self.results.viewportEntered.connect(lambda: self._look(-1))
        self.results.currentRowChanged.connect(self._current_changed)
        self.results.viewport().installEventFilter(self)
        column.addWidget(self.results, 1)
        self.use = press_button("Use on the selected performer", lambda: self.chosen.emit(self.results.currentRow()))
        self.use.setToolTip("Play it from the playhead on, blended in, on this body, driven to the target")
        self.use.setEnabled(False)
        below = QHBoxLayout()
        below.setContentsMargins(SIDE, 4, SIDE, 0)
        below.addWidget(self.use)
        column.addLayout(below)
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
        self._look(-1)
        self.results.clear()
        for name, reasons in results:
            item = QListWidgetItem(f"{name}\n{reasons}")
            item.setSizeHint(QSize(0, ROW_HEIGHT))
            item.setToolTip("Double-click to play it from the playhead on, driven to the target")
            self.results.addItem(item)
        self.hint.setText(hint)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """The mouse leaves the results: none is looked at any more."""
        if event.type() == QEvent.Type.Leave:
            self._look(-1)
        return super().eventFilter(watched, event)

    def hideEvent(self, event: QHideEvent) -> None:
        """What is not seen is not looked at."""
        self._look(-1)
        super().hideEvent(event)

    def _look(self, row: int) -> None:
        if row != self._looked:
            self._looked = row
            self.looked_at.emit(row)

    def _current_changed(self, row: int) -> None:
        self.use.setEnabled(row >= 0)
        self._look(row)

    def _buttons(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(SIDE, 4, SIDE, 4)
        for text, signal in (("Add folder…", self.folder_wanted), ("Find", self.wanted)):
            row.addWidget(press_button(text, signal.emit))
        return row
