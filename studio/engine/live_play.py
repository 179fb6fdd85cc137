"""Live play: the document's stage is simulated by a worker frame by frame, while it can be edited."""

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal

from studio.core.errors import StudioError
from studio.core.solver.performers.staged_performances import PrepareCapture
from studio.core.solver.request import AdaptedMotion
from studio.core.stage.clip import Clip
from studio.core.stage.project import Project
from studio.document.document import Document
from studio.engine.background_tasks import CLOSE_WAIT_SECONDS, join_threads

if TYPE_CHECKING:
    from studio.live.playing_stage import LiveStage

STAGE_STEP_SECONDS, UNSEEN_STEP_SECONDS = 1.0 / 60.0, 1.0 / 30.0
"""Seconds from one step to the next if there is time for it (a slow step is as long as it took), and longest wait of
the next step for the image of the last one: steps that nobody sees cost the window time.
"""
ANSWER_TIMEOUT_SECONDS = 2.0
"""Longest time in seconds for which the window waits for an answer of the worker; a step takes a hundredth of that."""
MAX_STAGE_STEP_SECONDS = 0.1
"""Longest step in seconds of stage time; time lost beyond that is not made up for."""


@dataclass(frozen=True, eq=False)
class StageSnapshot:
    """One step of live play: adapted frame and behaviour state of every performer, in ``project``."""

    seconds: float
    project: Project
    results: Mapping[str, AdaptedMotion]
    states: Mapping[str, str]
    failures: Mapping[str, str]


class LivePlay(QObject):
    """Live play of a document: starts, feeds and stops the worker. Each step uses the newest project."""

    running_changed = Signal(bool)
    recording_changed = Signal(bool)
    recorded = Signal(object)
    """Emitted with the StageTake of a recording that has ended."""
    stepped = Signal()
    """Emitted when a newer snapshot is available; several steps may be one emission."""
    state_changed = Signal(str, str)
    """Emitted with the performer's id and the name of its behaviour's new state; an empty name if it has none any
    more.
    """
    _made = Signal()
    _broken = Signal(object)

    def __init__(
        self,
        document: Document,
        prepare: PrepareCapture,
        parent: QObject | None = None,
        ready: Callable[[], bool] = lambda: True,
    ) -> None:
        """``ready`` returns True once the kernels that a step calls are compiled; live play cannot begin before."""
        super().__init__(parent)
        self._ready = ready
        self.moment: StageSnapshot | None = None
        self.recording = False
        self._document, self._prepare = document, prepare
        self._worker: _Worker | None = None
        self._told: dict[str, str] = {}
        self._failed: dict[str, str] = {}
        self._made.connect(self._take, Qt.ConnectionType.QueuedConnection)
        self._broken.connect(self._break, Qt.ConnectionType.QueuedConnection)
        document.entity_changed.connect(self._feed)
        document.project_opened.connect(self.end)

    @property
    def running(self) -> bool:
        """True during live play."""
        return self._worker is not None

    @property
    def seconds(self) -> float:
        """Stage time in seconds of live play; that of the playhead otherwise."""
        return self._document.playhead.time if self.moment is None else self.moment.seconds

    def begin(self) -> bool:
        """Start live play, with every performer at the playhead's time of its clip; returns False if the kernels are
        not compiled.
        """
        if not self._ready():
            self.running_changed.emit(False)
            return False
        from studio.live.playing_stage import LiveStage  # here: it loads kernels

        if self._worker is None:
            self._document.playhead.pause()
            stage = LiveStage(self._document.project, self._prepare, self._document.playhead.time)
            self._worker = _Worker(stage, self._made.emit, self._broken.emit)
            self._worker.start()
            self.running_changed.emit(True)
        return True

    def record(self) -> None:
        """Start a recording, or end the running one."""
        if self.recording:
            self._end_recording()
        elif self._worker is not None:
            self.recording = True
            self._order(lambda stage: stage.record())
            self.recording_changed.emit(True)

    def _end_recording(self) -> None:
        worker, self.recording = self._worker, False
        if worker is not None:
            take = worker.ask(lambda stage: stage.recorded())
            self.recording_changed.emit(False)
            if take is not None:
                self.recorded.emit(take)

    def end(self) -> None:
        """Stop live play and its recording; the playhead returns to where it was."""
        if self.recording:
            self._end_recording()
        worker, self._worker, self.moment = self._worker, None, None
        if worker is not None:
            worker.stop()
            for key in self._told:
                self.state_changed.emit(key, "")
            self._told, self._failed = {}, {}
            self.running_changed.emit(False)

    def allow_next_step(self) -> None:
        """Allow the next step, because the newest one was drawn."""
        if self._worker is not None:
            self._worker.drawn.set()

    def start(self, performer_id: str, clip: Clip) -> None:
        """Start a clip on a performer, with a transition from its current pose."""
        self._order(lambda stage: stage.start(performer_id, clip))

    def send(self, event: str) -> None:
        """Send an event to all behaviours."""
        self._order(lambda stage: stage.send(event))

    def press(self, key: str) -> None:
        """Send a key press to all behaviours."""
        self._order(lambda stage: stage.press(key))

    def close(self) -> None:
        """Stop live play, and disconnect from the document."""
        self.end()
        self._document.entity_changed.disconnect(self._feed)
        self._document.project_opened.disconnect(self.end)

    def _order(self, order: "Callable[[LiveStage], None]") -> None:
        if self._worker is not None:
            self._worker.orders.append(order)

    def _feed(self, _collection: str, _entity_id: str) -> None:
        if self._worker is not None:
            self._worker.project = self._document.project

    def _take(self) -> None:
        worker = self._worker
        if worker is None:
            return
        self.moment = worker.take()
        if self.moment is None:
            return
        for key in {*self._told, *self.moment.states}:
            state = self.moment.states.get(key, "")
            if self._told.get(key, "") != state:
                self._told[key] = state
                self.state_changed.emit(key, state)
        for key, sentence in self.moment.failures.items():
            if self._failed.get(key) != sentence:
                self._document.problem_reported.emit(sentence)
        self._failed = dict(self.moment.failures)
        self.stepped.emit()

    def _break(self, error: Exception) -> None:
        self.end()
        if not isinstance(error, StudioError):
            raise error
        self._document.problem_reported.emit(str(error))


