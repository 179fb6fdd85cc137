"""Status line: frame, frame rate, import assumptions, running job, and state of the backup."""

import math
import time
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, field

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QSizePolicy, QStatusBar, QWidget

from studio.document.document import Document
from studio.document.mnemonics import escaped_mnemonics
from studio.panels.fields import ElidedText, press_button

STATUS_BAR_WIDTH = 120
MIN_TIMED_SECONDS, MIN_TIMED_FRACTION = 3.0, 0.02
"""Seconds, and part of a job, that must have been timed before the time left is shown."""
STEADY_PACE = 1.5
"""Factor by which the pace of the second half of the time may differ from that of the whole."""
SECONDS_SHOWN_BELOW = 120
"""Time left in seconds from which it is shown in minutes."""
MOTION_NAME_PX = 240
"""Maximum width in pixels of the name of a motion; a longer one is elided in the middle."""


@dataclass
class Pace:
    """Progress of a job over time from its first progress on: what comes before, imports above all, is not repeated."""

    _timed: list[tuple[float, float]] = field(default_factory=list)
    """Monotonic seconds and progress (0 to 1); begun anew where progress goes back."""

    def update(self, seconds: float, share: float) -> None:
        """Take the progress (0 to 1) at a monotonic time."""
        if self._timed and share < self._timed[-1][1]:
            self._timed.clear()
        if share > 0.0:
            self._timed.append((seconds, share))

    @property
    def time_left(self) -> str:
        """Approximate time left in words; empty at the end, and until the pace is known: until enough has been timed,
        and while the second half of that time has another pace than the whole.
        """
        if not self._timed:
            return ""
        (begin, first), (now, last) = self._timed[0], self._timed[-1]
        if now - begin < MIN_TIMED_SECONDS or last - first < MIN_TIMED_FRACTION or last >= 1.0:
            return ""
        middle, reached = self._timed[bisect_left(self._timed, ((begin + now) / 2.0,)) - 1]
        pace, recent = (last - first) / (now - begin), (last - reached) / (now - middle)
        if not 1.0 / STEADY_PACE <= recent / pace <= STEADY_PACE:
            return ""
        left = (1.0 - last) / min(pace, recent)
        tens = 10 * math.ceil(left / 10.0)
        return f"about {f'{tens} s' if left < SECONDS_SHOWN_BELOW else f'{math.ceil(left / 60.0)} min'} left"


