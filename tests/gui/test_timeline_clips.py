"""Clips in the user's hands: dragged, trimmed, split, added, dropped, on the real widget over a real document."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

from studio.core.captures.contacts import ContactPoint
from studio.core.constraints.scope import Scope
from studio.core.stage.clip import Clip
from studio.core.stage.project import Motion
from studio.document import clip_edits
from studio.document.document import Document
from studio.document.dragging import capture_drag_data
from studio.panels.inspector import Inspector
from studio.panels.library_panel import LibraryPanel
from studio.timeline.hover import hover_text
from tests.builders import make_capture, make_constraint, make_contact, make_project
from tests.gui.hand import LEFT, NONE, RATE, pixels

FIRST, SECOND = "performer 0", "performer 1"
SHIFT = Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def document(qapp):
    """Two performers with two clips each, of two motions."""
    project = make_project(characters=2, constraints=0, contacts=0, frames=101)
    project = project.with_entity("captures", "other", make_capture("other", 101))
    project = project.with_entity("motions", "other", Motion("Other", "other"))
    rows = {
        FIRST: (Clip("motion", 0, 60, 0.0, "walk"), Clip("other", 0, 90, 50 / RATE, "punch")),
        SECOND: (Clip("motion", 0, 60, 0.0, "walk"), Clip("other", 10, 90, 80 / RATE, "kick")),
    }
    for key, row in rows.items():
        project = project.with_entity("performers", key, replace(project.performers[key], clips=row))
    document = Document(project)
    yield document
    document.close()


def place(timeline, performer_id, frame):
    row = timeline.row_rect("clip", performer_id)
    return QPoint(round(timeline.x_of_frame(frame)), row.center().y())


def clip(document, clip_id, performer_id=FIRST):
    return next(each for each in document.project.performers[performer_id].clips if each.id == clip_id)


def entry(timeline, point, *texts):
    """The entry of the menu under a point, which is open; of its submenu, if two texts are given."""
    QApplication.sendEvent(
        timeline.tracks,
        QContextMenuEvent(QContextMenuEvent.Reason.Mouse, point, timeline.tracks.mapToGlobal(point)),
    )
    menu = next(each for each in timeline.tracks.findChildren(QMenu) if each.isVisible())
    for text in texts[:-1]:
        menu = next(each.menu() for each in menu.actions() if each.text() == text)
    return next(each for each in menu.actions() if each.text() == texts[-1])


def choose(timeline, point, *texts):
    entry(timeline, point, *texts).trigger()
    QApplication.activePopupWidget() and QApplication.activePopupWidget().close()


def test_every_performer_has_its_row_and_one_row_stands_for_all_who_play_the_same(document, timeline):
    assert not timeline.row_rect("clip", FIRST).isEmpty()
    assert not timeline.row_rect("clip", SECOND).isEmpty()
    same = document.project.performers[FIRST].clips
    document.replace("performers", SECOND, replace(document.project.performers[SECOND], clips=same), "")
    assert timeline.row_rect("clip", SECOND).isEmpty()


def test_rows_of_performers_fold_and_unfold_by_the_arrow(timeline, hand):
    arrow = QPoint(6, timeline.row_rect("clip", FIRST).center().y())
    hand.drag(arrow, 0)
    assert timeline.row_rect("clip", SECOND).isEmpty()
    hand.drag(arrow, 0)
    assert not timeline.row_rect("clip", SECOND).isEmpty()


def test_a_click_selects_a_clip_with_whom_it_was_clicked_on(document, timeline, hand):
    hand.drag(place(timeline, SECOND, 120), 0)
    assert document.selection.items == (("performers", SECOND), ("clips", "kick"))
    assert document.active_clip.id == "kick"
    assert document.undo_stack.count() == 0


def test_dragging_a_bar_moves_it_in_time_as_one_step(document, timeline, hand):
    before = document.project
    hand.drag(place(timeline, SECOND, 120), pixels(timeline, 7))
    assert clip(document, "kick", SECOND).start * RATE == pytest.approx(87)
    assert document.undo_stack.count() == 1
    assert document.undo_stack.text(0) == "Move Other"
    document.undo_stack.undo()
    assert document.project.performers == before.performers


@pytest.mark.parametrize("frame", [120, 159.5], ids=["move", "trim"])
def test_a_clip_whose_motion_is_removed_while_it_is_dragged_stays_away(document, timeline, hand, frame):
    hand.press(place(timeline, SECOND, frame))
    hand.move(pixels(timeline, 3))
    document.remove("motions", "other", "Remove motion")
    hand.move(pixels(timeline, 9))
    assert "kick" not in document.project.clips
    hand.release()
    assert "kick" not in document.project.clips


def test_a_bar_catches_where_another_ends(document, timeline, hand):
    hand.press(place(timeline, SECOND, 120))
    hand.move(pixels(timeline, -19.5))
    assert clip(document, "kick", SECOND).start * RATE == pytest.approx(60)
    assert timeline.tracks.gesture.mark.magnet is not None
    hand.release()


def test_a_clip_that_both_play_moves_on_both(document, timeline, hand):
    hand.drag(place(timeline, FIRST, 30), pixels(timeline, 4))
    assert clip(document, "walk").start == clip(document, "walk", SECOND).start == pytest.approx(4 / RATE)


def test_all_selected_clips_move_by_one_of_them(document, timeline, hand):
    hand.drag(place(timeline, FIRST, 120), 0)
    QTest.mouseClick(timeline.tracks, LEFT, Qt.KeyboardModifier.ControlModifier, place(timeline, SECOND, 130))
    hand.drag(place(timeline, SECOND, 130), pixels(timeline, 5))
    assert clip(document, "punch").start * RATE == pytest.approx(55)
    assert clip(document, "kick", SECOND).start * RATE == pytest.approx(85)
    assert document.undo_stack.count() == 1


def test_an_end_that_is_dragged_trims_and_what_is_left_plays_when_it_did(document, timeline, hand):
    hand.drag(place(timeline, SECOND, 80) + QPoint(1, 0), pixels(timeline, 10))
    trimmed = clip(document, "kick", SECOND)
    assert (trimmed.first, trimmed.last) == (20, 90)
    assert trimmed.start * RATE == pytest.approx(90)
    hand.drag(place(timeline, SECOND, 160) - QPoint(1, 0), pixels(timeline, -20))
    assert clip(document, "kick", SECOND).last == 70
    assert document.undo_stack.text(1) == "Trim Other"


def test_esc_during_a_drag_puts_the_row_back(document, timeline, hand, live):
    before = document.project.performers
    hand.press(place(timeline, SECOND, 120))
    hand.move(pixels(timeline, 9))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    assert document.project.performers == before
    assert document.undo_stack.count() == 0
    assert not live.interactive


def test_a_split_at_the_playhead_asks_of_both_parts_what_was_asked_of_the_clip(document, timeline):
    document.add("constraints", make_constraint("other", scope=Scope(clip_id="kick")), "")
    document.add("contacts", make_contact("other", scope=Scope(clip_id="kick"), point=ContactPoint.LEFT_TOE), "")
    document.playhead.set_frame(120)
    choose(timeline, place(timeline, SECOND, 100), "Split at playhead")
    _, left, right = document.project.performers[SECOND].clips
    assert (left.first, left.last, right.first, right.last) == (10, 50, 50, 90)
    assert document.selection.current == ("clips", right.id)
    for part in (left, right):
        assert len(document.project.constraints_for(SECOND, part)) == 1
        assert len(document.project.contacts_for(SECOND, part)) == 1
    assert document.undo_stack.count() == 3
    document.undo_stack.undo()
    assert len(document.project.constraints) == len(document.project.contacts) == 1


def test_a_split_beside_the_clip_is_refused_in_a_sentence(document, timeline, qtbot):
    document.playhead.set_frame(0)
    with qtbot.waitSignal(document.problem_reported) as said:
        choose(timeline, place(timeline, SECOND, 100), "Split at playhead")
    assert "Move it between" in said.args[0]
    assert document.undo_stack.count() == 0


def test_del_deletes_a_clip_with_what_was_asked_of_it_alone(document, timeline, hand):
    document.add("constraints", make_constraint("other", scope=Scope(clip_id="kick")), "")
    hand.drag(place(timeline, SECOND, 120), 0)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert [each.id for each in document.project.performers[SECOND].clips] == ["walk"]
    assert not document.project.constraints
    assert ("clips", "kick") not in document.selection
    document.undo_stack.undo()
    assert len(document.project.constraints) == 1


def test_a_clip_made_its_own_is_edited_alone(document, timeline, hand):
    choose(timeline, place(timeline, SECOND, 30), f"Make unique for {document.project.performers[SECOND].name}")
    hand.drag(place(timeline, SECOND, 30), pixels(timeline, 4))
    assert clip(document, "walk").start == 0.0
    assert document.project.performers[SECOND].clips[0].start == pytest.approx(4 / RATE)


def test_a_clip_is_added_from_the_menu_where_it_was_opened(document, timeline):
    choose(timeline, place(timeline, SECOND, 70), "Add clip", "Other")
    added = document.selection.current[1]
    assert clip(document, added, SECOND).start * RATE == pytest.approx(70, abs=0.5)
    assert [each.id for each in document.project.performers[FIRST].clips] == ["walk", "punch"]


@pytest.mark.parametrize("what", ["Add clip", "Add layer"])
def test_a_motion_that_is_removed_while_the_menu_is_open_is_told_of(document, timeline, qtbot, what):
    chosen = entry(timeline, place(timeline, SECOND, 70), what, "Other")
    document.remove("motions", "other", "Remove motion")
    with qtbot.waitSignal(document.problem_reported) as said:
        chosen.trigger()
    assert "has been removed" in said.args[0]
    QApplication.activePopupWidget() and QApplication.activePopupWidget().close()


@pytest.mark.parametrize(
    ("gone", "what"),
    [
        ("performer", ["Add clip", "Other"]), ("performer", ["Add layer", "Other"]), ("performer", ["Mirror"]),
        ("clip", ["Split at playhead"]), ("clip", ["Mirror"]), ("clip", ["Duplicate"]), ("clip", ["Delete"]),
    ],
)  # fmt: skip
def test_what_is_removed_while_its_menu_is_open_is_told_of(document, timeline, qtbot, gone, what):
    chosen = entry(timeline, place(timeline, SECOND, 130), *what)
    if gone == "performer":
        document.remove("performers", SECOND, "Remove performer")
    else:
        clip_edits.remove_clips(document, ("kick",), "Delete")
    before = document.project
    with qtbot.waitSignal(document.problem_reported) as said:
        chosen.trigger()
    assert f"The {gone} has been removed" in said.args[0]
    assert document.project is before
    QApplication.activePopupWidget() and QApplication.activePopupWidget().close()


def test_arrow_keys_trim_the_edge_that_has_the_keyboard(document, timeline, hand):
    hand.drag(place(timeline, SECOND, 120), 0)
    timeline.tracks.setFocus()
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Tab)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Right)
    assert clip(document, "kick", SECOND).first == 11
    assert "first frame 11" in timeline.tracks.accessibleName()


def test_a_capture_dropped_from_the_library_becomes_a_clip_there(document, timeline, qtbot):
    library = LibraryPanel(document)
    qtbot.addWidget(library)
    index = library._index(("captures", "other"))
    assert library.model.flags(index) & Qt.ItemFlag.ItemIsDragEnabled
    content = library.model.mimeData([index])
    point = QPointF(place(timeline, FIRST, 145))
    event = QDropEvent(point, Qt.DropAction.CopyAction, content, LEFT, NONE)
    timeline.tracks.dropEvent(event)
    assert event.isAccepted()
    row = document.project.performers[FIRST].clips
    assert len(row) == 3
    assert row[-1].start * RATE == pytest.approx(145, abs=0.5)
    assert document.undo_stack.count() == 1


def test_files_are_left_to_the_window(timeline):
    content = QMimeData()  # an event does not hold it
    event = QDropEvent(QPointF(400, 40), Qt.DropAction.CopyAction, content, LEFT, NONE)
    timeline.tracks.dropEvent(event)
    assert not event.isAccepted()


def test_a_drop_beside_the_rows_goes_to_the_end_of_the_active_row(document, timeline):
    end = clip(document, "punch").start + 90 / RATE
    content = capture_drag_data("other")
    event = QDropEvent(QPointF(400, 300), Qt.DropAction.CopyAction, content, LEFT, NONE)
    timeline.tracks.dropEvent(event)
    assert document.project.performers[FIRST].clips[-1].start == pytest.approx(end - clip_edits.DEFAULT_BLEND_SECONDS)


def test_the_form_of_a_clip_changes_it_and_undo_takes_it_back(document, live, qtbot):
    inspector = Inspector(document, live)
    qtbot.addWidget(inspector)
    document.selection.set(("performers", SECOND), ("clips", "kick"))
    form = inspector.current_form()
    before = clip(document, "kick", SECOND)
    form._speed.setValue(2.0)
    form._repeats.setValue(3)
    form._first.setValue(30)
    form._mirrored.click()
    form._joined.click()
    form._turn.setValue(90.0)
    form._offset[0].setValue(0.5)
    after = clip(document, "kick", SECOND)
    assert (after.speed, after.repeats, after.first, after.mirrored, after.joined) == (2.0, 3, 30, True, False)
    assert after.turn == pytest.approx(1.5708, abs=1e-4)
    assert after.offset == (0.5, 0.0)
    assert document.undo_stack.count() == 7
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
    assert clip(document, "kick", SECOND) == before
    assert form._speed.value() == 1.0


def test_undo_of_an_added_clip_leaves_nothing_selected_that_is_gone(document):
    name = clip_edits.add_clip(document, [FIRST], "other")
    document.selection.set(("performers", FIRST), ("clips", name))
    document.undo_stack.undo()
    assert document.selection.items == (("performers", FIRST),)


def test_a_selected_constraint_brings_the_clip_of_which_it_is_asked(document, timeline):
    constraint_id = document.add("constraints", make_constraint("other"), "")
    document.selection.set(("performers", SECOND), ("constraints", constraint_id))
    assert document.active_clip.id == "kick"
    assert not timeline.row_rect("constraints", constraint_id).isEmpty()


def test_who_cannot_be_adapted_is_shown_as_such_and_the_others_as_ever(document, timeline, live):
    before = timeline.grab().toImage()
    live.failures[SECOND] = "It follows 'Nobody', which could not be adapted."
    live.reported_changed.emit()
    after = timeline.grab().toImage()
    points = {key: timeline.tracks.mapTo(timeline, place(timeline, key, 120)) for key in (FIRST, SECOND)}
    assert after.pixelColor(points[FIRST]) == before.pixelColor(points[FIRST])
    assert after.pixelColor(points[SECOND]) != before.pixelColor(points[SECOND])
    said = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(place(timeline, SECOND, 120)))
    assert "which could not be adapted" in said


@pytest.mark.parametrize(("stretched", "speed", "later"), [(60, 0.5, 60), (-30, 2.0, -30), (-59.9, 10.0, -54)])
def test_an_end_that_is_dragged_with_shift_changes_the_speed_and_later_clips_move_along(
    document, timeline, hand, stretched, speed, later
):
    document.replace(
        "performers",
        FIRST,
        replace(document.project.performers[FIRST], clips=(Clip("motion", 0, 60, 0.0, "walk"),
                Clip("other", 0, 90, 1.0, "punch"))),
        "Row",
    )  # fmt: skip
    document.undo_stack.clear()
    before = document.project
    hand.press(place(timeline, FIRST, 60) - QPoint(4, 0))
    hand.move(pixels(timeline, stretched), SHIFT)
    hand.release()
    walk = clip(document, "walk")
    assert walk.speed == pytest.approx(speed, rel=0.02)
    assert (walk.first, walk.last, walk.start) == (0, 60, 0.0)
    assert clip(document, "punch").start * RATE == pytest.approx(60 + later, abs=1.0)
    assert clip(document, "walk", SECOND).speed == walk.speed
    assert clip(document, "kick", SECOND).start * RATE == pytest.approx(80 + later, abs=1.0)
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert document.project == before
