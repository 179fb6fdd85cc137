"""Work in pieces that do not depend on each other, by two threads: numpy and kernels let go of Python's lock."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Piece = TypeVar("Piece")

THREADS = 2
_RUN = 1024
"""Frames worked on at a time."""


def in_threads(work: Callable[[Piece], object], pieces: Sequence[Piece]) -> Iterator[float]:
    """Do ``work`` for every piece; yields the share that is done. Who stops asking stops the work.

    What ``work`` raises is raised here, that of an earlier piece before that of a later one. Of one piece no thread is
    made.
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
    """``in_threads`` for ``count`` frames, a run of them at a time."""
    return in_threads(work, [slice(first, min(first + _RUN, count)) for first in range(0, count, _RUN)])


def do_over_frames(work: Callable[[slice], object], count: int) -> None:
    """``over_frames`` to its end, for who tells nobody how far it is."""
    for _ in over_frames(work, count):
        pass
