"""The timeline as a person uses it: with mouse and keys, on the real widget over a real document."""

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QHelpEvent, QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.timeline.transport import MAX_FRAME
from tests.gui.hand import RATE, frames, in_lane, pixels


def test_dragging_the_full_handle_ten_frames_is_one_step_that_can_be_undone(document, timeline, hand):
    before = document.project.constraints["kick"]
    hand.drag(timeline.handle_point("kick", "fade-in end"), pixels(timeline, 10))
    assert frames(document.project.constraints["kick"].activation) == (20, 40, 50, 60)
    assert document.undo_stack.count() == 1
    assert document.undo_stack.text(0) == "Move fade-in end of Kick target"
    document.undo_stack.undo()
    assert document.project.constraints["kick"] == before


def test_everybody_is_solved_live_from_the_press_to_the_release(timeline, live, hand):
    hand.press(timeline.handle_point("kick", "fade-in end"))
    hand.move(pixels(timeline, 10))
    assert live.interactive
    hand.release()
    assert not live.interactive


def test_the_document_follows_while_the_mouse_moves(document, timeline, hand):
    hand.press(timeline.handle_point("kick", "end"))
    hand.move(pixels(timeline, 10))
    assert frames(document.project.constraints["kick"].activation)[3] == 70


def test_esc_during_a_drag_puts_everything_back(document, timeline, live, hand):
    before = document.project.constraints["kick"]
    hand.press(timeline.handle_point("kick", "fade-in end"))
    hand.move(pixels(timeline, 10))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    assert document.project.constraints["kick"] == before
    assert document.undo_stack.count() == 0
    assert not live.interactive
    hand.move(pixels(timeline, 5))
    hand.release()
    assert document.project.constraints["kick"] == before


def test_a_drag_back_to_where_it_began_leaves_no_step(document, timeline, hand):
    hand.press(timeline.handle_point("kick", "fade-in end"))
    hand.move(pixels(timeline, 10))
    hand.move(-pixels(timeline, 10))
    hand.release()
    assert document.undo_stack.count() == 0


def test_times_snap_to_frames_unless_alt_is_held(document, timeline, hand):
    hand.press(timeline.handle_point("kick", "fade-in end"))
    hand.move(pixels(timeline, 4.4))
    assert frames(document.project.constraints["kick"].activation)[1] == 34
    hand.move(0, Qt.KeyboardModifier.AltModifier)
    assert frames(document.project.constraints["kick"].activation)[1] == pytest.approx(34.4, abs=0.1)
    hand.release()


def test_a_time_catches_on_the_playhead_even_between_frames(document, timeline, hand):
    document.playhead.set_time(40.3 / RATE)
    hand.press(timeline.handle_point("kick", "fade-in end"))
    hand.move(pixels(timeline, 10.1))
    assert frames(document.project.constraints["kick"].activation)[1] == pytest.approx(40.3)
    assert timeline.tracks.gesture.mark.magnet == pytest.approx(40.3 / RATE)
    hand.release()


def test_a_drag_tells_its_time_and_frame(timeline, hand, qtbot):
    hand.press(timeline.handle_point("kick", "fade-in end"))
    with qtbot.waitSignal(timeline.message_posted) as told:
        hand.move(pixels(timeline, 12))
    assert timeline.tracks.gesture.mark.text.endswith("0.700 s · frame 42")
    assert "frame" in told.args[0]
    hand.release()


def test_dragging_the_bar_moves_the_whole_curve(document, timeline, hand):
    row = timeline.row_rect("constraints", "kick")
    hand.drag(QPoint(round(timeline.x_of_frame(40)), row.top() + 18), pixels(timeline, 7))
    assert frames(document.project.constraints["kick"].activation) == (27, 37, 57, 67)
    assert document.undo_stack.count() == 1


def test_a_click_selects_and_changes_nothing(document, timeline, hand):
    hand.drag(timeline.handle_point("kick", "fade-in end"), 0)
    assert document.selection.current == ("constraints", "kick")
    assert document.undo_stack.count() == 0


def test_a_click_on_an_empty_place_selects_nothing(document, timeline, hand):
    document.selection.set(("constraints", "kick"))
    row = timeline.row_rect("constraints", "kick")
    hand.drag(QPoint(round(timeline.x_of_frame(90)), row.top() + 10), 0)
    assert document.selection.current is None


def test_a_row_is_selected_by_its_name(document, timeline, hand):
    row = timeline.row_rect("constraints", "kick")
    hand.drag(QPoint(60, row.center().y()), 0)
    assert document.selection.current == ("constraints", "kick")


@pytest.mark.parametrize("item", [("contacts", "early"), ("constraints", "kick")])
def test_del_deletes_what_is_selected_and_undo_brings_it_back(document, timeline, item):
    before = document.project.get(*item)
    document.selection.set(item)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert document.project.get(*item) is None
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert document.project.get(*item) == before


def test_dragging_on_the_ruler_scrubs_at_once(document, timeline, hand):
    y = timeline.row_rect("ruler").center().y()
    hand.press(QPoint(round(timeline.x_of_frame(30)), y))
    assert document.playhead.frame == 30
    hand.move(pixels(timeline, 25))
    assert document.playhead.frame == 55
    hand.release()
    assert document.undo_stack.count() == 0


def test_the_playhead_can_be_dragged_by_its_line_and_esc_brings_it_back(document, timeline, hand):
    document.playhead.set_frame(80)
    row = timeline.row_rect("constraints", "kick")
    hand.press(QPoint(round(timeline.x_of_frame(80)), row.center().y()))
    hand.move(-pixels(timeline, 20))
    assert document.playhead.frame == 60
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    assert document.playhead.frame == 80
    hand.release()


