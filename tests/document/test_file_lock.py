"""A lock of one document or journal: held by one alone, given back by whoever releases it or ends."""

import importlib
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from studio.document import file_lock


def test_a_lock_is_held_by_one_alone_until_it_is_released(tmp_path: Path) -> None:
    lock = file_lock.FileLock.acquired(tmp_path / "of" / "it")
    assert lock is not None
    assert file_lock.FileLock.acquired(tmp_path / "of" / "it") is None
    lock.release()
    again = file_lock.FileLock.acquired(tmp_path / "of" / "it")
    assert again is not None
    again.release()


def test_windows_locks_the_first_byte_without_waiting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its module stands in: a second lock of one file is refused with an OSError, as there."""
    held: set[str] = set()

    def locking(handle: int, mode: str, count: int) -> None:
        assert (mode, count) == ("without waiting", 1)
        name = Path(f"/proc/self/fd/{handle}").resolve().name
        if name in held:
            raise OSError("Permission denied")
        held.add(name)

    monkeypatch.setitem(sys.modules, "msvcrt", SimpleNamespace(locking=locking, LK_NBLCK="without waiting"))
    monkeypatch.setattr(sys, "platform", "win32")
    try:
        there = importlib.reload(file_lock)
        first, second, other = (there.FileLock.acquired(tmp_path / name) for name in ("lock", "lock", "other"))
        assert second is None
        for lock in (first, other):
            assert lock is not None
            lock.release()
    finally:
        monkeypatch.undo()
        importlib.reload(file_lock)
