"""Timing that a busy machine does not distort: processor time of this process, cases in turn, median and best.

The processor time of all threads of the process is measured, without the time spent waiting for a processor. All cases
run once in every round, so that a minute in which the machine is slow affects all of them, and the median of each case
is over the same rounds.
"""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

LEAST_BENCH_SECONDS = 0.02
"""Least seconds of work between two readings of the clock."""


@dataclass(frozen=True)
class BenchJob:
    """Job to time: ``work`` does ``count`` units of it in one call."""

    name: str
    work: Callable[[], object]
    count: int = 1


@dataclass(frozen=True)
class JobTiming:
    """Microseconds for one unit of a job."""

    median: float
    best: float


def time_jobs(jobs: Sequence[BenchJob], rounds: int) -> list[JobTiming]:
    """Times of all ``jobs`` over ``rounds``; first calls, which compile and fill caches, do not count."""
    repeats = []
    for job in jobs:
        job.work()
        repeats.append(max(1, round(LEAST_BENCH_SECONDS / max(_seconds(job, 1), 1e-7))))
    taken: list[list[float]] = [[] for _ in jobs]
    for _ in range(rounds):
        for job, times, times_over in zip(jobs, taken, repeats, strict=True):
            times.append(1e6 * _seconds(job, times_over) / job.count)
    return [JobTiming(statistics.median(times), min(times)) for times in taken]


def _seconds(job: BenchJob, repeats: int) -> float:
    """Processor time of one call in seconds, as the mean over ``repeats``."""
    start = time.process_time()
    for _ in range(repeats):
        job.work()
    return (time.process_time() - start) / repeats
