"""The warm-up is followed until it is done, and its share is that of the kernels that are there."""

import subprocess
import sys
from concurrent.futures import CancelledError
from pathlib import Path
from types import SimpleNamespace

import pytest

from studio.cli import first_run, warm_up
from studio.core.kernels.adapt import place_frames, solve_frames
from studio.core.kernels.body.normalize import encode_frames


def test_following_the_warm_up_reports_rising_shares_until_it_is_done(monkeypatch):
    shares = iter((0.2, 0.5, 0.9))
    running = iter((True, True, True, False))
    monkeypatch.setattr(warm_up, "ready_share", lambda: next(shares))
    monkeypatch.setattr(warm_up, "LOOKED_AT_EVERY", 0.0)
    monkeypatch.setattr(warm_up.WarmUp, "running", property(lambda _: next(running)))
    told = []
    warming = object.__new__(warm_up.WarmUp)
    warming._shares = dict(zip(warm_up.HALVES, (0.05, 0.2), strict=True))
    warming.follow(lambda share, words: told.append((share / warm_up.TRANSLATED, words)))
    assert told == [(pytest.approx(0.45), ""), (pytest.approx(0.75), ""), (1.0, "")]


def test_what_was_told_is_not_taken_back_when_more_kernels_are_loaded(monkeypatch):
    shares, running = iter((0.6, 0.2, 0.9)), iter((True, True, True, False))
    monkeypatch.setattr(warm_up, "ready_share", lambda: next(shares))
    monkeypatch.setattr(warm_up, "LOOKED_AT_EVERY", 0.0)
    monkeypatch.setattr(warm_up.WarmUp, "running", property(lambda _: next(running)))
    told = []
    warming = object.__new__(warm_up.WarmUp)
    warming._shares = dict.fromkeys(warm_up.HALVES, 0.0)
    warming.follow(lambda share, _words: told.append(share / warm_up.TRANSLATED))
    assert told == [pytest.approx(0.6), pytest.approx(0.6), pytest.approx(0.9)]


def test_kernels_that_are_loaded_while_they_are_counted_do_not_end_the_telling(monkeypatch):
    module = SimpleNamespace()

    class Kernel:
        @property
        def signatures(self):
            setattr(module, f"loaded_{len(vars(module))}", None)
            return [()]

    module.done = Kernel()
    monkeypatch.setattr(warm_up.sys, "modules", {"studio.core.kernels.one": module})
    share = warm_up.ready_share()
    monkeypatch.undo()
    assert share == 1.0


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
    parts = SimpleNamespace(run=lambda: ran.append("most"), run_seldom=lambda: ran.append("rest"))
    monkeypatch.setattr(warm_up, "import_module", lambda _: parts)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(warm_up, "CHILD", (sys.executable, "-c", "print(0.5)"))
    return ran


def test_a_cold_cache_is_filled_by_two_processes_and_then_fetched(cold):
    warming = warm_up.WarmUp()
    warming.follow(lambda _share, _text: None)
    warming.join()
    assert cold == ["most", "rest"]


def test_a_verb_says_what_it_waits_for_and_how_far_that_is(cold, capsys):
    warm_up.compile_first()
    told = capsys.readouterr().err.splitlines()
    assert "The solver is compiled, once on this machine" in told[0]
    assert told[-1] == "100% The solver is ready"
    assert cold == ["most", "rest"]


def test_who_only_reads_says_so_where_that_is_still_to_be_compiled_and_else_nothing(cold, tmp_path, capsys):
    warm_up.tell_what_reading_waits_for()
    assert capsys.readouterr().err == "What reads motions is compiled, once on this machine: some ten seconds.\n"
    (tmp_path / warm_up.LAST_TO_READ.replace("*", "1")).touch()
    warm_up.tell_what_reading_waits_for()
    assert capsys.readouterr().err == ""


def test_what_another_process_fails_in_is_done_and_told_here(cold, monkeypatch):
    monkeypatch.setattr(warm_up, "CHILD", (sys.executable, "-c", "raise SystemExit(3)"))
    warm_up.WarmUp().join()
    assert cold[0] == "most"


def test_a_window_that_closes_does_not_wait_for_the_other_processes(cold, monkeypatch):
    monkeypatch.setattr(warm_up, "CHILD", (sys.executable, "-c", "import time; time.sleep(600)"))
    warming = warm_up.WarmUp()
    warming.stop()
    with pytest.raises(CancelledError):
        warming.join()
    assert cold == []


def test_a_full_cache_needs_no_other_process(cold, capsys):
    warm_up.compile_first()
    capsys.readouterr()
    cold.clear()
    warm_up.compile_first()
    assert cold == []
    assert capsys.readouterr().err == ""
    warm_up.WarmUp().join()
    assert cold[0] == "most"


def test_a_warm_up_that_was_stopped_is_told_of_the_next_time_too(cold, capsys):
    warming = warm_up.WarmUp(held=True)
    warming.stop()
    warm_up.compile_first()
    assert "The solver is compiled" in capsys.readouterr().err


def test_while_it_is_held_other_processes_compile_and_this_one_fetches_nothing(cold):
    warming = warm_up.WarmUp(held=True)
    warming.join_picture()
    assert cold == []
    warming.go_on()
    warming.join()
    assert cold[0] == "most"


def test_one_that_is_held_can_be_stopped(cold):
    warming = warm_up.WarmUp(held=True)
    warming.stop()
    warming.join_picture()
    assert cold == []


def test_a_process_whose_listener_is_gone_ends_without_a_word():
    process = (sys.executable, "-m", "studio.cli.warm_up", "first_run", "run_standing")
    with subprocess.Popen(process, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
        child.stdout.close()
        assert child.wait(60) == 0
        assert child.stderr.read() == b""


def test_the_name_by_which_a_cache_is_known_to_read_is_that_of_the_kernel():
    assert encode_frames._cache._impl.filename_base.startswith(warm_up.LAST_TO_READ.removesuffix("*.nbc"))


def test_both_halves_compile_exactly_what_the_whole_needs():
    first_run.run()
    needed = [kernel.signatures for kernel in (place_frames, solve_frames)]
    first_run.run_standing()
    first_run.run_constraints()
    assert [kernel.signatures for kernel in (place_frames, solve_frames)] == needed


def test_nothing_is_compiled_after_the_warm_up():
    """Whatever is asked then: every kind of constraint, by itself and with others, still and growing bodies, files."""
    process = (sys.executable, "-m", "tests.cli.late_kernels")
    done = subprocess.run(process, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert (done.stdout.strip(), done.returncode) == ("", 0), done.stderr
