"""The whole window as a person uses it: drops, keys, clicks; only the 3D view is left out where it is not needed."""

import sys
import threading
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QTimer, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QScrollArea

from studio.app import recovery
from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.problems import ProblemHooks
from studio.app.settings import Settings
from studio.core.annotations import Annotations
from studio.document.document import Document
from studio.document.journal import StateHash
from studio.document.recovery import Session
from studio.io import registry
from studio.io.bvh_writer import write_bvh
from studio.io.export import take_of_capture, write_take
from studio.io.importing import load_capture
from studio.timeline.timeline import Timeline
from tests.builders import make_capture, make_constraint, make_contact, make_project

LEFT = Qt.MouseButton.LeftButton
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
PATIENCE = 30_000


@pytest.fixture
def window(qtbot, tmp_path):
    """A small project in the window, nothing playing."""
    make_application()
    document = Document(make_project(characters=2))
    window = make_window(Settings(tmp_path / "studio.ini"), document)
    with qtbot.waitExposed(window):
        window.show()
    window.resize(1400, 900)
    yield window
    window.leave()
    window.deleteLater()
    QTest.qWait(0)


@pytest.fixture
def walk(tmp_path):
    """A BVH file that the studio's own writer made."""
    capture = make_capture(frames=40)
    path = tmp_path / "walk.bvh"
    write_bvh(path, capture.skeleton, capture.poses, capture.frame_rate)
    return path


def drop(window, *paths):
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    event = QDropEvent(QPointF(400, 300), Qt.DropAction.CopyAction, content, LEFT, Qt.KeyboardModifier.NoModifier)
    window.dropEvent(event)


def same(first, second):
    hashes = StateHash()
    return hashes.of(first) == hashes.of(second)


def wait_until_idle(qtbot, window):
    qtbot.waitUntil(lambda: not window.bench.runner.running, timeout=PATIENCE)


def test_a_dropped_bvh_is_shown_on_the_visible_characters_as_one_undo_step(qtbot, window, walk):
    document = window.bench.document
    before = document.project
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert window.strip.text == ""
    assert document.history == ("Import walk.bvh",)
    new_motion = list(document.project.motions)[-1]
    assert {p.clips[0].motion_id for p in document.project.performers.values()} == {new_motion}
    assert len(document.project.captures) == len(before.captures) + 1
    assert window.bench.live.wait(300.0)
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert same(document.project, before)


def test_a_dropped_s4d_brings_its_own_contacts_and_constraints_and_is_one_undo_step(qtbot, window, tmp_path):
    document = window.bench.document
    before = document.project
    notes = Annotations((make_contact(first=4, last=9),), (make_constraint(name="Bell"),))
    write_take(take_of_capture(make_capture(), notes), tmp_path / "walk.s4d")
    drop(window, tmp_path / "walk.s4d")
    wait_until_idle(qtbot, window)
    assert window.strip.text == ""
    new_motion = list(document.project.motions)[-1]
    assert [each.name for each in document.project.constraints_of(new_motion).values()] == ["Bell"]
    assert [(each.first, each.last) for each in document.project.contacts_of(new_motion).values()] == [(4, 9)]
    assert {p.clips[0].motion_id for p in document.project.performers.values()} == {new_motion}
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert same(document.project, before)


def test_a_hidden_character_keeps_its_motion_when_another_is_dropped(qtbot, window, walk):
    document = window.bench.document
    document.selection.set(("performers", "performer 1"))
    QTest.keyClick(window, Qt.Key.Key_H)
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert document.project.performers["performer 1"].clips[0].motion_id == "motion"
    assert document.project.performers["performer 0"].clips[0].motion_id != "motion"


def test_a_file_that_cannot_be_read_is_a_sentence_and_changes_nothing(qtbot, window, walk):
    document = window.bench.document
    before = document.project
    walk.write_text(walk.read_text().replace("Frames:", "Bananas:"))
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert "walk.bvh" in window.strip.text
    assert window.strip.text.endswith("Your project was not changed.")
    assert document.project is before
    assert document.history == ()


def test_what_was_selected_of_the_motion_before_is_let_go_of_by_an_import(qtbot, window, walk):
    document = window.bench.document
    document.selection.set(("performers", "performer 0"), ("constraints", "constraint 0"))
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert document.selection.items == (("performers", "performer 0"),)


