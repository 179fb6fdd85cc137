"""Rows of clips: edited, retimed, joined and blended."""

from dataclasses import replace
from functools import cache
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.constraints.position import PositionConstraint
from studio.core.curves.keyed import KeyedNumber, KeyedPlace
from studio.core.curves.retiming import (
    FASTEST_CLIP_SPEED,
    SLOWEST_CLIP_SPEED,
    motion_seconds,
    playing_seconds,
    scaled_speed,
    speed_at,
)
from studio.core.curves.tangents import TangentMode, tangents_of
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.normalized.compose import Composite, compose_pieces
from studio.core.normalized.differences import channel_difference, with_difference
from studio.core.normalized.joining import SAME_FOOTHOLD_DISTANCE, PlanarTransform, average_body
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.core.normalized.pieces import MotionPiece
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.transition import MOST_TRANSITION_SECONDS, QUIET_PEAK, placed_channels
from studio.core.quality.metrics import angular_acceleration, contact_quality
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.performers.rows import clip_transform
from studio.core.stage.clip import Clip
from studio.core.stage.clip_row import (
    clip_halves,
    frame_at,
    players_of,
    with_clip_edited,
    with_first_frame,
    with_last_frame,
)
from studio.io.importing import load_capture
from tests.architecture.sources import ROOT
from tests.builders import make_constraint, make_morphology, make_project
from tests.core.motions import walk

# Rows of clips as one motion: cut, retimed, joined and blended, without a slide and without a jolt.


EXAMPLES = ("walk_turn", "front_kick", "straight_punch", "reach_grasp")
BODY = make_morphology(leg_scale=1.1)
PERMITTED = 1.5


@cache
def example(name: str) -> MotionPiece:
    """All of one of the project's own captures."""
    capture = load_capture(ROOT / "examples" / "captures" / f"{name}.bvh")
    motion, _ = normalize_capture(capture)
    found = capture_contacts(capture)
    contacts = tuple(ContactInterval("", point, *span) for point, spans in found.items() for span in spans)
    return MotionPiece(motion, contacts, 0, motion.frame_count - 1)


def cut(piece: MotionPiece, **changes: object) -> MotionPiece:
    return MotionPiece(**{**{name: getattr(piece, name) for name in piece.__dataclass_fields__}, **changes})


def standing(composite: Composite) -> GroundedMotion:
    return ground_motion(composite.motion, BODY, composite.contacts, Ground())


@cache
def peaks(name: str) -> np.ndarray:
    return standing(compose_pieces((example(name),))).peak_angular_accelerations


def local_accelerations(stands: GroundedMotion) -> np.ndarray:
    carriers = np.array(stands.morphology.layout.parent_segments())
    local = stands.rotations.copy()
    local[:, 1:] = np.swapaxes(stands.rotations[:, carriers[1:]], 2, 3) @ stands.rotations[:, 1:]
    return angular_acceleration(local, stands.motion.frame_rate)


def half_rate(motion: NormalizedMotion) -> NormalizedMotion:
    return NormalizedMotion(motion.name, motion.frame_rate / 2, motion.channels[::2], motion.spine_places)


def test_a_clip_that_plays_a_motion_as_it_is_is_that_motion() -> None:
    whole = example("front_kick")
    composite = compose_pieces((cut(whole, first=20, last=80, start=2.0),))
    assert composite.motion is whole.motion
    assert composite.contacts == whole.contacts
    assert composite.timing.start == pytest.approx(2.0)
    assert composite.timing.end == pytest.approx(3.0)


def test_the_same_row_is_the_same_value() -> None:
    row = example("front_kick"), cut(example("walk_turn"), start=6.0)
    assert compose_pieces(row) is compose_pieces(row)


def test_a_trimmed_clip_keeps_its_frames_to_the_bit_and_its_contacts() -> None:
    whole = example("walk_turn")
    row = compose_pieces((cut(whole, last=99), cut(whole, first=0, last=50, start=20.0, joined=False)))
    np.testing.assert_array_equal(row.motion.channels[:100], whole.motion.channels[:100])
    for point in ContactPoint:
        for frame in range(80):
            stands = [any(each.point == point and each.first <= frame <= each.last for each in contacts)
                      for contacts in (whole.contacts, row.contacts)]  # fmt: skip
            assert stands[0] == stands[1]