class ProgressLine(QWidget):
    """Progress of the running job, with a button to cancel it."""

    cancel_requested = Signal(int)
    message_posted = Signal(str, float)
    """Emitted with the text and progress (0 to 1) of the shown job; an empty text if none runs."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 12, 0)
        row.setSpacing(8)
        self._words = ElidedText()
        self._words.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._bar = QProgressBar()
        self._bar.setFixedWidth(STATUS_BAR_WIDTH)
        self._bar.setTextVisible(False)
        self._bar.setRange(0, 1000)
        self._cancel = press_button("Cancel", self._ask, "link")
        self._cancel.setObjectName("cancel")
        self._cancel.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        row.addWidget(self._words, 1)
        for widget in (self._bar, self._cancel):
            row.addWidget(widget, 0, Qt.AlignmentFlag.AlignVCenter)
        self._clock = clock
        self._titles: dict[int, str] = {}
        self._paces: dict[int, Pace] = {}
        self._jobs: dict[int, tuple[str, float]] = {}
        self.hide()

    @property
    def now(self) -> tuple[str, float]:
        """Text and progress (0 to 1) of the newest running job; empty and 0 if none runs."""
        return next(reversed(self._jobs.values()), ("", 0.0))

    def begin(self, task: int, title: str) -> None:
        """Add a job that has begun; the newest one is shown."""
        self._titles[task], self._paces[task] = title, Pace()
        self.show_share(task, 0.0, "")

    def show_share(self, task: int, share: float, words: str) -> None:
        """Show the progress of a job, from 0 to 1, and its time left."""
        if task in self._titles:
            self._paces[task].update(self._clock(), share)
            texts = self._titles[task], words, self._paces[task].time_left
            self._jobs[task] = (" · ".join(filter(None, texts)), share)
            self._show()

    def end(self, task: int) -> None:
        """Remove a job that has finished, failed or been cancelled."""
        self._titles.pop(task, None)
        self._paces.pop(task, None)
        self._jobs.pop(task, None)
        self._show()

    def _show(self) -> None:
        words, share = self.now
        self._words.setText(words)
        self._bar.setValue(round(share * 1000))
        self._bar.setAccessibleName(f"{words}, {share:.0%}")
        self.setVisible(bool(self._jobs))
        self.message_posted.emit(words, share)

    def _ask(self) -> None:
        for task in list(self._jobs)[-1:]:
            self.cancel_requested.emit(task)


class StatusLine(QStatusBar):
    """Status line: frame, frame rate and assumptions at the left, state of the backup at the right."""

    report_requested = Signal()
    """Emitted when the number of assumptions is clicked."""

    def __init__(self, document: Document) -> None:
        super().__init__()
        self.setSizeGripEnabled(False)
        self.document = document
        self._time, self._rate, self._journal, self._told = QLabel(), QLabel(), QLabel(), ElidedText()
        self._guesses = press_button("", self.report_requested.emit, "link")
        self.progress = ProgressLine()
        for label in (self._time, self._rate, self._told):
            label.setContentsMargins(8, 0, 8, 0)
        for widget in (self._time, self._rate, self._guesses):
            self.addWidget(widget)
        self.addWidget(self._told, 1)
        self._journal.setContentsMargins(8, 0, 12, 0)
        self.addPermanentWidget(self.progress)
        self.addPermanentWidget(self._journal)
        document.playhead.changed.connect(self._show_time)
        document.playhead.range_changed.connect(self._show_facts)
        document.entity_changed.connect(self._entity_changed)
        document.project_opened.connect(self._show_facts)
        document.selection.changed.connect(self._show_facts)
        document.saved_state_changed.connect(self._show_journal)
        document.undo_stack.indexChanged.connect(self._show_journal)
        self._show_facts()
        self._show_journal()

    def show_hint(self, words: str) -> None:
        """Show a text about the item under the mouse, on one line."""
        self._told.setText(" · ".join(words.splitlines()))

    def _entity_changed(self, collection: str, _: str) -> None:
        if collection in ("captures", "motions", "performers"):
            self._show_facts()

    def _show_time(self) -> None:
        playhead = self.document.playhead
        self._time.setText(f"Frame {playhead.frame} · {playhead.time:.3f} s")

    def _show_facts(self) -> None:
        self._show_time()
        project = self.document.project
        self._rate.setText(f"{self.document.playhead.frame_rate:.4g} fps")
        motion = project.motions.get(self.document.active_motion_id or "")
        self._guesses.setVisible(motion is not None)
        if motion is None:
            return
        guesses = project.captures[motion.capture_id].guesses
        count = f"{len(guesses)} assumption{'' if len(guesses) == 1 else 's'}"
        name = self._guesses.fontMetrics().elidedText(motion.name, Qt.TextElideMode.ElideMiddle, MOTION_NAME_PX)
        self._guesses.setText(escaped_mnemonics(f"{name} · {count}" if guesses else name))
        self._guesses.setToolTip("\n".join((motion.name, *(guess.title for guess in guesses))))

    def _show_journal(self) -> None:
        self._journal.setText(journal_words(self.document))


def journal_words(document: Document) -> str:
    """State of the backup and number of undo steps; if the backup has stopped, what to do."""
    count = document.undo_stack.index()
    edits = f"{count} edit" + ("" if count == 1 else "s")
    state, _, detail = document.journal_state.partition(" - ")
    if not state:
        return edits
    return f"{state} · {edits if 'edit' in detail else detail}"