def test_a_file_cut_in_the_middle_is_opened_and_its_repairs_are_told_with_the_way_to_the_report(qtbot, window, walk):
    document = window.bench.document
    walk.write_text(walk.read_text()[:-200])
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert "2 repairs" in window.strip.text
    assert "cut off" in window.strip.text
    assert " line " in window.strip.text
    window.strip.press("Import report")
    assert document.selection.items == (("captures", list(document.project.captures)[-1]),)
    assert window.strip.text == ""


def test_an_import_that_succeeds_takes_away_the_error_of_the_one_before(qtbot, window, walk, tmp_path):
    drop(window, tmp_path / "nowhere.bvh")
    wait_until_idle(qtbot, window)
    assert "nowhere.bvh" in window.strip.text
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert window.strip.text == ""


def test_a_click_on_the_eye_hides_and_shows_a_character(qtbot, window):
    document, view = window.bench.document, window.library.view
    row = window.library.row_rect(("performers", "performer 0"))
    eye = QPoint(row.right() - 18, row.center().y())
    QTest.mouseClick(view.viewport(), LEFT, pos=eye)
    assert not document.project.performers["performer 0"].visible
    QTest.mouseClick(view.viewport(), LEFT, pos=eye)
    assert document.project.performers["performer 0"].visible
    assert document.history == ("Hide Body 0", "Show Body 0")


def test_a_click_in_the_library_selects_and_the_inspector_shows_it(qtbot, window):
    item = ("constraints", "constraint 0")
    QTest.mouseClick(window.library.view.viewport(), LEFT, pos=window.library.row_rect(item).center())
    assert window.bench.document.selection.items == (item,)
    assert window.inspector.editor.entity_id == "constraint 0"


def test_what_is_selected_elsewhere_is_marked_in_the_library(qtbot, window):
    window.bench.document.selection.set(("performers", "performer 1"))
    [index] = window.library.view.selectionModel().selectedIndexes()
    assert index.data() == "Body 1"


def test_undo_and_redo_by_keys(qtbot, window):
    document = window.bench.document
    document.selection.set(("constraints", "constraint 0"))
    QTest.keyClick(window, Qt.Key.Key_Delete)
    assert "constraint 0" not in document.project.constraints
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert "constraint 0" in document.project.constraints
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL | SHIFT)
    assert "constraint 0" not in document.project.constraints


def test_delete_takes_the_constraint_and_not_the_body_it_is_seen_on(qtbot, window):
    document = window.bench.document
    document.selection.set(("performers", "performer 0"), ("constraints", "constraint 0"))
    QTest.keyClick(window, Qt.Key.Key_Delete)
    assert not document.project.constraints
    assert "performer 0" in document.project.performers


def test_saved_and_opened_again_it_is_the_same_project(qtbot, window, tmp_path):
    document = window.bench.document
    document.selection.set(("constraints", "constraint 0"))
    QTest.keyClick(window, Qt.Key.Key_D, CONTROL)
    window.actions_by_id.by_id["save"].trigger()
    assert document.dirty  # it asks for a name first
    from studio.app.verbs import files

    path = tmp_path / "kick.studio"
    files.save_to(window.bench, path)
    wait_until_idle(qtbot, window)
    saved = document.project
    assert not document.dirty
    assert "kick.studio" in window.windowTitle()
    assert window.bench.settings.recent == (path,)
    window.actions_by_id.by_id["new"].trigger()
    assert not document.project.constraints
    drop(window, path)
    wait_until_idle(qtbot, window)
    assert same(document.project, saved)


def test_a_file_that_somebody_else_changed_is_kept_until_the_user_says_to_replace_it(qtbot, window, tmp_path):
    from studio.app.verbs import files

    path = tmp_path / "kick.studio"
    files.save_to(window.bench, path)
    wait_until_idle(qtbot, window)
    foreign = path.read_bytes() + b"more"
    path.write_bytes(foreign)
    window.actions_by_id.by_id["save"].trigger()
    wait_until_idle(qtbot, window)
    assert path.read_bytes() == foreign
    assert "changed on the disk" in window.strip.text
    window.strip.press("Save anyway")
    wait_until_idle(qtbot, window)
    assert path.read_bytes() != foreign
    assert window.strip.text == ""


def test_space_plays_and_arrow_keys_step(qtbot, window):
    playhead = window.bench.document.playhead
    QTest.keyClick(window, Qt.Key.Key_Right)
    assert playhead.frame == 1
    QTest.keyClick(window, Qt.Key.Key_Right, SHIFT)
    assert playhead.frame == 29
    QTest.keyClick(window, Qt.Key.Key_Space)
    assert playhead.playing
    QTest.keyClick(window, Qt.Key.Key_K)
    assert not playhead.playing


