"""The whole window as a person uses it: keys, clicks, projects; only the 3D view is left out where it is not needed."""

import sys
import threading
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QPushButton, QScrollArea

from studio.app import recovery_offer
from studio.app.application import import_views, make_application, make_window, show_views
from studio.app.problems import ProblemHooks
from studio.app.settings import Settings
from studio.core.body.canonical import BodyPart
from studio.core.constraints.base import BodyPoint
from studio.core.constraints.own_place import OwnPlace
from studio.core.curves.keyed import KeyedPlace
from studio.core.stage.prop import Prop
from studio.document.document import Document
from studio.document.recovery import Session
from studio.io import registry
from studio.timeline.timeline import Timeline
from tests.builders import make_constraint, make_project
from tests.gui.window_use import PATIENCE, drop, same, wait_until_idle
from tests.patience import SECONDS

LEFT = Qt.MouseButton.LeftButton
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


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


def test_duplicates_are_numbered_and_the_history_says_of_what(qtbot, window):
    document = window.bench.document
    document.replace(
        "constraints",
        "constraint 0",
        replace(document.project.constraints["constraint 0"], name="Right wrist"),
        "Rename",
    )
    document.selection.set(("constraints", "constraint 0"))
    QTest.keyClick(window, Qt.Key.Key_D, CONTROL)
    QTest.keyClick(window, Qt.Key.Key_D, CONTROL)
    names = [each.name for each in document.project.constraints.values()]
    assert names == ["Right wrist", "Right wrist 2", "Right wrist 3"]
    assert document.history[-2:] == ("Duplicate Right wrist", "Duplicate Right wrist 2")


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


def test_the_palette_finds_every_panel_as_the_menus_do(qtbot, window):
    """ "pose" found the map and the correction of poses, and not the panel with the saved ones."""
    assert window.docks["Poses"].isHidden()
    window.actions_by_id.by_id["palette"].trigger()
    QTest.keyClicks(window.palette_panel.field, "poses p")
    QTest.keyClick(window.palette_panel.field, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: not window.pose_library.panel.visibleRegion().isEmpty())  # before the others, not behind


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
    assert "unsaved changes" in window.question.text
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
    assert window.bench.live.wait_until_solved(SECONDS)
    window.bench.document.playhead.play()
    QTest.qWait(50)
    window.close_without_saving()
    timers = [timer for timer in window.findChildren(QTimer) if timer.isActive()]
    assert timers == []
    qtbot.waitUntil(lambda: set(threading.enumerate()) <= threads, timeout=PATIENCE)  # a picture that is drawn is ended
    window.deleteLater()
    QTest.qWait(0)


def test_a_fault_in_an_action_is_told_and_does_not_stop_the_studio(qtbot, window):
    window.bench.post_message("An internal error occurred: KeyError: 'x'.")
    assert "internal error" in window.strip.text
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert window.strip.text == ""


def test_a_small_window_keeps_every_menu_and_leaves_the_stage_more_than_half(qtbot, window):
    window.show_timeline(Timeline(window.bench.document, window.bench.live))
    window.resize(1680, 1050)
    QTest.qWait(20)
    window.resize(1024, 700)
    QTest.qWait(20)
    bar = window.top_bar.menus
    assert bar.width() >= bar.sizeHint().width()
    assert bar.actionGeometry(bar.actions()[-1]).right() <= bar.width()
    qtbot.waitUntil(lambda: window.docks["Timeline"].height() <= 0.46 * window.height(), timeout=PATIENCE)


def test_a_timeline_that_floats_as_a_tab_of_another_panel_is_left_as_large_as_it_is(window, qtbot, qtlog):
    timeline = window.docks["Timeline"]
    window.removeDockWidget(timeline)  # Qt has it in a window of tabs then, which a test cannot drag it to
    timeline.resize(400, 3 * window.height())
    assert not timeline.isFloating()
    window.resize(1200, 800)
    qtbot.wait(20)
    assert [record.message for record in qtlog.records if "resizeDocks" in record.message] == []


def test_a_sentence_covers_the_view_and_does_not_change_its_size(qtbot, window):
    window.actions_by_id.by_id["open_sample"].trigger()
    wait_until_idle(qtbot, window)
    import_views()
    show_views(window)
    QTest.qWait(50)
    view = window.bench.viewport
    size = view.size()
    for strip in (window.strip, window.question, window.recovery):
        strip.show_sentence("walk_03.bvh, line 214: '90,5' is not a number. " * 3)
        QTest.qWait(20)
        assert view.size() == size
        assert view.geometry().contains(strip.geometry())
        middle = strip.mapTo(window, strip.rect().center())
        assert strip.isAncestorOf(window.childAt(middle)) or window.childAt(middle) is strip
        strip.clear()


def test_it_opens_within_its_screen_and_is_usable_at_1280_by_720(qtbot, window, tmp_path):
    room = window.screen().availableGeometry()
    other = make_window(Settings(tmp_path / "other.ini"), Document(make_project()))
    assert room.contains(other.geometry())
    other.close_without_saving()
    other.deleteLater()
    least = window.minimumSizeHint()
    assert least.width() <= 1280
    assert least.height() <= 720 - 36
    window.resize(1280, 684)
    document = window.bench.document
    for k in range(12):
        key = document.add("constraints", make_constraint(name=f"Target {k + 1}", priority=k + 1), "Add")
    document.selection.set(("constraints", key))
    QTest.qWait(50)
    library = window.library
    assert library.view.viewport().rect().contains(library.row_rect(("constraints", key)).center())
    bar = window.inspector.horizontalScrollBar()
    form = window.inspector.current_form()
    assert form.minimumSizeHint().width() <= window.inspector.viewport().width()
    assert not bar.isVisible()


