"""Workbench: what the verbs work with, the document, the engine and the views, and one place to say things."""

from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal

from studio.app.corrections import ReadAs
from studio.app.preferences import load_preferences
from studio.app.settings import Settings
from studio.document.document import Document


class Workbench(QObject):
    """Holds the parts of the running studio together. Views are None until they are made."""

    said = Signal(str)
    """A sentence for the message strip."""
    views_changed = Signal()

    def __init__(self, document: Document, live: Any, runner: Any, settings: Settings) -> None:
        super().__init__()
        self.document, self.live, self.runner, self.settings = document, live, runner, settings
        self.preferences = load_preferences(settings)
        self.window: Any = None
        self.viewport: Any = None
        self.timeline: Any = None
        self.journals: Path | None = None
        """Where sessions are kept for recovery."""
        self.sources: dict[str, Path] = {}
        """Files that captures were read from in this run, by capture id."""
        self.read_as: dict[str, ReadAs] = {}
        """Options by which the captures were read, to be corrected."""
        # What is connected to them would keep them, and all that they hold, for good: they go with their parent.
        for part in (document, live, runner):
            part.setParent(self)
        document.problem.connect(self.said)
        runner.failed.connect(lambda _, sentence: self.said.emit(sentence))

    def close(self) -> None:
        """Stop requests, join workers, then leave the document."""
        self.document.playhead.pause()
        self.runner.close()
        self.live.close()
        self.document.close()
        # A stack that dies tells of its last steps, when those who listen may be gone already.
        self.document.undo_stack.blockSignals(True)
