"""The warm-up is followed until it is done, and its share is that of the kernels that are there."""

import sys
from concurrent.futures import CancelledError
from types import SimpleNamespace

import pytest

from studio.core.kernels.adapt import place_frames, solve_frames
from studio.engine import first_run, warm_up


def test_following_the_warm_up_reports_rising_shares_until_it_is_done(monkeypatch):
    shares = iter((0.2, 0.5, 0.9))
    running = iter((True, True, True, False))
    monkeypatch.setattr(warm_up, "ready_share", lambda: next(shares))
    monkeypatch.setattr(warm_up, "LOOKED_AT_EVERY", 0.0)
    monkeypatch.setattr(warm_up.WarmUp, "running", property(lambda _: next(running)))
    told = []
    warming = object.__new__(warm_up.WarmUp)
    warming._shares = {"standing": 0.05, "constraints": 0.2}
    warming.follow(lambda share, words: told.append((share / warm_up.TRANSLATED, words)))
    assert told == [(pytest.approx(0.45), ""), (pytest.approx(0.75), ""), (1.0, "")]


def test_the_share_counts_kernels_with_a_signature_once_each(monkeypatch):
    done, waiting = SimpleNamespace(signatures=[()]), SimpleNamespace(signatures=[])
    modules = {
        "studio.core.kernels.one": SimpleNamespace(done=done, waiting=waiting),
        "studio.core.kernels.two": SimpleNamespace(done=done, other=3),
    }
    monkeypatch.setattr(warm_up.sys, "modules", modules)
    share = warm_up.ready_share()
    monkeypatch.undo()
    assert share == 0.5


@pytest.fixture
def cold(monkeypatch, tmp_path):
    """A cache that is empty, and what was run in place of compiling."""
    ran = []
    halves = SimpleNamespace(run=lambda: ran.append("all"))
    monkeypatch.setattr(warm_up, "import_module", lambda _: halves)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(warm_up, "CHILD", (sys.executable, "-c", "print(0.5)"))
    return ran


def test_a_cold_cache_is_filled_by_two_processes_and_then_fetched(cold):
    warming = warm_up.WarmUp()
    warming.join()
    assert cold == ["all"]


def test_what_another_process_fails_in_is_done_and_told_here(cold, monkeypatch):
    monkeypatch.setattr(warm_up, "CHILD", (sys.executable, "-c", "raise SystemExit(3)"))
    warm_up.WarmUp().join()
    assert cold == ["all"]


def test_a_window_that_closes_does_not_wait_for_the_other_processes(cold, monkeypatch):
    monkeypatch.setattr(warm_up, "CHILD", (sys.executable, "-c", "import time; time.sleep(600)"))
    warming = warm_up.WarmUp()
    warming.stop()
    with pytest.raises(CancelledError):
        warming.join()
    assert cold == []


def test_a_full_cache_needs_no_other_process(cold, tmp_path):
    (tmp_path / "kernels").mkdir()
    (tmp_path / "kernels" / warm_up.LONGEST_TO_COMPILE.replace("*", "1")).touch()
    warm_up.WarmUp().join()
    assert cold == ["all"]


def test_the_name_by_which_a_full_cache_is_known_is_that_of_the_kernel():
    assert solve_frames._cache._impl.filename_base.startswith(warm_up.LONGEST_TO_COMPILE.removesuffix("*.nbc"))


def test_both_halves_compile_exactly_what_the_whole_needs():
    first_run.run()
    needed = [kernel.signatures for kernel in (place_frames, solve_frames)]
    first_run.run_standing()
    first_run.run_constraints()
    assert [kernel.signatures for kernel in (place_frames, solve_frames)] == needed
