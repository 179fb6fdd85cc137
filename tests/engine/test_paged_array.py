"""Poses of long takes are kept in files, and read as those in memory are."""

import gc
import os

import numpy as np
import pytest

from studio.core.compact_array import CompactArray, compact_array
from studio.engine import paged_array
from studio.engine.paged_array import FileRows, paged_rows
from tests.core.test_sharing import INDICES, SHAPE

NUMBERS = np.random.default_rng(5).normal(size=SHAPE)


@pytest.fixture(autouse=True)
def every_length_is_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paged_array, "PAGED_BYTES", 0)
    monkeypatch.setattr(paged_array, "_ROWS_WRITTEN", 7)


def is_in_a_file(numbers: CompactArray) -> bool:
    return isinstance(numbers._kept, FileRows)


def open_files() -> int:
    return len(os.listdir("/proc/self/fd"))


def test_every_index_of_a_file_reads_the_numbers_of_memory_to_the_bit() -> None:
    kept, known = paged_rows(NUMBERS), compact_array(NUMBERS)
    assert is_in_a_file(kept)
    for write in (False, True):
        for index in INDICES:
            found = kept[index]
            assert found.dtype == np.float64
            np.testing.assert_array_equal(found, known[index])
        np.testing.assert_array_equal(np.asarray(kept), np.asarray(known))
        for rows in (slice(None), slice(7, 25), slice(-5, None), slice(20, 20)):
            np.testing.assert_array_equal(kept.part(rows)[:], known.part(rows)[:])
            np.testing.assert_array_equal(kept.part(rows).part(slice(1, 4))[:], known.part(rows).part(slice(1, 4))[:])
        if not write:
            kept, known = kept.copy(), known.copy()
            kept[9:12] = known[9:12] = 0.5
            assert is_in_a_file(kept)


def test_a_file_is_closed_with_the_last_rows_of_it() -> None:
    before = open_files()
    kept = paged_rows(NUMBERS)
    part = kept.part(slice(3, 9))
    assert open_files() == before + 1
    del kept
    gc.collect()
    assert open_files() == before + 1
    del part
    gc.collect()
    assert open_files() == before


def test_poses_stay_in_memory_where_no_file_can_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_arguments: object, **_named: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(paged_array.tempfile, "TemporaryFile", full)
    kept = paged_rows(NUMBERS)
    assert not is_in_a_file(kept)
    np.testing.assert_array_equal(kept[:], compact_array(NUMBERS)[:])


def test_many_takes_leave_files_for_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paged_array, "MOST_PAGE_FILES", 2)
    kept = [paged_rows(NUMBERS) for _ in range(3)]
    assert [is_in_a_file(each) for each in kept] == [True, True, False]
