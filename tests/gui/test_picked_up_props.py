"""Props that are picked up, handed over and dragged: what the hand does is what happens."""

import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QPushButton

from studio.app.verbs.props import add_box
from studio.core.body.canonical import BodyPart
from studio.core.captures.contacts import ContactInterval, Touch
from studio.core.constraints.base import BodyPoint
from studio.core.mesh.hand_shapes import OPEN_GRIP
from studio.core.rotations import rotations_about_z
from studio.core.solver.performers.prop_tracks import carried_track
from studio.core.solver.performers.stage import constraints_of_performer
from studio.core.stage.held_grips import gripped_prop
from studio.core.stage.mirrored_props import constraint_as_played
from studio.core.stage.prop import Carried, InHand, Prop
from studio.document.clip_edits import mirror_clip
from studio.engine.posed_performer import posed_performers
from studio.engine.prop_places import prop_at, wrists_from
from studio.panels.fields import Choice
from tests.gui.viewport_use import drag, on_arrow, settle
from tests.patience import PATIENCE, SECONDS

FIRST = "performer 0"
PICKED = 0.2


def held_box(document, **values):
    prop_id = document.add("props", Prop("Box", position=(0.9, 0.0, 0.2), **values), "Add")
    document.selection.set(("performers", FIRST), ("props", prop_id))
    return prop_id


def test_a_box_dragged_at_its_pick_up_frame_is_picked_up_elsewhere(studio):
    viewport, document, live = studio
    prop_id = held_box(document, held=Carried(FIRST, (0.3, 0.0, 0.1), begin=PICKED))
    viewport.frame_selection()
    settle(viewport)
    gizmo = viewport.gizmo()
    begin, end = on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.3)
    expected = (gizmo.grip("z", end.x(), end.y()) - gizmo.grip("z", begin.x(), begin.y()))[2]
    drag(viewport, begin, end)
    prop = document.project.props[prop_id]
    assert abs(expected) > 0.05
    assert prop.position == pytest.approx((0.9, 0.0, 0.2 + expected), abs=1e-6)
    assert prop.held.offset == (0.3, 0.0, 0.1)
    posed = posed_performers(document.project, live.result, PICKED)
    assert prop_at(document.project, posed, prop_id, PICKED).place == pytest.approx(prop.position)
    document.playhead.set_time(0.45)  # once it is held, a drag moves it between the hands
    settle(viewport)
    drag(viewport, on_arrow(viewport, "z", 0.7), on_arrow(viewport, "z", 1.3))
    later = document.project.props[prop_id]
    assert later.position == prop.position
    assert later.held.offset != prop.held.offset


def test_hands_open_as_they_come_to_a_prop_and_close_again_when_they_have_left_it(studio):
    _, document, live = studio
    held_box(document, held=Carried(FIRST, begin=0.25, end=0.26))

    def grip(time):
        return posed_performers(document.project, live.result, time)[FIRST].grip(1.0)

    assert grip(0.0) == 1.0
    assert -1.0 < grip(0.15) < 1.0
    assert grip(0.25) == OPEN_GRIP
    assert grip(0.5) == 1.0


def pick_up(window, performer_id, prop_id, time):
    document = window.bench.document
    document.selection.set(("performers", performer_id), ("props", prop_id))
    document.playhead.set_time(time)
    window.actions_by_id.by_id["pick_up_prop"].trigger()


@pytest.fixture
def played(window, qtbot):
    document = window.bench.document
    document.playhead.pause()
    qtbot.waitUntil(lambda: all(window.bench.live.result(key) for key in document.project.performers), timeout=PATIENCE)
    return window


