"""Workbench: document, solver and views, as the functions of actions use them, and messages to the user."""

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from studio.app.import_corrections import ReadAs
from studio.app.preferences import load_preferences
from studio.app.settings import Settings
from studio.document.document import Document
from studio.engine.background_tasks import TaskRunner
from studio.engine.live_adaptation import LiveAdaptation
from studio.panels.message_strip import Answer, Lifetime, UserMessage

# Both views load what a window can be shown without; the window loads this module.
if TYPE_CHECKING:
    from studio.app.main_window import MainWindow
    from studio.timeline.timeline import Timeline
    from studio.viewport.widget import Viewport


class Workbench(QObject):
    """Parts of the running program; the 3D view and the timeline are added after the window."""

    window: "MainWindow"
    """Main window; it sets this attribute when it is made."""

    message_posted = Signal(UserMessage)
    """Emitted with a UserMessage to be shown in the window; an empty one removes the last message."""
    media_relinked = Signal(str)
    """Emitted with the new path of a relinked sound or footage file, which is then read again."""
    views_changed = Signal()

    def __init__(self, document: Document, live: LiveAdaptation, runner: TaskRunner, settings: Settings) -> None:
        super().__init__()
        self.document, self.live, self.runner, self.settings = document, live, runner, settings
        self.preferences = load_preferences(settings)
        self._viewport: Viewport | None = None
        self._timeline: Timeline | None = None
        self.journals: Path | None = None
        """Folder in which session journals are kept for recovery."""
        self.sources: dict[str, Path] = {}
        """Source files of captures that were read or relinked in this run, by capture id."""
        self.read_as: dict[str, ReadAs] = {}
        """Import options of captures that were read in this run, by capture id."""
        # What is connected to them would keep them, and all that they hold, for good: they go with their parent.
        for part in (document, live, runner):
            part.setParent(self)
        document.problem_reported.connect(self.post_message)
        runner.failed.connect(lambda _, sentence: self.post_message(sentence))

    def post_message(self, sentence: str, *answers: Answer, until: Lifetime = Lifetime.CLOSED) -> None:
        """Show a warning to the user, with buttons for the answers to it; it is removed at the event ``until``."""
        self.message_posted.emit(UserMessage(sentence, answers, until))

    def inform(self, sentence: str, *answers: Answer, until: Lifetime = Lifetime.CLOSED) -> None:
        """Show an information message, without warning colour; ``answers`` and ``until`` as for a warning."""
        self.message_posted.emit(UserMessage(sentence, answers, until, warns=False))

    def clear_message(self) -> None:
        """Remove the last message."""
        self.message_posted.emit(UserMessage("", ()))

    @property
    def has_viewport(self) -> bool:
        """True if the 3D view exists; it is added after the window, and is missing if OpenGL cannot be used."""
        return self._viewport is not None

    @property
    def viewport(self) -> "Viewport":
        """3D view. RuntimeError if there is none."""
        if self._viewport is None:
            raise RuntimeError("There is no 3D view.")
        return self._viewport

    @property
    def has_timeline(self) -> bool:
        """True once the timeline exists."""
        return self._timeline is not None

    @property
    def timeline(self) -> "Timeline":
        """Timeline. RuntimeError if there is none."""
        if self._timeline is None:
            raise RuntimeError("There is no timeline.")
        return self._timeline

    def set_viewport(self, viewport: "Viewport | None") -> None:
        """Set the 3D view of the window, or None."""
        self._viewport = viewport

    def set_timeline(self, timeline: "Timeline | None") -> None:
        """Set the timeline of the window, or None."""
        self._timeline = timeline

    def finish_drag(self) -> None:
        """Finish a drag in the 3D view or the timeline, so that no other edit gets between its edits."""
        if self.live.interactive and self.has_viewport:
            self.viewport.finish_gesture()
        if self.live.interactive and self.has_timeline:
            self.timeline.tracks.finish_gesture()

    def close(self) -> None:
        """Cancel requests, wait for worker threads, then close the document."""
        self.document.playhead.pause()
        self.runner.close()
        self.live.close()
        self.document.close()