class _Worker:
    """Thread that steps the stage by the clock."""

    def __init__(self, stage: "LiveStage", made: Callable[[], object], broken: Callable[[Exception], object]) -> None:
        self.project = stage.project
        self.orders: deque[Callable[[LiveStage], None]] = deque()
        self._stage, self._made, self._broken = stage, made, broken
        self._newest: StageSnapshot | None = None
        self._seen = True
        self.drawn = threading.Event()
        """Set when a picture of the last step is made."""
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="live stage", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        self._stopped.set()
        join_threads([self._thread], CLOSE_WAIT_SECONDS)

    def take(self) -> StageSnapshot | None:
        """Newest snapshot, which then counts as seen; None before the first step."""
        self._seen = True
        return self._newest

    def ask(self, question: "Callable[[LiveStage], object]") -> object:
        """Answer of the stage to a ``question``, evaluated between two steps; None if the stage has failed."""
        answers: list[object] = []
        answered = threading.Event()

        def order(stage: "LiveStage") -> None:
            answers.append(question(stage))
            answered.set()

        self.orders.append(order)
        answered.wait(ANSWER_TIMEOUT_SECONDS)
        return answers[0] if answers else None

    def _run(self) -> None:
        try:
            last, dt = time.monotonic(), 0.0
            while not self._stopped.is_set():
                self._newest = self._step(dt)
                if self._seen:
                    self._seen = False
                    self._made()
                self._stopped.wait(max(last + STAGE_STEP_SECONDS - time.monotonic(), 0.0))
                self.drawn.wait(max(last + UNSEEN_STEP_SECONDS - time.monotonic(), 0.0))
                self.drawn.clear()
                now = time.monotonic()
                last, dt = now, min(now - last, MAX_STAGE_STEP_SECONDS)
        except Exception as error:  # noqa: BLE001 - told on the window's thread
            if not self._stopped.is_set():
                self._broken(error)

    def _step(self, dt: float) -> StageSnapshot:
        stage = self._stage
        stage.project = self.project
        while self.orders:
            self.orders.popleft()(stage)
        results = stage.step(dt)
        states = {key: each.state for key, each in stage.running.items()}
        return StageSnapshot(stage.seconds, stage.staged, results, states, dict(stage.failures))
