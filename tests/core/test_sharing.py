"""Results that are computed once, in pieces and in half the memory."""

import gc
import threading
import tracemalloc
import weakref
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from random import Random
from typing import Any

import numpy as np
import pytest

from studio.core.compact_array import CompactArray
from studio.core.sharing import Shared
from studio.core.threads import run_in_threads

# Results that several callers need of one object are computed once, and kept while the object lives.


@dataclass(frozen=True)
class Owner:
    """Object that sources refer to."""


@dataclass(frozen=True)
class Source:
    """Told apart by its name from others of its owner; its remark changes no result."""

    owner: Owner
    name: str
    remark: str = ""


def _by_owner(computed: list[str]) -> Shared[Source, list[str]]:
    def compute(source: Source) -> list[str]:
        computed.append(source.name)
        return [source.name]

    return Shared(compute, owner=lambda source: source.owner, terms=lambda source: source.name)


def test_threads_that_ask_while_it_is_computed_share_the_result() -> None:
    begun, go_on, asked = threading.Event(), threading.Event(), []

    def compute(key: Owner) -> list[Owner]:
        asked.append(key)
        begun.set()
        go_on.wait()
        return []

    shared, key = Shared(compute), Owner()
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(shared, key)
        begun.wait()
        second = pool.submit(shared, key)
        while not second.running():
            pass
        threading.Timer(0.05, go_on.set).start()
        assert first.result() is second.result()
    assert shared(key) is first.result()
    assert len(asked) == 1


def test_a_thread_that_waits_for_one_that_is_cancelled_computes_it_itself() -> None:
    begun, go_on = threading.Event(), threading.Event()

    def compute(key: Owner, cancelled: bool) -> str:
        if cancelled:
            begun.set()
            go_on.wait()
            raise InterruptedError
        return "done"

    shared, key = Shared(compute), Owner()
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(shared, key, True)
        begun.wait()
        second = pool.submit(shared, key, False)
        threading.Timer(0.05, go_on.set).start()
        with pytest.raises(InterruptedError):
            first.result()
        assert second.result() == "done"


def test_what_goes_wrong_is_told_every_time() -> None:
    def compute(key: Owner) -> None:
        raise ValueError("wrong")

    shared, key = Shared(compute), Owner()
    for _ in range(2):
        with pytest.raises(ValueError, match="wrong"):
            shared(key)


def test_sources_that_differ_in_what_does_not_matter_share_one_result() -> None:
    computed: list[str] = []
    shared, owner = _by_owner(computed), Owner()
    assert shared(Source(owner, "a")) is shared(Source(owner, "a", "remark"))
    assert computed == ["a"]


def test_sources_of_one_owner_that_differ_have_results_of_their_own() -> None:
    computed: list[str] = []
    shared, owner = _by_owner(computed), Owner()
    assert [shared(Source(owner, name)) for name in "aba"] == [["a"], ["b"], ["a"]]
    assert shared(Source(Owner(), "a")) == ["a"]


def test_a_result_is_freed_with_its_owner() -> None:
    shared, owner = Shared(lambda _source: Owner()), Owner()
    result = weakref.ref(shared(owner))
    assert result() is not None
    del owner
    gc.collect()
    assert result() is None


# Pieces by two threads: all are done, what goes wrong is told, and who stops asking stops the work.


@pytest.mark.parametrize("count", [1, 2, 40])
def test_every_piece_is_done_and_the_share_grows_to_all(count: int) -> None:
    done: list[int] = []
    shares = list(run_in_threads(done.append, range(count)))
    assert sorted(done) == list(range(count))
    assert shares == [pytest.approx((index + 1) / count) for index in range(count)]


def test_what_a_piece_raises_is_raised() -> None:
    def work(piece: int) -> None:
        if piece == 3:
            raise ValueError("piece 3")

    with pytest.raises(ValueError, match="piece 3"):
        list(run_in_threads(work, range(10)))


def test_who_stops_asking_stops_the_work() -> None:
    begun, go_on = [], threading.Event()

    def work(piece: int) -> None:
        begun.append(piece)
        if piece > 1:
            go_on.wait()

    shares = run_in_threads(work, range(100))
    next(shares)
    threading.Timer(0.05, go_on.set).start()
    shares.close()
    assert len(begun) < 10


# Poses kept in 32 bits are read, copied and written to like arrays, and share what was not written.


ROWS, SHAPE = 40, (40, 5, 3)
INDICES: tuple[Any, ...] = (
    3, -1, np.int64(7), slice(None), slice(4, 30), slice(-9, None), slice(30, 90), slice(None, None, 7),
    slice(9, 4), ..., np.array([3, 1, 39]), np.arange(ROWS) % 3 == 0,
    (5, 2), (-2, slice(1, 3)), (slice(None), 0), (slice(8, 20), [1, 4]), (slice(8, 20), slice(None), 2),
    (slice(None), [0, 2], 1), (3, [0, 2]), (..., 2), (np.array([1, 2]), np.array([3, 4])), (slice(None), ..., 1), None,
)  # fmt: skip


def written(seed: int) -> tuple[CompactArray, np.ndarray]:
    """Numbers that were copied, cut and written to at random, and an array to which the same was done."""
    random = Random(seed)
    numbers = np.random.default_rng(seed).normal(size=SHAPE).astype(np.float32).astype(np.float64)
    kept = CompactArray(numbers)
    for _ in range(random.randrange(6)):
        first = random.randrange(ROWS)
        index = random.choice([slice(first, first + random.randrange(ROWS)), (..., 2), (slice(first, None), 1), first])
        kept, numbers = kept.copy(), numbers.copy()
        value = round(random.random() * 64) / 64
        kept[index] = value
        numbers[index] = value
    return kept, numbers


@pytest.mark.parametrize("seed", range(30))
def test_what_was_written_anywhere_is_read_by_every_index(seed: int) -> None:
    kept, numbers = written(seed)
    for index in INDICES:
        found = kept[index]
        np.testing.assert_array_equal(found, numbers[index])
        assert found.dtype == np.float64
    np.testing.assert_array_equal(np.asarray(kept), numbers)
    for rows in (slice(None), slice(7, 25), slice(-5, None), slice(20, 20)):
        assert len(kept.part(rows)) == len(numbers[rows])
        np.testing.assert_array_equal(kept.part(rows)[:], numbers[rows])
    with pytest.raises(IndexError):
        kept[ROWS]


def test_a_copy_changes_alone() -> None:
    numbers = np.random.default_rng(0).normal(size=SHAPE).astype(np.float32)
    kept = CompactArray(numbers)
    copy = kept.copy()
    copy[3:9] = 1.0
    other = copy.copy()
    other[5] = 2.0
    kept.part(slice(2, 20))[0:4] = 7.0
    np.testing.assert_array_equal(kept[:], numbers)
    assert (copy[3:9] == 1.0).all()
    assert (other[5] == 2.0).all()


def test_a_copy_costs_what_is_written_to_it() -> None:
    kept = CompactArray(np.zeros((100_000, 5, 3)))
    tracemalloc.start()
    copy = kept.copy()
    copy[500:600] = 1.0
    costs = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert costs < 2 * 100 * 15 * 4
