"""Fields of the curve editor for time and value of the selected keys."""

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QGridLayout, QLabel, QWidget

from studio.core.curves.keyed import Keys
from studio.document import colours
from studio.document.channels import Channel, key_values, with_values
from studio.document.key_edits import KeyDrag
from studio.document.keyed_fields import Keyed, keyed_value
from studio.timeline.shown import RowContext
from studio.timeline.tracks.value_curves import ValueCurves, stage_time

VALUE_LIMIT = 1e6
CURVE_FIELDS_HEIGHT = 56


class CurveFields(QWidget):
    """Time and value of the first selected key; a typed value is set on all selected keys of the active channel."""

    changed = Signal()

    def __init__(self, curves: ValueCurves, parent: QWidget) -> None:
        super().__init__(parent)
        self._curves = curves
        self._shown: RowContext | None = None
        self._target: tuple[Channel, tuple[int, ...]] | None = None
        self.time, self.value = _field("Time of key", " s"), _field("Value of key", "")
        self.time.valueChanged.connect(self._set_time)
        self.value.valueChanged.connect(self._set_value)
        self._name = QLabel("Value")
        rows = QGridLayout(self)
        rows.setContentsMargins(14, 0, 8, 0)
        rows.setSpacing(4)
        for index, (label, field) in enumerate(((QLabel("Time"), self.time), (self._name, self.value))):
            rows.addWidget(label, index, 0)
            rows.addWidget(field, index, 1)
        self.setStyleSheet(
            f"QLabel {{ color: {colours.TEXT_THIRD}; font-size: 11px; }} QDoubleSpinBox {{ font-size: 12px; }}"
            " QAbstractSpinBox::up-button, QAbstractSpinBox::down-button { width: 0; border: none; }"
        )

    def show_keys(self, shown: RowContext | None) -> None:
        """Show the selected keys of the active channel; the fields are disabled if there are none."""
        self._shown = shown
        self._target = self._find() if shown is not None else None
        self.time.setEnabled(self._target is not None)
        keyed = self._keyed()
        self.value.setEnabled(self._target is not None and isinstance(keyed, Keys))
        if shown is None or self._target is None or keyed is None:
            return
        channel, places = self._target
        self._name.setText(channel.name.capitalize())
        with QSignalBlocker(self.time), QSignalBlocker(self.value):
            self.time.setValue(stage_time(shown, channel.field, keyed.times[places[0]]))
            self.value.setSuffix(f" {channel.unit}" if channel.unit else "")
            self.value.setValue(float(key_values(channel, keyed)[places[0]]))

    def _find(self) -> tuple[Channel, tuple[int, ...]] | None:
        """Channel and indices of its selected keys: of the active channel, else of the first one with a selected key.
        None if there is none.
        """
        assert self._shown is not None
        selected = self._shown.document.keys.by_field()
        channels = [channel for channel, _ in self._curves.channels(self._shown) if channel.field in selected]
        channels.sort(key=lambda channel: channel != self._curves.active)
        return (channels[0], selected[channels[0].field]) if channels else None

    def _keyed(self) -> Keyed | None:
        if self._shown is None or self._target is None:
            return None
        return keyed_value(self._shown.project, self._target[0].field)

    def _set_time(self, seconds: float) -> None:
        keyed = self._keyed()
        if self._shown is not None and self._target is not None and keyed is not None:
            channel, places = self._target
            old = stage_time(self._shown, channel.field, keyed.times[places[0]])
            KeyDrag(self._shown.document).move(seconds - old)
            self.changed.emit()

    def _set_value(self, value: float) -> None:
        keyed = self._keyed()
        if self._shown is not None and self._target is not None and keyed is not None:
            channel, places = self._target
            changed = with_values(channel, keyed, dict.fromkeys(places, value))
            KeyDrag(self._shown.document).move(0.0, {channel.field: changed})
            self.changed.emit()


def _field(name: str, suffix: str) -> QDoubleSpinBox:
    field = QDoubleSpinBox(decimals=3, minimum=-VALUE_LIMIT, maximum=VALUE_LIMIT, singleStep=0.01, suffix=suffix)
    field.setKeyboardTracking(False)
    field.setAccessibleName(name)
    field.setToolTip(name)
    field.lineEdit().returnPressed.connect(field.clearFocus)
    return field
