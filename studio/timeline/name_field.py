"""Text field over the timeline for renaming a label."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QRect, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QLineEdit, QWidget

MIN_NAME_FIELD_PX = 120


class NameField(QLineEdit):
    """Text field that accepts with Enter or a click elsewhere, cancels with Esc, and then closes."""

    def __init__(self, parent: QWidget, area: QRect, name: str, take: Callable[[str], object]) -> None:
        super().__init__(name, parent)
        self._name, self._take = name, take
        self.setAccessibleName("Name of the label")
        self.setGeometry(area.adjusted(0, -3, max(MIN_NAME_FIELD_PX - area.width(), 0), 3))
        self.selectAll()
        self.editingFinished.connect(self._finish)
        self.show()
        self.setFocus()

    def event(self, event: QEvent) -> bool:
        """Reserve Esc and letters from the window's shortcuts."""
        if event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Restore the old name on Esc."""
        if event.key() == Qt.Key.Key_Escape:
            self.setText(self._name)
            self._finish()
        else:
            super().keyPressEvent(event)

    def _finish(self) -> None:
        self.blockSignals(True)  # hiding it takes the focus away, which would finish it again
        self.hide()
        self.deleteLater()
        name = self.text().strip()
        if name and name != self._name:
            self._take(name)
