"""The warm-up is followed until it is done, and its share is that of the work that is done."""

import os
import subprocess
import sys
from concurrent.futures import CancelledError
from pathlib import Path
from types import SimpleNamespace

import pytest

from studio.core.kernels.body.encode_channels import encode_frames
from studio.core.kernels.solve_clip import place_frames, solve_frames
from studio.startup import first_run, kernel_warm_up
from studio.startup.compile_work import CompileWork, all_kernels, kernels_below
from tests.patience import SECONDS

FETCHED = [kernel_warm_up.WARM_STANDING, "first_run.run", kernel_warm_up.WARM_REST]


def followed(monkeypatch, *steps):
    """Reports while the shares of both processes are as in ``steps``."""
    left = list(steps)
    warming = object.__new__(kernel_warm_up.WarmUp)
    warming.cold, warming._shares = True, dict.fromkeys(kernel_warm_up.WARM_UPS_BY_PROCESS, 0.0)

    def is_running(_self):
        if left:
            warming._shares = dict(zip(kernel_warm_up.WARM_UPS_BY_PROCESS, left.pop(0), strict=True))
            return True
        return False

    monkeypatch.setattr(kernel_warm_up, "time", SimpleNamespace(sleep=lambda _seconds: None))
    monkeypatch.setattr(kernel_warm_up.WarmUp, "running", property(is_running))
    told = []
    warming.follow(lambda share, words: told.append((share / kernel_warm_up.COMPILED_FRACTION, words)))
    return told


def test_it_is_as_far_as_the_process_that_is_furthest_from_its_end(monkeypatch):
    told = followed(monkeypatch, (0.2, 0.1), (0.6, 0.2), (1.0, 0.3), (1.0, 1.0))
    assert [share for share, _ in told] == [0.1, 0.2, 0.3, 1.0]


def test_a_process_that_counts_anew_takes_nothing_back():
    warming = object.__new__(kernel_warm_up.WarmUp)
    part = kernel_warm_up.WARM_UPS_BY_PROCESS[0]
    warming._shares, warming._running = {part: 0.0}, {}
    warming._listen(part, [b"first_run.run_standing 0.400\n", b"first_run.run_rest 0.100\n", b"first_run.ru"])
    assert warming._shares == {part: 0.4}
    assert warming._running == {part: "first_run.run_rest"}


class Counted:
    """A kernel of some bytes that calls others."""

    def __init__(self, size, **calls):
        code = SimpleNamespace(co_code=bytes(size), co_names=tuple(calls), co_consts=())
        self.py_func = SimpleNamespace(__code__=code, __globals__=calls)
        self.py_func = type("Function", (), vars(self.py_func))
        self.signatures = []


def test_the_share_is_that_of_the_bytes_of_kernels_that_are_translated_with_all_they_call():
    leaf, aside = Counted(30), Counted(50)
    middle = Counted(20, leaf=leaf)
    top = Counted(100, middle=middle, aside=aside, other=3)
    compiling = CompileWork([top])
    assert compiling.fraction_done(1.0) == 0.0
    middle.signatures.append(())
    assert compiling.fraction_done(2.0) == 0.25
    top.signatures.append(())
    assert compiling.fraction_done(3.0) == 1.0


def test_linking_takes_its_part_of_the_share_by_the_pace_of_translating():
    kernel = Counted(30)
    compiling = CompileWork([kernel], linking=0.25)
    kernel.signatures.append(())
    shares = [compiling.fraction_done(spent) for spent in (8.0, 9.0, 10.0, 11.0)]
    assert shares == pytest.approx([0.8, 0.9, 1.0, 1.0])


def test_no_kernel_is_left_out_of_what_is_counted():
    """All that the warm-up has compiled in this process, and nothing that is not compiled by it."""
    kernels = all_kernels()
    assert len(kernels) > 500
    compiled = kernels_below(each for each in kernels if each.signatures)
    assert [each.py_func.__name__ for each in kernels if id(each) not in compiled] == []


@pytest.fixture
def cold(monkeypatch, tmp_path):
    """A cache that is empty, and what was run in place of compiling."""
    ran = []
    monkeypatch.setattr(kernel_warm_up, "run", ran.append)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(kernel_warm_up, "CHILD_COMMAND", (sys.executable, "-c", "print('first_run.run_standing 0.5')"))
    return ran


def test_a_cold_cache_is_filled_by_two_processes_and_then_fetched(cold):
    warming = kernel_warm_up.WarmUp()
    warming.follow(lambda _share, _text: None)
    warming.join()
    assert cold == FETCHED


def test_a_verb_says_what_it_waits_for_and_how_far_that_is(cold, capsys):
    kernel_warm_up.compile_first()
    told = capsys.readouterr().err.splitlines()
    assert "Compiling the solver, once on this machine" in told[0]
    assert told[-1] == "100% The solver is ready"
    assert cold == FETCHED


def test_who_only_reads_says_so_where_that_is_still_to_be_compiled_and_else_nothing(cold, tmp_path, capsys):
    kernel_warm_up.print_wait_reason()
    assert capsys.readouterr().err == "Compiling the file readers, once on this computer: about ten seconds.\n"
    (tmp_path / kernel_warm_up.READING_KERNEL_PATTERN.replace("*", "1")).touch()
    kernel_warm_up.print_wait_reason()
    assert capsys.readouterr().err == ""


