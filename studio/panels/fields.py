"""Widgets of forms: sections, labelled rows, number fields, choices and buttons."""

from collections.abc import Callable, Iterable, Sequence
from typing import cast

from PySide6.QtCore import QEvent, QObject, QPointF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QFont, QHelpEvent, QKeyEvent, QKeySequence, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QApplication,
    QButtonGroup,
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QToolTip,
    QVBoxLayout,
    QWidget,
)

from studio.core.names import tags_in
from studio.document.length_units import shown_unit
from studio.document.mnemonics import escaped_mnemonics

FIELD_LABEL_WIDTH, MAX_NAME_WIDTH_PX = 84, 90
FORM_ROW_HEIGHT_PX = 26
FIELD_ICON_PX = 12
SCRUB_START_PIXELS = 3
DIALOG_MARGIN = QSize(80, 120)
PER_CENT = 100.0


def styled_label(text: str, role: str) -> QLabel:
    """Label with a role of the style sheet: head, title, second, hint or value."""
    label = ElidedText(text) if role == "value" else QLabel(text.upper() if role == "head" else text)
    label.setProperty("role", role)
    if role == "head":
        font = label.font()
        font.setLetterSpacing(QFont.SpacingType.PercentageSpacing, 106)
        label.setFont(font)
        label.setAccessibleName(text)
    label.setWordWrap(role == "hint")
    return label


def elided_name(name: str, among: QWidget) -> str:
    """Name, elided if necessary so that a form does not become wider; ``among`` is the widget that will show it among
    other words.
    """
    return among.fontMetrics().elidedText(name, Qt.TextElideMode.ElideRight, MAX_NAME_WIDTH_PX)


class ElidedText(QLabel):
    """Label whose text is elided if it does not fit; its tooltip shows the whole text."""

    def minimumSizeHint(self) -> QSize:
        """Narrow size, so that the label does not widen the form."""
        return QSize(0, super().minimumSizeHint().height())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the text, elided if it does not fit."""
        if not self._is_truncated():
            super().paintEvent(event)
            return
        room = self.contentsRect()
        words = self.fontMetrics().elidedText(self.text(), Qt.TextElideMode.ElideRight, room.width())
        where, enabled = int(self.alignment()), self.isEnabled()
        with QPainter(self) as painter:
            self.style().drawItemText(painter, room, where, self.palette(), enabled, words, self.foregroundRole())

    def event(self, event: QEvent) -> bool:
        """Show the whole text as a tooltip if it is elided."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip and self._is_truncated():
            QToolTip.showText(event.globalPos(), self.text(), self)
            return True
        return bool(super().event(event))

    def _is_truncated(self) -> bool:
        wide = self.fontMetrics().horizontalAdvance(self.text())
        return not self.wordWrap() and wide > self.contentsRect().width()


class Section(QWidget):
    """Section of a form: a title, and rows of label and fields in shared columns."""

    def __init__(self, title: str) -> None:
        super().__init__()
        column = QVBoxLayout(self)
        column.setContentsMargins(FIELD_ICON_PX, 12, FIELD_ICON_PX, 0)
        column.setSpacing(4)
        self.head = QHBoxLayout()
        self.head.addWidget(styled_label(title, "head"))
        self.head.addStretch(1)
        column.addLayout(self.head)
        self._grid = QGridLayout()
        self._grid.setHorizontalSpacing(8)
        self._grid.setVerticalSpacing(4)
        self._grid.setColumnMinimumWidth(0, FIELD_LABEL_WIDTH)
        self._grid.setColumnStretch(1, 1)
        column.addLayout(self._grid)

    def add_row(self, label: str, *fields: QWidget) -> QLabel:
        """Add a row and return its label; the fields share the width evenly, and the label is their accessible name if
        they have none.
        """
        row = self._grid.rowCount()
        caption = styled_label(label, "second")
        self._grid.addWidget(caption, row, 0)
        cell = QHBoxLayout()
        cell.setSpacing(4)
        for field in fields:
            cell.addWidget(field, 1 if _stretches(field) else 0)
            if not field.accessibleName():
                field.setAccessibleName(label)
        self._grid.addLayout(cell, row, 1)
        if fields:
            caption.setBuddy(fields[0])
        return caption

    def add_wide(self, widget: QWidget) -> None:
        """Add a widget over the full width."""
        self._grid.addWidget(widget, self._grid.rowCount(), 0, 1, 2)


def with_unit(caption: str, unit: str) -> str:
    """Label with the display unit in brackets, ``Offset (cm)``, for a row whose fields show no unit."""
    symbol = shown_unit(unit).symbol
    return f"{caption} ({symbol})" if symbol else caption


def _stretches(widget: QWidget) -> bool:
    return widget.sizePolicy().horizontalPolicy() is not QSizePolicy.Policy.Fixed


