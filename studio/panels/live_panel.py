"""Live panel: network input, its mapping to performers and props, and output."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QFrame,
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
from studio.panels.fields import FIELD_ICON_PX, Choice, NumberField, Section, check_box, press_button, styled_label

OWN_CLIPS_LABEL, NO_INPUT_LABEL, NO_PROP_LABEL = "Own clips", "Nothing", "No prop yet"
NO_INPUTS_HINT = "Not listening. Choose a port and press Listen, or replay a recording."
INPUT_LIST_HEIGHT_PX = 98
CENTRED = Qt.AlignmentFlag.AlignVCenter
KEY_ROLE, SENDER_ROLE = Qt.ItemDataRole.UserRole, Qt.ItemDataRole.UserRole + 1


@dataclass(frozen=True)
class SenderRow:
    """Sender to a port: ``on`` if its packets are accepted, ``rate`` in packets per second, ``age`` in seconds since
    the last packet (None: never).
    """

    address: str
    on: bool
    rate: float
    age: float | None


@dataclass(frozen=True)
class InputRow:
    """Port or replayed recording: its name, and a text ``words`` about it and the performers that it drives."""

    key: str
    name: str
    words: str
    rate: float
    senders: tuple[SenderRow, ...]


class LivePanel(QScrollArea):
    """Content of the Live panel; every signal is a request of the user."""

    listen_requested = Signal(int, str)
    """Emitted with port and address."""
    replay_requested = Signal()
    record_requested = Signal()
    close_requested = Signal(str)
    sender_switched = Signal(str, str, bool)
    """Emitted with the input, the address of the sender, and True to accept it."""
    body_driven = Signal(str, str)
    """Emitted with the performer and the input that shall drive it; empty for its own clips."""
    head_tracked = Signal(str, str, str)
    """Emitted with the input, the names of bones or trackers separated by commas, and the prop; without input tracking
    ends.
    """
    performer_shown = Signal(str)
    streaming_requested = Signal(bool, str, int)
    """Emitted with True to stream, the address, and the first port."""

    def __init__(self, port: int, loopback: str, out_port: int) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.port = NumberField("Port", "", 1, 65_535, 1, 0)
        self.port.show_value(port)
        self.address = Choice("From", ((loopback, "This computer only"), ("0.0.0.0", "Network (allowed senders)")))
        self.address.setToolTip("Network: senders are listed; enable each to accept it")
        self.inputs = self._make_list()
        self.record = press_button("Record…", self.record_requested.emit)
        self.performer, self.body = Choice("Character", ()), Choice("Driven by", ((None, OWN_CLIPS_LABEL),))
        self.head, self.prop = (
            Choice("Head tracking input", ((None, NO_INPUT_LABEL),)),
            Choice("Driven prop", ((None, NO_PROP_LABEL),)),
        )
        self.names = QLineEdit("Head")
        self.names.setToolTip("One bone, or trackers separated by commas (their mean is used)")
        self.stream = check_box("Stream visible characters as VMC")
        self.out_address, self.out_port = QLineEdit(loopback), NumberField("Port", "", 1, 65_535, 1, 0)
        self.out_port.show_value(out_port)
        self.told, self.out_told = styled_label(NO_INPUTS_HINT, "hint"), styled_label("", "hint")
        self._lay_out()
        self._connect()

    # Display

    def show_inputs(self, rows: Sequence[InputRow], told: str) -> None:
        """List the inputs; choices of the user are kept, and rows are updated in place."""
        with QSignalBlocker(self.inputs):
            for index, row in enumerate(rows):
                top = self.inputs.topLevelItem(index) or QTreeWidgetItem(self.inputs)
                _fill(top, row.words, row.rate, None)
                top.setData(0, KEY_ROLE, row.key)
                for number, sender in enumerate(row.senders):
                    item = top.child(number) or QTreeWidgetItem(top)
                    _fill(item, sender.address, sender.rate, sender.age)
                    item.setData(0, KEY_ROLE, row.key)
                    item.setData(0, SENDER_ROLE, sender.address)
                    item.setCheckState(0, Qt.CheckState.Checked if sender.on else Qt.CheckState.Unchecked)
                for number in range(top.childCount() - 1, len(row.senders) - 1, -1):
                    top.takeChild(number)
                top.setExpanded(True)
            for index in range(self.inputs.topLevelItemCount() - 1, len(rows) - 1, -1):
                self.inputs.takeTopLevelItem(index)
        self.told.setText(told if rows else NO_INPUTS_HINT)
        for choice, none in ((self.body, OWN_CLIPS_LABEL), (self.head, NO_INPUT_LABEL)):
            chosen = choice.value
            choice.offer([(None, none), *((row.key, row.name) for row in rows)])
            choice.show_value(chosen if choice.offers(chosen) else None)

    def offer(self, performers: Sequence[tuple[str, str]], props: Sequence[tuple[str, str]]) -> None:
        """Set the performers and props that can be driven."""
        offered: list[tuple[Choice, list[tuple[object, str]]]]
        offered = [(self.performer, [*performers]), (self.prop, [*props] or [(None, NO_PROP_LABEL)])]
        for choice, items in offered:
            chosen = choice.value
            choice.offer(items)
            choice.show_value(chosen if choice.offers(chosen) else items[0][0] if items else None)

    def show_driver(self, input_key: str | None) -> None:
        """Show the input that drives the chosen performer."""
        self.body.show_value(input_key)

    def show_recording(self, words: str) -> None:
        """Show the recorded amount as text; an empty text means that nothing is recorded."""
        self.record.setText("Stop recording" if words else "Record…")
        self.record.setToolTip(words)

    def show_streaming(self, on: bool, words: str) -> None:
        """Show if characters are streamed, and a text about their addresses."""
        with QSignalBlocker(self.stream):
            self.stream.setChecked(on)
        self.out_told.setText(words)

    # Construction

    def _make_list(self) -> QTreeWidget:
        made = QTreeWidget()
        made.setObjectName("live_inputs")
        made.setAccessibleName("Inputs (ports, recordings) and their senders")
        made.setHeaderLabels(["Input", "Packets/s", "Last packet"])
        made.setFixedHeight(INPUT_LIST_HEIGHT_PX)
        made.setRootIsDecorated(False)
        made.setIndentation(14)
        made.setUniformRowHeights(True)
        made.header().setStretchLastSection(False)
        for column in (1, 2):
            made.headerItem().setTextAlignment(column, CENTRED | Qt.AlignmentFlag.AlignRight)
        for column, mode in enumerate((QHeaderView.ResizeMode.Stretch, *2 * [QHeaderView.ResizeMode.ResizeToContents])):
            made.header().setSectionResizeMode(column, mode)
        return made

    def _lay_out(self) -> None:
        inside = QWidget()
        self.setWidget(inside)
        column = QVBoxLayout(inside)
        column.setContentsMargins(0, 0, 0, 8)
        column.setSpacing(4)
        coming = Section("Input")
        coming.add_row("Port", self.port, press_button("Listen", self._listen, "main"))
        coming.add_row("Accept from", self.address)
        coming.add_wide(self.inputs)
        column.addWidget(coming)
        buttons = QHBoxLayout()
        buttons.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        for button in (
            press_button("Replay…", self.replay_requested.emit),
            self.record,
            press_button("Close", self._close),
        ):
            buttons.addWidget(button, 1)
        column.addLayout(buttons)
        for hint in (self.told, self.out_told):
            hint.setContentsMargins(FIELD_ICON_PX, 0, FIELD_ICON_PX, 0)
        column.addWidget(self.told)
        drives = Section("Mapping")
        drives.add_row("Character", self.performer)
        drives.add_row("Driven by", self.body)
        drives.add_row("Prop", self.prop)
        drives.add_row("Follows", self.head, self.names)
        column.addWidget(drives)
        out = Section("Output")
        out.add_wide(self.stream)
        out.add_row("Address", self.out_address, self.out_port)
        column.addWidget(out)
        column.addWidget(self.out_told)
        column.addStretch(1)

    def _connect(self) -> None:
        self.inputs.itemChanged.connect(self._changed)
        self.performer.value_chosen.connect(lambda key: self.performer_shown.emit(str(key)))
        self.body.value_chosen.connect(self._drive)
        for field in (self.head, self.prop):
            field.value_chosen.connect(lambda _: self._track())
        self.names.editingFinished.connect(self._track)
        self.stream.toggled.connect(self.ask_to_stream)
        self.out_address.editingFinished.connect(lambda: self.ask_to_stream(self.stream.isChecked()))
        self.out_port.edited.connect(lambda _: self.ask_to_stream(self.stream.isChecked()))

    def _drive(self, key: str | None) -> None:
        if self.performer.value is not None:
            self.body_driven.emit(str(self.performer.value), key or "")

    def _listen(self) -> None:
        self.listen_requested.emit(round(self.port.value()), str(self.address.value))

    def _close(self) -> None:
        item = self.inputs.currentItem() or self.inputs.topLevelItem(0)
        if item is not None:
            self.close_requested.emit(item.data(0, KEY_ROLE))

    def _changed(self, item: QTreeWidgetItem, column: int) -> None:
        sender = item.data(0, SENDER_ROLE)
        if column == 0 and sender is not None:
            on = item.checkState(0) == Qt.CheckState.Checked
            self.sender_switched.emit(item.data(0, KEY_ROLE), sender, on)

    def _track(self) -> None:
        self.head_tracked.emit(str(self.head.value or ""), self.names.text(), str(self.prop.value or ""))

    def ask_to_stream(self, on: bool) -> None:
        """Emit a request to start or stop streaming to the address in the fields."""
        self.streaming_requested.emit(on, self.out_address.text().strip(), round(self.out_port.value()))


def _fill(item: QTreeWidgetItem, name: str, rate: float, age: float | None) -> None:
    heard = "" if age is None else "now" if age < 1.0 else f"{age:.0f} s ago"
    for column, words in enumerate((name, f"{rate:.0f}", heard)):
        if item.text(column) != words:
            item.setText(column, words)
            side = Qt.AlignmentFlag.AlignRight if column else Qt.AlignmentFlag.AlignLeft
            item.setTextAlignment(column, CENTRED | side)
    quiet = colours.TEXT_SECOND if item.parent() is not None else colours.TEXT
    item.setForeground(0, QColor(quiet))
    item.setToolTip(0, name)
