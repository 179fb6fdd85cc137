"""Sources that have moved, in the window: found again after a project is reopened, or chosen by hand."""

import pytest
from PySide6.QtWidgets import QFileDialog

from studio.app import relinking
from studio.io.export import take_of_capture, write_take
from studio.io.project.project_file import read_project, write_project
from tests.builders import make_capture
from tests.gui.window_use import PATIENCE, drop, wait_until_idle


@pytest.fixture
def imported(qtbot, window, walk):
    """The id of a capture that was dropped on the window."""
    drop(window, walk)
    wait_until_idle(qtbot, window)
    return list(window.bench.document.project.captures)[-1]


def reopen(window, path):
    """Save the project, and open it as another session does, which knows no source."""
    write_project(path, window.bench.document.project, "document")
    window.bench.document.show_opened(read_project(path))
    window.bench.sources.clear()
    window.bench.settings._store.clear()


def answer_with(monkeypatch, path):
    monkeypatch.setattr(relinking, "ask_file", lambda bench, title, kind, then: then(path))


def test_after_reopening_a_moved_and_renamed_source_is_read_again(qtbot, window, walk, imported, tmp_path):
    (tmp_path / "project" / "takes").mkdir(parents=True)
    reopen(window, tmp_path / "project" / "scene.studio")
    moved = walk.rename(tmp_path / "project" / "takes" / "renamed.bvh")
    window.inspector.reimport_requested.emit(imported, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    assert window.bench.document.project.captures[imported].unit == "inch"
    assert window.bench.sources[imported] == moved


def test_the_message_of_a_missing_source_offers_to_relink_it_and_goes_on(
    qtbot, window, walk, imported, tmp_path, monkeypatch
):
    (tmp_path / "project").mkdir()
    reopen(window, tmp_path / "project" / "scene.studio")
    (tmp_path / "far" / "away" / "deep").mkdir(parents=True)
    moved = walk.rename(tmp_path / "far" / "away" / "deep" / "other.bvh")
    window.inspector.reimport_requested.emit(imported, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    assert window.strip.text.startswith("The source file of walk cannot be found. Relink it")
    before = window.bench.document.undo_stack.count()
    answer_with(monkeypatch, moved)
    window.strip.press("Relink…")
    qtbot.waitUntil(lambda: window.bench.document.project.captures[imported].unit == "inch", timeout=PATIENCE)
    assert window.bench.document.undo_stack.count() == before + 1  # the reading; the content is what it was


def test_a_source_of_other_content_is_linked_as_one_step_that_can_be_undone(
    qtbot, window, walk, imported, tmp_path, monkeypatch
):
    document = window.bench.document
    old = document.project.captures[imported]
    walk.unlink()
    (tmp_path / "far" / "away" / "deep").mkdir(parents=True)
    other = tmp_path / "far" / "away" / "deep" / "other.bvh"
    write_take(take_of_capture(make_capture(frames=9)), other)
    answer_with(monkeypatch, other)
    document.selection.set(("captures", imported))
    window.actions_by_id.by_id["relink"].trigger()
    qtbot.waitUntil(lambda: document.project.captures[imported].source == "other.bvh", timeout=PATIENCE)
    assert document.history[-1] == "Relink walk"
    assert "Its content differs from that of the imported file." in window.strip.text
    assert document.project.captures[imported].frame_count == old.frame_count
    document.undo_stack.undo()
    assert document.project.captures[imported].source == old.source


def test_relinking_tells_where_a_source_lies_that_is_found(qtbot, window, walk, imported):
    window.bench.document.selection.set(("captures", imported))
    window.actions_by_id.by_id["relink"].trigger()
    wait_until_idle(qtbot, window)
    assert str(walk) in window.strip.text
    window.strip.press("Choose another…")
    dialogs = window.findChildren(QFileDialog)
    assert [dialog.windowTitle() for dialog in dialogs] == ["Locate the source file of walk"]
    dialogs[0].reject()


def test_a_source_that_was_edited_where_it_lies_is_read_and_told(qtbot, window, walk, imported):
    write_take(take_of_capture(make_capture(frames=9)), walk)
    window.inspector.reimport_requested.emit(imported, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    assert window.bench.document.project.captures[imported].frame_count == 9
    assert "has changed since it was imported" in window.strip.text


@pytest.mark.parametrize("by_hand", [False, True])
def test_a_capture_that_is_removed_while_its_source_is_looked_for_is_left_alone(
    qtbot, window, walk, imported, monkeypatch, by_hand
):
    answer_with(monkeypatch, walk)
    (relinking.ask_source if by_hand else relinking.relink)(window.bench, imported)
    window.bench.document.undo_stack.undo()
    assert imported not in window.bench.document.project.captures
    wait_until_idle(qtbot, window)
    assert window.strip.text == ""
