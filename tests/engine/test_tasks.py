"""Jobs tell how far they are, stop when asked, and fail in one way."""

import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
import shiboken6
from PySide6.QtCore import QCoreApplication

from studio.core.errors import StudioError
from studio.engine.background_tasks import Progress, TaskRunner
from tests.patience import SECONDS


@pytest.fixture
def runner(qapp: Any) -> Iterator[TaskRunner]:
    runner = TaskRunner()
    yield runner
    runner.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("task-")]


def until_cancelled(progress: Progress) -> None:
    while True:
        progress.report(0.5, "Working")
        threading.Event().wait(0.002)


def test_a_job_reports_and_its_result_comes_on_the_windows_thread(qtbot: Any, runner: TaskRunner) -> None:
    heard: list[Any] = []
    runner.progressed.connect(lambda task, share, text: heard.append((share, text)))
    with qtbot.waitSignal(runner.finished):
        runner.run(
            "Import",
            lambda progress: (progress.report(0.25, "Reading"), 42)[1],
            lambda result: heard.append((result, threading.current_thread())),
        )
    assert heard == [(0.25, "Reading"), (42, threading.main_thread())]
    assert runner.running == ()


def test_a_cancelled_job_ends_without_a_result(qtbot: Any, runner: TaskRunner) -> None:
    results: list[Any] = []
    task = runner.run("Import", until_cancelled, results.append)
    with qtbot.waitSignal(runner.cancelled):
        runner.cancel(task)
    assert results == []


def test_a_sentence_for_the_user_is_told_as_it_is(qtbot: Any, runner: TaskRunner) -> None:
    def fail(progress: Progress) -> None:
        raise StudioError("The file is empty.")

    with qtbot.waitSignal(runner.failed) as failure:
        runner.run("Import", fail)
    assert failure.args[1] == "The file is empty."


def test_a_fault_of_the_program_is_told_too(qtbot: Any, runner: TaskRunner) -> None:
    with qtbot.waitSignal(runner.failed) as failure:
        runner.run("Import", lambda progress: 1 // 0)
    assert "Import" in failure.args[1]
    assert "ZeroDivisionError" in failure.args[1]


def test_what_goes_wrong_with_the_result_fails_the_job_too(qtbot: Any, runner: TaskRunner) -> None:
    def refuse(result: int) -> None:
        raise StudioError("No.")

    with qtbot.waitSignal(runner.failed):
        runner.run("Import", lambda progress: 1, refuse)


def test_closing_cancels_what_runs(qapp: Any) -> None:
    runner = TaskRunner()
    runner.run("Import", until_cancelled)
    runner.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("task-")]


def test_a_job_that_hears_nothing_does_not_hold_up_the_end(qapp: Any) -> None:
    runner, going_on, done = TaskRunner(), threading.Event(), list[int]()
    runner.run("Import", lambda _progress: going_on.wait(SECONDS), done.append)
    runner.close()
    assert any(thread.name.startswith("task-") for thread in threading.enumerate())
    going_on.set()
    for thread in threading.enumerate():
        if thread.name.startswith("task-"):
            thread.join()
    QCoreApplication.processEvents()
    assert done == []


def test_a_job_that_outlives_its_runner_ends_in_silence(qapp: Any) -> None:
    runner, going_on = TaskRunner(), threading.Event()
    runner.run("Import", lambda progress: (going_on.wait(SECONDS), progress.report(0.5)))
    runner.close(patience=0.0)
    [thread] = [thread for thread in threading.enumerate() if thread.name.startswith("task-")]
    shiboken6.delete(runner)
    going_on.set()
    thread.join(SECONDS)  # pytest fails a test in which a thread ends with an exception
    assert not thread.is_alive()


def test_a_job_that_has_ended_when_the_runner_is_closed_is_not_told(qapp: Any) -> None:
    runner, done = TaskRunner(), list[int]()
    runner.run("Import", lambda _progress: 1, done.append)
    while any(thread.name.startswith("task-") for thread in threading.enumerate()):
        time.sleep(0.001)
    runner.close()
    QCoreApplication.processEvents()
    assert done == []