def test_what_another_process_fails_in_is_done_and_told_here(cold, monkeypatch):
    monkeypatch.setattr(kernel_warm_up, "CHILD_COMMAND", (sys.executable, "-c", "raise SystemExit(3)"))
    kernel_warm_up.WarmUp().join()
    assert cold[0] == FETCHED[0]


def test_a_window_that_closes_does_not_wait_for_the_other_processes(cold, monkeypatch):
    monkeypatch.setattr(kernel_warm_up, "CHILD_COMMAND", (sys.executable, "-c", "import time; time.sleep(600)"))
    warming = kernel_warm_up.WarmUp()
    warming.stop()
    with pytest.raises(CancelledError):
        warming.join()
    assert cold == []


def test_a_full_cache_needs_no_other_process(cold, capsys):
    kernel_warm_up.compile_first()
    capsys.readouterr()
    cold.clear()
    kernel_warm_up.compile_first()
    assert cold == []
    assert capsys.readouterr().err == ""
    kernel_warm_up.WarmUp().join()
    assert cold[0] == FETCHED[0]


def test_a_warm_up_that_was_stopped_is_told_of_the_next_time_too(cold, capsys):
    warming = kernel_warm_up.WarmUp(held=True)
    warming.stop()
    kernel_warm_up.compile_first()
    assert "Compiling the solver" in capsys.readouterr().err


def test_while_it_is_held_other_processes_compile_and_this_one_fetches_nothing(cold):
    warming = kernel_warm_up.WarmUp(held=True)
    warming.join_picture()
    assert cold == []
    warming.release()
    warming.join()
    assert cold[0] == FETCHED[0]


def test_one_that_is_held_can_be_stopped(cold):
    warming = kernel_warm_up.WarmUp(held=True)
    warming.stop()
    warming.join_picture()
    assert cold == []


def test_a_process_whose_listener_is_gone_ends_without_a_word():
    process = (sys.executable, "-m", "studio.startup.kernel_warm_up", kernel_warm_up.WARM_STANDING)
    with subprocess.Popen(process, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
        child.stdout.close()
        assert child.wait(SECONDS) == 0
        assert child.stderr.read() == b""


def test_the_name_by_which_a_cache_is_known_to_read_is_that_of_the_kernel():
    assert encode_frames._cache._impl.filename_base.startswith(
        kernel_warm_up.READING_KERNEL_PATTERN.removesuffix("*.nbc")
    )


def test_both_halves_compile_exactly_what_the_whole_needs():
    first_run.run()
    needed = [kernel.signatures for kernel in (place_frames, solve_frames)]
    first_run.run_standing()
    first_run.run_constraints()
    first_run.run_rest()
    assert [kernel.signatures for kernel in (place_frames, solve_frames)] == needed


def test_nothing_is_compiled_after_the_warm_up():
    """Requests of all kinds: every kind of constraint, by itself and with others, still and growing bodies, files."""
    process = (sys.executable, "-m", "tests.startup.late_kernels")
    done = subprocess.run(process, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert (done.stdout.strip(), done.returncode) == ("", 0), done.stderr


def test_what_was_compiled_before_a_kernel_was_written_is_compiled_again(cold, tmp_path):
    """A checkout made anew at the same place holds the same kernels, which numba takes for others all the same."""
    mark = tmp_path / kernel_warm_up.COMPLETE_MARK_FILE
    mark.touch()
    assert not kernel_warm_up.is_cold()
    os.utime(mark, (1e9, 1e9))
    assert kernel_warm_up.is_cold()


def test_bodies_can_stand_before_the_constraints_are_compiled(cold, monkeypatch):
    script = (
        "import sys, time; constraints = 'run_constraints' in sys.argv[1]\n"
        "print('first_run.run_rest 0.9', flush=True); time.sleep(600 if constraints else 0)"
    )
    monkeypatch.setattr(kernel_warm_up, "CHILD_COMMAND", (sys.executable, "-c", script))
    warming = kernel_warm_up.WarmUp()
    warming.join_grounded()
    assert cold == [kernel_warm_up.WARM_STANDING]
    assert warming.grounded
    assert not warming.ready
    warming.stop()


def test_a_second_start_says_nothing_of_compiling(cold):
    kernel_warm_up.WarmUp().join()
    first = kernel_warm_up.WarmUp()
    first.stop()
    Path(os.environ["NUMBA_CACHE_DIR"], kernel_warm_up.COMPLETE_MARK_FILE).touch()
    second = kernel_warm_up.WarmUp(held=True)
    assert (second.cold, second.words) == (False, "")
    second.stop()


def test_the_processes_are_as_urgent_as_the_one_that_waits_for_them(cold, monkeypatch, tmp_path):
    """Of two processors that two others keep busy they get half, and so end in twice their time."""
    script = "import os, sys; print(os.nice(0), file=open(sys.argv[-1].replace('.', '-'), 'w'))"
    monkeypatch.setattr(kernel_warm_up, "CHILD_COMMAND", (sys.executable, "-c", script))
    monkeypatch.setattr("studio.io.child_process.STUDIO_ROOT", tmp_path)
    kernel_warm_up.WarmUp().join()
    told = {
        part[-1]: (tmp_path / part[-1].replace(".", "-")).read_text()
        for part in (kernel_warm_up.PICTURE_FUNCTIONS, *kernel_warm_up.WARM_UPS_BY_PROCESS)
    }
    assert told == dict.fromkeys(told, f"{os.nice(0)}\n")
