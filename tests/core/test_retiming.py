"""Speeds that are keyed: time is one to one with the motion's, parts play as the whole, contacts come along."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.curves.retiming import (
    FASTEST_CLIP,
    SLOWEST_CLIP,
    motion_seconds,
    playing_seconds,
    scaled_speed,
    speed_at,
)
from studio.core.curves.tangents import TangentMode, tangents_of
from studio.core.normalized.compose import compose_pieces
from studio.core.solver.performers.rows import clip_transform
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import clip_halves, frame_at, with_first_frame
from tests.builders import make_constraint
from tests.core.test_clip_row import NAMES, RATE, pieces_of
from tests.core.test_compose import example

SLOW_MIDDLE = KeyedNumber((1.0, 1.4, 2.2, 2.6), (1.0, 1.0 / 3.0, 1.0 / 3.0, 1.0))


@some.composite
def keyed_speeds(draw):
    """Speeds with one to five keys, some of them stepped or linear."""
    count = draw(some.integers(1, 5))
    gaps = draw(some.lists(some.floats(0.3, 2.0), min_size=count, max_size=count))
    values = draw(some.lists(some.floats(SLOWEST_CLIP, FASTEST_CLIP), min_size=count, max_size=count))
    modes = draw(some.lists(some.sampled_from([None, *TangentMode]), min_size=count, max_size=count))
    start = draw(some.floats(-1.0, 3.0))
    tangents = tuple(None if mode in (None, TangentMode.FREE) else tangents_of(mode, (1.0, 1.0)) for mode in modes)
    return KeyedNumber(tuple((start + np.cumsum(gaps)).tolist()), tuple(values), tangents=tangents)


@settings(max_examples=150, deadline=None)
@given(keyed_speeds())
def test_time_of_the_stage_and_of_the_motion_are_each_others_inverse_at_the_speed_that_is_keyed(speed):
    seconds = np.linspace(-2.0, 15.0, 800)
    played = playing_seconds(speed, seconds)
    assert (np.diff(played) > 0.0).all()
    assert motion_seconds(speed, played) == pytest.approx(seconds, abs=1e-9)
    step = 1e-4
    there = np.array([time for time in seconds if min(abs(time - key) for key in speed.times) > 0.02])
    slope = 2 * step / (playing_seconds(speed, there + step) - playing_seconds(speed, there - step))
    assert slope == pytest.approx(speed_at(speed, there), rel=0.15)


@pytest.mark.parametrize("constant", [0.25, 1.0, 3.0])
def test_a_speed_with_one_key_plays_as_the_constant_one_does(constant):
    keyed = Clip("motion", 20, 220, 0.5, "one", KeyedNumber((1.7,), (constant,)), repeats=2)
    plain = replace(keyed, speed=constant)
    assert keyed.length(RATE) == pytest.approx(plain.length(RATE), abs=1e-9)
    times = np.linspace(-1.0, 8.0, 50)
    assert keyed.stage_seconds(times, RATE) == pytest.approx(plain.stage_seconds(times, RATE), abs=1e-9)
    assert keyed.motion_seconds(times, RATE) == pytest.approx(plain.motion_seconds(times, RATE), abs=1e-9)
    motion = example("walk_turn")
    ours, theirs = (compose_pieces(pieces_of((clip,), motion)) for clip in (keyed, plain))
    assert ours.timing.last == theirs.timing.last
    assert np.abs(ours.motion.channels - theirs.motion.channels).max() < 1e-7
    for one, other in zip(ours.contacts, theirs.contacts, strict=True):  # an end may lie between two frames
        assert one.point is other.point
        assert max(abs(one.first - other.first), abs(one.last - other.last)) <= 1


@pytest.mark.parametrize("wrong", [0.05, 11.0])
def test_a_key_of_a_speed_that_no_clip_may_have_is_refused(wrong):
    with pytest.raises(ValueError, match="speed lies between"):
        Clip("motion", 0, 10, speed=KeyedNumber((0.0, 1.0), (1.0, wrong)))


def test_a_speed_that_is_scaled_keeps_its_shape_within_the_range_of_clips():
    assert scaled_speed(2.0, 0.5) == 1.0
    assert scaled_speed(2.0, 100.0) == FASTEST_CLIP
    assert scaled_speed(SLOW_MIDDLE, 2.0).values == pytest.approx((2.0, 2 / 3, 2 / 3, 2.0))
    seconds = np.linspace(0.0, 4.0, 60)
    half = playing_seconds(scaled_speed(SLOW_MIDDLE, 2.0), seconds)
    assert half == pytest.approx(playing_seconds(SLOW_MIDDLE, seconds) / 2.0, abs=1e-5)


@pytest.mark.parametrize("repeats", [1, 3])
@pytest.mark.parametrize("share", [0.2, 0.5, 0.77])
def test_a_split_or_trimmed_clip_plays_as_it_did(share, repeats):
    motion = example("walk_turn")
    clip = Clip("motion", 20, 220, 0.5, "one", SLOW_MIDDLE, repeats)
    whole = compose_pieces(pieces_of((clip,), motion))
    parts = clip_halves(clip, RATE, clip.start + share * clip.length(RATE), iter(NAMES))
    assert sum(part.length(RATE) for part in parts) == pytest.approx(clip.length(RATE), abs=1e-9)
    joined = compose_pieces(pieces_of(parts, motion))
    assert joined.timing.last == whole.timing.last
    assert np.abs(joined.motion.channels - whole.motion.channels).max() < 1e-6
    trimmed = with_first_frame(clip, RATE, 90)
    assert frame_at(trimmed, RATE, 2.5) == pytest.approx(frame_at(clip, RATE, 2.5), abs=1e-6)


def test_contacts_last_as_long_as_their_frames_do_and_feet_stand_where_they_stood():
    motion = example("walk_turn")
    clip = Clip("motion", 0, 240, 0.0, "one", SLOW_MIDDLE)
    whole = compose_pieces(pieces_of((clip,), motion))
    for contact in motion.contacts:
        if contact.first > 0 and contact.last < 240:
            begin, end = clip.stage_seconds(np.array([contact.first, contact.last]) / RATE, RATE)
            alike = [each for each in whole.contacts if each.point is contact.point]
            nearest = min(alike, key=lambda each: abs(each.first / RATE - begin))
            assert (nearest.first / RATE, nearest.last / RATE) == pytest.approx((begin, end), abs=2.0 / RATE)


def test_constraints_keys_and_their_slopes_come_along():
    motion = example("walk_turn")
    clip = Clip("motion", 0, 240, 0.5, "one", SLOW_MIDDLE)
    whole = compose_pieces(pieces_of((clip,), motion))
    carry = clip_transform(whole.played[0], whole.timing, 0.9)
    target = KeyedPlace((1.2, 1.8, 2.4), ((0.0, 0.0, 1.0), (0.2, 0.0, 1.2), (0.4, 0.0, 1.0)))
    tangents = tuple(tangents_of(TangentMode.SMOOTH, (1.0, 1.0)) for _ in target.times)
    asked = make_constraint(target=replace(target, tangents=tangents))
    assert isinstance(asked, PositionConstraint)
    moved = constraint_on_clip(asked, carry)
    expected = clip.stage_seconds(np.array(target.times), RATE) - whole.timing.begin
    assert moved.target.times == pytest.approx(expected, abs=1e-9)
    assert moved.activation.full == pytest.approx(
        float(clip.stage_seconds(asked.activation.full, RATE)) - whole.timing.begin, abs=1e-9
    )
    assert carry.mean_speed == pytest.approx((240 / RATE) / clip.length(RATE), rel=1e-3)


def test_a_clip_that_goes_on_in_another_one_is_known_by_its_times():
    first = ClipTransform(0.5, SLOW_MIDDLE, 0.0, (0.0, 0.0), False, 0.5, 2.0)
    after = replace(first, first=2.0, last=4.0)
    assert first.goes_on_in(after, 0.01)
    assert not first.goes_on_in(replace(after, speed=1.0), 0.01)
    assert not first.goes_on_in(replace(after, begin=0.6), 0.01)


def test_a_key_far_away_costs_no_memory_and_changes_nothing_among_those_nearby() -> None:
    near = KeyedNumber((0.0, 1.0, 2.0), (1.0, 3.0, 3.0))
    far = KeyedNumber((0.0, 1.0, 2.0, 1e9), (1.0, 3.0, 3.0, 3.0))
    seconds = np.linspace(-1.0, 2.0, 50)
    np.testing.assert_array_equal(playing_seconds(far, seconds), playing_seconds(near, seconds))
    later = np.array([3.0, 1e4, 1e9, 2e9])
    np.testing.assert_allclose(motion_seconds(far, playing_seconds(far, later)), later, rtol=1e-9)
