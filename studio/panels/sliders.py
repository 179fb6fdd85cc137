"""Slider with its number beside it; a drag is one undo step."""

from PySide6.QtCore import QEvent, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QWidget

from studio.panels.fields import styled_label

SLIDER_STEPS = 1000
SLIDER_VALUE_WIDTH_PX = 62


class QuietSlider(QSlider):
    """Slider that jumps to the pressed position; a double click or Home emits ``restored``, to reset the value."""

    restored = Signal()

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setRange(0, SLIDER_STEPS)
        self.setSingleStep(5)
        self.setPageStep(50)

    def wheelEvent(self, event: QEvent) -> None:
        event.ignore()

    def mouseDoubleClickEvent(self, _: QEvent) -> None:
        self.restored.emit()

    def event(self, event: QEvent) -> bool:
        """Let the arrow keys move the slider while it has the focus, instead of the playhead."""
        keys = (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down)
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and event.key() in keys:
            event.accept()
            return True
        return bool(super().event(event))


class ValueSlider(QWidget):
    """Slider from ``low`` to ``high`` with a number; ``begun`` and ``ended`` are emitted around every change."""

    begun = Signal()
    edited = Signal(float)
    ended = Signal()
    restored = Signal()

    def __init__(self, name: str, low: float, high: float) -> None:
        super().__init__()
        self._low, self._high = low, high
        self.slider = QuietSlider()
        self.slider.setAccessibleName(name)
        self.slider.setToolTip(f"{name}. Double-click to reset.")
        self._value: QLabel = styled_label("", "value")
        self._value.setFixedWidth(SLIDER_VALUE_WIDTH_PX)
        self._value.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(8)
        row.addWidget(self.slider, 1)
        row.addWidget(self._value)
        self.setAccessibleName(name)
        self.setFocusProxy(self.slider)
        self.slider.sliderPressed.connect(self.begun)
        self.slider.sliderReleased.connect(self.ended)
        self.slider.valueChanged.connect(self._tell)
        self.slider.restored.connect(self.restored)

    def show_value(self, value: float, words: str) -> None:
        """Show a value, and its text ``words``."""
        self._value.setText(words)
        if not self.slider.isSliderDown():
            with QSignalBlocker(self.slider):
                self.slider.setValue(round((value - self._low) / (self._high - self._low) * SLIDER_STEPS))

    def _tell(self, step: int) -> None:
        value = self._low + (self._high - self._low) * step / SLIDER_STEPS
        down = self.slider.isSliderDown()
        if not down:
            self.begun.emit()
        self.edited.emit(value)
        if not down:
            self.ended.emit()
