"""The timeline as a person uses it: with mouse and keys, on the real widget over a real document."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.core.constraints.activation import ActivationCurve
from studio.core.contacts import ContactPoint
from studio.core.project import Project
from studio.document.document import Document
from studio.engine.empty_stage import HIDDEN
from studio.timeline.menus import menu_at
from studio.timeline.strips import StripState
from studio.timeline.timeline import Timeline
from studio.timeline.tracks.plot import Quantity
from tests.builders import make_constraint, make_contact, make_project
from tests.timeline.fakes import FakeLive

RATE = 60.0
LEFT = Qt.MouseButton.LeftButton
NONE = Qt.KeyboardModifier.NoModifier


def curve(start, full, full_end, end):
    return ActivationCurve(start / RATE, full / RATE, full_end / RATE, end / RATE)


def frames(activation):
    times = (activation.start, activation.full, activation.full_end, activation.end)
    return tuple(round(time * RATE, 6) for time in times)


@pytest.fixture
def document(qapp):
    project = make_project(characters=2, constraints=0, contacts=0, frames=101)
    project = project.with_entity(
        "constraints", "kick", make_constraint(name="Kick target", activation=curve(20, 30, 50, 60))
    )
    for key, first, last in (("early", 5, 15), ("late", 70, 90)):
        contact = make_contact(point=ContactPoint.LEFT_HEEL, first=first, last=last)
        project = project.with_entity("contacts", key, contact)
    document = Document(project)
    yield document
    document.close()


@pytest.fixture
def live(document):
    return FakeLive(document)


@pytest.fixture
def timeline(qtbot, document, live):
    timeline = Timeline(document, live)
    qtbot.addWidget(timeline)
    timeline.resize(1296, 350)
    timeline.show()
    QApplication.processEvents()
    return timeline


class Hand:
    """A mouse on the rows, with a button that stays down from ``press`` to ``release``."""

    def __init__(self, timeline):
        self.rows = timeline.tracks
        self.at = QPoint()

    def press(self, point):
        self.at = QPoint(point)
        QTest.mousePress(self.rows, LEFT, NONE, self.at)

    def move(self, dx, modifiers=NONE, dy=0):
        for step in (0.5, 1.0):
            place = QPointF(self.at) + QPointF(dx, dy) * step
            event = QMouseEvent(QEvent.Type.MouseMove, place, self.rows.mapToGlobal(place), LEFT, LEFT, modifiers)
            QApplication.sendEvent(self.rows, event)
        self.at = QPoint(round(self.at.x() + dx), self.at.y() + dy)

    def release(self):
        QTest.mouseRelease(self.rows, LEFT, NONE, self.at)

    def drag(self, point, dx):
        self.press(point)
        self.move(dx)
        self.release()

    def wheel(self, point, degrees, modifiers):
        place = QPointF(point)
        event = QWheelEvent(
            place,
            self.rows.mapToGlobal(place),
            QPoint(),
            QPoint(0, round(degrees * 8)),
            Qt.MouseButton.NoButton,
            modifiers,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(self.rows, event)


@pytest.fixture
def hand(timeline):
    return Hand(timeline)


def pixels(timeline, count):
    return timeline.x_of_frame(count) - timeline.x_of_frame(0)


def in_lane(timeline, frame, toe=False):
    row = timeline.row_rect("lane", "left foot")
    return QPoint(round(timeline.x_of_frame(frame)), row.center().y() + (4 if toe else -4))


# Activation


def test_dragging_the_full_handle_ten_frames_is_one_step_that_can_be_undone(document, timeline, hand):
    before = document.project.constraints["kick"]
    hand.drag(timeline.handle_point("kick", "full"), pixels(timeline, 10))
    assert frames(document.project.constraints["kick"].activation) == (20, 40, 50, 60)
    assert document.undo_stack.count() == 1
    assert document.undo_stack.text(0) == "Move full of Kick target"
    document.undo_stack.undo()
    assert document.project.constraints["kick"] == before


def test_everybody_is_solved_live_from_the_press_to_the_release(timeline, live, hand):
    hand.press(timeline.handle_point("kick", "full"))
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
    hand.press(timeline.handle_point("kick", "full"))
    hand.move(pixels(timeline, 10))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    assert document.project.constraints["kick"] == before
    assert document.undo_stack.count() == 0
    assert not live.interactive
    hand.move(pixels(timeline, 5))
    hand.release()
    assert document.project.constraints["kick"] == before


def test_a_drag_back_to_where_it_began_leaves_no_step(document, timeline, hand):
    hand.press(timeline.handle_point("kick", "full"))
    hand.move(pixels(timeline, 10))
    hand.move(-pixels(timeline, 10))
    hand.release()
    assert document.undo_stack.count() == 0


def test_times_snap_to_frames_unless_alt_is_held(document, timeline, hand):
    hand.press(timeline.handle_point("kick", "full"))
    hand.move(pixels(timeline, 4.4))
    assert frames(document.project.constraints["kick"].activation)[1] == 34
    hand.move(0, Qt.KeyboardModifier.AltModifier)
    assert frames(document.project.constraints["kick"].activation)[1] == pytest.approx(34.4, abs=0.1)
    hand.release()


def test_a_time_catches_on_the_playhead_even_between_frames(document, timeline, hand):
    document.playhead.set_time(40.3 / RATE)
    hand.press(timeline.handle_point("kick", "full"))
    hand.move(pixels(timeline, 10.1))
    assert frames(document.project.constraints["kick"].activation)[1] == pytest.approx(40.3)
    assert timeline.tracks.gesture.mark.caught == pytest.approx(40.3 / RATE)
    hand.release()


def test_a_drag_tells_its_time_and_frame(timeline, hand, qtbot):
    hand.press(timeline.handle_point("kick", "full"))
    with qtbot.waitSignal(timeline.told) as told:
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
    hand.drag(timeline.handle_point("kick", "full"), 0)
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


# Contacts


def contact_frames(document, key):
    contact = document.project.contacts[key]
    return contact.first, contact.last


def test_dragging_a_contact_moves_it(document, timeline, hand):
    hand.drag(timeline.contact_rect("early").center(), pixels(timeline, 8))
    assert contact_frames(document, "early") == (13, 23)
    assert document.undo_stack.count() == 1


def test_a_contact_stops_at_its_neighbour_and_at_the_ends(document, timeline, hand):
    hand.drag(timeline.contact_rect("early").center(), pixels(timeline, 80))
    assert contact_frames(document, "early") == (59, 69)
    hand.drag(timeline.contact_rect("early").center(), -pixels(timeline, 90))
    assert contact_frames(document, "early") == (0, 10)


def test_either_end_of_a_moved_contact_catches_on_the_playhead(document, timeline, hand):
    late = document.project.performers["performer 1"]
    clips = (replace(late.clips[0], start=8.0),)  # so much is shown now that six pixels are several frames
    document.replace("performers", "performer 1", replace(late, clips=clips), "")
    document.playhead.set_frame(40)
    hand.drag(timeline.contact_rect("early").center(), pixels(timeline, 23))
    assert contact_frames(document, "early") == (30, 40)
    hand.drag(timeline.contact_rect("early").center(), pixels(timeline, 12))
    assert contact_frames(document, "early") == (40, 50)


def test_the_ends_of_a_contact_trim_it(document, timeline, hand):
    bar = timeline.contact_rect("early")
    hand.drag(QPoint(bar.right(), bar.center().y()), pixels(timeline, 8))
    assert contact_frames(document, "early") == (5, 23)
    hand.drag(QPoint(bar.left() + 1, bar.center().y()), pixels(timeline, 4))
    assert contact_frames(document, "early") == (9, 23)
    hand.drag(QPoint(round(timeline.x_of_frame(9)) + 1, bar.center().y()), pixels(timeline, 40))
    assert contact_frames(document, "early") == (23, 23)


def test_esc_puts_a_contact_back(document, timeline, hand):
    hand.press(timeline.contact_rect("late").center())
    hand.move(pixels(timeline, -8))
    assert contact_frames(document, "late") == (62, 82)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    hand.release()
    assert contact_frames(document, "late") == (70, 90)
    assert document.undo_stack.count() == 0


@pytest.mark.parametrize(
    ("frame", "toe", "point", "first", "last"),
    [
        (40, False, ContactPoint.LEFT_HEEL, 31, 49),
        (20, False, ContactPoint.LEFT_HEEL, 16, 34),
        (40, True, ContactPoint.LEFT_TOE, 31, 49),
        (99, True, ContactPoint.LEFT_TOE, 82, 100),
    ],
)
def test_a_double_click_adds_a_contact_of_at_most_a_third_of_a_second(
    document, timeline, frame, toe, point, first, last
):
    QTest.mouseDClick(timeline.tracks, LEFT, NONE, in_lane(timeline, frame, toe))
    collection, key = document.selection.current
    contact = document.project.contacts[key]
    assert (collection, contact.point, contact.first, contact.last) == ("contacts", point, first, last)
    assert document.undo_stack.count() == 1


def test_a_contact_added_between_two_fills_no_more_than_the_gap(document, timeline):
    document.add("contacts", make_contact(first=22, last=60), "")
    QTest.mouseDClick(timeline.tracks, LEFT, NONE, in_lane(timeline, 18))
    assert contact_frames(document, document.selection.current[1]) == (16, 21)


def test_a_double_click_on_a_contact_adds_nothing(document, timeline):
    QTest.mouseDClick(timeline.tracks, LEFT, NONE, timeline.contact_rect("late").center())
    QTest.mouseRelease(timeline.tracks, LEFT, NONE, timeline.contact_rect("late").center())
    assert set(document.project.contacts) == {"early", "late"}


def test_a_contact_can_be_added_at_the_playhead_without_the_mouse(document, timeline):
    document.playhead.set_frame(40)
    added = timeline.add_contact(ContactPoint.LEFT_HEEL)
    assert contact_frames(document, added) == (31, 49)
    assert timeline.add_contact(ContactPoint.LEFT_HEEL) is None


def test_the_menu_of_a_foot_adds_and_that_of_a_contact_deletes(document, timeline):
    menu = menu_at(timeline.tracks, QPointF(in_lane(timeline, 40)))
    assert [action.text() for action in menu.actions()] == ["Add left heel contact here", "Add contact of"]
    menu.actions()[0].trigger()
    added = document.selection.current[1]
    menu = menu_at(timeline.tracks, QPointF(timeline.contact_rect(added).center()))
    menu.actions()[0].trigger()
    assert set(document.project.contacts) == {"early", "late"}


def test_a_hand_that_touches_gets_a_row_and_is_trimmed_as_a_foot(document, timeline, hand):
    assert timeline.row_rect("lane", "hands").isEmpty()
    menu = menu_at(timeline.tracks, QPointF(in_lane(timeline, 40)))
    others = {action.text(): action for action in menu.actions()[1].menu().actions()}
    assert list(others)[4:] == ["Left hand", "Right hand", "Left knee", "Right knee", "Seat"]
    others["Right hand"].trigger()
    added = document.selection.current[1]
    assert document.project.contacts[added].point is ContactPoint.RIGHT_HAND
    assert not timeline.row_rect("lane", "hands").isEmpty()
    bar = timeline.contact_rect(added)
    assert timeline.row_rect("lane", "hands").contains(bar.center())
    hand.drag(bar.center(), pixels(timeline, 10))
    assert contact_frames(document, added) == (41, 59)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert timeline.row_rect("lane", "hands").isEmpty()


@pytest.mark.parametrize("item", [("contacts", "early"), ("constraints", "kick")])
def test_del_deletes_what_is_selected_and_undo_brings_it_back(document, timeline, item):
    before = document.project.get(*item)
    document.selection.set(item)
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert document.project.get(*item) is None
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert document.project.get(*item) == before


# Time


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
    assert timeline.tracks.accessibleName() == "Kick target, full, 0.517 s · frame 31"
    assert document.playhead.frame == 0
    assert document.undo_stack.count() == 1


# What is shown


def test_the_strip_of_a_body_follows_its_residual(timeline, live):
    live.errors["performer 1"] = {"kick": 0.042}
    assert timeline.strip_state("kick", "performer 0", 40) == StripState.HELD
    assert timeline.strip_state("kick", "performer 1", 40) == StripState.NOT_REACHED
    assert timeline.strip_state("kick", "performer 1", 80) == StripState.INACTIVE


def test_pointing_at_a_strip_tells_the_millimetres(timeline, live, qtbot):
    live.errors["performer 1"] = {"kick": 0.042}
    timeline.tracks.document.playhead.set_frame(43)  # its line does not hide what it lies over
    with qtbot.waitSignal(timeline.told) as told:
        QTest.mouseMove(timeline.tracks, timeline.strip_point("kick", "performer 1", 43))
    assert told.args == ["Body 1: 42 mm at frame 43"]


def test_pointing_at_a_name_tells_who_misses_the_constraint_most(timeline, live, qtbot):
    live.errors = {"performer 0": {"kick": 0.004}, "performer 1": {"kick": 0.042}}
    row = timeline.row_rect("constraints", "kick")
    with qtbot.waitSignal(timeline.told) as told:
        QTest.mouseMove(timeline.tracks, QPoint(60, row.center().y()))
    assert told.args == ["Kick target: Body 1 42 mm at frame 30"]


def strip_colour(timeline, frame):
    place = timeline.strip_point("kick", "performer 1", frame)
    return timeline.tracks.grab().toImage().pixelColor(place)


def test_strips_are_painted_anew_soon_after_a_result(qtbot, timeline, live):
    held = strip_colour(timeline, 40)
    live.errors["performer 1"] = {"kick": 0.042}
    live.adapted.emit("performer 1")
    qtbot.waitUntil(lambda: strip_colour(timeline, 40).red() > 150 > held.red())


def test_a_moved_playhead_draws_no_row_again(document, timeline, monkeypatch):
    timeline.grab()
    drawn = []
    monkeypatch.setattr("studio.timeline.picture._paint_content", lambda *each: drawn.append(each))
    document.playhead.set_frame(33)
    timeline.grab()
    assert drawn == []


def test_rows_follow_the_constraints_in_order_of_priority(document, timeline):
    added = document.add("constraints", make_constraint(name="First", priority=0), "")
    document.replace("constraints", "kick", make_constraint(name="Kick", priority=1), "")
    first, second = timeline.row_rect("constraints", added), timeline.row_rect("constraints", "kick")
    assert first.bottom() + 1 == second.top()
    document.remove("constraints", added, "")
    assert timeline.row_rect("constraints", added).isEmpty()
    assert timeline.row_rect("constraints", "kick") == first


def test_the_plot_can_show_the_error_of_a_constraint(timeline, live):
    live.errors["performer 1"] = {"kick": 0.042}
    timeline.tracks.set_quantity(Quantity.ERROR)
    timeline.grab()
    plot = timeline.tracks.picture.plot
    assert [round(curve.at(40 / RATE), 6) for curve in plot.curves] == [0.0, 42.0]


@pytest.mark.parametrize("quantity", Quantity)
def test_every_quantity_is_plotted_for_every_body_with_its_unit(timeline, quantity):
    timeline.tracks.set_quantity(quantity)
    timeline.grab()
    plot, shown = timeline.tracks.picture.plot, timeline.tracks.shown
    assert len(plot.curves) == len(shown.subject.bodies)
    assert all(np.isfinite(curve.values).all() and curve.values.min() >= 0.0 for curve in plot.curves)
    assert quantity.unit(shown) in plot.words(shown, 1.0)


def test_without_a_motion_one_line_says_what_to_do_and_nothing_breaks(document, timeline):
    document.new(Project())
    assert timeline.row_rect("ruler").isEmpty()
    assert not timeline.tracks.grab().isNull()
    QTest.mouseClick(timeline.tracks, LEFT, NONE, QPoint(300, 100))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Delete)
    assert timeline.tracks.prompt == "Drop a capture here"


def test_with_nobody_shown_the_line_asks_for_a_character(document, timeline):
    for key, performer in document.project.performers.items():
        document.replace("performers", key, replace(performer, visible=False), "")
    assert timeline.row_rect("ruler").isEmpty()
    assert timeline.tracks.prompt == HIDDEN


# The transport


def test_the_transport_plays_steps_and_goes_to_the_ends(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    for button, frame in (
        (transport.next, 1),
        (transport.previous, 0),
        (transport.to_end, 100),
        (transport.to_start, 0),
    ):
        QTest.mouseClick(button, LEFT)
        assert playhead.frame == frame
    QTest.mouseClick(transport.play, LEFT)
    assert playhead.playing
    assert transport.play.toolTip() == "Pause"
    QTest.mouseClick(transport.play, LEFT)
    assert not playhead.playing


def test_the_fields_show_and_take_frame_and_seconds(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    playhead.set_frame(30)
    assert (transport.frame.value(), transport.seconds.value()) == (30, 0.5)
    for field, typed, frame in ((transport.frame, "45", 45), (transport.seconds, "1.0", 60)):
        field.selectAll()
        QTest.keyClicks(field, typed)
        QTest.keyClick(field, Qt.Key.Key_Return)
        assert playhead.frame == frame


def test_a_speed_set_by_keys_is_shown_when_playback_begins(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    for speed, shown in ((2.0, "2×"), (-4.0, "-4×")):
        playhead.speed = speed
        playhead.play()
        playhead.pause()
        assert (transport.speed.currentText() or transport.speed.placeholderText()) == shown
        assert playhead.speed == speed


def test_loop_speed_and_range_reach_the_playhead(document, timeline):
    transport, playhead = timeline.transport, document.playhead
    QTest.mouseClick(transport.loop, LEFT)
    assert playhead.loop is False
    transport.speed.setCurrentIndex(0)
    assert playhead.speed == 0.25
    transport.first.setValue(10)
    transport.last.setValue(50)
    assert (playhead.first, playhead.last) == (10, 50)
    playhead.set_range(0, 100)
    assert (transport.first.value(), transport.last.value()) == (0, 100)


def test_a_closed_timeline_follows_nothing_any_more(document, live, timeline, hand):
    hand.press(timeline.handle_point("kick", "full"))
    hand.move(pixels(timeline, 10))
    timeline.close()
    assert frames(document.project.constraints["kick"].activation)[1] == 30
    assert not live.interactive
    sheet = timeline.tracks.sheet
    document.remove("constraints", "kick", "")
    document.playhead.set_frame(50)
    live.adapted.emit("performer 0")
    assert timeline.tracks.sheet is sheet
    assert timeline.transport.frame.value() == 0
