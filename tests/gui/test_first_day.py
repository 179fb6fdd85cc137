"""Small things of an animator's first day: keys that answer, hints that go, bodies that stand in a row."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication

from studio.app.action_set import with_mnemonics
from studio.app.actions import MENUS
from studio.app.application import import_views, show_views
from studio.app.character_import import add_read_character
from studio.app.preferences import key_maps
from studio.core.captures.contacts import ContactInterval, Touch
from studio.core.stage.prop import Prop
from studio.core.stage.staging import PERFORMER_SPACING, performers_side_by_side
from studio.document import colours
from studio.engine.posed_performer import swept_points
from studio.io.bvh.writer import write_bvh
from studio.io.project.character_file import bundled_characters
from studio.panels.command_palette import plain_text
from studio.panels.message_strip import Lifetime
from studio.resources_folder import example_captures_folder
from tests.builders import make_capture
from tests.gui.viewport_use import LEFT, NONE, joint_pixel
from tests.gui.window_use import drop, wait_until_idle
from tests.patience import PATIENCE, SECONDS

LEAST_SCREEN = 1280, 720
CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def changed(window):
    """The window with a change that is not saved, asked for a new project."""
    document = window.bench.document
    document.replace("motions", "motion", replace(document.project.motions["motion"], name="Other"), "Rename")
    window.activateWindow()
    QTest.keyClick(window, Qt.Key.Key_N, CONTROL)
    QApplication.processEvents()
    assert window.question.isVisible()
    return window


def press(key):
    QTest.keyClick(QApplication.focusWidget(), key)


def test_esc_answers_the_question_about_unsaved_changes_with_cancel(changed):
    press(Qt.Key.Key_Escape)
    assert not changed.question.isVisible()
    assert "motion" in changed.bench.document.project.motions


def test_tab_and_enter_answer_it_as_chosen(changed):
    assert QApplication.focusWidget().text() == "Save"
    press(Qt.Key.Key_Tab)
    assert QApplication.focusWidget().text() == "Don't save"
    press(Qt.Key.Key_Return)
    assert not changed.question.isVisible()
    assert "motion" not in changed.bench.document.project.motions


def test_a_new_project_forgets_the_range(changed):
    document = changed.bench.document
    document.playhead.set_range(7, 19)
    press(Qt.Key.Key_Tab)
    press(Qt.Key.Key_Return)
    assert (document.playhead.first, document.playhead.last) == (0, 300)


def test_a_new_project_plays_forwards_at_real_time(changed):
    playhead = changed.bench.document.playhead
    playhead.speed = -2.0
    press(Qt.Key.Key_Tab)
    press(Qt.Key.Key_Return)
    assert playhead.speed == 1.0


def test_solo_shows_the_selected_bodies_alone_and_then_all_again(window):
    document, key = window.bench.document, next(iter(window.bench.document.project.performers))
    window.activateWindow()
    document.selection.set(("performers", key))
    QTest.keyClick(window, Qt.Key.Key_H, CONTROL)
    assert [each.visible for each in document.project.performers.values()] == [True, False]
    assert document.undo_stack.count() == 1
    QTest.keyClick(window, Qt.Key.Key_H, CONTROL)
    assert all(each.visible for each in document.project.performers.values())


def test_no_long_name_or_sentence_makes_the_window_wider(window):
    document = window.bench.document
    name = "captured_on_stage_two_take_" * 8
    document.replace("motions", "motion", replace(document.project.motions["motion"], name=name), "Rename")
    for key, performer in document.project.performers.items():
        document.replace("performers", key, replace(performer, name=name), "Rename")
    window.status.progress.begin(1, f"Opening {name}.bvh")
    window.status.progress.show_share(1, 0.5, f"Finding floor and reference pose of {name}.bvh")
    sentence = f"The source file /{'/'.join([name] * 3)}.bvh cannot be found."
    window.bench.post_message(sentence)
    window.status.show_hint(name)
    QApplication.processEvents()
    window.layout().activate()
    assert window.layout().minimumSize().width() < LEAST_SCREEN[0]
    assert window.strip.text == sentence


@pytest.mark.parametrize("key_map", sorted(key_maps()))
def test_every_menu_opens_by_a_letter_that_nothing_else_has(window, key_map):
    actions = window.actions_by_id
    window.bench.preferences = replace(window.bench.preferences, key_map=key_map, own_keys={"save": ("Alt+F",)})
    actions.apply_keys()
    titles = [menu.title() for menu in actions.menus.values()]
    letters = [title[title.index("&") + 1].upper() for title in titles]
    taken = {keys for of_action in actions.keys_now().values() for keys in of_action}
    assert "Alt+F" in taken
    assert len({*letters}) == len(MENUS)
    assert not {f"Alt+{letter}" for letter in letters} & taken


def test_a_menu_without_a_free_letter_has_none():
    assert with_mnemonics(("Clip", "Constraint")) == ["C&lip", "&Constraint"]
    assert with_mnemonics(("Clip", "Lip"), ["Alt+C", "Alt+I", "Ctrl+Alt+P"]) == ["Cli&p", "&Lip"]
    assert with_mnemonics(("A", "A")) == ["&A", "A"]


def test_names_with_an_ampersand_are_shown_whole_and_open_nothing(window, qtbot, tmp_path):
    document, actions = window.bench.document, window.actions_by_id
    document.replace("motions", "motion", replace(document.project.motions["motion"], name="R&Q"), "Rename motion")
    for key, performer in tuple(document.project.performers.items()):
        document.replace("performers", key, replace(performer, name=f"{key} R&Q"), "Rename R&Q")
        document.selection.set(("performers", key), ("clips", performer.clips[0]))
        qtbot.wait(1)
        buttons = [each for each in window.findChildren(QAbstractButton) if each.isVisible()]
        assert [each.text() for each in buttons if not each.shortcut().isEmpty()] == []
        assert any("R&&Q" in each.text() for each in buttons)
    assert actions.by_id["undo"].text() == "Undo rename R&&Q"
    assert plain_text(actions.by_id["undo"]) == "Undo rename R&Q"


def test_a_click_on_the_guesses_shows_the_import_report(window):
    QTest.mouseClick(window.status._guesses, LEFT)
    assert window.bench.document.selection.items == (("captures", "capture"),)


def test_the_hint_to_click_a_joint_goes_when_one_is_constrained(window, qtbot):
    import_views()
    show_views(window)
    assert window.bench.live.wait_until_solved(SECONDS)
    viewport = window.bench.viewport
    qtbot.waitUntil(lambda: len(viewport.posed) == 2, timeout=PATIENCE)
    QTest.qWait(200)
    QTest.keyClick(window, Qt.Key.Key_C)
    assert window.strip.text.startswith("Click a joint")
    QTest.mouseClick(viewport, LEFT, NONE, joint_pixel(viewport, "performer 0", "right wrist"))
    assert window.strip.text == ""
    QTest.keyClick(window, Qt.Key.Key_C)
    assert window.bench.document.selection.of("constraints")
    assert window.strip.text == ""


def test_what_an_action_needs_first_is_no_longer_said_once_something_is_selected_or_edited(window):
    document = window.bench.document
    prop_id = document.add("props", Prop("Box", position=(0.6, 0.0, 0.2)), "Add box")
    for go_on in (
        lambda: document.selection.set(("performers", "performer 1")),
        lambda: document.remove("props", prop_id, "Delete"),
    ):
        window.bench.post_message("Select a prop.", until=Lifetime.SELECTED)
        assert window.strip.text == "Select a prop."
        go_on()
        assert window.strip.text == ""


def test_where_a_new_box_is_picked_up_is_said_until_it_is(window, qtbot):
    import_views()
    show_views(window)
    document, by_id = window.bench.document, window.actions_by_id.by_id
    assert window.bench.live.wait_until_solved(SECONDS)
    qtbot.waitUntil(lambda: len(window.bench.viewport.posed) == 2, timeout=PATIENCE)
    clip = document.project.performers["performer 0"].clips[0]
    document.add("contacts", ContactInterval(clip.motion_id, Touch.HANDS_ON_THING, 10, clip.last), "Add")
    document.selection.set(("performers", "performer 0"))
    by_id["add_box"].trigger()
    assert "Pick it up" in window.strip.text
    [prop_id] = document.project.props
    document.selection.set(("performers", "performer 0"), ("props", prop_id))
    document.playhead.set_frame(10)
    assert "Pick it up" in window.strip.text
    by_id["pick_up_prop"].trigger()
    assert document.project.props[prop_id].held is not None
    assert window.strip.text == ""


def test_what_a_scene_shows_is_said_until_another_project_is_open(window):
    document = window.bench.document
    window.bench.post_message("The box is heavy.", until=Lifetime.PROJECT_OPENED)
    document.selection.set(("performers", "performer 1"))
    document.add("props", Prop("Box", position=(0.6, 0.0, 0.2)), "Add box")
    assert window.strip.text == "The box is heavy."
    document.new(document.project)
    assert window.strip.text == ""


def test_a_joint_is_picked_and_constrained_by_keys_alone(window, qtbot):
    import_views()
    show_views(window)
    assert window.bench.live.wait_until_solved(SECONDS)
    viewport, document = window.bench.viewport, window.bench.document
    qtbot.waitUntil(lambda: len(viewport.posed) == 2, timeout=PATIENCE)
    document.selection.set(("performers", "performer 1"))
    window.activateWindow()
    QTest.keyClick(window, Qt.Key.Key_J, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClicks(window.choice_panel.field, "left kn")
    press(Qt.Key.Key_Return)
    assert (viewport.joint_picked.performer_id, viewport.joint_picked.joint.name) == ("performer 1", "left knee")
    QTest.keyClick(viewport, Qt.Key.Key_C)
    [constraint_id] = document.selection.of("constraints")
    assert document.project.constraints[constraint_id].name == "Left knee"


def test_line_up_puts_bodies_across_their_way_as_one_step(window, qtbot, walk):
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    for index, key in enumerate(document.project.performers):
        performer = replace(document.project.performers[key], position=(3.0 * index, 0.4 * index), heading=0.3)
        document.replace("performers", key, performer, "Move")
    count = document.undo_stack.count()
    window.actions_by_id.by_id["line_up"].trigger()
    places = np.array([each.position for each in document.project.performers.values()])
    assert np.linalg.norm(places[1] - places[0]) == pytest.approx(2 * PERFORMER_SPACING)  # this walk spreads its arms
    assert {each.heading for each in document.project.performers.values()} == {0.0}
    assert document.undo_stack.count() == count + 1
    document.undo_stack.undo()
    assert document.project.performers["performer 1"].position == (3.0, 0.4)


def test_bodies_whose_clips_end_before_the_stage_begins_are_lined_up_too(window, qtbot):
    document = window.bench.document
    assert window.bench.live.wait_until_solved(SECONDS)
    for key, performer in document.project.performers.items():
        clips = tuple(replace(clip, start=-9.0) for clip in performer.clips)
        document.replace("performers", key, replace(performer, clips=clips), "Move")
    count = document.undo_stack.count()
    window.actions_by_id.by_id["line_up"].trigger()
    assert document.undo_stack.count() == count + 1


def travelling(folder, name, heading):
    """A BVH file of a body that goes three metres in a heading."""
    capture = make_capture(frames=60)
    moves = np.array(capture.poses.local_translations)
    moves[:, 0, :2] = np.linspace(0.0, 3.0, 60)[:, None] * [np.cos(heading), np.sin(heading)]
    write_bvh(folder / name, capture.skeleton, replace(capture.poses, local_translations=moves), capture.frame_rate)
    return folder / name


def test_bodies_of_which_some_play_another_take_are_lined_up_and_do_not_meet(window, qtbot, tmp_path):
    document = window.bench.document
    first, second = document.project.performers
    row = performers_side_by_side(document.project.characters).values()
    for key, stood in zip((first, second), row, strict=True):
        document.replace("performers", key, replace(document.project.performers[key], position=stood.position), "Row")
    drop(window, travelling(tmp_path, "ahead.bvh", 0.0))
    wait_until_idle(qtbot, window)
    shown = document.project.performers[second]
    document.replace("performers", second, replace(shown, visible=False), "Hide")
    drop(window, travelling(tmp_path, "across.bvh", np.pi / 2))
    wait_until_idle(qtbot, window)
    places = [np.array(each.position) for each in document.project.performers.values()]
    assert document.project.performers[second].clips != document.project.performers[first].clips
    assert np.abs(places[0] - places[1]) == pytest.approx([PERFORMER_SPACING, 0.0], abs=1e-6)
    window.actions_by_id.by_id["show_all"].trigger()
    assert window.bench.live.wait_until_solved(SECONDS)
    window.actions_by_id.by_id["line_up"].trigger()
    assert window.bench.live.wait_until_solved(SECONDS)
    swept = swept_points(document.project, window.bench.live.result)
    one, other = (np.array(each.position) + swept[key][:, 0] for key, each in document.project.performers.items())
    assert np.linalg.norm(one - other, axis=1).min() > 0.75


def test_line_up_puts_bodies_of_a_mirrored_walk_across_the_way_that_is_seen(window, qtbot, tmp_path):
    document = window.bench.document
    drop(window, travelling(tmp_path, "aslant.bvh", np.pi / 4))
    wait_until_idle(qtbot, window)
    document.selection.set(("clips", next(iter(document.project.performers.values())).clips[0].id))
    QTest.keyClick(window, Qt.Key.Key_M, CONTROL)
    assert window.bench.live.wait_until_solved(SECONDS)
    window.actions_by_id.by_id["line_up"].trigger()
    first, second = (np.array(each.position) for each in document.project.performers.values())
    path = next(iter(swept_points(document.project, window.bench.live.result).values()))[:, 0]
    assert (path[-1] - path[0])[1] < -1.0
    assert (path[-1] - path[0]) @ (second - first) == pytest.approx(0.0, abs=0.1)


def test_what_is_said_of_a_stored_view_goes_with_the_next_edit(window):
    import_views()
    show_views(window)
    QTest.keyClick(window.bench.viewport, Qt.Key.Key_F5, Qt.KeyboardModifier.ShiftModifier)
    assert window.strip.text.startswith("The view is stored")
    window.bench.document.add("props", Prop("Box", position=(0.6, 0.0, 0.2)), "Add box")
    assert window.strip.text == ""


def test_only_a_warning_has_the_colour_of_a_warning(window):
    def edge():
        strip = window.strip
        strip.ensurePolished()
        return strip.grab().toImage().pixelColor(strip.width() // 2, 0).name()

    window.bench.inform("Exported walk.bvh.")
    QApplication.processEvents()
    assert edge() != colours.PARTLY.lower()
    window.bench.post_message("The file cannot be read.")
    QApplication.processEvents()
    assert edge() == colours.PARTLY.lower()
    window.bench.inform("Exported walk.bvh.")
    QApplication.processEvents()
    assert edge() != colours.PARTLY.lower()


def test_a_motion_that_spreads_its_limbs_puts_bodies_farther_apart_and_a_dropped_one_too(window, qtbot):
    """In splits, kicks and cartwheels neighbours cut into each other."""
    document, folder = window.bench.document, example_captures_folder()
    row = performers_side_by_side(document.project.characters).values()
    for key, stood in zip([*document.project.performers], row, strict=True):
        document.replace("performers", key, replace(document.project.performers[key], position=stood.position), "Row")
    drop(window, folder / "handstand.bvh")
    wait_until_idle(qtbot, window)
    assert least_spacing(document.project.performers) > PERFORMER_SPACING + 0.3
    character = next(iter(bundled_characters().values()))
    add_read_character(document, replace(character, name="New"), "Add New")
    assert least_spacing(document.project.performers) > PERFORMER_SPACING + 0.3


def least_spacing(performers):
    places = np.sort([each.position[1] for each in performers.values()])
    return np.diff(places).min()
