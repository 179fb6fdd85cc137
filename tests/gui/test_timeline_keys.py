"""Keys as things on the timeline: selected, dragged, nudged, scaled, deleted, set, and undone in one step."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.constraints.follow import UNTURNED
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.curves.tangents import Tangent, TangentMode, Tangents
from studio.core.stage.prop import Prop
from studio.document.key_edits import set_keys
from studio.document.keyed_fields import KeyedField
from studio.timeline.hover import hover_text
from studio.timeline.keyboard import handles_key
from studio.timeline.menus import menu_at
from tests.builders import make_constraint
from tests.gui.hand import LEFT, RATE, Hand, curve, pixels

TARGET = KeyedField("constraints", "kick", "target")
Modifier = Qt.KeyboardModifier
CONTROL, SHIFT, ALT = Modifier.ControlModifier, Modifier.ShiftModifier, Modifier.AltModifier


def keyed(*frames):
    return KeyedPlace(tuple(frame / RATE for frame in frames), tuple((0.01 * k, 0.0, 1.0) for k in range(len(frames))))


@pytest.fixture
def kick(document):
    """A constraint whose target has keys at frames 24, 36, 44 and 56."""
    old = document.project.constraints["kick"]
    document.replace("constraints", "kick", replace(old, target=keyed(24, 36, 44, 56)), "Key")
    document.selection.set(("constraints", "kick"))
    document.undo_stack.clear()
    return "kick"


def frames(document, name="target"):
    value = getattr(document.project.constraints["kick"], name)
    return [round(time * RATE, 4) for time in value.times]


def on_bar(timeline, frame):
    row = timeline.row_rect("constraints", "kick")
    return QPoint(round(timeline.x_of_frame(frame)), row.top() + 16)


def selected(document):
    return {key.place for key in document.keys.items if key.field == TARGET}


def click(timeline, point, modifiers=Modifier.NoModifier):
    QTest.mouseClick(timeline.tracks, LEFT, modifiers, point)


def press(timeline, key, modifiers=Modifier.NoModifier):
    QTest.keyClick(timeline.tracks, key, modifiers)


def test_a_click_selects_a_key_and_ctrl_adds_or_takes_one(document, timeline, kick):
    click(timeline, on_bar(timeline, 36))
    assert selected(document) == {1}
    click(timeline, on_bar(timeline, 44), CONTROL)
    assert selected(document) == {1, 2}
    click(timeline, on_bar(timeline, 36), CONTROL)
    assert selected(document) == {2}
    press(timeline, Qt.Key.Key_Escape)
    assert not document.keys.items
    assert ("constraints", "kick") in document.selection


def test_a_box_selects_the_keys_in_it(document, timeline, hand, kick):
    row = timeline.row_rect("constraints", "kick")
    hand.press(QPoint(round(timeline.x_of_frame(33)), row.bottom() - 2))
    hand.move(pixels(timeline, 14), dy=-(row.height() - 6))
    assert selected(document) == {1, 2}
    timeline.tracks.grab()
    hand.release()
    assert selected(document) == {1, 2}


def test_selected_keys_are_dragged_together_as_one_step_and_undone_exactly(document, timeline, hand, kick):
    before = document.project
    click(timeline, on_bar(timeline, 36))
    click(timeline, on_bar(timeline, 44), CONTROL)
    hand.drag(on_bar(timeline, 36), pixels(timeline, 3))
    assert frames(document) == [24, 39, 47, 56]
    assert frames(document, "activation") == [20, 30, 50, 60]
    assert document.undo_stack.count() == 1
    assert document.undo_stack.undoText() == "Move 2 keys"
    document.undo_stack.undo()
    assert document.project == before
    assert selected(document) == {1, 2}
    document.undo_stack.redo()
    assert frames(document) == [24, 39, 47, 56]


def test_esc_gives_a_dragged_key_back(document, timeline, hand, kick):
    hand.press(on_bar(timeline, 36))
    hand.move(pixels(timeline, 20))
    assert frames(document) != [24, 36, 44, 56]
    press(timeline, Qt.Key.Key_Escape)
    assert frames(document) == [24, 36, 44, 56]
    assert document.undo_stack.count() == 0
    hand.release()


def test_a_dragged_key_passes_others_and_takes_the_place_of_one_it_is_put_on(document, timeline, hand, kick):
    value = document.project.constraints["kick"].target.values[0]
    hand.press(on_bar(timeline, 24))
    hand.move(pixels(timeline, 16))
    assert frames(document) == [36, 40, 44, 56]
    assert selected(document) == {1}
    hand.move(pixels(timeline, 4))
    assert frames(document) == [36, 44, 56]
    assert document.project.constraints["kick"].target.values[1] == value
    hand.move(pixels(timeline, -4))
    assert frames(document) == [36, 40, 44, 56]
    hand.release()
    assert document.undo_stack.count() == 1


def test_a_key_catches_on_contacts_the_playhead_and_other_keys_and_a_line_shows_it(document, timeline, hand, kick):
    document.playhead.set_time(47.5 / RATE)
    for at, lands in ((47.3, 47.5), (70.2, 70), (56.2, 56)):
        hand.press(on_bar(timeline, 36))
        hand.move(pixels(timeline, at - 36))
        mark = timeline.tracks.gesture.mark
        assert mark.magnet == pytest.approx(lands / RATE)
        timeline.tracks.grab()
        press(timeline, Qt.Key.Key_Escape)
        hand.release()
    hand.press(on_bar(timeline, 36))
    hand.move(pixels(timeline, 4.4))
    assert frames(document)[1] == 40
    hand.move(pixels(timeline, 0.1), ALT)
    assert frames(document)[1] == pytest.approx(40.5, abs=0.1)
    hand.release()


def test_shift_scales_the_selected_keys_about_the_playhead(document, timeline, kick):
    document.playhead.set_frame(24)
    press(timeline, Qt.Key.Key_A, CONTROL)
    document.keys.set(key for key in document.keys.items if key.field == TARGET)
    hand = Hand(timeline)
    QTest.mousePress(timeline.tracks, LEFT, SHIFT, on_bar(timeline, 44))
    hand.at = on_bar(timeline, 44)
    hand.move(pixels(timeline, -10), SHIFT)
    hand.release()
    assert frames(document) == pytest.approx([24, 30, 34, 40], abs=1e-3)
    assert document.undo_stack.undoText() == "Scale 4 keys"
    press(timeline, Qt.Key.Key_Right, ALT | CONTROL)
    assert frames(document)[-1] == pytest.approx(41)
    document.undo_stack.undo()
    document.undo_stack.undo()
    assert frames(document) == [24, 36, 44, 56]


def test_the_keyboard_selects_nudges_and_deletes_keys(document, timeline, kick):
    document.playhead.set_frame(31)
    press(timeline, Qt.Key.Key_Down, CONTROL)
    assert document.playhead.frame == 36
    assert selected(document) == {1}
    press(timeline, Qt.Key.Key_Right, ALT)
    press(timeline, Qt.Key.Key_Left, ALT | SHIFT)
    assert frames(document) == [24, 27, 44, 56]
    assert document.undo_stack.count() == 2
    press(timeline, Qt.Key.Key_Delete)
    assert frames(document) == [24, 44, 56]
    document.undo_stack.undo()
    assert frames(document) == [24, 27, 44, 56]


def test_the_last_key_that_is_deleted_leaves_the_value_of_the_playhead(document, timeline, kick):
    document.playhead.set_frame(56)
    press(timeline, Qt.Key.Key_A, CONTROL)
    press(timeline, Qt.Key.Key_Delete)
    assert document.project.constraints["kick"].target == (0.03, 0.0, 1.0)
    assert frames(document, "activation") == [20, 30, 50, 60]
    document.undo_stack.undo()
    assert frames(document) == [24, 36, 44, 56]


def test_the_menu_of_a_key_deletes_it(document, timeline, kick):
    menu = menu_at(timeline.tracks, on_bar(timeline, 44).toPointF())
    menu.actions()[0].trigger()
    assert frames(document) == [24, 36, 56]


def test_the_bar_takes_its_keys_along_or_leaves_them_with_alt(document, timeline, hand, kick):
    hand.press(on_bar(timeline, 40))
    hand.move(pixels(timeline, 5))
    assert frames(document, "activation") == [25, 35, 55, 65]
    assert frames(document) == [29, 41, 49, 61]
    hand.move(0, ALT)
    assert frames(document) == [24, 36, 44, 56]
    assert frames(document, "activation") == pytest.approx([25, 35, 55, 65], abs=0.2)
    hand.move(0)
    hand.release()
    assert document.undo_stack.count() == 1
    document.undo_stack.undo()
    assert frames(document) == [24, 36, 44, 56]


def test_a_key_says_what_it_is(document, timeline, kick):
    text = hover_text(timeline.tracks.sheet, timeline.tracks.picture.plot, on_bar(timeline, 36).toPointF())
    assert text == "Key of Kick target, target: 0.600 s · frame 36"


def test_keys_of_props_have_a_row_in_which_they_are_dragged(document, timeline, hand):
    prop = Prop("Ball", position=keyed(10, 50), heading=KeyedNumber((10 / RATE, 70 / RATE), (0.0, 1.0)))
    key = document.add("props", prop, "Add")
    row = timeline.row_rect("props", key)
    assert row.height() > 0
    hand.drag(QPoint(round(timeline.x_of_frame(10)), row.center().y()), pixels(timeline, 5))
    moved = document.project.props[key]
    assert moved.position.times[0] == moved.heading.times[0] == pytest.approx(15 / RATE)
    assert moved.position.times[1] == pytest.approx(50 / RATE)


def test_set_key_keys_what_is_selected_at_the_playhead(document, timeline, kick):
    document.playhead.set_frame(40)
    there = document.project.constraints["kick"].target.at([40 / RATE])[0]
    set_keys(document)
    assert frames(document) == [24, 36, 40, 44, 56]
    assert document.project.constraints["kick"].target.values[2] == pytest.approx(tuple(there))
    assert selected(document) == {2}
    prop = document.add("props", Prop("Ball", position=(0.1, 0.2, 0.3)), "Add")
    document.selection.set(("props", prop))
    set_keys(document)
    assert document.project.props[prop].position == KeyedPlace((40 / RATE,), ((0.1, 0.2, 0.3),))
    document.selection.set(("performers", "performer 0"))
    set_keys(document)
    character = document.project.characters[document.project.performers["performer 0"].character_id]
    assert character.proportions == KeyedProportions((40 / RATE,), (Proportions(),))


def test_set_key_keys_a_constraint_and_not_the_body_that_is_selected_with_it(document, timeline, kick):
    document.selection.set(("performers", "performer 0"), ("constraints", kick))
    document.playhead.set_time(30 / RATE)
    assert set_keys(document) == 1
    assert frames(document) == [24, 30, 36, 44, 56]
    character = document.project.characters[document.project.performers["performer 0"].character_id]
    assert character.proportions == Proportions()
    document.selection.set(("performers", "performer 0"))
    assert set_keys(document) == 1
    document.selection.set(("performers", "performer 0"), ("constraints", kick))
    document.playhead.set_time(40 / RATE)
    assert set_keys(document) == 1


def test_set_key_where_a_weight_overshoots_below_zero_sets_zero(document, timeline, kick):
    side = Tangent(TangentMode.FREE, (-9.0,))
    weight = KeyedNumber((24 / RATE, 44 / RATE), (0.2, 1.0), tangents=(Tangents(side, side), None))
    document.replace("constraints", "kick", replace(document.project.constraints["kick"], weight=weight), "Weigh")
    document.playhead.set_frame(28)
    assert weight.value_at(28 / RATE) < 0.0
    set_keys(document)
    assert document.project.constraints["kick"].weight.values == (0.2, 0.0, 1.0)


@pytest.mark.parametrize("collection", ["constraints", "props"])
def test_set_key_while_turning_begins_keys_of_heading_and_tilt(document, timeline, kick, collection):
    base = make_constraint()
    area = AreaConstraint(
        base.motion_id, "Table", base.point, base.chain, 5, base.activation, shape=AreaShape.TABLE, heading=0.4
    )
    key = document.add(collection, area if collection == "constraints" else Prop("Box", heading=0.4), "Add")
    document.selection.set((collection, key))
    document.playhead.set_frame(40)
    assert set_keys(document) == 1  # its position
    assert set_keys(document, turning=True) == 3
    entity = document.project.get(collection, key)
    assert entity.heading == KeyedNumber((40 / RATE,), (0.4,))
    assert entity.tilt == KeyedTurn((40 / RATE,), (UNTURNED,))
    document.undo_stack.undo()
    assert document.project.get(collection, key).heading == 0.4


def test_random_edits_of_keys_are_undone_to_the_project_they_began_with(document, timeline, kick):
    random = np.random.default_rng(3)
    before = document.project
    document.add(
        "constraints", make_constraint(target=keyed(3, 30, 80), activation=curve(1, 10, 70, 90), priority=1), "Add"
    )
    states = [before, document.project]
    timeline.set_dope(True)
    document.selection.clear()
    for _ in range(40):
        press(timeline, Qt.Key.Key_A, CONTROL)
        every = sorted(document.keys.items)
        document.keys.set(key for key in every if random.random() < 0.5)
        document.playhead.set_frame(int(random.integers(0, 100)))
        count = document.undo_stack.index()
        match random.integers(0, 4):
            case 0:
                press(timeline, Qt.Key.Key_Right, ALT)
            case 1:
                press(timeline, Qt.Key.Key_Left, ALT | SHIFT)
            case 2:
                press(timeline, Qt.Key.Key_Right, ALT | CONTROL)
            case 3:
                press(timeline, Qt.Key.Key_Delete)
        assert document.undo_stack.index() <= count + 1
        if document.undo_stack.index() > count:
            states.append(document.project)
        if len(document.project.constraints) < 2 or random.random() < 0.2:
            document.undo_stack.undo()
            states.pop()
            assert document.project == states[-1]
    while document.undo_stack.canUndo():
        document.undo_stack.undo()
        states.pop()
        assert document.project == states[-1]
    assert document.project == before


def test_alt_with_up_and_down_is_left_to_the_priority_of_the_constraint(timeline):
    """The table of actions has them; the timeline takes no key that an action has with Alt."""
    taken = {(key, ALT) for key in (Qt.Key.Key_Up, Qt.Key.Key_Down) if handles_key(timeline.tracks, key, ALT)}
    assert taken == set()