def test_the_palette_finds_an_action_by_a_few_letters_and_runs_it(qtbot, window):
    QTest.keyClick(window, Qt.Key.Key_K, CONTROL)
    assert window.palette_panel.isVisible()
    QTest.keyClicks(window.palette_panel.field, "show imp")
    QTest.keyClick(window.palette_panel.field, Qt.Key.Key_Return)
    assert not window.palette_panel.isVisible()
    assert window.bench.document.selection.items == (("captures", "capture"),)


def test_closing_with_unsaved_work_asks_beside_it_and_cancel_keeps_the_window(qtbot, window):
    document = window.bench.document
    document.selection.set(("constraints", "constraint 0"))
    QTest.keyClick(window, Qt.Key.Key_Delete)
    window.close()
    assert window.isVisible()
    assert "not saved" in window.question.text
    window.question.press("Cancel")
    assert window.isVisible()
    window.close()
    window.question.press("Don't save")
    assert not window.isVisible()


def test_closing_leaves_no_thread_and_no_timer(qtbot, tmp_path):
    make_application()
    threads = set(threading.enumerate())
    window = make_window(Settings(tmp_path / "studio.ini"), Document(make_project()))
    window.show()
    import_views()
    show_views(window)
    assert window.bench.live.wait(300.0)
    window.bench.document.playhead.play()
    QTest.qWait(50)
    window.leave()
    timers = [timer for timer in window.findChildren(QTimer) if timer.isActive()]
    assert timers == []
    assert set(threading.enumerate()) <= threads
    window.deleteLater()
    QTest.qWait(0)


def test_a_fault_in_an_action_is_told_and_does_not_stop_the_studio(qtbot, window):
    window.bench.said.emit("The studio made a mistake: KeyError: 'x'.")
    assert "mistake" in window.strip.text
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert window.strip.text == ""


def test_the_adapted_motion_of_a_character_is_exported_as_bvh(qtbot, window, tmp_path):
    from studio.app import exporting

    assert window.bench.live.wait(300.0)
    path = tmp_path / "out.bvh"
    exporting.export(window.bench, {"performer 0": path})
    wait_until_idle(qtbot, window)
    assert "out.bvh" in window.strip.text
    assert load_capture(path).frame_count == 30


@pytest.mark.parametrize("suffix", [".bvh", ".s4d", ".glb", ".c3d", ".npz"])
def test_every_kind_of_file_goes_out_by_the_one_dialog(qtbot, window, tmp_path, monkeypatch, suffix):
    from studio.app import export_dialog

    asked = []
    monkeypatch.setattr(export_dialog, "ask_folder", lambda bench, title, then: asked.append(title) or then(tmp_path))
    window.actions_by_id.by_id["export"].trigger()
    dialog = window.findChild(export_dialog.ExportDialog)
    dialog.choose(export_dialog.What.ADAPTED, suffix)
    dialog.names.show_value("unreal")
    dialog.go.click()
    wait_until_idle(qtbot, window)
    assert asked == ["Export 2 adapted motions into a folder"]
    assert sorted(path.name for path in tmp_path.glob("*" + suffix)) == [f"Walk body {k}{suffix}" for k in (0, 1)]
    assert "Exported 2 files" in window.strip.text
    again = export_dialog.open_export_dialog(window.bench)
    assert (again.kind.value.suffix, again.names.value) == (suffix, "unreal")
    again.reject()
    if suffix in (".bvh", ".s4d"):
        assert "upperarm_l" in load_capture(tmp_path / f"Walk body 0{suffix}").skeleton.names


def test_the_motion_itself_goes_out_with_its_contacts_and_constraints(qtbot, window, tmp_path, monkeypatch):
    from studio.app import export_dialog
    from studio.io.importing import load_annotations

    path = tmp_path / "walk.s4d"
    monkeypatch.setattr(export_dialog, "ask_new_file", lambda bench, title, kind, name, then, suffix: then(path))
    window.actions_by_id.by_id["export"].trigger()
    dialog = window.findChild(export_dialog.ExportDialog)
    dialog.choose(export_dialog.What.MOTION, ".s4d")
    assert not dialog.names.isVisible()
    dialog.go.click()
    wait_until_idle(qtbot, window)
    project = window.bench.document.project
    stored = load_annotations(path, load_capture(path), "motion")
    assert stored.constraints == tuple(project.constraints_of("motion").values())
    assert set(stored.contacts) == set(project.contacts_of("motion").values())


