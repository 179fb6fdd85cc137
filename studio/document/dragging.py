"""MIME data of drags between views: a library row by its entity, strikes and poses by their index in a list."""

import json

from PySide6.QtCore import QMimeData

CAPTURE_MIME = "application/x-morpho-studio-capture"
LIBRARY_ITEM_MIME = "application/x-morpho-studio-library-item"
STRIKE_MIME = "application/x-morpho-studio-strike"
"""MIME type of a dragged strike from the list of results."""
POSE_MIME = "application/x-morpho-studio-pose"
"""MIME type of a dragged saved pose."""


def capture_drag_data(capture_id: str) -> QMimeData:
    """MIME data of a dragged capture."""
    content = QMimeData()
    content.setData(CAPTURE_MIME, capture_id.encode())
    return content


def item_drag_data(item: tuple[str, str]) -> QMimeData:
    """MIME data of a dragged library row, the (collection, id) of its entity; for a capture also those of
    ``capture_drag_data``.
    """
    collection, entity_id = item
    content = capture_drag_data(entity_id) if collection == "captures" else QMimeData()
    content.setData(LIBRARY_ITEM_MIME, json.dumps(item).encode())
    return content


def item_in(content: QMimeData) -> tuple[str, str] | None:
    """(collection, id) of the dragged library row, or None."""
    if not content.hasFormat(LIBRARY_ITEM_MIME):
        return None
    collection, entity_id = json.loads(bytes(content.data(LIBRARY_ITEM_MIME).data()))
    return collection, entity_id


def capture_in(content: QMimeData) -> str | None:
    """Id of the dragged capture, or None."""
    return bytes(content.data(CAPTURE_MIME).data()).decode() if content.hasFormat(CAPTURE_MIME) else None


def row_drag_data(kind: str, row: int) -> QMimeData:
    """MIME data of type ``kind`` for the list item at the index ``row``."""
    content = QMimeData()
    content.setData(kind, str(row).encode())
    return content


def row_in(kind: str, content: QMimeData) -> int | None:
    """Index of the list item dragged with the MIME type ``kind``; None for other data."""
    return int(bytes(content.data(kind).data())) if content.hasFormat(kind) else None
