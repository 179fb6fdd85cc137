"""The stage plays live in the window: keys, edits and takes while it does."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.app.application import import_views, show_views
from studio.core.curves.keyed import KeyedPlace
from studio.core.solver.adapt import body_point_positions
from studio.core.stage.behaviour import Behaviour, Role, State, Transition
from studio.core.stage.conditions import KeyCondition
from studio.core.stage.project import Project
from tests.live.test_live_stage import WRIST, clip_of, reaching, staged
from tests.patience import PATIENCE, SECONDS

PLACE = (0.4, -0.2, 1.1)


@pytest.fixture
def playing(window, qtbot):
    """A window whose stage plays live."""
    punch = replace(clip_of("straight_punch", 60, 200), speed=0.1)  # on a slow machine it does not end within a test
    kick = clip_of("front_kick", 60, 200, 12.0)
    project = staged(punch, kick, reach=reaching("straight_punch", PLACE))
    ways = (Transition("guard", "kick", (KeyCondition("X"),)),)
    states = (State("guard", clip_of("straight_punch", 60, 120)), State("kick", kick))
    behaviour = Behaviour("Fighter", states, ways, cast=(Role("two"),))
    two = replace(project.performers["one"], name="Two", position=(0.0, 2.0))
    project = project.with_entity("performers", "two", two)
    window.bench.document.new(replace(project, behaviours={"fighter": behaviour}))
    import_views()
    show_views(window)
    window.bench.viewport.start()
    assert window.bench.live.wait_until_solved(SECONDS)
    window.bench.document.selection.set(("performers", "one"))
    window.actions_by_id.by_id["play_live"].trigger()
    play = window.bench.live.play
    qtbot.waitUntil(lambda: play.moment is not None and play.moment.seconds > 0.1, timeout=PATIENCE)
    yield window
    play.end()


def press(window, key, modifiers=Qt.KeyboardModifier.NoModifier):
    QTest.keyClick(window.bench.viewport, key, modifiers)


def test_keys_start_clips_of_the_selected_performer_and_escape_ends_it(playing, qtbot):
    play, viewport = playing.bench.live.play, playing.bench.viewport
    press(playing, Qt.Key.Key_2)
    qtbot.waitUntil(lambda: viewport.posed["one"].motion_id == "front_kick", timeout=PATIENCE)
    assert viewport.posed["two"].motion_id == "straight_punch"
    assert playing.actions_by_id.by_id["play_live"].isChecked()
    press(playing, Qt.Key.Key_Escape)
    assert not play.running
    qtbot.waitUntil(lambda: viewport.posed["one"].motion_id == "straight_punch", timeout=PATIENCE)
    assert playing.bench.document.playhead.time == 0.0


def test_a_behaviour_hears_keys_and_its_state_is_lit(playing, qtbot):
    states = []
    playing.bench.live.play.state_changed.connect(lambda key, state: states.append((key, state)))
    press(playing, Qt.Key.Key_X)
    qtbot.waitUntil(lambda: ("two", "kick") in states, timeout=PATIENCE)
    assert playing.behaviour.diagram.running == {"two": "kick"}
    press(playing, Qt.Key.Key_Escape)
    assert playing.behaviour.diagram.running == {}


def test_a_take_begins_at_the_playhead_and_plays_there_what_was_recorded(playing, qtbot):
    document, play = playing.bench.document, playing.bench.live.play
    press(playing, Qt.Key.Key_2)
    qtbot.waitUntil(lambda: playing.bench.viewport.posed["one"].motion_id == "front_kick", timeout=PATIENCE)
    begin = document.playhead.time
    seconds = play.moment.seconds
    qtbot.waitUntil(lambda: play.moment.seconds > seconds + 0.5, timeout=PATIENCE)  # the stage is ahead of the playhead
    press(playing, Qt.Key.Key_R, Qt.KeyboardModifier.ShiftModifier)
    begun = play.moment.seconds
    assert begun > begin + 0.3
    qtbot.waitUntil(lambda: play.moment.seconds > begun + 0.5, timeout=PATIENCE)
    press(playing, Qt.Key.Key_R, Qt.KeyboardModifier.ShiftModifier)
    press(playing, Qt.Key.Key_Escape)
    clips = document.project.performers["one"].clips
    assert clips[0].motion_id == "front_kick"
    assert clips[0].start == pytest.approx(begin, abs=1.0 / document.playhead.frame_rate)
    assert document.playhead.time == pytest.approx(begin, abs=1.0 / document.playhead.frame_rate)
    assert playing.bench.live.wait_until_solved(SECONDS)
    qtbot.waitUntil(lambda: playing.bench.viewport.posed["one"].motion_id == "front_kick", timeout=PATIENCE)
    document.undo_stack.undo()
    assert document.project.performers["one"].clips[0].motion_id == "straight_punch"


def test_a_target_that_is_moved_while_it_plays_is_followed_and_kept_in_the_take(playing, qtbot):
    document, play = playing.bench.document, playing.bench.live.play
    press(playing, Qt.Key.Key_R, Qt.KeyboardModifier.ShiftModifier)
    assert play.recording
    gesture = document.new_gesture()
    for step in range(1, 11):
        x, y, z = PLACE
        place = (x, y + 0.02 * step, z)
        asked = replace(document.project.constraints["reach"], target=place)
        document.replace("constraints", "reach", asked, "Move target", gesture)
        qtbot.wait(20)

    def reached():
        return np.linalg.norm(body_point_positions(WRIST, play.moment.results["one"])[0] - place) < 2e-3

    qtbot.waitUntil(reached, timeout=PATIENCE)
    press(playing, Qt.Key.Key_R, Qt.KeyboardModifier.ShiftModifier)
    assert not play.recording
    assert document.undo_stack.undoText() == "Record take"
    assert document.playhead.frame == document.playhead.first
    own = [each for key, each in document.project.constraints.items() if isinstance(each.target, KeyedPlace)]
    assert own
    press(playing, Qt.Key.Key_Escape)
    assert playing.bench.live.wait_until_solved(SECONDS)
    document.undo_stack.undo()
    assert document.project.constraints["reach"].target == place
    assert len(document.project.performers["one"].clips) == 2


def test_typing_into_a_field_is_typing_while_the_stage_plays(playing, qtbot):
    field = playing.bench.timeline.transport.frame
    field.setFocus()
    field.selectAll()
    QTest.keyClick(field, Qt.Key.Key_2)
    assert field.text() == "2"
    assert playing.bench.live.play.running


def test_the_message_names_the_keys_that_are_in_force_and_whom_they_concern(playing):
    assert playing.strip.text.endswith("X: kick (Two). Shift+R: record. Esc: stop.")
    playing.bench.live.play.end()
    playing.bench.preferences = replace(playing.bench.preferences, own_keys={"record_take": ("Ctrl+R",)})
    playing.actions_by_id.apply_keys()
    playing.actions_by_id.by_id["play_live"].trigger()
    assert "Ctrl+R: record." in playing.strip.text


def test_another_project_ends_it(playing):
    playing.bench.document.new(staged(clip_of("straight_punch")))
    assert not playing.bench.live.play.running


def test_nothing_plays_live_before_the_solver_is_there_and_the_window_says_so(playing, monkeypatch):
    play, said = playing.bench.live.play, []
    play.end()
    playing.bench.message_posted.connect(lambda message: said.append(message.sentence))
    monkeypatch.setattr(play, "_ready", lambda: False)
    playing.actions_by_id.by_id["play_live"].trigger()
    assert not play.running
    assert not playing.actions_by_id.by_id["play_live"].isChecked()
    assert "still being prepared" in said[-1]


def test_the_playhead_moves_though_the_last_picture_is_of_another_project_that_played(playing, monkeypatch):
    play, viewport, document = playing.bench.live.play, playing.bench.viewport, playing.bench.document
    moment = play.moment
    document.new(Project())
    monkeypatch.setattr(play, "moment", moment)
    viewport.redraw()
    viewport.grab_image()
    assert viewport.posed
    monkeypatch.setattr(play, "moment", None)
    document.playhead.set_range(0, 300)
    document.playhead.set_frame(30)


def test_trails_of_a_body_are_drawn_though_its_character_was_deleted_while_it_plays(playing):
    document, viewport = playing.bench.document, playing.bench.viewport
    document.remove("characters", document.project.performers["one"].character_id, "Delete character")
    document.selection.set(("constraints", "reach"))
    viewport.grab_image()
    assert viewport.view.trail is not None
    assert "one" in viewport.posed  # the stage has not stepped since