def test_zooming_keeps_the_playhead_and_what_is_under_the_mouse(document, timeline, hand):
    document.playhead.set_frame(40)
    place = QPoint(700, timeline.row_rect("clip", "performer 0").center().y())
    before, scale = timeline.frame_at(700), pixels(timeline, 1)
    hand.wheel(place, 60, Qt.KeyboardModifier.ControlModifier)
    assert timeline.frame_at(700) == pytest.approx(before)
    assert pixels(timeline, 1) > 1.5 * scale
    assert document.playhead.frame == 40


def test_shift_and_wheel_scroll_in_time_and_fit_shows_all_again(timeline, hand):
    whole = timeline.x_of_frame(0), timeline.x_of_frame(100)
    hand.wheel(QPoint(700, 100), 90, Qt.KeyboardModifier.ControlModifier)
    before = timeline.x_of_frame(50)
    hand.wheel(QPoint(700, 100), -15, Qt.KeyboardModifier.ShiftModifier)
    assert timeline.x_of_frame(50) < before
    timeline.fit()
    assert (timeline.x_of_frame(0), timeline.x_of_frame(100)) == whole


def test_arrows_step_frames_and_home_and_end_go_to_the_ends(document, timeline):
    document.playhead.set_frame(10)
    for key, frame in (
        (Qt.Key.Key_Right, 11),
        (Qt.Key.Key_Left, 10),
        (Qt.Key.Key_End, 100),
        (Qt.Key.Key_Home, 0),
    ):
        QTest.keyClick(timeline.tracks, key)
        assert document.playhead.frame == frame


def test_up_and_down_go_to_contacts_and_activation_times(document, timeline):
    document.playhead.set_frame(10)
    visited = []
    for key in (Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Up):
        QTest.keyClick(timeline.tracks, key)
        visited.append(document.playhead.frame)
    assert visited == [15, 20, 30, 20]


def test_tab_takes_hold_of_a_handle_and_arrows_move_it_by_a_frame(document, timeline):
    document.selection.set(("constraints", "kick"))
    timeline.tracks.setFocus()
    for _ in range(2):
        QTest.keyClick(timeline.tracks, Qt.Key.Key_Tab)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Right)
    assert frames(document.project.constraints["kick"].activation) == (20, 31, 50, 60)
    assert timeline.tracks.accessibleName() == "Kick target, fade-in end, 0.517 s · frame 31"
    assert document.playhead.frame == 0
    assert document.undo_stack.count() == 1


def point_at(widget, place):
    """As a hand that comes to rest there, wherever the real mouse is."""
    where, no = QPointF(place), Qt.MouseButton.NoButton
    event = QMouseEvent(QEvent.Type.MouseMove, where, widget.mapToGlobal(where), no, no, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(widget, event)


def test_hover_texts_go_when_what_they_tell_of_goes(document, timeline, live):
    said = []
    timeline.message_posted.connect(said.append)
    row = timeline.row_rect("constraints", "kick")
    point_at(timeline.tracks, QPoint(60, row.center().y()))
    assert said[-1].startswith("Kick target")
    document.remove("constraints", "kick", "Delete")
    assert said[-1] == ""
    lane = in_lane(timeline, 10)
    point_at(timeline.tracks, lane)
    assert "contact" in said[-1]
    QApplication.sendEvent(timeline.tracks, QEvent(QEvent.Type.Leave))
    assert said[-1] == ""


@pytest.mark.parametrize(("kind", "x"), [("constraints", 60), ("lane", 400), ("clip", 400)])
def test_a_tooltip_leaves_the_row_free_that_it_tells_of(timeline, kind, x):
    row = timeline.row_rect(kind, next(row.id for row in timeline.tracks.sheet.rows if row.kind == kind))
    for y in (row.top() + 4, row.center().y(), row.bottom() - 4):
        place = QPoint(x, y)
        rest = QHelpEvent(QEvent.Type.ToolTip, place, timeline.tracks.mapToGlobal(place))
        QApplication.sendEvent(timeline.tracks, rest)
        [tip] = [each for each in QApplication.topLevelWidgets() if each.inherits("QTipLabel") and each.isVisible()]
        covered = QRect(timeline.tracks.mapFromGlobal(tip.geometry().topLeft()), tip.size())
        assert not covered.intersects(row)
        tip.hide()


def test_the_playhead_is_wiped_from_where_it_was_painted_last_also_by_a_zoom(document, timeline, monkeypatch):
    document.playhead.set_frame(20)
    timeline.tracks.axis.zoom(1.4, timeline.x_of_frame(10))
    timeline.tracks.grab()
    painted = QPoint(round(timeline.x_of_frame(20)), 4)
    wiped = []
    monkeypatch.setattr(timeline.tracks, "update", lambda *area: wiped.extend(area))
    document.playhead.set_frame(60)
    assert any(area.contains(painted) for area in wiped)


def test_a_range_as_long_as_its_field_takes_is_painted_from_very_near(document, timeline):
    timeline.transport.last.setValue(MAX_FRAME)
    document.playhead.set_frame(MAX_FRAME)
    for factor in (1e9, 1e-9):
        timeline.tracks.axis.zoom(factor, 700)
        assert not timeline.grab().isNull()
    document.playhead.set_frame(0)
    assert not timeline.grab().isNull()
