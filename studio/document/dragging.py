"""Data of drags between views: a capture of the project by its id, a strike by its place in the list."""

from PySide6.QtCore import QMimeData

CAPTURE = "application/x-morpho-studio-capture"
STRIKE = "application/x-morpho-studio-strike"


def carried_capture(capture_id: str) -> QMimeData:
    """Data of a drag of a capture."""
    content = QMimeData()
    content.setData(CAPTURE, capture_id.encode())
    return content


def capture_in(content: QMimeData) -> str | None:
    """The capture that is dragged, or None for anything else."""
    return bytes(content.data(CAPTURE).data()).decode() if content.hasFormat(CAPTURE) else None


def carried_strike(place: int) -> QMimeData:
    """Data of a drag of a strike that a search has found."""
    content = QMimeData()
    content.setData(STRIKE, str(place).encode())
    return content


def strike_in(content: QMimeData) -> int | None:
    """The place in the list of the strike that is dragged, or None for anything else."""
    return int(bytes(content.data(STRIKE).data())) if content.hasFormat(STRIKE) else None
