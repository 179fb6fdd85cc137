"""A short visit of the monkey; ``make soak`` lets it stay for a hundred times as long."""

import subprocess
import sys

import pytest

from tests.monkey.report import Schedule, seconds_of_own, slowness

EVENTS, ROUND = 1000, 200
"""As many windows in a thousand events as in five thousand of its usual rounds."""


def test_the_window_survives_a_thousand_events() -> None:
    command = [sys.executable, "-m", "tests.monkey", "--events", str(EVENTS), "--round", str(ROUND)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stderr}{done.stdout}"


def kept(passed: float, *, worked: float = 0.0, window_waited: float = 0.0, drew: float = 0.0, others: float = 0.0):
    """Own seconds of a turn of a window, with a thread that draws for it and another one."""
    before = {1: Schedule(5.0, 2.0, False), 2: Schedule(1.0, 1.0, True), 3: Schedule(9.0, 0.0, False)}
    now = {
        1: Schedule(5.0 + worked, 2.0 + window_waited, False),
        2: Schedule(1.0 + drew, 1.0, True),
        3: Schedule(9.0, others, False),
        4: Schedule(7.0, 7.0, False),  # began within the turn
    }
    return seconds_of_own(passed, before, now, 1)


def test_a_busy_machine_makes_no_gap_and_work_or_an_idle_wait_makes_one() -> None:
    assert kept(2.0, worked=1.9, window_waited=0.1) == pytest.approx(1.9)
    assert kept(9.0, worked=1.9, window_waited=3.0, others=4.0) == pytest.approx(2.0)
    assert kept(2.0, drew=1.8, worked=0.1, others=0.5) == pytest.approx(1.9)
    assert kept(2.0) == pytest.approx(2.0)  # it slept
    assert kept(2.0, worked=0.1, window_waited=0.9, others=0.9) == pytest.approx(0.2)
    assert slowness() >= 1.0