def test_add_box_puts_it_where_the_capture_holds_a_thing_and_pick_up_takes_it_there(played):
    document = played.bench.document
    clip = document.project.performers[FIRST].clips[0]
    rate = document.project.frame_rate_of(clip)
    first = clip.last // 2
    document.add("contacts", ContactInterval(clip.motion_id, Touch.HANDS_ON_THING, first, clip.last), "Add")
    document.selection.set(("performers", FIRST))
    document.playhead.set_time(0.0)
    add_box(played.bench)
    [prop_id] = document.project.props
    holder = posed_performers(document.project, played.bench.live.result, first / rate)[FIRST]
    layout = holder.motion.morphology.layout
    hands = [layout.wrist_point(side) + end for side in range(2) for end in range(2)]
    middle = holder.placement.to_stage(holder.motion.unconstrained.positions[first, hands].mean(axis=0))
    assert document.project.props[prop_id].position[:2] == pytest.approx(middle[:2], abs=0.01)
    document.replace("props", prop_id, replace(document.project.props[prop_id], position=(5.0, 5.0, 0.2)), "Move")
    pick_up(played, FIRST, prop_id, first / rate)
    assert document.project.props[prop_id].position[:2] == pytest.approx(middle[:2], abs=0.01)
    assert document.project.props[prop_id].held.offset[:2] == (0.0, 0.0)


def test_a_box_is_put_down_where_the_hands_of_the_capture_leave_it(played):
    document, said = played.bench.document, []
    played.bench.message_posted.connect(lambda message: said.append(message.sentence))
    clip = document.project.performers[FIRST].clips[0]
    rate = document.project.frame_rate_of(clip)
    first, last = 2, clip.last // 4
    document.add("contacts", ContactInterval(clip.motion_id, Touch.HANDS_ON_THING, first, last), "Add")
    prop_id = document.add("props", Prop("Box", position=(0.5, 0.0, 0.9)), "Add box")
    steps, begin, end = document.undo_stack.count(), first / rate, clip.start + last / rate
    pick_up(played, FIRST, prop_id, begin)
    [hold] = document.project.props[prop_id].holds
    assert (hold.begin, hold.end) == pytest.approx((begin, end))
    grips = [each for each in document.project.constraints.values() if gripped_prop(each) == prop_id]
    assert grips
    assert all(each.activation.full_end == pytest.approx(last / rate) for each in grips)
    assert any("is put down there" in each for each in said)
    assert document.undo_stack.count() == steps + 1
    places = []
    for time in (end, end + 0.1):
        posed = posed_performers(document.project, played.bench.live.result, time)
        places.append(prop_at(document.project, posed, prop_id, time).place)
    assert places[1] == pytest.approx(places[0], abs=1e-6)


def test_a_box_beyond_reach_is_moved_ahead_of_who_picks_it_up_and_a_message_says_so(played):
    document, said = played.bench.document, []
    played.bench.message_posted.connect(lambda message: said.append(message.sentence))
    prop_id = document.add("props", Prop("Box", position=(4.0, 0.0, 0.2)), "Add box")
    steps = document.undo_stack.count()
    pick_up(played, FIRST, prop_id, PICKED)
    root = posed_performers(document.project, played.bench.live.result, PICKED)[FIRST].points[0]
    near = np.linalg.norm(np.array(document.project.props[prop_id].position)[:2] - root[:2])
    assert near < 0.7
    assert any("out of reach" in each for each in said)
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    assert document.project.props[prop_id].position == (4.0, 0.0, 0.2)


def test_gestures_do_not_swing_a_box_that_the_motion_does_not_hold(played):
    """Hands of the capture that went to the hips lifted the box into the face, and turned a palm by 179 degrees."""
    document = played.bench.document
    prop_id = document.add("props", Prop("Box", position=(0.6, 0.0, 0.2)), "Add box")
    pick_up(played, FIRST, prop_id, PICKED)
    hold = document.project.props[prop_id].held
    assert hold.steady
    motion = posed_performers(document.project, played.bench.live.result, PICKED)[FIRST].motion
    unasked, layout = motion.unconstrained, motion.morphology.layout
    positions, rotations = unasked.positions.copy(), unasked.rotations
    arms = [layout.wrist_point(side) + end for side in range(2) for end in range(2)]
    before = carried_track(hold, positions, rotations, motion.body).positions
    positions[:, arms] += [0.2, 0.1, 0.5]
    assert carried_track(hold, positions, rotations, motion.body).positions == pytest.approx(before)
    held = replace(hold, steady=False)
    assert np.abs(carried_track(held, positions, rotations, motion.body).positions - before).max() > 0.4