def test_a_cancelled_export_leaves_nothing_behind(qtbot, window, tmp_path):
    from studio.app import exporting

    task = exporting.export(window.bench, {"performer 0": tmp_path / "a.glb", "performer 1": tmp_path / "b.glb"})
    window.bench.runner.cancel(task)
    wait_until_idle(qtbot, window)
    assert list(tmp_path.iterdir()) == []


def test_a_small_window_keeps_every_menu_and_leaves_the_stage_more_than_half(qtbot, window):
    window.show_timeline(Timeline(window.bench.document, window.bench.live))
    window.resize(1680, 1050)
    QTest.qWait(20)
    window.resize(1024, 700)
    QTest.qWait(20)
    bar = window.top_bar.menus
    assert bar.width() >= bar.sizeHint().width()
    assert bar.actionGeometry(bar.actions()[-1]).right() <= bar.width()
    assert window.docks["Timeline"].height() <= 0.46 * window.height()


def test_the_sheet_of_shortcuts_is_whole_and_says_what_always_is(qtbot, window):
    window.bench.document.remove("constraints", "constraint 0", "Delete Target 0")
    window.show_shortcuts()
    texts = {label.text() for label in window._sheet.findChildren(QLabel)}
    assert "Undo" in texts
    assert not any("target 0" in text for text in texts)
    area = window._sheet.findChild(QScrollArea)
    wanted, room = area.widget().sizeHint(), window.screen().availableSize()
    assert window._sheet.width() >= wanted.width()
    assert window._sheet.height() >= min(wanted.height(), room.height() - 120)
    window._sheet.close()


def test_arranged_panels_say_their_name_once(qtbot, window):
    window.actions_by_id.by_id["arrange"].trigger()
    assert window.history.head.isHidden()
    window.actions_by_id.by_id["arrange"].trigger()
    assert not window.history.head.isHidden()


def test_the_recent_projects_stand_in_the_file_menu(qtbot, window, tmp_path):
    window.bench.settings.remember(tmp_path / "kick.studio")
    menu = window.actions_by_id.recent
    menu.aboutToShow.emit()
    assert [action.text() for action in menu.actions()] == ["kick.studio"]


def test_recent_files_are_remembered_newest_first(tmp_path):
    settings = Settings(tmp_path / "studio.ini")
    first, second = tmp_path / "a.studio", tmp_path / "b.studio"
    for path in (first, second, first):
        settings.remember(path)
    assert Settings(tmp_path / "studio.ini").recent == (first, second)
    assert isinstance(settings.recent[0], Path)


