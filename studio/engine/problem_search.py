"""Search for problems of the stage, measured in the background and kept up to date while they are shown."""

import logging
from functools import partial

from PySide6.QtCore import QObject, QThreadPool, QTimer, Signal

from studio.core.errors import INTERNAL_ERROR
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.project import Project
from studio.document.document import Document
from studio.engine.live_interface import Live
from studio.engine.quality_summary import FoundProblem, SummaryRow, problems_in, summary_of

_log = logging.getLogger(__name__)
REST_MS = 300
"""Milliseconds without a new result after which the stage is measured."""


class ProblemSearch(QObject):
    """Background measurement; ``rows`` and ``problems`` are those of the newest measured results."""

    found = Signal()
    """Emitted when ``rows`` and ``problems`` are updated."""
    failed = Signal(str)
    """Emitted with a sentence why the stage could not be measured."""
    _measured = Signal(int, object)

    def __init__(self, document: Document, live: Live, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._document, self._live = document, live
        self.rows: tuple[SummaryRow, ...] = ()
        self.problems: tuple[FoundProblem, ...] = ()
        self._number, self._is_fresh, self._lacks_source = 0, False, False
        self._wanted, self._asked = False, False
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(1)
        self._rest = QTimer(self, singleShot=True, interval=REST_MS)
        self._rest.timeout.connect(self._measure)
        self._measured.connect(self._take)
        live.reported_changed.connect(self._changed)
        live.adapted.connect(self._source_came)
        document.project_opened.connect(self._changed)

    def set_continuous(self, wanted: bool) -> None:
        """Keep the summary up to date, or stop doing so."""
        self._wanted = wanted
        if wanted and not self._is_fresh:
            self._rest.start(0)

    def request_summary(self) -> bool:
        """Measure once if anything has changed; returns True if the summary is up to date already."""
        self._asked = not self._is_fresh
        if self._asked and not self._rest.isActive():
            self._rest.start(0)
        return self._is_fresh

    def close(self) -> None:
        """Wait for a running measurement."""
        self._rest.stop()
        self._number += 1
        self._pool.waitForDone()

    def _changed(self) -> None:
        self._is_fresh = False
        self._number += 1
        if self._wanted or self._asked:
            self._rest.start()

    def _source_came(self, _: str) -> None:
        """Measure again, because a source motion with which peaks are compared has become available."""
        if self._lacks_source and not self._live.interactive:
            self._changed()

    def _measure(self) -> None:
        if self._live.interactive:
            self._rest.start()
            return
        project = self._document.project
        motions = {key: motion for key in project.performers if (motion := self._live.reported_motion(key)) is not None}
        played = {clip.motion_id for key in motions for clip in project.performers[key].clips}
        sources = {key: source for key in played if (source := self._live.source(key)) is not None}
        self._lacks_source = len(sources) < len(played)
        self._pool.start(partial(self._work, self._number, project, motions, sources))

    def _work(
        self, number: int, project: Project, motions: dict[str, AdaptedMotion], sources: dict[str, AdaptedMotion]
    ) -> None:
        """Measure the stage; runs in its own thread."""
        try:
            self._measured.emit(number, summary_of(project, motions, sources))
        except Exception as error:  # noqa: BLE001 - a thread has nobody above it; the sentence is shown
            _log.exception("The summary of problems failed")
            self._measured.emit(number, error)

    def _take(self, number: int, result: tuple[SummaryRow, ...] | Exception) -> None:
        if number != self._number:
            return
        self._is_fresh, self._asked = True, False
        if isinstance(result, Exception):
            self.failed.emit(f"The summary of problems failed ({INTERNAL_ERROR}: {result}). Nothing was changed.")
            return
        self.rows, self.problems = result, problems_in(result)
        self.found.emit()
