"""Jobs of a batch on worker processes of this machine: each does one job at a time; one that dies is replaced."""

import gc
import multiprocessing
import os
import signal
import sys
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from studio.core.solver.request import AdaptRequest
from studio.io.importing import GUESS_ALL
from studio.io.json_text import JsonObject
from studio.io.project.character_file import bundled_characters
from studio.jobs.adapt_report import character_report
from studio.jobs.adaptation import ready_capture
from studio.jobs.batch_jobs import BatchJob, adapt_job, death_record
from studio.resources_folder import example_captures_folder
from studio.startup.process import prepare_process

POLL_SECONDS = 0.2
"""Seconds between two calls of ``waited``."""
MOST_WORKER_DEATHS = 2
"""Number of workers that may die of a job before it counts as failed."""
WORKER_STOP_SECONDS = 5.0
"""Seconds that a stopped worker has to remove half-written files."""


class Worker:
    """Worker process and its current job."""

    def __init__(self, context: "multiprocessing.context.ForkContext | multiprocessing.context.SpawnContext") -> None:
        self.pipe, theirs = context.Pipe()
        self.process: BaseProcess = context.Process(target=run_worker, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()
        self.job: BatchJob | None = None

    def give(self, job: BatchJob) -> None:
        """Send a job to the process."""
        self.job = job
        with suppress(BrokenPipeError):  # a worker that died idle is noticed like one that dies of a job
            self.pipe.send(job)

    def end(self) -> None:
        """Stop the process, even in the middle of a job."""
        self.process.terminate()
        self.process.join(WORKER_STOP_SECONDS)
        self.process.kill()
        self.process.join()
        self.pipe.close()


def can_fork() -> bool:
    """True if workers can be forks, which inherit imports and loaded kernels; a new process takes seconds to load them.

    Linux alone forks safely, and only a process whose other threads are not in the middle of something.
    """
    return sys.platform == "linux" and threading.current_thread() is threading.main_thread()


def run_worker(pipe: Connection) -> None:
    """Run the main loop of a worker: one job after the other, until there are no more or the parent process is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that gives the jobs
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    prepare_process()
    parent = multiprocessing.parent_process()
    assert parent is not None
    try:
        while pipe in wait([pipe, parent.sentinel]):
            pipe.send(adapt_job(pipe.recv()))
    except (KeyboardInterrupt, EOFError, OSError):
        return


def load_kernels() -> None:
    """Load the kernels that all jobs call, once for all workers, by adapting a bundled capture without writing it."""
    ready = ready_capture(min(example_captures_folder().glob("*.bvh"), key=lambda path: path.stat().st_size), GUESS_ALL)
    body = next(iter(bundled_characters().values())).morphology
    request = AdaptRequest(ready.motion, body, ready.contacts, actor=ready.actor.morphology, clears=True)
    character_report(request, ready.source_peaks, ready.capture.first_frame, by_frame=False)


def run_in_workers(jobs: Sequence[BatchJob], count: int | None, waited: Callable[[], object]) -> Iterator[JsonObject]:
    """Records of the jobs as soon as they are done by ``count`` processes (None for the number of cores), largest
    captures first.

    The job of a worker that dies is given to another one. ``waited`` is called while no job is done; it may raise an
    exception to stop.
    """
    forks = can_fork()
    waiting = deque(sorted(jobs, key=lambda job: job.size, reverse=True))
    count = min(count or os.cpu_count() or 1, len(jobs))
    if forks:
        if count > 1:
            load_kernels()
        gc.freeze()  # else the garbage collector of a fork would copy all that is loaded
    context = multiprocessing.get_context("fork") if forks else multiprocessing.get_context("spawn")
    workers, deaths = [Worker(context) for _ in range(count)], Counter[str]()
    try:
        for worker in workers:
            worker.give(waiting.popleft())
        while busy := {worker.pipe: worker for worker in workers if worker.job is not None}:
            waited()
            for pipe in wait(list(busy), POLL_SECONDS):
                worker = busy[pipe]  # type: ignore[index]
                job, record = worker.job, _answer(worker)
                assert job is not None
                if record is None:
                    worker.end()
                    workers[workers.index(worker)] = worker = Worker(context)
                    deaths[job.name] += 1
                    if deaths[job.name] < MOST_WORKER_DEATHS:
                        waiting.appendleft(job)
                    else:
                        record = death_record(job)
                if waiting:
                    worker.give(waiting.popleft())
                if record is not None:
                    yield record
    finally:
        for worker in workers:
            worker.end()


def _answer(worker: Worker) -> JsonObject | None:
    """Record of a worker's job; None if it died."""
    worker.job = None
    try:
        record: JsonObject = worker.pipe.recv()
    except (EOFError, OSError):
        return None
    return record
