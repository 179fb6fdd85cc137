"""Data of drags between views: a row of the library by its entity, strikes and poses by their index in a list."""

import json

from PySide6.QtCore import QMimeData

CAPTURE = "application/x-morpho-studio-capture"
LIBRARY_ITEM = "application/x-morpho-studio-library-item"
STRIKE = "application/x-morpho-studio-strike"
"""Kind of a drag of a strike that a search has found."""
POSE = "application/x-morpho-studio-pose"
"""Kind of a drag of a saved pose."""


def carried_capture(capture_id: str) -> QMimeData:
    """Data of a drag of a capture."""
    content = QMimeData()
    content.setData(CAPTURE, capture_id.encode())
    return content


def carried_item(item: tuple[str, str]) -> QMimeData:
    """Data of a drag of a library row, the (collection, id) of its entity; a capture also has that of a capture."""
    collection, entity_id = item
    content = carried_capture(entity_id) if collection == "captures" else QMimeData()
    content.setData(LIBRARY_ITEM, json.dumps(item).encode())
    return content


def item_in(content: QMimeData) -> tuple[str, str] | None:
    """(collection, id) of the dragged library row, or None."""
    if not content.hasFormat(LIBRARY_ITEM):
        return None
    collection, entity_id = json.loads(bytes(content.data(LIBRARY_ITEM).data()))
    return collection, entity_id


def capture_in(content: QMimeData) -> str | None:
    """Id of the dragged capture, or None."""
    return bytes(content.data(CAPTURE).data()).decode() if content.hasFormat(CAPTURE) else None


def carried_row(kind: str, row: int) -> QMimeData:
    """Data for dragging an item of a list of this kind."""
    content = QMimeData()
    content.setData(kind, str(row).encode())
    return content


def row_in(kind: str, content: QMimeData) -> int | None:
    """Index in the list of the dragged item, or None for another kind."""
    return int(bytes(content.data(kind).data())) if content.hasFormat(kind) else None