def test_who_takes_a_box_face_to_face_leaves_it_its_heading_and_finds_free_places(played, qtbot):
    document = played.bench.document
    giver = document.project.performers[FIRST]
    x, y = giver.position
    taker = replace(giver, position=(x + 1.1, y), heading=math.pi)
    other = document.add("performers", taker, "Add")
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    pick_up(played, FIRST, prop_id, 0.1)
    document.selection.clear()
    qtbot.waitUntil(lambda: played.bench.live.result(other) is not None, timeout=PATIENCE)
    pick_up(played, other, prop_id, 0.4)
    one, two = document.project.props[prop_id].holds
    assert abs(math.remainder(two.heading - one.heading - math.pi, 2 * math.pi)) < 1e-9
    wrists = {}
    for each in document.project.constraints.values():
        if " hand on " in each.name:
            wrists[each.scope.performer_id, each.name] = (
                np.array(each.target.offset)
                + np.array(each.target.share) * np.array(document.project.props[prop_id].size) / 2
            )
    of_one, of_two = ([place for (key, _), place in wrists.items() if key == who] for who in (FIRST, other))
    assert len(of_one) == len(of_two) == 2
    assert min(np.linalg.norm(a - b) for a in of_one for b in of_two) > 0.09


def test_who_cannot_reach_a_box_that_another_holds_is_told_to_come_closer(played, qtbot):
    document = played.bench.document
    giver = document.project.performers[FIRST]
    x, y = giver.position
    far = document.add("performers", replace(giver, name="Far one", position=(x + 4.0, y), heading=math.pi), "Add")
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    pick_up(played, FIRST, prop_id, 0.1)
    document.selection.clear()
    qtbot.waitUntil(lambda: played.bench.live.result(far) is not None, timeout=PATIENCE)
    pick_up(played, far, prop_id, 0.4)
    assert "Move Far one closer" in played.strip.text
    assert [hold.performer_id for hold in document.project.props[prop_id].holds] == [FIRST, far]


def test_who_carries_a_box_does_not_pick_it_up_once_more_and_let_go_of_it_before(played):
    """The grips from the first pick-up to the second were removed: the box floated before the hands."""
    document = played.bench.document
    x, y = document.project.performers[FIRST].position
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    pick_up(played, FIRST, prop_id, 0.1)
    before = document.project
    pick_up(played, FIRST, prop_id, 0.4)
    assert document.project is before
    assert "already carries Box" in played.strip.text


def test_who_has_just_taken_a_box_does_not_lose_it_as_the_giver_would_put_it_down(played, qtbot):
    document = played.bench.document
    giver = document.project.performers[FIRST]
    x, y = giver.position
    other = document.add("performers", replace(giver, position=(x + 1.1, y), heading=math.pi), "Add")
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    pick_up(played, FIRST, prop_id, 0.1)
    qtbot.waitUntil(lambda: played.bench.live.result(other) is not None, timeout=PATIENCE)
    pick_up(played, other, prop_id, 0.4)
    taken = document.project.props[prop_id]
    played.actions_by_id.by_id["put_down_prop"].trigger()
    assert document.project.props[prop_id] == taken
    assert "move the playhead past its pick-up" in played.strip.text
    document.playhead.set_time(0.25)
    played.actions_by_id.by_id["put_down_prop"].trigger()
    one, two = document.project.props[prop_id].holds
    assert (one.performer_id, one.end) == (FIRST, pytest.approx(document.playhead.time))
    assert two == taken.holds[1]


def test_a_box_picked_up_as_a_clip_plays_again_is_gripped_from_then_on_and_not_before(played):
    document = played.bench.document
    performer = document.project.performers[FIRST]
    once = performer.clips[0].length(document.project.frame_rate_of(performer.clips[0]))
    twice = replace(performer, clips=(replace(performer.clips[0], repeats=2),))
    document.replace("performers", FIRST, twice, "Loop")
    prop_id = document.add("props", Prop("Box", position=(4.0, 0.0, 0.2)), "Add box")
    assert played.bench.live.wait_until_solved(SECONDS)
    pick_up(played, FIRST, prop_id, once + PICKED)
    asked = [each for each in constraints_of_performer(document.project, FIRST) if gripped_prop(each.constraint)]
    begins = {each.repeat: once * each.repeat + each.constraint.activation.full for each in asked}
    assert list(begins.values()) == pytest.approx([once + PICKED] * len(begins))
    assert 1 in begins


