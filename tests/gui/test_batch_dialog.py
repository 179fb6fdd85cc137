"""Many files from the window: the dialog over a batch, with real processes."""

import threading

import pytest
from PySide6.QtCore import QCoreApplication, QEvent, Qt
from PySide6.QtTest import QTest

from studio.app.batch_dialog import BatchDialog
from studio.io.export import write_capture
from studio.jobs.batch import BatchResult
from tests.builders import make_capture, make_project
from tests.patience import PATIENCE


@pytest.fixture
def project():
    return make_project(characters=1)


@pytest.fixture
def dialog(window, tmp_path):
    (tmp_path / "captures").mkdir()
    for seed, name in enumerate(("walk", "run")):
        write_capture(make_capture(seed=seed), tmp_path / "captures" / f"{name}.bvh")
    window.actions_by_id.by_id["batch"].trigger()
    [dialog] = window.findChildren(BatchDialog)
    for key, check in dialog.characters.items():
        check.setChecked(key == "actor")
    dialog.source.setText(str(tmp_path / "captures"))
    return dialog


def press(button):
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def test_a_folder_is_adapted_with_progress_and_its_summary_offered(qtbot, dialog, tmp_path, monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)  # one worker to start
    (tmp_path / "captures" / "broken.bvh").write_text("HIERARCHY\n")
    assert not dialog.start.isEnabled()
    dialog.out.setText(str(tmp_path / "out"))
    shares = []
    dialog.bar.valueChanged.connect(shares.append)
    press(dialog.start)
    assert dialog.stop.isVisible()
    qtbot.waitUntil(lambda: not dialog.running, timeout=PATIENCE)
    assert dialog.words.text() == "3 files: 2 adapted, 0 unchanged, 1 failed."
    assert (tmp_path / "out" / "walk_actor.bvh").is_file()
    assert dialog.show_page.isVisible()
    assert len([share for share in shares if 0 < share < 1000]) >= 2


def test_what_the_batch_refuses_is_said_in_the_dialog(qtbot, dialog, tmp_path):
    dialog.out.setText(str(tmp_path / "out"))
    dialog.source.setText(str(tmp_path / "nowhere"))
    press(dialog.start)
    qtbot.waitUntil(lambda: not dialog.running, timeout=PATIENCE)
    assert "is not a folder" in dialog.words.text()


def test_stopped_while_the_workers_start_it_ends_at_once_and_nothing_goes_on(qtbot, dialog, tmp_path):
    dialog.out.setText(str(tmp_path / "out"))
    press(dialog.start)
    QTest.qWait(300)
    press(dialog.stop)
    qtbot.waitUntil(lambda: not dialog.running, timeout=PATIENCE)
    assert dialog.words.text().startswith("Stopped.")
    assert dialog.start.isEnabled()


@pytest.mark.parametrize("leave", [BatchDialog.close, BatchDialog.reject], ids=["button", "Escape"])
def test_closed_while_it_runs_it_goes_on_and_says_in_the_window_what_came_of_it(
    qtbot, window, dialog, tmp_path, monkeypatch, leave
):
    answer = BatchResult(tmp_path, ({"name": "walk.bvh"}, {"name": "run.bvh"}), unchanged=0)
    closed = threading.Event()
    monkeypatch.setattr("studio.app.batch_dialog.run_batch", lambda *_: (closed.wait(), answer)[1])
    dialog.out.setText(str(tmp_path / "out"))
    press(dialog.start)
    leave(dialog)
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    closed.set()
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)
    assert window.strip.text == "2 files: 2 adapted, 0 unchanged, 0 failed."
