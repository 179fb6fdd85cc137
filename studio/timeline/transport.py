"""Transport bar: playback, step, loop, speed, time and frame of the playhead, and the play range."""

from collections.abc import Callable

import qtawesome
from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QIcon, QResizeEvent, QValidator
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox, QHBoxLayout, QLabel, QSpinBox, QToolButton, QWidget

from studio.document import colours
from studio.document.document import Document
from studio.document.playhead import INITIAL_PLAYHEAD
from studio.engine.live_play import LivePlay
from studio.timeline.shown import ROW_LABEL_WIDTH
from studio.timeline.time_words import rate_text
from studio.timeline.timecode import TIMECODE, frame_of_timecode, timecode

TRANSPORT_HEIGHT = 32
PLAYBACK_SPEEDS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0)
MAX_FRAME = 9_999_999


class Transport(QWidget):
    """Controls of playback and of live play; ``action_requested`` is emitted with the id of an action."""

    action_requested = Signal(str)

    def __init__(self, document: Document, play: LivePlay, parent: QWidget | None = None) -> None:
        """``play`` is the live play of the document."""
        super().__init__(parent)
        self.playhead, self._play = document.playhead, play
        self.setFixedHeight(TRANSPORT_HEIGHT)
        self.setObjectName("transport")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setStyleSheet(_STYLE)
        self._make_buttons()
        self._make_fields()
        self._lay_out()
        self.playhead.changed.connect(self._show_time)
        self.playhead.playing_changed.connect(self._show_playing)
        self.playhead.range_changed.connect(self._show_range)
        for changed in (play.running_changed, play.recording_changed, play.stepped):
            changed.connect(self._show_live)
        self._show_live()
        self._show_playing()
        self._show_range()

    def leave(self) -> None:
        """Disconnect from the playhead."""
        self.playhead.changed.disconnect(self._show_time)
        self.playhead.playing_changed.disconnect(self._show_playing)
        self.playhead.range_changed.disconnect(self._show_range)
        for changed in (self._play.running_changed, self._play.recording_changed, self._play.stepped):
            changed.disconnect(self._show_live)

    def _make_buttons(self) -> None:
        playhead = self.playhead
        self.to_start = _button("mdi6.skip-previous", "Go to start", lambda: playhead.set_frame(playhead.first))
        self.previous = _button("mdi6.step-backward", "Previous frame", lambda: playhead.step(-1))
        self.play = _button("mdi6.play", "Play", playhead.toggle)
        self.next = _button("mdi6.step-forward", "Next frame", lambda: playhead.step(1))
        self.to_end = _button("mdi6.skip-next", "Go to end", lambda: playhead.set_frame(playhead.last))
        self.loop = _button("mdi6.repeat", "Loop", self._set_loop)
        self.loop.setCheckable(True)
        self.loop.setChecked(playhead.loop)
        self.live = _button("mdi6.broadcast", "Play live", lambda: self.action_requested.emit("play_live"))
        self.record = _button(
            "mdi6.record-circle-outline", "Record take", lambda: self.action_requested.emit("record_take")
        )
        self.dope = _button("mdi6.rhombus-split-outline", "Dope sheet: the keys of the selection", lambda: None)
        self.curves = _button("mdi6.chart-bell-curve", "Curve editor: the values of the selection", lambda: None)
        for button in (self.live, self.record, self.dope, self.curves):
            button.setCheckable(True)
        self.clock = QLabel()
        self.clock.setObjectName("live")

    def _make_fields(self) -> None:
        playhead = self.playhead
        self.frame = _frame_field("Frame", playhead.set_frame)
        self.seconds = QDoubleSpinBox(decimals=3, minimum=0.0, maximum=1e6, suffix=" s")
        _dress(self.seconds, "Time in seconds", 76)
        self.seconds.valueChanged.connect(playhead.set_time)
        self.timecode = TimecodeField()
        self.timecode.valueChanged.connect(playhead.set_frame)
        self.rate = QLabel()
        self.speed = QComboBox()
        self.speed.setAccessibleName("Playback speed")
        self.speed.setToolTip("Playback speed")
        self.speed.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves Space to the playback
        for speed in PLAYBACK_SPEEDS:
            self.speed.addItem(f"{speed:g}×", speed)
        self.speed.setCurrentIndex(PLAYBACK_SPEEDS.index(1.0))
        self.speed.currentIndexChanged.connect(self._set_speed)
        self.first = _frame_field("First frame of the range", lambda frame: self._set_range())
        self.last = _frame_field("Last frame of the range", lambda frame: self._set_range())

    def _lay_out(self) -> None:
        buttons = QWidget(self)
        buttons.setFixedWidth(ROW_LABEL_WIDTH)
        inner = QHBoxLayout(buttons)
        inner.setContentsMargins(8, 0, 0, 0)
        inner.setSpacing(2)
        for button in (self.to_start, self.previous, self.play, self.next, self.to_end, self.loop):
            inner.addWidget(button)
        inner.addStretch()
        row = self._row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 12, 0)
        row.setSpacing(6)
        row.addWidget(buttons)
        row.addSpacing(10)
        _add(row, _caption("Frame"), self.frame, self.seconds, self.timecode, self.rate)
        row.addSpacing(12)
        speed = _caption("Speed")
        _add(row, speed, self.speed)
        row.addSpacing(12)
        _add(row, self.live, self.record, self.clock)
        row.addStretch()
        _add(row, self.dope, self.curves)
        row.addSpacing(12)
        _add(row, _caption("Play range"), self.first, _caption("–"), self.last)
        self._optional = (self.timecode, self.rate, self.seconds, speed, self.speed)

    def minimumSizeHint(self) -> QSize:
        """Size without the fields that a narrow bar hides."""
        shown = [each for each in self._optional if not each.isHidden()]
        spare = sum(
            each.minimumSizeHint().expandedTo(each.minimumSize()).width() + self._row.spacing() for each in shown
        )
        return QSize(self._row.minimumSize().width() - spare, TRANSPORT_HEIGHT)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Hide fields of a narrow bar, the least important first; the status line and shortcuts have them as well."""
        super().resizeEvent(event)
        for each in self._optional:
            each.show()
        for each in self._optional:
            if self._row.minimumSize().width() <= self.width():
                break
            each.hide()

    def _show_time(self) -> None:
        with QSignalBlocker(self.frame), QSignalBlocker(self.seconds), QSignalBlocker(self.timecode):
            self.frame.setValue(self.playhead.frame)
            self.seconds.setValue(self.playhead.time)
            self.timecode.show_frame(self.playhead.frame, self.playhead.frame_rate)

    def _show_playing(self) -> None:
        playing = self.playhead.playing
        self.play.setIcon(_icon("mdi6.pause" if playing else "mdi6.play"))
        self.play.setToolTip("Pause" if playing else "Play")
        self.play.setAccessibleName(self.play.toolTip())
        self._show_manner()

    def _show_live(self, *_: object) -> None:
        running, recording = self._play.running, self._play.recording
        self.live.setChecked(running)
        self.record.setChecked(recording)
        self.record.setEnabled(running)
        words = "RECORDING" if recording else "LIVE"
        self.clock.setText(f"{words} {self._play.seconds:.1f} s" if running else "")

    def _show_manner(self) -> None:
        """Show speed and loop, which shortcuts may have changed; a speed outside of the list is added."""
        with QSignalBlocker(self.speed):
            self.speed.setPlaceholderText(f"{self.playhead.speed:g}×")
            self.speed.setCurrentIndex(self.speed.findData(self.playhead.speed))
        self.loop.setChecked(self.playhead.loop)

    def _show_range(self) -> None:
        playhead = self.playhead
        self.rate.setText(rate_text(playhead.frame_rate))
        with QSignalBlocker(self.first), QSignalBlocker(self.last), QSignalBlocker(self.seconds):
            self.first.setMaximum(playhead.last)
            self.last.setMinimum(playhead.first)
            self.first.setValue(playhead.first)
            self.last.setValue(playhead.last)
            self.seconds.setSingleStep(1.0 / playhead.frame_rate)
        self._show_time()

    def _set_range(self) -> None:
        self.playhead.set_range(*sorted((self.first.value(), self.last.value())))  # one may be typed past the other

    def _set_speed(self) -> None:
        self.playhead.speed = self.speed.currentData()

    def _set_loop(self) -> None:
        self.playhead.loop = self.loop.isChecked()


class TimecodeField(QSpinBox):
    """Number field for a frame, displayed as SMPTE timecode."""

    def __init__(self) -> None:
        self._frame_rate = INITIAL_PLAYHEAD.frame_rate
        super().__init__(maximum=MAX_FRAME)
        _dress(self, "SMPTE timecode (hours:minutes:seconds:frames)", 92)

    def show_frame(self, frame: int, frame_rate: float) -> None:
        """Show a frame at a frame rate in Hz."""
        is_same = frame == self.value()
        self._frame_rate = frame_rate
        self.setValue(frame)
        if is_same:  # the same frame may have another timecode now
            self.lineEdit().setText(self.textFromValue(self.value()))

    def textFromValue(self, frame: int) -> str:
        """Timecode of a frame."""
        return timecode(frame, self._frame_rate)

    def valueFromText(self, text: str) -> int:
        """Frame at a timecode, within the field's range."""
        return min(frame_of_timecode(text, self._frame_rate), self.maximum())

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        """Accept a timecode, or the beginning of one."""
        if TIMECODE.fullmatch(text):
            return QValidator.State.Acceptable, text, position
        is_begun = all(letter in "0123456789:;." for letter in text)
        return QValidator.State.Intermediate if is_begun else QValidator.State.Invalid, text, position