def test_read_with_another_unit_the_capture_is_replaced_as_one_undo_step(qtbot, window, walk):
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    capture_id = list(document.project.captures)[-1]
    document.selection.set(("captures", capture_id))
    window.inspector.reimport_wanted.emit(capture_id, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    assert document.project.captures[capture_id].unit == "inch"
    assert document.history == ("Import walk.bvh", "Read walk with unit inch")
    window.inspector.reimport_wanted.emit(capture_id, {"reference": "3"})
    wait_until_idle(qtbot, window)
    assert document.history[-1] == "Read walk with reference 3"
    assert document.project.captures[capture_id].unit == "inch"
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert document.project.captures[capture_id].unit == "cm"


def test_what_is_corrected_in_a_report_holds_for_the_next_file_of_its_kind(qtbot, window, walk):
    document, settings = window.bench.document, window.bench.settings
    drop(window, walk)
    wait_until_idle(qtbot, window)
    capture_id = list(document.project.captures)[-1]
    floor = document.project.captures[capture_id].floor
    window.inspector.reimport_wanted.emit(capture_id, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    document.replace("captures", capture_id, document.project.captures[capture_id].with_floor(0.25), "Set floor")
    second = walk.with_name("second.bvh")
    second.write_bytes(walk.read_bytes())
    drop(window, second)
    wait_until_idle(qtbot, window)
    second_id = list(document.project.captures)[-1]
    assert (document.project.captures[second_id].unit, document.project.captures[second_id].floor) == ("inch", 0.25)
    assert window.strip.text.endswith("corrected its kind of file before: unit inch, floor 0.25.")
    window.strip.press("Guess again")
    wait_until_idle(qtbot, window)
    assert (document.project.captures[second_id].unit, document.project.captures[second_id].floor) == ("cm", floor)
    assert settings.corrections == {}


def test_the_kinds_of_files_are_listed_and_those_that_failed_with_them(window, monkeypatch):
    known = registry.known_formats()
    failed = replace(known, failures=("The format 'gone' of nobody could not be added: it is gone.",))
    monkeypatch.setattr("studio.app.verbs.view.known_formats", lambda: failed)
    window.actions_by_id.by_id["formats"].trigger()
    texts = [action.text() for action in window.choice_panel._actions]
    assert "BVH  .bvh" in texts
    assert failed.failures[0] in texts


def test_a_correction_that_is_undone_is_not_remembered(qtbot, window, walk):
    document, settings = window.bench.document, window.bench.settings
    drop(window, walk)
    wait_until_idle(qtbot, window)
    capture_id = list(document.project.captures)[-1]
    names = document.project.captures[capture_id].body_map.to_json(document.project.captures[capture_id].skeleton)
    changed = document.project.captures[capture_id].with_body_map(names | {"left_toe": "LeftFoot"})
    document.replace("captures", capture_id, changed, "Map left toe")
    [corrected] = settings.corrections.values()
    assert corrected["body_map"]["left_toe"] == "LeftFoot"
    document.undo_stack.undo()
    assert settings.corrections == {}


def test_a_capture_whose_file_is_not_known_is_not_read_again_but_said_so(qtbot, window):
    window.inspector.reimport_wanted.emit("capture", {"unit": "cm"})
    assert "Import it again" in window.strip.text


def test_a_double_click_on_a_capture_plays_it_on_the_visible_characters(qtbot, window, walk):
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    window.library.wanted.emit("capture")
    assert {p.clips[0].motion_id for p in document.project.performers.values()} == {"motion"}
    assert document.history[-1] == "Play Walk"


def test_the_sample_is_one_motion_playing_on_five_characters(qtbot, window):
    window.actions_by_id.by_id["open_sample"].trigger()
    wait_until_idle(qtbot, window)
    document = window.bench.document
    assert len(document.project.performers) == 5
    assert len({performer.clips for performer in document.project.performers.values()}) == 1
    assert len({performer.position for performer in document.project.performers.values()}) == 5
    assert document.playhead.playing
    assert not document.dirty


def test_what_a_crashed_session_left_is_offered_and_recovered(qtbot, window, tmp_path, monkeypatch):
    session = Session(tmp_path / "j.sqlite", "id", None, 3, datetime.now().astimezone(), False)
    monkeypatch.setattr(recovery, "recoverable_sessions", lambda folder: (session,))
    recovered = []
    monkeypatch.setattr(window.bench.document, "recover", recovered.append)
    recovery.offer(window.bench, tmp_path)
    assert "3 edits" in window.recovery.text
    window.recovery.press("Recover")
    assert recovered == [session]
    assert window.recovery.text == ""


def test_work_that_the_user_gave_up_is_listed_and_can_be_had_again(qtbot, window, tmp_path):
    journals = tmp_path / "journal"
    given_up = Document(make_project(), journal_folder=journals)
    given_up.remove("constraints", "constraint 0", "Delete Target 0")
    given_up.close()
    recovery.offer(window.bench, journals)
    assert window.recovery.text == ""
    window.actions_by_id.by_id["recover"].trigger()
    row = window.choice_panel.list.topLevelItem(0)
    assert row.text(0) == "Untitled"
    assert row.text(1).endswith("1 edit")
    QTest.keyClick(window.choice_panel.field, Qt.Key.Key_Return)
    assert window.bench.document.history == ("Delete Target 0",)
    assert "constraint 0" not in window.bench.document.project.constraints


def test_without_earlier_work_that_is_said(qtbot, window, tmp_path):
    recovery.offer(window.bench, tmp_path)
    window.actions_by_id.by_id["recover"].trigger()
    assert "no earlier work" in window.strip.text


def test_an_exception_that_nobody_caught_is_a_sentence_in_the_strip(qtbot, window):
    hooks = ProblemHooks()
    hooks.told.connect(window.bench.said)
    try:
        sys.excepthook(KeyError, KeyError("hips"), None)
        assert "KeyError: 'hips'" in window.strip.text
    finally:
        hooks.close()


def test_every_action_that_is_enabled_without_the_3d_view_runs(qtbot, window):
    asking = {
        "open",
        "save",
        "save_as",
        "save_increment",
        "import",
        "export",
        "quit",
        "shortcuts",
        "new",
        "open_sample",
    }
    for name, action in window.actions_by_id.by_id.items():
        if action.isEnabled() and name not in asking:
            action.trigger()
    window.bench.document.playhead.pause()