@pytest.mark.parametrize(
    ("collection", "target"),
    [
        *((each, "shared") for each in ("captures", "characters", "performers", "clips", "contacts", "props")),
        *(("constraints", target) for target in ("shared", "per character")),
    ],
)
def test_no_form_is_cut_however_long_the_names_are(window, collection, target):
    long = "accad_female1_D4_RandomStuff_as_it_was_recorded_on_the_second_day"
    document, project = window.bench.document, make_project()
    for kind in ("captures", "characters", "motions", "performers"):
        for key, each in getattr(project, kind).items():
            project = project.with_entity(kind, key, replace(each, name=long))
    wrist = BodyPoint(BodyPart.RIGHT_FOREARM, at_end=True)
    own = make_constraint(name=long, target=OwnPlace(wrist, 0.2, (0.1, 0.0, 0.0)))
    project = project.with_entity("constraints", "reach", make_constraint(name=long))
    if target == "per character":
        project = project.with_entity("constraints", "reach", own)
    document.new(project.with_entity("props", "box", Prop(name=long)))
    window.resize(1280, 684)
    if collection == "clips":
        key = next(iter(project.performers.values())).clips[0].id
    else:
        key = next(iter(getattr(document.project, collection)))
    document.selection.set((collection, key))
    QTest.qWait(20)
    form = window.inspector.current_form()
    bar = window.inspector.verticalScrollBar()
    beside_bar = window.inspector.viewport().width() - (0 if bar.isVisible() else bar.sizeHint().width())
    assert form.minimumSizeHint().width() <= beside_bar


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


def test_the_kinds_of_files_are_listed_and_those_that_failed_with_them(window, monkeypatch):
    known = registry.known_formats()
    failed = replace(known, failures=("The format 'gone' of nobody could not be added: it is gone.",))
    monkeypatch.setattr("studio.app.verbs.view.known_formats", lambda: failed)
    window.actions_by_id.by_id["formats"].trigger()
    texts = [action.text() for action in window.choice_panel._actions]
    assert "BVH  .bvh" in texts
    assert failed.failures[0] in texts


def test_what_is_offered_to_choose_goes_with_the_project_that_it_is_of(window):
    document = window.bench.document
    changes = [
        lambda: document.add("props", Prop("Box"), "Add a box"),
        lambda: document.new(make_project(characters=0)),
    ]
    for change in changes:
        window.actions_by_id.by_id["add_clip"].trigger()
        assert window.choice_panel.isVisible()
        change()
        assert not window.choice_panel.isVisible()


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
    monkeypatch.setattr(recovery_offer, "recoverable_sessions", lambda folder: (session,))
    recovered = []
    monkeypatch.setattr(window.bench.document, "recover", recovered.append)
    recovery_offer.offer_recovery(window.bench, tmp_path)
    assert "3 edits" in window.recovery.text
    window.recovery.press("Recover")
    assert recovered == [session]
    assert window.recovery.text == ""


def test_work_that_the_user_gave_up_is_listed_and_can_be_had_again(qtbot, window, tmp_path):
    journals = tmp_path / "journal"
    given_up = Document(make_project(), journal_folder=journals)
    given_up.remove("constraints", "constraint 0", "Delete Target 0")
    given_up.close()
    recovery_offer.offer_recovery(window.bench, journals)
    assert window.recovery.text == ""
    window.actions_by_id.by_id["recover"].trigger()
    row = window.choice_panel.list.topLevelItem(0)
    assert row.text(0) == "Untitled"
    assert row.text(1).endswith("1 edit")
    QTest.keyClick(window.choice_panel.field, Qt.Key.Key_Return)
    assert window.bench.document.history == ("Delete Target 0",)
    assert "constraint 0" not in window.bench.document.project.constraints


def test_without_earlier_work_that_is_said(qtbot, window, tmp_path):
    recovery_offer.offer_recovery(window.bench, tmp_path)
    window.actions_by_id.by_id["recover"].trigger()
    assert "no unsaved work" in window.strip.text


def test_an_exception_that_nobody_caught_is_a_sentence_in_the_strip(qtbot, window):
    hooks = ProblemHooks()
    hooks.message_posted.connect(window.bench.post_message)
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
        if action.isEnabled() and name not in asking and not name.startswith("scene_"):
            action.trigger()
    window.bench.document.playhead.pause()
    assert window.isVisible()
    assert window.bench.document.history


def test_a_new_window_shows_every_menu(window):
    """Its bar was fitted to texts as wide as before they had the theme's font."""
    window.resize(1400, 900)
    window.show()
    assert window.top_bar.menus.width() >= window.top_bar.menus.sizeHint().width()


@pytest.mark.parametrize("width", [1280, 1400, 1600])
def test_the_search_stays_in_the_window_at_once_where_the_name_of_the_project_changes(window, width):
    """The search was cut at the window's edge for as long as the 3D view was being started."""
    window.resize(width, 720)
    window.show()
    QApplication.processEvents()
    bar = window.top_bar
    for name in ("a", "a much longer name of a project" * 4, "b"):
        bar.refresh(name, "saved")
        search = bar.findChild(QPushButton, "search")
        assert search.geometry().right() <= bar.width()


def test_a_key_is_set_before_the_3d_view_is_there(window):
    document = window.bench.document
    document.selection.set(("constraints", "constraint 0"))
    assert not window.bench.has_viewport
    window.actions_by_id.by_id["set_key"].trigger()
    assert isinstance(document.project.constraints["constraint 0"].target, KeyedPlace)


def test_layouts_of_earlier_versions_find_every_panel(window):
    """They name the outliner by the name that it had."""
    names = {dock.objectName() for dock in window.docks.values()}
    assert names >= {"Library", "Inspector", "History", "Timeline", "Behaviour", "Pose map", "Console"}
