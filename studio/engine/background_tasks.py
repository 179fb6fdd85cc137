"""One-off background tasks with progress, cancellation and error reports."""

import itertools
import logging
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from PySide6.QtCore import QObject, Qt, Signal, SignalInstance

from studio.core.errors import INTERNAL_ERROR, StudioError

Result = TypeVar("Result")
CLOSE_WAIT_SECONDS = 0.25
"""Seconds for which a closing window waits for threads. A thread inside a long library call cannot be stopped, but
holds only values.
"""
_log = logging.getLogger(__name__)


def join_threads(threads: Iterable[threading.Thread], patience: float) -> None:
    """Wait up to ``patience`` seconds for all threads together; unfinished ones end with the process."""
    end = time.monotonic() + patience
    for thread in threads:
        thread.join(max(end - time.monotonic(), 0.0))


class CancelledError(Exception):
    """Raised in a task that the user has cancelled."""


class Progress:
    """Progress of a task; the task can be cancelled at every report."""

    def __init__(self, tell: Callable[[float, str], None]) -> None:
        self._tell = tell
        self._cancelled = threading.Event()

    def report(self, fraction: float, text: str = "") -> None:
        """Report the progress ``fraction`` (0 to 1) and a text. Raises CancelledError if the task was cancelled."""
        if self._cancelled.is_set():
            raise CancelledError
        self._tell(fraction, text)

    __call__ = report

    def cancel(self) -> None:
        """Make the next report raise CancelledError."""
        self._cancelled.set()


@dataclass(frozen=True, eq=False)
class _Task:
    title: str
    progress: Progress
    thread: threading.Thread
    on_done: Callable[[Any], object]
    on_error: Callable[[StudioError], object]


class TaskRunner(QObject):
    """Runner of tasks, each in its own thread; signals and ``on_done`` are called on the window's thread."""

    started = Signal(int, str)
    progressed = Signal(int, float, str)
    finished = Signal(int, object)
    failed = Signal(int, str)
    cancelled = Signal(int)
    _ended = Signal(int, object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._numbers = itertools.count(1)
        self._tasks: dict[int, _Task] = {}
        self._telling, self._closed = threading.Lock(), False
        self._ended.connect(self._end, Qt.ConnectionType.QueuedConnection)

    @property
    def running(self) -> tuple[int, ...]:
        """Ids of the tasks that have not ended."""
        return tuple(self._tasks)

    def run(
        self,
        title: str,
        job: Callable[[Progress], Result],
        on_done: Callable[[Result], object] = lambda _result: None,
        on_error: Callable[[StudioError], object] = lambda _error: None,
    ) -> int:
        """Run ``job(progress)`` in a thread, then ``on_done`` with its result unless it failed or was cancelled.
        Returns the id of the task.

        ``on_error`` is called after ``failed`` with an error meant for the user, to offer further actions.
        """
        number = next(self._numbers)
        progress = Progress(lambda fraction, text: self._tell(self.progressed, number, fraction, text))

        def work() -> None:
            try:
                result, error = job(progress), None
            except Exception as failure:  # noqa: BLE001 - the window's thread tells the user
                result, error = None, failure
            self._tell(self._ended, number, result, error)

        thread = threading.Thread(target=work, name=f"task-{number}", daemon=True)
        self._tasks[number] = _Task(title, progress, thread, on_done, on_error)
        self.started.emit(number, title)
        thread.start()
        return number

    def cancel(self, task_id: int) -> None:
        """Ask a task to stop; ``cancelled`` is emitted once it has. Does nothing if it has ended."""
        if task_id in self._tasks:
            self._tasks[task_id].progress.cancel()

    def close(self, patience: float = CLOSE_WAIT_SECONDS) -> None:
        """Cancel all tasks and wait up to ``patience`` seconds for their threads; nothing is emitted afterwards."""
        with self._telling:
            self._closed = True
        self._ended.disconnect(self._end)
        for task in self._tasks.values():
            task.progress.cancel()
        join_threads((task.thread for task in self._tasks.values()), patience)
        self._tasks.clear()

    def _tell(self, signal: SignalInstance, *values: object) -> None:
        """Emit a signal from a task's thread, which may outlive the runner."""
        with self._telling:
            if not self._closed:
                signal.emit(*values)

    def _end(self, number: int, result: Any, error: Exception | None) -> None:
        task = self._tasks.pop(number, None)
        if task is None:
            return  # it ended while the runner was closed
        task.thread.join()
        if isinstance(error, CancelledError):
            self.cancelled.emit(number)
            return
        try:
            if error is not None:
                raise error
            task.on_done(result)
        except StudioError as sentence:
            self.failed.emit(number, str(sentence))
            task.on_error(sentence)
        except Exception as fault:  # noqa: BLE001 - told to the user and logged with its stack
            _log.exception("%s failed", task.title)
            self.failed.emit(number, f"{task.title} failed ({INTERNAL_ERROR}: {type(fault).__name__}: {fault}).")
        else:
            self.finished.emit(number, result)