@pytest.mark.parametrize("turned", [0.0, math.pi / 2])
def test_hands_that_pick_up_a_box_in_a_mirrored_clip_do_not_cross(played, qtbot, turned):
    document, live = played.bench.document, played.bench.live
    clip = document.project.performers[FIRST].clips[0]
    mirror_clip(document, clip.id)
    qtbot.waitUntil(lambda: live.result(FIRST).composite.played[0].piece.mirrored, timeout=PATIENCE)
    prop_id = document.add("props", Prop("Box", position=(4.0, 0.0, 0.2), heading=turned), "Add box")
    pick_up(played, FIRST, prop_id, PICKED)
    hold = document.project.props[prop_id].held
    assert live.wait_until_solved(SECONDS)
    clip = document.project.performers[FIRST].clips[0]
    for stored in document.project.constraints.values():
        if stored.name.endswith("hand on box"):
            seen = constraint_as_played(document.project, FIRST, clip, stored)
            side = 1.0 if seen.name.startswith("Left") else -1.0
            across = rotations_about_z(np.array([hold.heading]))[0] @ np.array(seen.target.share)
            assert across == pytest.approx([0.0, side, 0.0], abs=1e-9)
            assert seen.point.part.value.startswith("left" if side > 0.0 else "right")


def test_a_mirrored_clip_takes_the_stick_into_the_other_hand_in_one_step(played):
    document = played.bench.document
    hold = InHand(FIRST, BodyPoint(BodyPart.RIGHT_HAND, (0.01, 0.02, 0.03)), (0.1, 0.2, 0.3, 0.9))
    prop_id = document.add("props", Prop("Stick", (0.03, 0.03, 1.0), held=hold), "Add stick")
    [clip] = document.project.performers[FIRST].clips
    steps = document.undo_stack.count()
    mirror_clip(document, clip.id)
    assert document.project.props[prop_id].held.point.part is BodyPart.LEFT_HAND
    assert document.undo_stack.count() == steps + 1
    mirror_clip(document, clip.id)
    assert document.project.props[prop_id].held == hold


def grips(document, performer_id):
    return [
        each
        for each in document.project.constraints.values()
        if gripped_prop(each) is not None and each.scope.performer_id == performer_id
    ]


def choose(window, name, text):
    """Choose an entry of a list of the shown form."""
    [field] = [each for each in window.inspector.current_form().findChildren(Choice) if each.accessibleName() == name]
    field.setCurrentIndex(field.findText(text))
    field.activated.emit(field.currentIndex())


@pytest.mark.parametrize("placement", ["Attached to a body point", "Fixed", "Animated", "Pendulum"])
def test_hands_leave_a_box_whose_carrying_is_ended_in_its_form_in_one_step(played, placement):
    """The grips stayed: the box hung beside the hands, and both arms reached for it."""
    document = played.bench.document
    x, y = document.project.performers[FIRST].position
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    pick_up(played, FIRST, prop_id, 0.1)
    document.selection.set(("props", prop_id))
    before, steps = document.project, document.undo_stack.count()
    assert len(grips(document, FIRST)) == 4
    choose(played, "Placement", placement)
    assert not grips(document, FIRST)
    assert document.undo_stack.count() == steps + 1
    document.undo_stack.undo()
    assert document.project == before


def wrists_off(window, performer_id, prop_id, time):
    """Distance in metres of both wrists from the surface of a prop at a time of the stage."""
    assert window.bench.live.wait_until_solved(SECONDS)
    project = window.bench.document.project
    posed = posed_performers(project, window.bench.live.result, time)
    return wrists_from(prop_at(project, posed, prop_id, time), posed[performer_id])


