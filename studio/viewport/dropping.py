"""Drops of strikes and poses on the 3D view: the character under the mouse is selected, and receives the drop."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, Signal
from PySide6.QtGui import QDropEvent

from studio.document.document import Document
from studio.document.dragging import row_in
from studio.viewport import picking

if TYPE_CHECKING:
    from studio.viewport.widget import Viewport


class BodyDrops(QObject):
    """Event filter for drags of one kind; ``dropped`` is emitted with the index in the list and the performer's id."""

    dropped = Signal(int, str)

    def __init__(self, viewport: "Viewport", document: Document, kind: str) -> None:
        super().__init__(viewport)
        self._viewport, self._document, self._kind = viewport, document, kind
        viewport.setAcceptDrops(True)
        viewport.installEventFilter(self)

    def eventFilter(self, _: QObject, event: QEvent) -> bool:
        """Accept drags of this kind, and leave all others to other filters."""
        place = row_in(self._kind, event.mimeData()) if isinstance(event, QDropEvent) else None  # so are moves
        if place is None or not isinstance(event, QDropEvent):
            return False
        view, where = self._viewport, event.position()
        key = picking.body_at(view.posed, view.camera, view.view_size, where.x(), where.y())
        event.setAccepted(key is not None or event.type() == QEvent.Type.DragEnter)
        if key is not None and event.type() == QEvent.Type.Drop:
            self.dropped.emit(place, key)
        elif key is not None:
            self._document.selection.set(("performers", key))
        return True