def test_captures_of_30_60_and_120_frames_a_second_play_the_same_motion() -> None:
    whole = example("walk_turn")
    slow, fast = (
        NormalizedMotion("", rate, whole.motion.channels, whole.motion.spine_places) for rate in (30.0, 120.0)
    )
    half = half_rate(whole.motion)
    thirty = compose_pieces((cut(whole, motion=half, contacts=(), last=200), cut(whole, motion=fast, start=30.0)))
    assert thirty.timing.frame_rate == 120.0
    played = realize_motion(
        NormalizedMotion("", 60.0, thirty.motion.channels[:600:2], thirty.motion.spine_places), BODY
    )[0]
    np.testing.assert_allclose(played, realize_motion(whole.motion, BODY)[0][:300], atol=4e-3)
    assert compose_pieces((cut(whole, motion=slow), cut(whole, motion=slow, start=40.0))).timing.frame_rate == 30.0


def test_twice_as_fast_plays_every_other_frame() -> None:
    whole = example("straight_punch")
    composite = compose_pieces((cut(whole, speed=2.0),))
    assert composite.timing.end == pytest.approx(whole.end / 2)
    np.testing.assert_array_equal(composite.motion.channels, whole.motion.channels[::2])


@pytest.mark.parametrize("second", EXAMPLES)
def test_a_clip_goes_on_where_the_one_before_has_ended(second: str) -> None:
    before, after = example("walk_turn"), example(second)
    row = compose_pieces((before, cut(after, start=before.end)))
    placement, layout = row.played[1].placement, average_body().layout
    begin = placed_channels(after.motion.channels[:1], placement.turn, np.array(placement.offset))
    feet = [
        realize_motion(NormalizedMotion("", 1.0, channels, after.motion.spine_places), average_body())[0][
            0, [layout.ankle_point(0), layout.ankle_point(1)], :2
        ]
        for channels in (before.motion.channels[-1:], begin)
    ]
    nearer = np.linalg.norm(feet[1] - feet[0], axis=1).min()
    assert nearer < SAME_FOOTHOLD_DISTANCE * average_body().leg_length
    apart = compose_pieces((before, cut(after, start=before.end, joined=False)))
    np.testing.assert_allclose(apart.motion.channels[-1, :2], after.motion.channels[-1, :2], atol=1e-12)


def test_a_clip_is_turned_about_where_it_begins_and_moved_in_leg_lengths() -> None:
    whole = example("walk_turn")
    turned = compose_pieces((cut(whole, own=PlanarTransform(np.pi / 2, (0.5, -1.0))),)).motion.channels
    plain = whole.motion.channels
    np.testing.assert_allclose(turned[0, :2], plain[0, :2] + [0.5, -1.0], atol=1e-12)
    way = plain[-1, :2] - plain[0, :2]
    np.testing.assert_allclose(turned[-1, :2] - turned[0, :2], [-way[1], way[0]], atol=1e-12)


@pytest.mark.parametrize("overlap", [-0.5, 0.0, 0.4])
@pytest.mark.parametrize(("first", "second"), list(permutations(EXAMPLES, 2)))
def test_no_foot_slides_and_no_joint_jolts_where_one_clip_follows_another(
    first: str, second: str, overlap: float
) -> None:
    before = example(first)
    row = compose_pieces((before, cut(example(second), start=before.end - overlap)))
    stands = standing(row)
    quality = contact_quality(solve_constraints(stands, ()), stands.contacts, Ground())
    assert quality.slide < 1e-3
    assert quality.penetration < 1e-3
    usual = np.maximum(np.maximum(peaks(first), peaks(second)), QUIET_PEAK)
    assert (local_accelerations(stands).max(axis=0) / usual).max() < PERMITTED
    ways = np.linalg.norm(np.diff(stands.positions, axis=0), axis=2).max() * row.timing.frame_rate
    fastest = max(_fastest(first), _fastest(second))
    assert ways < 1.1 * fastest


