"""Independent pieces of work in two threads; numpy and kernels release Python's lock."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Piece = TypeVar("Piece")

THREADS = 2
_RUN = 1024
"""Number of frames in one piece of work."""


def run_in_threads(work: Callable[[Piece], object], pieces: Sequence[Piece]) -> Iterator[float]:
    """Call ``work`` for every piece in two threads, and yield the fraction that is done, from 0 to 1.

    Closing the generator stops the work. Errors of ``work`` are raised here, that of an earlier piece first. A single
    piece needs no thread.
    """
    if len(pieces) == 1:
        work(pieces[0])
        yield 1.0
        return
    with ThreadPoolExecutor(THREADS) as pool:
        waiting = [pool.submit(work, piece) for piece in pieces]
        try:
            for done, each in enumerate(waiting, 1):
                each.result()
                yield done / len(waiting)
        finally:
            for each in waiting:
                each.cancel()


def over_frames(work: Callable[[slice], object], count: int) -> Iterator[float]:
    """Call ``work`` for slices of ``count`` frames in two threads, and yield the fraction that is done, from 0 to 1."""
    return run_in_threads(work, [slice(first, min(first + _RUN, count)) for first in range(0, count, _RUN)])


def do_over_frames(work: Callable[[slice], object], count: int) -> None:
    """Call ``work`` for slices of ``count`` frames in two threads, and return when all are done."""
    for _ in over_frames(work, count):
        pass
