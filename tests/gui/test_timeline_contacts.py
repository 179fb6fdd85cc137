"""Contacts on the timeline: moved, trimmed, added and deleted."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest

from studio.core.captures.contacts import ContactPoint
from studio.timeline.menus import menu_at
from tests.builders import make_contact
from tests.gui.hand import LEFT, NONE, in_lane, pixels


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


@pytest.mark.parametrize("x", [3, 60])
def test_the_menu_of_a_foots_name_and_of_its_triangle_adds_at_the_playhead(document, timeline, x):
    document.playhead.set_frame(40)
    row = timeline.row_rect("lane", "left foot")
    [others] = menu_at(timeline.tracks, QPointF(x, row.center().y())).actions()
    others.menu().actions()[0].trigger()
    assert contact_frames(document, document.selection.current[1]) == (31, 49)


def test_a_hand_that_touches_gets_a_row_and_is_trimmed_as_a_foot(document, timeline, hand):
    assert timeline.row_rect("lane", "hands").isEmpty()
    menu = menu_at(timeline.tracks, QPointF(in_lane(timeline, 40)))
    others = {action.text(): action for action in menu.actions()[1].menu().actions()}
    assert list(others)[4:9] == ["Left hand", "Right hand", "Left knee", "Right knee", "Seat"]
    assert list(others)[9:11] == ["Hands together", "Hands on object"]
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
