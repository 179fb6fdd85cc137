"""Scheduler of solves, of which the newest request wins: workers are plain threads, and results arrive on the window's
thread.
"""

import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QObject, Qt, Signal

from studio.engine.background_tasks import CLOSE_WAIT_SECONDS, join_threads

Stage = Callable[[], object]


@dataclass(eq=False)
class _Request:
    key: str
    revision: int
    stages: Sequence[Stage]
    order: int
    stage: int = 0


@dataclass(frozen=True, eq=False)
class _Answer:
    request: _Request
    stage: int
    value: object
    error: Exception | None


class SolveScheduler(QObject):
    """Scheduler of requests by key: a newer request replaces an older one, and no key is solved twice at the same
    time.

    A request has one or more stages; the first stages of all keys are run before the second ones. Workers hold only
    immutable values. Results are emitted on the thread that owns the scheduler, never an older one after a newer one.
    """

    answered = Signal(str, int, object)
    failed = Signal(str, int, object)
    settled = Signal()
    _done = Signal(object)

    def __init__(self, parent: QObject | None = None, workers: int | None = None) -> None:
        super().__init__(parent)
        self._condition = threading.Condition()
        self._waiting: dict[str, _Request] = {}
        self._running: set[str] = set()
        self._shown: dict[str, tuple[int, int]] = {}
        self._newest: dict[str, int] = {}
        self._undelivered = 0
        self._order = 0
        self._closed = False
        self._done.connect(self._deliver, Qt.ConnectionType.QueuedConnection)
        count = workers or os.cpu_count() or 2  # one too many beats one too few: most of the time none has work
        self._threads = [threading.Thread(target=self._work, name=f"solve-{k}", daemon=True) for k in range(count)]
        for thread in self._threads:
            thread.start()

    @property
    def busy(self) -> bool:
        """True if any request is waiting, running, or not delivered yet."""
        with self._condition:
            return bool(self._waiting or self._running or self._undelivered)

    def request(self, key: str, revision: int, *stages: Stage) -> None:
        """Replace the waiting request of a key by ``stages``, to be run in turn; an older ``revision`` is ignored."""
        with self._condition:
            if revision < self._newest.get(key, revision):
                return
            self._newest[key] = revision
            self._order += 1
            self._waiting[key] = _Request(key, revision, stages, self._order)
            self._condition.notify()

    def forget(self, key: str) -> None:
        """Drop the waiting request of a key, and the result of a running one."""
        with self._condition:
            self._order += 1
            self._waiting.pop(key, None)
            self._shown[key] = (self._order, 0)

    def close(self, patience: float = CLOSE_WAIT_SECONDS) -> None:
        """Drop waiting requests, and wait up to ``patience`` seconds for running ones. Nothing is emitted
        afterwards.
        """
        with self._condition:
            self._closed = True
            self._waiting.clear()
            self._condition.notify_all()
        join_threads(self._threads, patience)
        self._done.disconnect(self._deliver)

    def _next(self) -> _Request | None:
        """Next request: by stage, then in order of arrival; None once the scheduler is closed."""
        with self._condition:
            while not self._closed:
                free = [item for key, item in self._waiting.items() if key not in self._running]
                if free:
                    chosen = min(free, key=lambda item: (item.stage, item.order))
                    del self._waiting[chosen.key]
                    self._running.add(chosen.key)
                    return chosen
                self._condition.wait()
            return None

    def _work(self) -> None:
        while self._work_once():
            pass

    def _work_once(self) -> bool:
        """Wait for a request and run one stage of it, without keeping references to its values.

        Returns False once the scheduler is closed.
        """
        request = self._next()
        if request is None:
            return False
        stage, value, error = request.stage, None, None
        try:
            value = request.stages[stage]()
        except Exception as failure:  # noqa: BLE001 - handed to the window's thread, which tells or raises it
            error = failure
        with self._condition:
            self._running.discard(request.key)
            request.stage += 1
            wanted = error is None and request.stage < len(request.stages) and not self._closed
            if wanted and request.key not in self._waiting and not self._forgotten(request):
                self._waiting[request.key] = request
            if self._closed:
                return False
            self._undelivered += 1
            self._condition.notify()
            self._done.emit(_Answer(request, stage, value, error))  # not after ``close``: nobody may be there then
        return True

    def _forgotten(self, request: _Request) -> bool:
        return self._shown.get(request.key, (0, 0))[0] > request.order

    def _deliver(self, answer: _Answer) -> None:
        if self._closed:
            return  # it was on its way
        key, newest = answer.request.key, (answer.request.order, answer.stage + 1)
        with self._condition:
            self._undelivered -= 1
            fresh = newest > self._shown.get(key, (0, 0))
            if fresh:
                self._shown[key] = newest
        if fresh and answer.error is None:
            self.answered.emit(key, answer.request.revision, answer.value)
        elif fresh:
            self.failed.emit(key, answer.request.revision, answer.error)
        if not self.busy:
            self.settled.emit()
