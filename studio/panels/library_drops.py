"""Drops of library rows on another view."""

from collections.abc import Collection

from PySide6.QtCore import QEvent, QObject, Signal
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QWidget

from studio.document.dragging import item_in

BODY_COLLECTIONS = ("performers", "characters")


class LibraryDrops(QObject):
    """Event filter that accepts drags of library rows of the given ``collections`` and emits ``dropped``; other drags
    are left to the view.
    """

    dropped = Signal(tuple)

    def __init__(self, view: QWidget, collections: Collection[str]) -> None:
        super().__init__(view)
        self._collections = collections
        view.setAcceptDrops(True)
        view.installEventFilter(self)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        if not isinstance(event, QDropEvent):  # entries and moves are drop events as well
            return False
        item = item_in(event.mimeData())
        if item is None or item[0] not in self._collections:
            return False
        event.accept()
        if event.type() == QEvent.Type.Drop:
            self.dropped.emit(item)
        return True
