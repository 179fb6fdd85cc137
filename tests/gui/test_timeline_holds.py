"""Holds of a prop, on the timeline and from the menu: picked up, put down, dragged."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest

from studio.core.curves.activation import ActivationCurve
from studio.core.stage.held_grips import gripped_prop
from studio.core.stage.prop import Carried, Prop
from studio.document.grips import add_grips
from studio.timeline.hover import hover_text
from tests.gui.hand import RATE, pixels

FIRST = "performer 0"


@pytest.fixture
def box(document):
    prop_id = document.add("props", Prop("Box", held=Carried(FIRST, begin=20 / RATE, end=80 / RATE)), "Add")
    document.undo_stack.clear()
    return prop_id


def place(timeline, box, frame):
    row = timeline.row_rect("props", box)
    return QPoint(round(timeline.x_of_frame(frame)), row.center().y())


def span(document, box):
    held = document.project.props[box].held
    return held.begin * RATE, held.end * RATE


def test_the_bar_of_a_hold_is_moved_and_its_ends_dragged(document, timeline, hand, box):
    hand.drag(place(timeline, box, 50), pixels(timeline, 7))
    assert span(document, box) == pytest.approx((27, 87))
    hand.drag(place(timeline, box, 27) + QPoint(1, 0), pixels(timeline, 10))
    assert span(document, box) == pytest.approx((37, 87))
    hand.drag(place(timeline, box, 87) - QPoint(1, 0), pixels(timeline, -70))
    assert span(document, box) == pytest.approx((37, 37))
    assert document.undo_stack.count() == 3
    document.undo_stack.undo()
    words = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(place(timeline, box, 50)))
    assert words.startswith("Box: carried by")
    assert ("props", box) in document.selection


def grip_spans(document):
    return {(round(each.activation.full * RATE), round(each.activation.full_end * RATE)) for each in grips_of(document)}


def grips_of(document):
    return [each for each in document.project.constraints.values() if gripped_prop(each) is not None]


def test_hands_go_with_the_bar_of_a_hold_in_the_same_step(document, timeline, hand, box):
    """They came to the box and left it at the old times: it floated."""
    add_grips(document, box, document.project.props[box].held, "Grip")
    document.undo_stack.clear()
    before = document.project
    assert grip_spans(document) == {(20, 80)}
    reach = [each.activation.full - each.activation.start for each in grips_of(document)]
    hand.drag(place(timeline, box, 80) - QPoint(1, 0), pixels(timeline, 7))
    assert span(document, box) == pytest.approx((20, 87))
    assert grip_spans(document) == {(20, 87)}
    hand.drag(place(timeline, box, 20) + QPoint(1, 0), pixels(timeline, -7))
    assert grip_spans(document) == {(13, 87)}
    hand.drag(place(timeline, box, 50), pixels(timeline, 5))
    assert grip_spans(document) == {(18, 92)}
    assert [each.activation.full - each.activation.start for each in grips_of(document)] == pytest.approx(reach)
    assert document.undo_stack.count() == 3
    hand.press(place(timeline, box, 50))
    hand.move(pixels(timeline, 5))
    QTest.keyClick(timeline.tracks, Qt.Key.Key_Escape)
    assert grip_spans(document) == {(18, 92)}
    for _ in range(3):
        document.undo_stack.undo()
    assert document.project == before


def test_a_prop_is_picked_up_and_put_down_at_the_playhead_from_the_menu(window):
    document = window.bench.document
    prop_id = document.add("props", Prop("Box"), "Add box")
    performer_id = next(iter(document.project.performers))
    document.selection.set(("performers", performer_id), ("props", prop_id))
    document.playhead.pause()
    document.playhead.set_time(0.2)
    window.actions_by_id.by_id["pick_up_prop"].trigger()
    assert document.project.props[prop_id].held.begin == pytest.approx(0.2, abs=0.02)
    asked = [each for each in document.project.constraints.values() if " on box" in each.name]
    assert len(asked) == 4
    document.selection.set(("performers", performer_id), ("props", prop_id))
    document.playhead.set_time(0.4)
    window.actions_by_id.by_id["put_down_prop"].trigger()
    assert document.project.props[prop_id].held.end == pytest.approx(0.4, abs=0.02)
    curves = [each.activation for each in document.project.constraints.values() if " on box" in each.name]
    assert all(isinstance(each, ActivationCurve) and each.full_end == pytest.approx(0.4, abs=0.02) for each in curves)
    assert len({each.full for each in curves}) == 1


def test_the_moment_at_which_a_prop_is_handed_on_is_dragged_for_both(document, timeline, hand, box):
    other = list(document.project.performers)[1]
    handed = document.project.props[box].taken(Carried(other), 80 / RATE)
    document.replace("props", box, handed, "Hand on")
    hand.drag(place(timeline, box, 80) - QPoint(1, 0), pixels(timeline, -20))
    one, two = document.project.props[box].holds
    assert (one.end * RATE, two.begin * RATE) == pytest.approx((60, 60))
    words = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, QPointF(place(timeline, box, 70)))
    assert document.project.performers[other].name in words


def test_who_picks_up_what_another_one_holds_takes_it_out_of_its_hands(window):
    document = window.bench.document
    one = next(iter(document.project.performers))
    other = document.add("performers", document.project.performers[one], "Add")
    prop_id = document.add("props", Prop("Box"), "Add box")
    for performer_id, seconds in ((one, 0.2), (other, 0.4)):
        document.selection.set(("performers", performer_id), ("props", prop_id))
        document.playhead.set_time(seconds)
        window.actions_by_id.by_id["pick_up_prop"].trigger()
    first, second = document.project.props[prop_id].holds
    assert (first.performer_id, second.performer_id) == (one, other)
    assert first.end == second.begin == pytest.approx(0.4, abs=0.02)
    of_first = [each for each in document.project.constraints.values() if each.scope.performer_id == one]
    assert len(of_first) == 4
    assert all(each.activation.full_end == pytest.approx(0.4, abs=0.02) for each in of_first)


def test_whoever_would_have_taken_a_prop_later_keeps_its_hands_free_once_another_takes_it(window):
    document = window.bench.document
    one = next(iter(document.project.performers))
    two, three = (document.add("performers", document.project.performers[one], "Add") for _ in range(2))
    prop_id = document.add("props", Prop("Box"), "Add box")
    for performer_id, seconds in ((one, 0.1), (two, 0.4), (three, 0.25)):
        document.selection.set(("performers", performer_id), ("props", prop_id))
        document.playhead.set_time(seconds)
        window.actions_by_id.by_id["pick_up_prop"].trigger()
    assert [each.performer_id for each in document.project.props[prop_id].holds] == [one, three]
    assert {each.scope.performer_id for each in document.project.constraints.values() if " on box" in each.name} == {
        one, three,
    }  # fmt: skip


def test_hands_stay_on_a_prop_in_every_clip_that_is_played_after_it_is_picked_up(window):
    document = window.bench.document
    performer_id, performer = next(iter(document.project.performers.items()))
    [clip] = performer.clips
    rate = document.project.frame_rate_of(clip)
    later = document.add("motions", document.project.motions[clip.motion_id], "Import")
    row = clip, replace(clip, motion_id=later, start=clip.start + clip.length(rate), id="later")
    document.replace("performers", performer_id, replace(performer, clips=row), "Add clip")
    prop_id = document.add("props", Prop("Box"), "Add box")
    document.selection.set(("performers", performer_id))
    document.selection.set(("props", prop_id))
    for seconds, motions in ((0.2, {clip.motion_id, later}), (row[1].start + 0.2, {later})):
        document.playhead.set_time(seconds)
        window.actions_by_id.by_id["pick_up_prop"].trigger()
        asked = [each for each in document.project.constraints.values() if each.scope.performer_id == performer_id]
        assert {each.motion_id for each in asked} == motions
        assert all(each.activation.full == pytest.approx(0.2, abs=0.02) for each in asked if len(motions) == 1)
        document.undo_stack.undo()
