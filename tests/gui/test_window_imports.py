"""Files dropped on the window, what is told of them, and what is corrected in their reports."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.app.capture_import import repair_words
from studio.core.body.humanoid import BodyPart
from studio.core.body.pose import PoseSequence
from studio.core.captures.annotations import Annotations, Label
from studio.core.grounds import Steps
from studio.core.normalized.normalize import captured_steps
from studio.core.rotations import multiply
from studio.io.export import take_of_capture, write_take
from studio.io.importing import load_capture
from studio.resources_folder import example_captures_folder
from tests.builders import make_capture, make_constraint, make_contact
from tests.climbs import write_climb
from tests.gui.window_use import drop, same, wait_until_idle
from tests.patience import SECONDS

LEFT = Qt.MouseButton.LeftButton
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


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
    assert window.bench.live.wait_until_solved(SECONDS)
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert same(document.project, before)


def test_a_dropped_s4d_brings_its_own_contacts_and_constraints_and_is_one_undo_step(qtbot, window, tmp_path):
    document = window.bench.document
    before = document.project
    notes = Annotations((make_contact(first=4, last=9),), (make_constraint(name="Bell"),), (Label("kick", 3, 8),))
    write_take(take_of_capture(make_capture(), notes), tmp_path / "walk.s4d")
    drop(window, tmp_path / "walk.s4d")
    wait_until_idle(qtbot, window)
    assert window.strip.text == ""
    new_motion = list(document.project.motions)[-1]
    assert [each.name for each in document.project.constraints_of(new_motion).values()] == ["Bell"]
    assert [(each.first, each.last) for each in document.project.contacts_of(new_motion).values()] == [(4, 9)]
    assert list(document.project.labels_of(new_motion).values()) == [Label("kick", 3, 8, new_motion)]
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


def test_read_with_another_unit_the_capture_is_replaced_as_one_undo_step(qtbot, window, walk):
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    capture_id = list(document.project.captures)[-1]
    document.selection.set(("captures", capture_id))
    window.inspector.reimport_requested.emit(capture_id, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    assert document.project.captures[capture_id].unit == "inch"
    assert document.history == ("Import walk.bvh", "Set unit of walk to inch")
    window.inspector.reimport_requested.emit(capture_id, {"reference": "3"})
    wait_until_idle(qtbot, window)
    assert document.history[-1] == "Set reference of walk to 3"
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
    window.inspector.reimport_requested.emit(capture_id, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    document.replace("captures", capture_id, document.project.captures[capture_id].with_floor(0.25), "Set floor")
    second = walk.with_name("second.bvh")
    second.write_bytes(walk.read_bytes())
    drop(window, second)
    wait_until_idle(qtbot, window)
    second_id = list(document.project.captures)[-1]
    assert (document.project.captures[second_id].unit, document.project.captures[second_id].floor) == ("inch", 0.25)
    assert window.strip.text.endswith("corrections for this kind of file: unit inch, floor 0.25.")
    window.strip.press("Detect again")
    wait_until_idle(qtbot, window)
    assert (document.project.captures[second_id].unit, document.project.captures[second_id].floor) == ("cm", floor)
    assert settings.corrections == {}


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
    window.inspector.reimport_requested.emit("capture", {"unit": "cm"})
    wait_until_idle(qtbot, window)
    assert "cannot be found. Relink it" in window.strip.text


def test_a_double_click_on_a_capture_plays_it_on_the_visible_characters(qtbot, window, walk):
    document = window.bench.document
    drop(window, walk)
    wait_until_idle(qtbot, window)
    window.library.performance_requested.emit("capture")
    assert {p.clips[0].motion_id for p in document.project.performers.values()} == {"motion"}
    assert document.history[-1] == "Play Walk"


def test_an_import_shows_its_own_report_in_place_of_that_of_another_capture(qtbot, window, walk):
    document = window.bench.document
    document.selection.set(("captures", "capture"))
    drop(window, walk)
    wait_until_idle(qtbot, window)
    assert document.selection.items == (("captures", list(document.project.captures)[-1]),)


def test_a_noisy_take_is_offered_a_cleaning_that_one_click_applies_and_undo_takes_back(qtbot, window, tmp_path):
    capture = load_capture(example_captures_folder() / "walk_turn.bvh")
    rotations = capture.poses.local_rotations.copy()
    forearm = capture.body_map[BodyPart.LEFT_FOREARM]
    rotations[100:103, forearm] = multiply(rotations[100:103, forearm], np.array([1.0, 0.0, 0.0, 0.0]))
    poses = PoseSequence(rotations, capture.poses.local_translations)
    write_take(take_of_capture(replace(capture, poses=poses), Annotations()), tmp_path / "spike.bvh")
    drop(window, tmp_path / "spike.bvh")
    wait_until_idle(qtbot, window)
    document = window.bench.document
    capture_id = list(document.project.captures)[-1]
    as_read = document.project
    assert "cleaning" in {guess.subject for guess in document.project.captures[capture_id].guesses}
    document.selection.set(("captures", capture_id))
    [clean] = [each for each in window.inspector.findChildren(QPushButton) if each.text() == "Clean up motion"]
    QTest.mouseClick(clean, LEFT)
    wait_until_idle(qtbot, window)
    cleaned = document.project.captures[capture_id]
    assert "cleaning" not in {guess.subject for guess in cleaned.guesses}
    assert "was cleaned. It had 1 spike;" in cleaned.repairs[-1]
    assert window.strip.text == repair_words(cleaned)
    assert document.history[-1] == "Clean spike"
    window.inspector.reimport_requested.emit(capture_id, {"unit": "inch"})
    wait_until_idle(qtbot, window)
    assert "was cleaned" in document.project.captures[capture_id].repairs[-1]  # the other setting keeps it
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert same(document.project, as_read)


def test_steps_of_a_capture_become_the_ground_by_one_click_and_undo_takes_them_back(qtbot, window, tmp_path):
    write_climb(tmp_path / "climb.bvh", 0.16)
    drop(window, tmp_path / "climb.bvh")
    wait_until_idle(qtbot, window)
    document = window.bench.document
    as_read, capture_id = document.project, list(document.project.captures)[-1]
    document.selection.set(("captures", capture_id))
    [use] = [each for each in window.inspector.findChildren(QPushButton) if each.text() == "Use steps as ground"]
    QTest.mouseClick(use, LEFT)
    wait_until_idle(qtbot, window)
    project = document.project
    ground, performer = project.ground, project.performers[document.active_performer_id]
    assert (type(ground), ground.count, round(ground.rise, 2)) == (Steps, 4, 0.16)
    motion_id = performer.clips[0].motion_id
    assert len(project.contacts_of(motion_id)) > len(as_read.contacts_of(motion_id))
    assert "steps" not in {guess.subject for guess in project.captures[capture_id].guesses}
    placed = ground.seen_from(performer.position, performer.heading)
    steps = captured_steps(project.captures[capture_id])
    ahead = np.linspace([0.0, 0.0], [4.0, 0.0], 41)
    np.testing.assert_allclose(placed.height_at(ahead), steps.height_at(ahead), atol=1e-9)
    assert document.history[-1] == "Use steps of climb as ground"
    QTest.keyClick(window, Qt.Key.Key_Z, CONTROL)
    assert same(document.project, as_read)


@pytest.mark.parametrize("repair", ["walk.bvh, line 9: cut off.", "walk.bvh: line 9: cut off.", "line 9: cut off."])
def test_a_message_about_repairs_names_the_file_once(repair):
    capture = replace(make_capture(), source="walk.bvh", repairs=(repair,))
    assert repair_words(capture) == "walk.bvh was read with 1 repair: line 9: cut off."
