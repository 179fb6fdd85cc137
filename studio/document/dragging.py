"""What is dragged from one view to another: a capture of the project, by its id."""

from PySide6.QtCore import QMimeData

CAPTURE = "application/x-morpho-studio-capture"


def carried_capture(capture_id: str) -> QMimeData:
    """What a drag of a capture carries."""
    content = QMimeData()
    content.setData(CAPTURE, capture_id.encode())
    return content


def capture_in(content: QMimeData) -> str | None:
    """The capture that is dragged, or None for anything else."""
    return bytes(content.data(CAPTURE).data()).decode() if content.hasFormat(CAPTURE) else None
