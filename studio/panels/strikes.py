"""Strikes panel: clips of the motion library that hit a target, ranked with reasons."""

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QEvent, QMimeData, QObject, Qt, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QListWidget, QListWidgetItem, QSizePolicy, QVBoxLayout, QWidget

from studio.document.dragging import STRIKE_MIME, row_drag_data
from studio.panels.fields import FIELD_ICON_PX, Choice, Section, Segments, press_button, styled_label
from studio.panels.two_lines import TwoLines

NO_TARGET_CHOICE = "None (list all strikes)"
NO_STRIKES_HINT = "No clips yet. Add a folder of captures: strikes are found in them automatically."
READY_HINT = "Hover to preview a strike. Drag it onto a character or a track, or insert it at the playhead."
EVALUATING_HINT = "Ranking strikes on this stage…"
NO_MATCH_HINT = "No clip in the motion library matches that limb and type."
POSE_CLIPS_HINT = "Clips that contain the selected pose, best match first."
INSERT_TIP = "Insert the strike at the playhead, blended in and constrained to the target"
TARGET_NEEDED_TIP = "Choose a target first: a strike is inserted so that it meets it"
UNSOLVED_HINT = "All strikes of the motion library. Ranking starts when this character and its target are solved."
OWN_FACE_HINT = "All strikes of the motion library. A character cannot target its own face: choose another target."
NO_TARGET_HINT = "All strikes of the motion library. Choose a target, a box or a face, to rank them."


class Strikes(QWidget):
    """Content of the Strikes panel.

    ``search_requested`` requests a search, ``strike_chosen`` the insertion of a result by its index, ``opened`` its
    label; ``strike_highlighted`` carries the result under the mouse or with the focus, -1 for none.
    """

    folder_requested = Signal()
    search_requested = Signal()
    strike_chosen = Signal(int)
    opened = Signal(int)
    strike_highlighted = Signal(int)
    shown = Signal()

    def __init__(self, limbs: Iterable[tuple[object, str]], kinds: Iterable[tuple[object, str]]) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._looked, self._usable = -1, False
        section = Section("Target of the strike")
        self.target = Choice("Target", ((None, NO_TARGET_CHOICE),))
        self.aim = Segments("Aim", ((True, "Moving target"), (False, "Position at search")))
        self.aim.setToolTip("Meet the target where it is at the hit frame, or where it was at the search")
        self.aim.value_chosen.connect(self._choose_aim)
        self.aim.value_chosen.connect(lambda _: self.search_requested.emit())
        self.follows = True
        """True if a strike follows its target until the hit, False if it aims at the target's present position."""
        self.aim.show_value(True)
        self.limb, self.kind = (
            Choice("Limb", ((None, "Any limb"), *limbs)),
            Choice("Type", ((None, "Any type"), *kinds)),
        )
        for choice in (self.target, self.limb, self.kind):
            choice.value_chosen.connect(lambda _: self.search_requested.emit())
        for name, fields in (("Target", [self.target]), ("Aim", [self.aim]), ("Strike", [self.limb, self.kind])):
            section.add_row(name, *fields)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 4)
        section.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)  # rows do not overlap
        column.addWidget(section)
        column.addLayout(self._buttons())
        self.hint = styled_label(NO_STRIKES_HINT, "hint")
        self.hint.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        column.addWidget(self.hint)
        self.results = self._make_results()
        column.addWidget(self.results, 1)
        self.use = press_button(
            "Insert on selected character", lambda: self.strike_chosen.emit(self.results.currentRow())
        )
        self.use.setToolTip(TARGET_NEEDED_TIP)
        self.use.setEnabled(False)
        self.correct = press_button("Classify…", lambda: self.opened.emit(self.results.currentRow()))
        self.correct.setToolTip("Confirm or correct trim range, hit frame, limb and type")
        self.correct.setEnabled(False)
        below = QHBoxLayout()
        below.setContentsMargins(FIELD_ICON_PX, 4, FIELD_ICON_PX, 0)
        below.addWidget(self.use, 1)
        below.addWidget(self.correct)
        column.addLayout(below)

    def offer_targets(self, targets: Sequence[tuple[object, str]], wanted: object) -> None:
        """Set the targets; select ``wanted`` if it is among them, else ``NO_TARGET_CHOICE``."""
        self.target.offer([(None, NO_TARGET_CHOICE), *targets])
        self.target.show_value(wanted if self.target.offers(wanted) else None)

    def show_results(self, results: Sequence[tuple[str, str]], hint: str, usable: bool = True) -> None:
        """List (name, reasons) of each result, best first, with a ``hint``. ``usable`` is False if results cannot be
        inserted, without a target.
        """
        self._look(-1)
        self._usable = usable
        self.use.setToolTip(INSERT_TIP if usable else TARGET_NEEDED_TIP)
        self.results.clear()
        for name, reasons in results:
            item = QListWidgetItem(f"{name}\n{reasons}")
            tip = (
                "insert it at the playhead, constrained to the target"
                if usable
                else "confirm or correct its classification"
            )
            item.setToolTip(f"Double-click to {tip}")
            self.results.addItem(item)
        self.hint.setText(hint)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Emit that no result is highlighted when the mouse leaves the list."""
        if event.type() == QEvent.Type.Leave:
            self._look(-1)
        return super().eventFilter(watched, event)

    def showEvent(self, event: QShowEvent) -> None:
        """Emit that the panel is visible."""
        super().showEvent(event)
        self.shown.emit()

    def hideEvent(self, event: QHideEvent) -> None:
        """Emit that no result is highlighted."""
        self._look(-1)
        super().hideEvent(event)

    @property
    def place(self) -> int | None:
        """Index of the selected result; None if none is selected."""
        row = self.results.currentRow()
        return None if row < 0 else row

    def _look(self, row: int) -> None:
        if row != self._looked:
            self._looked = row
            self.strike_highlighted.emit(row)

    def _choose_aim(self, follows: bool) -> None:
        self.follows = follows

    def _activate(self, row: int) -> None:
        (self.strike_chosen if self._usable else self.opened).emit(row)

    def _current_changed(self, row: int) -> None:
        self.use.setEnabled(row >= 0 and self._usable)
        self.correct.setEnabled(self.place is not None)
        self._look(row)

    def _make_results(self) -> "ResultList":
        results = ResultList()
        results.setAccessibleName("Strikes found, best first")
        results.setItemDelegate(TwoLines(results))
        results.setResizeMode(QListWidget.ResizeMode.Adjust)
        results.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        results.itemActivated.connect(lambda item: self._activate(results.row(item)))
        results.setMouseTracking(True)
        results.itemEntered.connect(lambda item: self._look(results.row(item)))
        results.viewportEntered.connect(lambda: self._look(-1))
        results.currentRowChanged.connect(self._current_changed)
        results.viewport().installEventFilter(self)
        return results

    def _buttons(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(FIELD_ICON_PX, 4, FIELD_ICON_PX, 4)
        for text, signal in (("Add folder…", self.folder_requested), ("Find", self.search_requested)):
            row.addWidget(press_button(text, signal.emit))
        return row


class ResultList(QListWidget):
    """List of strikes, which can be dragged to a character or to its track on the timeline."""

    def __init__(self) -> None:
        super().__init__()
        self.setDragEnabled(True)

    def mimeTypes(self) -> list[str]:
        return [STRIKE_MIME]

    def mimeData(self, items: Sequence[QListWidgetItem]) -> QMimeData:
        """MIME data with the index of the dragged result."""
        return row_drag_data(STRIKE_MIME, self.row(items[0]))