@cache
def _fastest(name: str) -> float:
    stands = standing(compose_pieces((example(name),)))
    return float(np.linalg.norm(np.diff(stands.positions, axis=0), axis=2).max() * stands.motion.frame_rate)


def test_a_cut_in_the_middle_of_a_stride_slides_no_foot() -> None:
    motion, contacts = walk()
    stride = MotionPiece(motion, contacts, 10, 64)
    for frame in (20, 41, 55, 70):
        row = compose_pieces((stride, MotionPiece(motion, contacts, frame, 140, start=stride.end)))
        stands = standing(row)
        quality = contact_quality(solve_constraints(stands, ()), stands.contacts, Ground())
        assert quality.slide < 1e-3


def test_what_leads_from_one_frame_to_another_leads_there() -> None:
    kick, punch = (example(name).motion for name in ("front_kick", "straight_punch"))
    there = with_difference(kick.channels[:300], channel_difference(kick.channels[:300], punch.channels[:300]))
    arrived, wanted = (
        realize_motion(NormalizedMotion("", 60.0, channels, punch.spine_places), average_body())[0]
        for channels in (there, punch.channels[:300])
    )
    np.testing.assert_allclose(arrived, wanted, atol=1e-9)


def test_a_pose_holds_while_nothing_plays() -> None:
    kick = example("front_kick")
    row = compose_pieces((kick, cut(kick, start=kick.end + 2.0)))
    still = row.motion.channels[kick.last + 70 : kick.last + 110]
    assert np.abs(np.diff(still, axis=0)).max() < 1e-9
    assert any(each.first < kick.last and each.last > kick.last + 110 for each in row.contacts)


def test_a_row_that_is_far_too_long_is_refused_before_any_of_it_is_made() -> None:
    kick = example("front_kick")
    with pytest.raises(StudioError, match="nearer to each other"):
        compose_pieces((kick, cut(kick, start=1e6)))


def test_a_clip_over_a_longer_one_takes_over_in_its_first_second() -> None:
    """It would not be seen at all if it took over as it ends."""
    kick = example("front_kick")
    row = compose_pieces((example("walk_turn"), cut(kick, start=2.0)))
    assert row.played[0].last < row.played[1].first <= round((2.0 + MOST_TRANSITION_SECONDS) * row.timing.frame_rate)


@pytest.mark.parametrize("seed", range(20))
def test_clips_that_cover_each_other_leave_no_part_of_a_row_empty(seed: int) -> None:
    random = np.random.default_rng(seed)
    whole = [example(EXAMPLES[k]) for k in random.permutation(4)]
    row = compose_pieces(
        tuple(cut(each, last=each.first + int(random.integers(1, 90)), start=0.5 * random.random()) for each in whole)
    )
    assert all(part.start < part.stop for part in row.motion.parts)
    assert standing(row).positions.shape[0] == row.motion.frame_count


# Edits of clips: what is cut plays as before, and an edit is of all who play the clip.


RATE = 60.0
NAMES = ("second", "third", "fourth")


def pieces_of(clips: tuple[Clip, ...], motion: MotionPiece) -> tuple[MotionPiece, ...]:
    """Frames that clips of one motion play, repeat by repeat."""
    once = {clip.id: clip.length(RATE) / clip.repeats for clip in clips}
    return tuple(
        cut(
            motion, first=clip.first, last=clip.last, start=clip.start + repeat * once[clip.id], speed=clip.speed,
            mirrored=clip.mirrored, joined=clip.joined or repeat > 0, origin=(index, repeat),
        )
        for index, clip in enumerate(clips)
        for repeat in range(clip.repeats)
    )  # fmt: skip


@pytest.mark.parametrize("name", ["walk_turn", "front_kick"])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_split_clip_plays_as_it_did(name: str, mirrored: bool) -> None:
    motion = example(name)
    clip = Clip("motion", 20, 220, 0.5, "one", mirrored=mirrored, speed=1.25)
    whole = compose_pieces(pieces_of((clip,), motion))
    parts = compose_pieces(pieces_of(clip_halves(clip, RATE, 2.0, iter(NAMES)), motion))
    assert parts.timing == whole.timing
    assert np.abs(parts.motion.channels - whole.motion.channels).max() < 1e-6  # leg lengths: a micron