def test_a_box_that_is_carried_by_its_form_is_in_both_hands_in_one_step(played):
    """It floated between hands that did not touch it."""
    document = played.bench.document
    document.remove("constraints", "constraint 0", "Delete target")
    prop_id = document.add("props", Prop("Box", position=(0.5, 0.0, 0.9)), "Add box")
    document.selection.set(("performers", FIRST), ("props", prop_id))
    before, steps = document.project, document.undo_stack.count()
    choose(played, "Placement", "Carried in both hands")
    assert len(grips(document, FIRST)) == 4
    assert max(wrists_off(played, FIRST, prop_id, time) for time in (0.1, 0.3, 0.45)) < 0.01
    choose(played, "Placement", "Fixed")
    assert document.undo_stack.count() == steps + 2
    assert not grips(document, FIRST)
    played.actions_by_id.by_id["undo"].trigger()
    played.actions_by_id.by_id["undo"].trigger()
    assert document.project == before


def test_hands_grip_a_box_for_the_time_for_which_a_form_lets_them_carry_it(played):
    document = played.bench.document
    held = InHand(FIRST, BodyPoint(BodyPart.RIGHT_HAND), begin=0.2, end=0.4)
    prop_id = document.add("props", Prop("Box", position=(0.5, 0.0, 0.9), held=held), "Add box")
    document.selection.set(("performers", FIRST), ("props", prop_id))
    choose(played, "Placement", "Carried in both hands")
    begin = document.project.performers[FIRST].clips[0].start
    for each in grips(document, FIRST):
        assert (each.activation.full, each.activation.full_end) == pytest.approx((0.2 - begin, 0.4 - begin))
    [always] = [each for each in played.inspector.current_form().findChildren(QPushButton) if each.text() == "Always"]
    always.click()
    assert len(grips(document, FIRST)) == 4
    assert all(each.activation.full == 0.0 and each.activation.full_end > 0.45 for each in grips(document, FIRST))


def test_who_carried_a_box_leaves_it_where_another_carries_it_throughout(played, qtbot):
    document = played.bench.document
    giver = document.project.performers[FIRST]
    x, y = giver.position
    other = document.add("performers", replace(giver, name="Other", position=(x + 1.1, y), heading=math.pi), "Add")
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    for performer_id in (FIRST, other):
        assert played.bench.live.wait_until_solved(SECONDS)
        document.selection.set(("performers", performer_id), ("props", prop_id))
        played.actions_by_id.by_id["hold_prop"].trigger()
    assert not grips(document, FIRST)
    assert len(grips(document, other)) == 4


def test_a_box_given_to_another_in_its_form_keeps_no_grip_of_who_carried_it(played, qtbot):
    document = played.bench.document
    giver = document.project.performers[FIRST]
    x, y = giver.position
    other = document.add("performers", replace(giver, name="Other", position=(x + 1.1, y), heading=math.pi), "Add")
    prop_id = document.add("props", Prop("Box", position=(x + 0.5, y, 0.9)), "Add box")
    pick_up(played, FIRST, prop_id, 0.1)
    assert played.bench.live.wait_until_solved(SECONDS)
    document.selection.set(("props", prop_id))
    choose(played, "Carried by", "Other")
    assert document.project.props[prop_id].held.performer_id == other
    assert not grips(document, FIRST)
    assert len(grips(document, other)) == 4


def test_a_box_that_the_capture_holds_to_the_end_of_its_clip_is_carried_into_the_next_one(played):
    """It was left in the air where the next clip begins."""
    document = played.bench.document
    performer = document.project.performers[FIRST]
    clip = performer.clips[0]
    rate = document.project.frame_rate_of(clip)
    document.add("contacts", ContactInterval(clip.motion_id, Touch.HANDS_ON_THING, clip.last - 8, clip.last), "Add")
    after = replace(clip, id="after", last=clip.last - 10, start=clip.start + clip.length(rate))
    document.replace("performers", FIRST, replace(performer, clips=(clip, after)), "Add clip")
    prop_id = document.add("props", Prop("Box", position=(0.5, 0.0, 0.9)), "Add box")
    assert played.bench.live.wait_until_solved(SECONDS)
    pick_up(played, FIRST, prop_id, (clip.last - 6) / rate)
    [hold] = document.project.props[prop_id].holds
    assert hold.end is None