class NumberField(QDoubleSpinBox):
    """Number with unit: typed, stepped with the arrow keys, or scrubbed by dragging sideways.

    ``begun`` and ``ended`` are emitted around every change, so that a drag is one undo step.
    """

    begun = Signal()
    edited = Signal(float)
    ended = Signal()

    def __init__(
        self, name: str, unit: str, low: float, high: float, step: float, decimals: int = 2, *, suffix: bool = True
    ) -> None:
        super().__init__()
        self._low, self._high, self._step, self._usual_decimals = low, high, step, decimals
        self._suffix, self._factor = suffix, 1.0
        self.setAccessibleName(name)
        self.setToolTip(f"{name}. Drag sideways to change, click to type.")
        self.set_unit(unit)
        self.setKeyboardTracking(False)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMinimumWidth(36)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._press: tuple[QPointF, float] | None = None
        self._scrubbing = False
        self.lineEdit().setTextMargins(4, 0, 4, 0)
        self.lineEdit().installEventFilter(self)
        self.lineEdit().setCursor(Qt.CursorShape.SizeHorCursor)
        self.valueChanged.connect(self._tell)
        self.editingFinished.connect(lambda: self.lineEdit().setModified(False))

    def set_unit(self, unit: str) -> None:
        """Set the unit of the values; the display may use another unit, set in the preferences."""
        shown = shown_unit(unit)
        self._factor = shown.factor
        with QSignalBlocker(self):
            self.setDecimals(max(self._usual_decimals + shown.added_decimals, 0))
            self.setRange(self._low * shown.factor, self._high * shown.factor)
            self.setSingleStep(float(f"{self._step * shown.factor:.1g}") if shown.factor != 1.0 else self._step)
            self.setSuffix(f" {shown.symbol}" if self._suffix and unit else "")

    def set_least(self, low: float) -> None:
        """Set the minimum."""
        self._low = low
        with QSignalBlocker(self):
            self.setMinimum(low * self._factor)

    def show_value(self, value: float) -> None:
        """Show a value; emits nothing, and does not disturb a drag."""
        value *= self._factor
        if not self._scrubbing and round(value, self.decimals()) != self.value():  # the same would be painted again
            with QSignalBlocker(self):
                self.setValue(value)

    def _tell(self, value: float) -> None:
        value /= self._factor
        if self._scrubbing:
            self.edited.emit(value)
        else:
            self.begun.emit()
            self.edited.emit(value)
            self.ended.emit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Turn a sideways drag over the text into scrubbing; a click still places the cursor."""
        if isinstance(event, QMouseEvent) and event.type() != QEvent.Type.MouseButtonDblClick:
            if self._scrub(event):
                return True
        elif isinstance(event, QKeyEvent) and self._scrubbing and event.key() == Qt.Key.Key_Escape:
            self._finish(restore=True)
            return True
        return bool(super().eventFilter(watched, event))

    def _scrub(self, event: QMouseEvent) -> bool:
        kind, place = event.type(), event.globalPosition()
        if kind == QEvent.Type.MouseButtonPress and event.button() == Qt.MouseButton.LeftButton:
            self._press = (place, self.value())
        elif kind == QEvent.Type.MouseMove and self._press is not None:
            start, value = self._press
            distance = place.x() - start.x()
            if not self._scrubbing and abs(distance) >= SCRUB_START_PIXELS:
                self._scrubbing = True
                self.begun.emit()
            if self._scrubbing:
                fine = 0.1 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1.0
                self.setValue(value + round(distance) * self.singleStep() * fine)
            return self._scrubbing
        elif kind == QEvent.Type.MouseButtonRelease and self._press is not None:
            was_scrubbing = self._scrubbing
            self._finish()
            return was_scrubbing
        return False

    def _finish(self, restore: bool = False) -> None:
        press, self._press = self._press, None
        if self._scrubbing:
            if restore and press is not None:
                self.setValue(press[1])
            self._scrubbing = False
            self.lineEdit().deselect()
            self.ended.emit()

    def event(self, event: QEvent) -> bool:
        """Leave keys to the window's shortcuts unless a number is being typed."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and self.leaves(event):
            event.ignore()
            return False
        return bool(super().event(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Pass the keys that belong to the window on to it."""
        if self.leaves(event):
            event.ignore()
        else:
            super().keyPressEvent(event)

    def leaves(self, event: QKeyEvent) -> bool:
        """True for keys that belong to the window (undo, Space, letters), unless a number is being typed."""
        begins_none = event.text() == " " or event.text().isalpha() or undoes_or_redoes(event)
        return begins_none and not self.lineEdit().isModified()

    def wheelEvent(self, event: QEvent) -> None:
        """Ignore the wheel, so that it scrolls the form and never changes a number by accident."""
        event.ignore()


class Choice(QComboBox):
    """Drop-down list of (value, text); ``value_chosen`` is emitted only if the user chooses."""

    value_chosen = Signal(object)

    def __init__(self, name: str, items: Iterable[tuple[object, str]]) -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keys to playback and playhead
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setMinimumContentsLength(6)
        self._values: list[object] = []
        for value, text in items:
            self.add(value, text)
        self.activated.connect(lambda place: self.value_chosen.emit(self._values[place]))

    def add(self, value: object, text: str) -> None:
        """Add a choice."""
        self._values.append(value)
        self.addItem(text)

    def clear_all(self) -> None:
        """Remove all choices."""
        self._values.clear()
        self.clear()

    @property
    def value(self) -> object:
        """Chosen value; None if nothing is chosen."""
        place = self.currentIndex()
        return self._values[place] if place >= 0 else None

    def offer(self, items: Iterable[tuple[object, str]]) -> None:
        """Replace the choices; does nothing if they are unchanged."""
        items = list(items)
        shown = [(value, self.itemText(index)) for index, value in enumerate(self._values)]
        if items != shown:
            with QSignalBlocker(self):
                self.clear_all()
                for value, text in items:
                    self.add(value, text)

    def offers(self, value: object) -> bool:
        """True if ``value`` is among the choices."""
        return value in self._values

    def show_value(self, value: object) -> None:
        """Select a value; nothing is selected if it is not among the choices."""
        with QSignalBlocker(self):
            self.setCurrentIndex(self._values.index(value) if value in self._values else -1)

    def event(self, event: QEvent) -> bool:
        """Open the list on the arrow keys while the widget has the focus.

        Otherwise each step through the closed list would be an edit of its own, and some edits lose values that a later
        one needs.
        """
        if isinstance(event, QKeyEvent) and event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            if event.type() == QEvent.Type.KeyPress:
                self.showPopup()
            event.accept()
            return True
        return bool(super().event(event))

    def wheelEvent(self, event: QEvent) -> None:
        """Ignore the wheel, so that it never changes a choice by accident."""
        event.ignore()


class TextField(QLineEdit):
    """Line of text; Return ends typing, so that keys are shortcuts again."""

    def __init__(self) -> None:
        super().__init__()
        self.editingFinished.connect(lambda: self.setModified(False))
        self.returnPressed.connect(self.clearFocus)

    def event(self, event: QEvent) -> bool:
        """Leave undo to the window unless a text is being typed."""
        is_undo = event.type() == QEvent.Type.ShortcutOverride and undoes_or_redoes(cast(QKeyEvent, event))
        if is_undo and not self.isModified():
            event.ignore()
            return False
        return bool(super().event(event))


class TagField(TextField):
    """Text field for tags separated by commas; ``tags_edited`` is emitted only if the user edits."""

    tags_edited = Signal(tuple)

    def __init__(self, examples: str, about: str) -> None:
        super().__init__()
        self._tags: tuple[str, ...] = ()
        self.setAccessibleName("Tags")
        self.setPlaceholderText(examples)
        self.setToolTip(f"Tags, comma-separated; {about}")
        self.editingFinished.connect(self._read)

    def show_tags(self, tags: tuple[str, ...]) -> None:
        """Show tags, unless the user is typing."""
        self._tags = tags
        if not self.hasFocus() or tags_in(self.text()) != tags:
            self.setText(", ".join(tags))
            self.setCursorPosition(0)

    def _read(self) -> None:
        tags = tags_in(self.text())
        if tags != self._tags:
            self.tags_edited.emit(tags)


class Segments(QWidget):
    """Row of two to four exclusive buttons."""

    value_chosen = Signal(object)

    def __init__(self, name: str, items: Sequence[tuple[object, str]]) -> None:
        super().__init__()
        self.setAccessibleName(name)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        self._group = QButtonGroup(self)
        self._values = [value for value, _ in items]
        for index, (_, text) in enumerate(items):
            button = press_button(text, None, "segment")
            button.setCheckable(True)
            button.setAccessibleName(f"{name}: {text}")
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            self._group.addButton(button, index)
            row.addWidget(button, 1)
        self._group.idClicked.connect(lambda index: self.value_chosen.emit(self._values[index]))

    def show_value(self, value: object) -> None:
        """Select the button of a value."""
        self._group.button(self._values.index(value)).setChecked(True)


def room_on_screen(window: QWidget) -> QSize:
    """Maximum size of a dialog on the screen of ``window``, without title bar and borders."""
    return QSize(window.screen().availableSize() - DIALOG_MARGIN)


def undoes_or_redoes(event: QKeyEvent) -> bool:
    """True for the shortcuts of undo and redo."""
    return event.matches(QKeySequence.StandardKey.Undo) or event.matches(QKeySequence.StandardKey.Redo)


def return_keys(widget: QWidget) -> None:
    """Give the focus back to the window before ``widget`` is hidden; Qt would give it to the next button."""
    focused = QApplication.focusWidget()
    if focused is not None and (focused is widget or widget.isAncestorOf(focused)):
        widget.window().setFocus()


def check_box(text: str = "") -> QCheckBox:
    """Checkbox that is focused only by Tab, so that Space still starts playback after a click."""
    box = QCheckBox(escaped_mnemonics(text))
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    return box


def press_button(text: str, run: Callable[[], object] | None, role: str = "") -> QPushButton:
    """Button that is focused only by Tab, so that Space still starts playback after a click."""
    button = QPushButton(escaped_mnemonics(text))
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    if role:
        button.setProperty("role", role)
    if run is not None:
        button.clicked.connect(lambda _=False: run())
    return button