@given(
    some.integers(0, 50), some.integers(2, 80), some.integers(1, 5), some.floats(0.1, 10.0), some.floats(-5.0, 5.0),
    some.floats(0.0, 1.0),
)  # fmt: skip
def test_parts_of_a_clip_follow_each_other_and_are_as_long_together(
    first: int, length: int, repeats: int, speed: float, start: float, share: float
) -> None:
    clip = Clip("motion", first, first + length, start, "one", speed, repeats)
    time = start + share * clip.length(RATE)
    played = round((time - start) * speed * RATE)
    if not 0 < played < repeats * length:
        with pytest.raises(ValueError, match="playhead"):
            clip_halves(clip, RATE, time, iter(NAMES))
        return
    parts = clip_halves(clip, RATE, time, iter(NAMES))
    assert parts[0].id == "one"
    assert len({part.id for part in parts}) == len(parts) > 1
    for one, other in pairwise(parts):
        assert other.start == pytest.approx(one.start + one.length(RATE))
    assert sum(part.length(RATE) for part in parts) == pytest.approx(clip.length(RATE))
    assert any(abs(part.start - time) <= 0.51 / (speed * RATE) for part in parts[1:])


@given(some.integers(-40, 140), some.floats(0.1, 10.0))
def test_trimming_the_beginning_leaves_every_frame_when_it_was(frame: int, speed: float) -> None:
    clip = Clip("motion", 10, 60, 2.0, "one", speed)
    trimmed = with_first_frame(clip, RATE, frame)
    assert 0 <= trimmed.first <= trimmed.last == 60
    for time in (1.0, 2.0, 3.0):
        assert frame_at(trimmed, RATE, time) == pytest.approx(frame_at(clip, RATE, time))


@given(some.integers(-40, 140))
def test_an_end_stays_within_the_motion_and_behind_the_beginning(frame: int) -> None:
    assert 10 <= with_last_frame(Clip("motion", 10, 60), frame, 100).last <= 99


def test_an_edit_is_of_all_who_play_the_clip_and_leaves_other_clips_alone() -> None:
    project = make_project(characters=2)
    players = players_of(project, "clip")
    assert len(players) == 2
    other = Clip("motion", 0, 5, 9.0, "other")
    for performer in players.values():
        both = with_clip_edited(performer, "clip", lambda clip: (clip, other))
        late = with_clip_edited(both, "clip", lambda clip: (Clip("motion", 0, 5, 20.0, clip.id),))
        assert [clip.id for clip in late.clips] == ["other", "clip"]  # in the order in which they begin


# Speeds that are keyed: time is one to one with the motion's, parts play as the whole, contacts come along.


SLOW_MIDDLE = KeyedNumber((1.0, 1.4, 2.2, 2.6), (1.0, 1.0 / 3.0, 1.0 / 3.0, 1.0))


@some.composite
def keyed_speeds(draw):
    """Speeds with one to five keys, some of them stepped or linear."""
    count = draw(some.integers(1, 5))
    gaps = draw(some.lists(some.floats(0.3, 2.0), min_size=count, max_size=count))
    values = draw(some.lists(some.floats(SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED), min_size=count, max_size=count))
    modes = draw(some.lists(some.sampled_from([None, *TangentMode]), min_size=count, max_size=count))
    start = draw(some.floats(-1.0, 3.0))
    tangents = tuple(None if mode in (None, TangentMode.FREE) else tangents_of(mode, (1.0, 1.0)) for mode in modes)
    return KeyedNumber(tuple((start + np.cumsum(gaps)).tolist()), tuple(values), tangents=tangents)


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


def test_a_speed_that_is_scaled_keeps_its_shape_within_the_range_of_clips():
    assert scaled_speed(2.0, 0.5) == 1.0
    assert scaled_speed(2.0, 100.0) == FASTEST_CLIP_SPEED
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
