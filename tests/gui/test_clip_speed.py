"""The speed of a clip as a curve: keys set by S, in its form and by drags; later clips move along."""

from dataclasses import replace
from random import Random

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.core.curves.keyed import KeyedNumber
from studio.core.stage.clip import Clip
from studio.document.clip_edits import set_speed
from studio.document.key_edits import delete_keys, nudge_keys, set_keys
from studio.document.keyed_fields import KeyedField, KeyRef
from studio.io.project.project_file import new_document_id, read_project, write_project
from studio.panels.clip_editor import ClipEditor
from tests.gui.hand import RATE
from tests.gui.test_curve_editor import Editor

LATER = "later"


def clips_of(document):
    """The clips of the first performer."""
    return next(iter(document.project.performers.values())).clips


@pytest.fixture
def row(document):
    """Id of a clip that all play, which is selected, with another one behind it."""
    for key, performer in document.project.performers.items():
        clip = performer.clips[0]
        behind = Clip(clip.motion_id, 0, 50, clip.start + clip.length(RATE), LATER)
        document.replace("performers", key, replace(performer, clips=(clip, behind)), "Add clip")
    clip_id = clips_of(document)[0].id
    document.selection.set(("performers", next(iter(document.project.performers))), ("clips", clip_id))
    return clip_id


def key_speed(document, row, keys):
    """Set keys of the speed, frames of the motion by their values."""
    speed = KeyedNumber(tuple(frame / RATE for frame in keys), tuple(keys.values()))
    set_speed(document, row, speed, "Key speed")


def test_s_sets_keys_of_the_selected_clip_and_of_nothing_else(document, row):
    before = document.project
    for frame in (20, 60):
        document.playhead.set_frame(frame)
        assert set_keys(document) == 1
    speed = clips_of(document)[0].speed
    assert speed == KeyedNumber((20 / RATE, 60 / RATE), (1.0, 1.0))
    assert document.project.characters == before.characters
    assert document.history[-1] == "Set key"
    for _ in range(2):
        document.undo_stack.undo()
    assert document.project == before


def test_a_key_that_is_raised_in_the_curve_editor_changes_the_length_and_later_clips_move_along(
    document, timeline, hand, row
):
    key_speed(document, row, {20: 1.0, 40: 1.0, 60: 1.0, 80: 1.0})
    timeline.edit_curves(True)
    editor, before = Editor(document, timeline), clips_of(document)
    assert editor.channel("speed")[0].unit == "×"
    curves = timeline.tracks.picture.curves
    point = editor.key("speed", 1)
    lower = curves.y_of(timeline.tracks.shown, editor.area, editor.channel("speed")[0], 0.5)
    hand.press(point)
    hand.move(0, dy=round(lower) - point.y())
    hand.release()
    clip, behind = clips_of(document)
    assert clip.speed.values == pytest.approx((1.0, 0.5, 1.0, 1.0), abs=0.03)
    assert clip.speed.times == before[0].speed.times
    assert clip.length(RATE) > before[0].length(RATE) + 0.1
    assert behind.start == pytest.approx(clip.start + clip.length(RATE), abs=1e-9)
    for performer in document.project.performers.values():
        assert performer.clips == (clip, behind)
    document.undo_stack.undo()
    assert clips_of(document) == before


def test_diamonds_of_the_speed_lie_on_the_bar_and_are_dragged_in_time(document, timeline, hand, row):
    key_speed(document, row, {20: 1.0, 40: 0.5, 80: 1.0})
    clip = clips_of(document)[0]
    there = float(clip.stage_seconds(40 / RATE, RATE)) * RATE
    area = timeline.row_rect("clip", next(iter(document.project.performers)))
    begin = QPoint(round(timeline.x_of_frame(there)), area.center().y())
    hand.drag(begin, round(timeline.x_of_frame(there + 12) - timeline.x_of_frame(there)))
    moved = clips_of(document)[0].speed
    assert moved.times[0] == 20 / RATE
    assert moved.times[1] == pytest.approx(float(clip.motion_seconds((there + 12) / RATE, RATE)), abs=1.5 / RATE)
    assert document.selection.of("clips") == (row,)
    assert document.keys.items == {KeyRef(KeyedField("clips", row, "speed"), 1)}
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert clips_of(document)[0].speed.times == (20 / RATE, 80 / RATE)


def test_the_form_shows_the_speed_at_the_playhead_keys_it_and_fixes_it(qtbot, document, live, row):
    editor = ClipEditor(document, live, "clips", row)
    qtbot.addWidget(editor)
    document.playhead.set_frame(30)
    editor._keyed.setChecked(True)
    assert clips_of(document)[0].speed == KeyedNumber((0.5,), (1.0,))
    document.playhead.set_frame(60)
    editor._speed.setValue(0.5)
    speed = clips_of(document)[0].speed
    assert speed.values == (1.0, 0.5)
    editor.refresh()
    assert editor._speed.value() == pytest.approx(0.5)
    assert clips_of(document)[1].start == pytest.approx(clips_of(document)[0].length(RATE), abs=1e-9)
    document.playhead.set_frame(0)
    editor._keyed.setChecked(False)
    assert clips_of(document)[0].speed == 1.0
    assert clips_of(document)[1].start == pytest.approx(100 / RATE, abs=1e-9)


def test_a_keyed_speed_is_written_and_read_again(document, row, tmp_path):
    key_speed(document, row, {20: 1.0, 40: 1 / 3, 80: 1.0})
    write_project(tmp_path / "stage.studio", document.project, new_document_id())
    assert read_project(tmp_path / "stage.studio").project.performers == document.project.performers


@pytest.mark.parametrize("seed", range(12))
def test_random_edits_of_speeds_are_undone_exactly(document, row, seed):
    chance, before = Random(seed), document.project
    document.undo_stack.clear()
    for _ in range(25):
        clip = document.project.clips[row]
        document.playhead.set_frame(chance.randrange(100))
        match chance.choice(["set", "raise", "nudge", "delete", "fix"]):
            case "set":
                set_keys(document)
            case "raise" if isinstance(clip.speed, KeyedNumber):
                values = tuple(chance.uniform(0.2, 3.0) for _ in clip.speed.times)
                set_speed(document, row, replace(clip.speed, values=values), "Raise")
            case "nudge":
                nudge_keys(document, chance.randrange(-5, 6))
            case "delete":
                delete_keys(document)
            case "fix":
                set_speed(document, row, chance.uniform(0.3, 2.0), "Fix")
        one, other = clips_of(document)
        assert other.start == pytest.approx(one.start + one.length(RATE), abs=1e-6)
    after = document.project
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert document.project == before
    while document.undo_stack.canRedo():
        document.undo_stack.redo()
    assert document.project == after