def _add(row: QHBoxLayout, *widgets: QWidget) -> None:
    for widget in widgets:
        row.addWidget(widget)


def _icon(name: str) -> QIcon:
    icon: QIcon = qtawesome.icon(name, color=colours.TEXT, color_on=colours.SELECTED_HANDLE)
    return icon


def _button(icon: str, text: str, action: Callable[[], object]) -> QToolButton:
    button = QToolButton()
    button.setAutoRaise(True)
    button.setToolTip(text)
    button.setAccessibleName(text)
    button.setIcon(_icon(icon))
    button.setIconSize(QSize(18, 18))
    button.setFixedSize(26, 24)
    button.clicked.connect(lambda: action())
    return button


def _frame_field(text: str, action: Callable[[int], None]) -> QSpinBox:
    field = QSpinBox(maximum=MAX_FRAME)
    _dress(field, text, 56)
    field.valueChanged.connect(action)
    return field


def _dress(field: QSpinBox | QDoubleSpinBox, text: str, width: int) -> None:
    field.setAlignment(Qt.AlignmentFlag.AlignRight)
    field.setKeyboardTracking(False)  # a half-typed number is no frame to go to
    field.setFixedWidth(width)
    field.lineEdit().setTextMargins(4, 0, 4, 0)
    field.lineEdit().returnPressed.connect(field.clearFocus)  # so that keys move the playhead again
    field.setAccessibleName(text)
    field.setToolTip(text)


def _caption(text: str) -> QLabel:
    label = QLabel(text)
    label.setObjectName("caption")
    return label


_STYLE = f"""
#transport {{ background: {colours.BAR}; }}
#transport QLabel#live {{ color: {colours.LIVE}; font-weight: 600; }}
#transport QLabel {{ color: {colours.TEXT_THIRD}; font-size: 12px; }}
#transport QAbstractSpinBox, #transport QComboBox {{ font-size: 12px; min-height: 20px; }}
/* Without this, and with NoButtons too, Qt leaves a styled field one pixel for its text. */
#transport QAbstractSpinBox::up-button, #transport QAbstractSpinBox::down-button {{ width: 0; border: none; }}
#transport QToolButton {{ border: 1px solid transparent; border-radius: 5px; }}
#transport QToolButton:hover {{ background: {colours.CONTROL}; }}
#transport QToolButton:checked {{ background: {colours.SELECTED_ROW}; }}
#transport QToolButton:focus {{ border-color: {colours.SELECTED_CONTROL}; }}
"""
