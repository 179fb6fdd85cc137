"""The curve editor: keys dragged in time and value, tangents dragged by handles, fields, menus, framing."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from studio.core.body.canonical import BodyPart
from studio.core.body.growth import KeyedProportions
from studio.core.body.morphology import Proportions
from studio.core.constraints.base import BodyPoint, Chain
from studio.core.constraints.distance import DistanceConstraint
from studio.core.curves.keyed import KeyedNumber, KeyedPlace, KeyedTurn
from studio.core.curves.tangents import Beyond, TangentMode
from studio.core.rotations import from_euler
from studio.core.stage.prop import Prop
from studio.document.channels import (
    TangentSide,
    channels_of,
    handle_of,
    key_values,
    values_at,
    with_broken,
    with_handle,
    with_mode,
    with_values,
)
from studio.document.keyed_fields import KeyedField, KeyRef
from studio.timeline.curves import Quantity
from studio.timeline.menus import menu_at
from studio.timeline.tracks.value_curves import HandleRef, plot_area
from tests.gui.hand import RATE, Hand, curve, frames, pixels

FIELD = KeyedField("constraints", "kick", "target")
ACTIVATION = KeyedField("constraints", "kick", "activation")
Modifier = Qt.KeyboardModifier
NONE = Modifier.NoModifier
KEYS = KeyedPlace(
    tuple(f / RATE for f in (24, 36, 44, 56)), ((0.4, 0.0, 1.0), (0.5, 0.1, 1.2), (0.2, 0.3, 1.4), (0.4, 0.0, 1.1))
)


class Editor:
    """Things of the curve editor and their places."""

    def __init__(self, document, timeline):
        self.document, self.timeline = document, timeline

    @property
    def area(self):
        return plot_area(self.timeline.tracks.sheet.plot)

    @property
    def target(self):
        return self.document.project.constraints["kick"].target

    def channel(self, name):
        channels = self.timeline.tracks.picture.curves.channels(self.timeline.tracks.shown)
        return next((channel, keyed) for channel, keyed in channels if channel.name == name)

    def key(self, name, place):
        channel, keyed = self.channel(name)
        curves, shown = self.timeline.tracks.picture.curves, self.timeline.tracks.shown
        return curves.point(shown, self.area, channel, keyed, place).toPoint()

    def handle(self, name, place, side):
        channel, keyed = self.channel(name)
        curves, shown = self.timeline.tracks.picture.curves, self.timeline.tracks.shown
        return curves.handle_point(shown, self.area, HandleRef(channel, place, side), keyed).toPoint()

    def menu(self, point, text):
        menu = menu_at(self.timeline.tracks, point.toPointF())
        actions = [
            *menu.actions(),
            *(inner for action in menu.actions() if action.menu() for inner in action.menu().actions()),
        ]
        next(action for action in actions if action.text() == text).trigger()


@pytest.fixture
def editor(document, timeline):
    old = document.project.constraints["kick"]
    document.replace("constraints", "kick", replace(old, target=KEYS), "Key")
    document.selection.set(("constraints", "kick"))
    document.undo_stack.clear()
    timeline.resize(1296, 560)
    timeline.transport.curves.click()
    assert timeline.editing_curves
    timeline.tracks.grab()
    return Editor(document, timeline)


def test_a_key_is_dragged_in_value_alone_in_time_alone_or_both_and_only_its_channel_rises(document, editor, hand):
    hand.press(editor.key("z", 1))
    hand.move(2, dy=-40)
    hand.release()
    assert editor.target.times == KEYS.times
    x, y, z = editor.target.values[1]
    assert (x, y) == KEYS.values[1][:2]
    assert z > 1.22
    assert document.undo_stack.count() == 1
    hand.drag(editor.key("z", 1), pixels(editor.timeline, 3))
    assert editor.target.times[1] == pytest.approx(39 / RATE)
    assert editor.target.values[1] == (x, y, z)
    document.undo_stack.undo()
    document.undo_stack.undo()
    assert editor.target == KEYS


def test_a_key_under_the_playhead_is_dragged_and_the_playhead_stays(document, editor, hand):
    document.playhead.set_time(editor.timeline.tracks.shown.subject.to_stage(KEYS.times[1]))
    before, place = document.playhead.time, editor.key("z", 1)
    hand.press(place)
    hand.move(0, dy=-20)
    hand.release()
    assert editor.target.values[1][2] > KEYS.values[1][2] + 0.01
    assert document.playhead.time == before


def test_shift_is_finer_and_ctrl_catches_on_round_values(document, editor, hand):
    risen = []
    for keys in (NONE, Modifier.ShiftModifier):
        hand.press(editor.key("z", 1))
        hand.move(0, keys, dy=-30)
        risen.append(editor.target.values[1][2] - 1.2)
        QTest.keyClick(editor.timeline.tracks, Qt.Key.Key_Escape)
        hand.release()
        document.keys.clear()
    assert risen[1] == pytest.approx(risen[0] / 10.0)
    hand.press(editor.key("z", 1))
    hand.move(0, Modifier.ControlModifier, dy=-31)
    hand.release()
    assert (editor.target.values[1][2] * 100.0) % 1.0 == pytest.approx(0.0, abs=1e-6)


def test_selected_keys_of_a_channel_rise_together(document, editor, hand):
    document.keys.set([KeyRef(FIELD, 1), KeyRef(FIELD, 2)])
    hand.press(editor.key("x", 1))
    hand.move(0, dy=-20)
    hand.release()
    changes = np.array(editor.target.values) - KEYS.values
    assert changes[1] == pytest.approx(changes[2])
    assert changes[1, 0] > 0.0
    assert np.count_nonzero(changes) == 2


def test_a_handle_turns_both_sides_of_a_key_and_alt_breaks_them(document, editor, hand):
    document.keys.set([KeyRef(FIELD, 1)])
    hand.press(editor.handle("z", 1, TangentSide.OUT))
    hand.move(0, dy=-40)
    hand.release()
    own = editor.target.tangents[1]
    assert own.arriving.mode is own.leaving.mode is TangentMode.FREE
    assert own.arriving.rate == own.leaving.rate
    assert own.leaving.rate[2] > 1.0
    assert document.undo_stack.count() == 1
    hand.press(editor.handle("z", 1, TangentSide.IN))
    hand.move(0, Modifier.AltModifier, dy=-60)
    hand.release()
    broken = editor.target.tangents[1]
    assert broken.broken
    assert broken.leaving == own.leaving
    assert broken.arriving.rate[2] < own.arriving.rate[2]
    document.undo_stack.undo()
    document.undo_stack.undo()
    assert editor.target == KEYS


def test_a_handle_that_is_pulled_out_weighs_more_and_ctrl_keeps_the_weight(document, editor, hand):
    document.keys.set([KeyRef(FIELD, 1)])
    hand.press(editor.handle("x", 1, TangentSide.OUT))
    hand.move(30)
    assert editor.target.tangents[1].leaving.weight > 1.5
    hand.move(0, Modifier.ControlModifier)
    assert editor.target.tangents[1].leaving.weight == pytest.approx(1.0)
    QTest.keyClick(editor.timeline.tracks, Qt.Key.Key_Escape)
    hand.release()
    assert editor.target == KEYS


def test_the_handles_of_an_activation_change_how_it_rises(document, editor, hand):
    document.keys.set([KeyRef(ACTIVATION, 0)])
    hand.press(editor.handle("activation", 0, TangentSide.OUT))
    hand.move(25, dy=-30)
    hand.release()
    curve = document.project.constraints["kick"].activation
    assert curve.weights[0] > 1.3
    assert frames(curve) == (20, 30, 50, 60)
    assert curve.weights[1:] == (1.0, 1.0, 1.0)


def test_the_menu_sets_tangents_and_what_holds_beyond_the_keys(document, editor):
    document.keys.set([KeyRef(FIELD, 1)])
    point = editor.key("z", 1)
    for mode in TangentMode:
        editor.menu(point, f"{mode.value.capitalize()} tangents")
        own = editor.target.tangents[1] if editor.target.tangents else None
        assert (own.leaving.mode if own else TangentMode.AUTO) is mode
    editor.menu(point, "Break tangents")
    assert editor.target.tangents[1].broken
    editor.menu(point, "Unify tangents")
    assert not editor.target.tangents[1].broken
    editor.menu(point, "Loop")
    assert editor.target.before is Beyond.LOOP
    assert editor.target.after is Beyond.HOLD


def _keyed_distance(document):
    apart = DistanceConstraint(
        "motion", "Apart", BodyPoint(BodyPart.LEFT_FOREARM), Chain(), 1, curve(20, 24, 56, 60),
        other=BodyPoint(BodyPart.RIGHT_FOREARM), distance=KeyedNumber((24 / RATE, 56 / RATE), (0.2, 0.4)),
    )  # fmt: skip
    return "constraints", document.add("constraints", apart, "Add"), "distance"


def _keyed_measures(document):
    key = document.project.performers["performer 0"].character_id
    keyed = KeyedProportions((24 / RATE, 56 / RATE), (Proportions(trunk=0.3), Proportions(trunk=0.6)))
    document.replace("characters", key, replace(document.project.characters[key], proportions=keyed), "Key")
    return "characters", key, "trunk"


@pytest.mark.parametrize(("make", "least"), [(_keyed_distance, 0.0), (_keyed_measures, 0.2)])
def test_a_key_that_is_dragged_below_what_can_be_stops_there(document, editor, hand, make, least):
    collection, key, name = make(document)
    document.selection.set(("performers", "performer 0") if collection == "characters" else (collection, key))
    editor.timeline.tracks.grab()
    hand.press(editor.key(name, 0))
    hand.move(0, dy=editor.area.height() * 2)
    hand.release()
    assert key_values(*editor.channel(name))[0] == pytest.approx(least)
    editor.timeline.tracks.fields.value.setValue(-1e6)
    assert key_values(*editor.channel(name))[0] == pytest.approx(least)


def test_time_and_value_are_typed(document, editor):
    fields = editor.timeline.tracks.fields
    QTest.mouseClick(editor.timeline.tracks, Qt.MouseButton.LeftButton, NONE, editor.key("z", 2))
    assert fields.value.value() == pytest.approx(1.4)
    fields.value.setValue(1.234)
    assert editor.target.values[2] == (0.2, 0.3, 1.234)
    fields.time.setValue(0.75)
    assert editor.target.times[2] == 0.75
    assert document.undo_stack.count() == 2


def test_all_or_the_selected_keys_are_framed(document, editor):
    curves, shown = editor.timeline.tracks.picture.curves, editor.timeline.tracks.shown
    document.keys.set([KeyRef(FIELD, 1), KeyRef(FIELD, 2)])
    QTest.keyClick(editor.timeline.tracks, Qt.Key.Key_F)
    axis = editor.timeline.tracks.axis
    assert axis.time_at(axis.right) - axis.time_at(axis.left) < 0.3
    QTest.keyClick(editor.timeline.tracks, Qt.Key.Key_A)
    assert axis.time_at(axis.right) > 1.5
    metres, _ = editor.channel("z")
    span = curves.range_of(shown, metres)
    assert span.low < 0.0
    assert span.high > 1.4
    hand = Hand(editor.timeline)
    hand.wheel(editor.area.center(), 15, NONE)
    assert curves.range_of(shown, metres).high < span.high


def test_one_selected_key_is_framed_at_the_scale_of_time_that_is_shown(document, editor):
    """Its x, y and z are at one time: two frames about it filled the whole width."""
    axis, key = editor.timeline.tracks.axis, FIELD
    axis.zoom(3.0, axis.left)
    axis.scroll(10_000.0)
    shown = axis.time_at(axis.right) - axis.time_at(axis.left)
    document.keys.set([KeyRef(key, 0)])
    assert KEYS.times[0] < axis.time_at(axis.left)
    QTest.keyClick(editor.timeline.tracks, Qt.Key.Key_F)
    assert axis.time_at(axis.left) <= KEYS.times[0] <= axis.time_at(axis.right)
    assert axis.time_at(axis.right) - axis.time_at(axis.left) == pytest.approx(shown)


def test_normalized_curves_each_fill_the_height_and_are_dragged_at_their_own_scale(document, editor, hand):
    values = {name: [*key_values(*editor.channel(name))] for name in "xyz"}
    heights = {name: [editor.key(name, index).y() for index in range(4)] for name in "xyz"}
    assert np.ptp(heights["x"]) < 0.4 * editor.area.height()
    editor.menu(editor.key("z", 1), "Normalize curves")
    for name in "xyz":
        tall = [editor.key(name, index).y() for index in range(4)]
        assert np.ptp(tall) > 0.7 * editor.area.height()
    pixels_per_metre = np.ptp([editor.key("x", index).y() for index in range(4)]) / np.ptp(values["x"])
    hand.press(editor.key("x", 2))
    hand.move(0, dy=-20)
    hand.release()
    assert key_values(*editor.channel("x"))[2] == pytest.approx(values["x"][2] + 20 / pixels_per_metre, abs=0.003)
    editor.timeline.tracks.grab()
    QTest.keyClick(editor.timeline.tracks, Qt.Key.Key_A)
    assert np.ptp([editor.key("y", index).y() for index in range(4)]) > 0.7 * editor.area.height()
    document.undo_stack.undo()
    editor.menu(editor.key("z", 1), "Normalize curves")
    assert {name: [editor.key(name, index).y() for index in range(4)] for name in "xyz"} == heights


def test_a_box_selects_keys_by_time_and_value(document, editor, hand):
    corner = editor.key("z", 2) - QPoint(12, 12)
    hand.press(corner)
    hand.move(24, dy=24)
    hand.release()
    assert document.keys.items == {KeyRef(FIELD, 2)}


def test_measured_curves_lie_behind_and_everything_is_painted(document, editor):
    prop = Prop("Ball", position=KEYS, heading=KeyedNumber((0.1, 1.2), (0.0, 1.0)))
    key = document.add("props", prop, "Add")
    document.selection.set(("props", key))
    channels = editor.timeline.tracks.picture.curves.channels(editor.timeline.tracks.shown)
    assert [channel.name for channel, _ in channels] == ["x", "y", "z", "heading"]
    document.selection.clear()
    editor.timeline.tracks.grab()
    assert editor.timeline.tracks.picture.plot.curves


def test_measured_curves_are_drawn_again_only_if_they_or_the_axis_change(document, editor, monkeypatch):
    tracks = editor.timeline.tracks
    plot = tracks.picture.plot
    monkeypatch.setattr(tracks.live, "result", cache(tracks.live.result))

    def drawn():
        tracks.grab()
        return plot._image

    document.keys.set([KeyRef(FIELD, 0)])
    first = drawn()
    document.keys.set([KeyRef(FIELD, 1)])
    assert drawn() is first
    tracks.axis.zoom(1.5, 400.0)
    zoomed = drawn()
    assert zoomed is not first
    tracks.set_quantity(Quantity.KNEE_SPEED)
    assert drawn() is not zoomed


def turns():
    angles = np.radians([[0.0, 0.0, 0.0], [80.0, 20.0, 10.0], [170.0, -30.0, 0.0], [260.0, 10.0, 40.0]])
    return KeyedTurn((0.0, 0.5, 1.0, 1.6), tuple(map(tuple, from_euler("ZYX", angles).tolist())))


def test_angles_of_a_rotation_go_on_past_half_a_turn():
    heading, pitch, roll = channels_of(FIELD, turns())
    assert key_values(heading, turns()) == pytest.approx([0.0, 80.0, 170.0, 260.0])
    assert np.abs(np.diff(values_at(heading, turns(), np.linspace(0.0, 1.6, 400)))).max() < 5.0
    changed = with_values(pitch, turns(), {1: 35.0})
    assert key_values(pitch, changed)[1] == pytest.approx(35.0)
    assert key_values(roll, changed)[1] == pytest.approx(10.0)


@pytest.mark.parametrize("name", ["heading", "pitch", "roll"])
def test_the_handle_of_an_angle_is_its_rate(name):
    keyed = turns()
    channel = next(each for each in channels_of(FIELD, keyed) if each.name == name)
    new = with_handle(channel, keyed, 1, TangentSide.OUT, 0.2, 30.0)
    seconds, value = handle_of(channel, new, 1, TangentSide.OUT)
    assert value / seconds == pytest.approx(150.0, abs=0.05)
    before, after = values_at(channel, new, [0.5 - 1e-4, 0.5 + 1e-4])
    assert (after - before) / 2e-4 == pytest.approx(150.0, abs=1.0)
    assert seconds == pytest.approx(0.2)


def test_breaking_and_joining_tangents_keeps_the_curve_where_they_agree():
    broken = with_broken(KEYS, 1, True)
    times = np.linspace(KEYS.times[0], KEYS.times[-1], 50)
    assert broken.at(times) == pytest.approx(KEYS.at(times), abs=1e-9)
    assert with_broken(broken, 1, False).at(times) == pytest.approx(KEYS.at(times), abs=1e-9)
    assert with_mode(broken, 1, TangentMode.AUTO) == KEYS
