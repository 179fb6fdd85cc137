"""The newest request wins, whatever the solver's timing; nothing is left when the scheduler is closed."""

import threading
import time
from collections import Counter
from random import Random
from typing import Any

import pytest

from studio.engine.scheduler import SolveScheduler
from tests.patience import PATIENCE

REQUESTS = 1000


def settle(qtbot: Any, scheduler: SolveScheduler) -> None:
    qtbot.waitUntil(lambda: not scheduler.busy, timeout=PATIENCE)


@pytest.fixture
def scheduler(qapp: Any) -> Any:
    scheduler = SolveScheduler(workers=3)
    yield scheduler
    scheduler.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("solve-")]


def test_the_newest_revision_wins_whatever_the_solver_takes(qtbot: Any, scheduler: SolveScheduler) -> None:
    chance = Random(7)
    seen: dict[str, list[int]] = {}
    at_work: Counter[str] = Counter()
    twice: list[str] = []
    lock = threading.Lock()

    def solve(key: str, revision: int, seconds: float) -> int:
        with lock:
            at_work[key] += 1
            if at_work[key] > 1:
                twice.append(key)
        time.sleep(seconds)
        with lock:
            at_work[key] -= 1
        return revision

    scheduler.answered.connect(lambda key, revision, value: seen.setdefault(key, []).append(value))
    newest: dict[str, int] = {}
    for revision in range(REQUESTS):
        key = chance.choice("abcde")
        newest[key] = revision
        seconds = chance.random() ** 4 * 0.005
        scheduler.request(key, revision, lambda k=key, r=revision, s=seconds: solve(k, r, s))
        if chance.random() < 0.1:
            qtbot.wait(1)
    settle(qtbot, scheduler)
    assert {key: values[-1] for key, values in seen.items()} == newest
    assert all(values == sorted(values) for values in seen.values())
    assert not twice


def test_revisions_fed_as_3_1_2_show_3(qtbot: Any, scheduler: SolveScheduler) -> None:
    seen: list[int] = []
    scheduler.answered.connect(lambda key, revision, value: seen.append(revision))
    for revision in (3, 1, 2):
        scheduler.request("a", revision, lambda: None)
    settle(qtbot, scheduler)
    assert seen == [3]


def test_windows_of_all_come_before_the_whole_of_any(qtbot: Any, qapp: Any) -> None:
    scheduler = SolveScheduler(workers=1)
    hold, seen = threading.Event(), []
    scheduler.request("gate", 0, hold.wait)
    for key in "ab":
        scheduler.request(key, 1, lambda k=key: seen.append(f"window {k}"), lambda k=key: seen.append(f"whole {k}"))
    hold.set()
    settle(qtbot, scheduler)
    scheduler.close()
    assert seen == ["window a", "window b", "whole a", "whole b"]


def test_answers_come_on_the_thread_of_the_window(qtbot: Any, scheduler: SolveScheduler) -> None:
    threads: list[Any] = []
    scheduler.answered.connect(lambda *answer: threads.append((threading.current_thread(), answer[2])))
    scheduler.request("a", 1, threading.current_thread)
    settle(qtbot, scheduler)
    ((shown_on, solved_on),) = threads
    assert shown_on is threading.main_thread()
    assert solved_on is not threading.main_thread()


def test_an_error_is_handed_on_and_the_worker_lives(qtbot: Any, scheduler: SolveScheduler) -> None:
    errors: list[Exception] = []
    answers: list[int] = []
    scheduler.failed.connect(lambda key, revision, error: errors.append(error))
    scheduler.answered.connect(lambda key, revision, value: answers.append(value))
    for key in "abcd":
        scheduler.request(key, 1, lambda: 1 // 0)
    settle(qtbot, scheduler)
    scheduler.request("a", 2, lambda: 5)
    settle(qtbot, scheduler)
    assert [type(error) for error in errors] == [ZeroDivisionError] * 4
    assert answers == [5]


def test_what_is_forgotten_is_not_shown(qtbot: Any, scheduler: SolveScheduler) -> None:
    seen: list[str] = []
    started, hold = threading.Event(), threading.Event()
    scheduler.answered.connect(lambda key, revision, value: seen.append(key))

    def slow() -> None:
        started.set()
        hold.wait()

    scheduler.request("a", 1, slow, lambda: None)
    started.wait()
    scheduler.forget("a")
    hold.set()
    settle(qtbot, scheduler)
    assert seen == []


def test_closing_at_random_moments_leaves_no_thread(qtbot: Any, qapp: Any) -> None:
    chance = Random(3)
    for _ in range(30):
        scheduler = SolveScheduler(workers=2)
        for revision in range(20):
            scheduler.request(chance.choice("ab"), revision, lambda: time.sleep(0.0005))
        time.sleep(chance.random() * 0.003)
        scheduler.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("solve-")]
