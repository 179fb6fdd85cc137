"""Rows of clips as one motion: cut, retimed, joined and blended, without a slide and without a jolt."""

from functools import cache
from itertools import permutations

import numpy as np
import pytest

from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.errors import StudioError
from studio.core.grounds.ground import Ground
from studio.core.normalized.compose import Composite, MotionPiece, compose_pieces
from studio.core.normalized.differences import channel_difference, with_difference
from studio.core.normalized.joining import SAME_PLACE, PlanarTransform, average_body
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.normalize import capture_contacts, normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.transition import MOST_TRANSITION, QUIET_PEAK, placed_channels
from studio.core.quality.metrics import angular_acceleration, contact_quality
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.standing.stand import GroundedMotion, stand
from studio.io.importing import load_capture
from tests.architecture.sources import ROOT
from tests.builders import make_morphology
from tests.core.motions import walk

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
    return stand(composite.motion, BODY, composite.contacts, Ground())


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
    assert nearer < SAME_PLACE * average_body().leg_length
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
    assert row.played[0].last < row.played[1].first <= round((2.0 + MOST_TRANSITION) * row.timing.frame_rate)


@pytest.mark.parametrize("seed", range(20))
def test_clips_that_cover_each_other_leave_no_part_of_a_row_empty(seed: int) -> None:
    random = np.random.default_rng(seed)
    whole = [example(EXAMPLES[k]) for k in random.permutation(4)]
    row = compose_pieces(
        tuple(cut(each, last=each.first + int(random.integers(1, 90)), start=0.5 * random.random()) for each in whole)
    )
    assert all(part.start < part.stop for part in row.motion.parts)
    assert standing(row).positions.shape[0] == row.motion.frame_count
