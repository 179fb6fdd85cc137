"""Poses kept in 32 bits are read, copied and written to like arrays, and share what was not written."""

import tracemalloc
from random import Random
from typing import Any

import numpy as np
import pytest

from studio.core.compact_array import CompactArray

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
