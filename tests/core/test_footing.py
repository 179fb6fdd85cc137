"""Footing of a body: states of the feet, extension of the legs, lowering of the root."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from studio.core.captures.contacts import ContactInterval, ContactPoint
from studio.core.grounds.ground import Ground
from studio.core.kernels.limbs.legs import place_leg, required_root_lowering
from studio.core.kernels.limbs.limb import SOFT_IK_THRESHOLD, SOLE_SOFT_IK_THRESHOLD
from studio.core.kernels.records import LegTargets, Pose
from studio.core.kernels.solve_clip import place_frames
from studio.core.kernels.support.foot_anchoring import anchor_ankles
from studio.core.kernels.support.sole import HEEL_STANDS, SOLE_STANDS
from studio.core.normalized.realize import realize_motion
from studio.core.solver.grounding.contact_blending import release_weight, smooth_drops
from studio.core.solver.grounding.footing import find_footing, foot_states, leg_soft_thresholds, root_follow
from tests.builders import make_morphology
from tests.core.motions import random_rotations, walk
from tests.core.twins import legs as twin

seeds = st.integers(0, 2**32 - 1)
drops = arrays(np.float64, st.integers(1, 80), elements=st.floats(-0.2, 0.5))
BODY = make_morphology(leg_scale=1.1)
WALK, CONTACTS = walk(120)
POSITIONS, _ = realize_motion(WALK, BODY)


@given(drops, st.sampled_from([24.0, 60.0, 120.0]))
def test_smoothed_drops_are_deep_enough_everywhere_and_never_deeper_than_the_deepest(
    raw: np.ndarray, frame_rate: float
) -> None:
    smooth = smooth_drops(raw, frame_rate)
    assert smooth.shape == raw.shape
    assert (smooth >= raw - 1e-12).all()
    assert smooth.max() <= max(raw.max(), 0.0) + 1e-12
    assert smooth.min() >= -1e-15


def test_smoothed_drops_have_no_jolt() -> None:
    raw = np.zeros(240)
    raw[100:140] = 0.1
    smooth = smooth_drops(raw, 120.0)
    assert np.abs(np.diff(smooth)).max() * 120.0 < 0.1 / 0.15 * 1.2
    assert np.abs(np.diff(smooth, 2)).max() * 120.0**2 < 0.1 / 0.15**2 * 4


def test_states_are_bits_of_heel_and_toe() -> None:
    contacts = [
        ContactInterval("walk", point, first, last)
        for point, first, last in (
            (ContactPoint.LEFT_HEEL, 1, 3), (ContactPoint.LEFT_TOE, 3, 5), (ContactPoint.RIGHT_TOE, 0, 0),
            (ContactPoint.RIGHT_HEEL, 6, 99),
        )
    ]  # fmt: skip
    assert foot_states(contacts, 8).tolist() == [[0, 1, 1, 3, 2, 2, 0, 0], [2, 0, 0, 0, 0, 0, 1, 1]]


@given(st.lists(st.booleans(), min_size=1, max_size=60), st.sampled_from([30.0, 60.0]))
def test_a_foot_is_free_when_its_nearest_stand_is_long_ago(planted: list[bool], frame_rate: float) -> None:
    free = release_weight(np.array(planted), frame_rate)
    stands = np.flatnonzero(planted)
    for frame, share in enumerate(free):
        gap = np.abs(stands - frame).min() / frame_rate if len(stands) else np.inf
        assert share == (0.0 if gap == 0.0 else pytest.approx(1.0) if gap >= 0.15 - 1e-9 else pytest.approx(share))
        assert 0.0 <= share <= 1.0
    assert np.allclose(release_weight(np.array(planted[::-1]), frame_rate), free[::-1])


def test_a_standing_leg_stretches_as_far_as_the_motions_own_or_nearly_straight() -> None:
    states = foot_states(CONTACTS, WALK.frame_count)
    level, uneven = (leg_soft_thresholds(WALK, states, is_level) for is_level in (True, False))
    standing = states != 0
    assert (uneven[standing] >= SOLE_SOFT_IK_THRESHOLD - 1e-12).all()
    assert (level[standing] > uneven[standing] - 1e-12).all()
    assert (level < 1.0).all()
    assert level.min() == pytest.approx(SOFT_IK_THRESHOLD, abs=0.02)


@given(seeds)
def test_how_far_the_root_comes_down_is_what_the_twin_says(seed: int) -> None:
    random, frames = np.random.default_rng(seed), 6
    rotations = random_rotations(random, frames, BODY.layout.segment_count)
    ankles = random.normal(size=(2, frames, 3)) * 0.4 + [0.0, 0.0, -0.9]
    comforts, states = random.uniform(0.9, 1.0, (2, frames)), random.integers(0, 4, (2, frames))
    found = np.empty(frames)
    required_root_lowering(WALK.channels[:frames], BODY.packed[None], rotations, ankles, comforts, states, found)
    expected = [
        twin.drop(BODY, rotations[frame, 0], ankles[:, frame], comforts[:, frame], states[:, frame])
        for frame in range(frames)
    ]
    assert np.allclose(found, expected, atol=1e-12)


class _Leg:
    """One leg of one frame of the walk, set on a random ankle."""

    def __init__(self, seed: int, stretch: tuple[float, float] = (0.4, 1.4)) -> None:
        random = np.random.default_rng(seed)
        self.side, self.row = int(random.integers(2)), WALK.channels[random.integers(WALK.frame_count)]
        self.positions = np.tile(random.normal(size=3), (BODY.layout.point_count, 1))
        self.rotations = random_rotations(random, BODY.layout.segment_count)
        self.hip = self.positions[0] + self.rotations[0] @ BODY.hip_offset[self.side]
        self.direction = random.normal(size=3)
        self.direction /= np.linalg.norm(self.direction)
        self.comfort, self.length = random.uniform(0.95, 0.999), BODY.leg[self.side].sum()
        self.ankle = self.hip + random.uniform(*stretch) * self.length * self.direction
        self.foot, self.toe = random_rotations(random), random_rotations(random)
        self.before = self.positions.copy(), self.rotations.copy()
        ours = (np.stack([each] * 2) for each in (self.comfort, self.ankle, self.foot, self.toe))
        place_leg(self.side, BODY.packed, LegTargets(self.row, *ours), Pose(self.positions, self.rotations))
        first, upper = BODY.layout.hip_point(self.side), BODY.layout.spine_count + 10 + 4 * self.side
        self.points, self.segments = slice(first, first + 5), slice(upper, upper + 4)


@given(seeds)
def test_a_leg_is_placed_as_its_twin_and_nothing_else_moves(seed: int) -> None:
    leg = _Leg(seed)
    root, pelvis = leg.before[0][0], leg.before[1][0]
    stance = twin.Stance(leg.comfort, leg.ankle, leg.foot, leg.toe)
    points, segments = twin.place_leg(leg.row, BODY, leg.side, stance, root, pelvis)
    assert np.allclose(leg.positions[leg.points], points, atol=1e-9)
    assert np.allclose(leg.rotations[leg.segments], segments, atol=1e-9)
    others = np.delete(leg.positions, leg.points, axis=0), np.delete(leg.rotations, leg.segments, axis=0)
    assert np.array_equal(others[0], np.delete(leg.before[0], leg.points, axis=0))
    assert np.array_equal(others[1], np.delete(leg.before[1], leg.segments, axis=0))


@given(seeds)
def test_an_ankle_within_comfort_is_met(seed: int) -> None:
    leg = _Leg(seed, (0.3, 0.95))
    assert np.allclose(leg.positions[BODY.layout.ankle_point(leg.side)], leg.ankle, atol=1e-12)


@given(seeds)
def test_an_ankle_out_of_reach_is_neared_along_its_line(seed: int) -> None:
    leg = _Leg(seed, (1.0, 3.0))
    stretched = leg.positions[BODY.layout.ankle_point(leg.side)] - leg.hip
    assert np.allclose(np.cross(stretched, leg.direction), 0.0, atol=1e-12)
    assert leg.comfort * leg.length < np.linalg.norm(stretched) <= leg.length + 1e-12


def test_a_clip_is_placed_frame_by_frame() -> None:
    """``place_frames`` lowers every root and then puts both legs on their ankles."""
    positions, rotations = realize_motion(WALK, BODY)
    footing = find_footing(WALK, BODY, CONTACTS, Ground(), positions, rotations)
    placed, turned = positions.copy(), rotations.copy()
    stance = (footing.soft_thresholds, footing.ankles, footing.feet, footing.toes)
    place_frames(BODY.packed[None], footing.drops, LegTargets(WALK.channels, *stance), placed, turned)
    for frame in (0, 33, 119):
        root = positions[frame, 0] - [0.0, 0.0, footing.drops[frame]]
        assert np.allclose(placed[frame, 0], root)
        for side in range(2):
            each = twin.Stance(*(array[side, frame] for array in stance))
            points, _ = twin.place_leg(WALK.channels[frame], BODY, side, each, root, rotations[frame, 0])
            assert np.allclose(placed[frame, BODY.layout.hip_point(side) :][:5], points, atol=1e-9)
    above = positions[:, BODY.layout.neck_base] - placed[:, BODY.layout.neck_base]
    assert np.allclose(above[:, 2], footing.drops)


def test_a_body_goes_along_with_the_one_foot_that_stands() -> None:
    """Its leg stays as it is, and what the other foot does is for that to answer."""
    states = np.repeat([[1, 3, 0, 0], [0, 0, 0, 3]], 30, axis=1)
    off = np.zeros((2, 120, 3))
    off[0] = [0.02, -0.01, 0.03]
    off[1] = [-0.01, 0.0, 0.0]
    went = root_follow(off, states, 60.0, POSITIONS, BODY)
    assert np.allclose(went[:40], off[0, 0], atol=1e-9)
    assert np.allclose(went[110:], off[1, 0], atol=1e-9)
    assert np.abs(np.diff(went, axis=0)).max() < 0.005
    assert not root_follow(off, np.zeros_like(states), 60.0, POSITIONS, BODY).any()


@given(st.floats(-0.05, 0.05), st.floats(-0.02, 0.02))
def test_hips_over_two_flat_feet_go_where_legs_that_lean_keep_their_lengths(nearer: float, higher: float) -> None:
    """Beside the middle between what both ask, where a foot set down 2 cm too high bends the straight leg over it."""
    positions = np.repeat(POSITIONS[:1], 60, axis=0)
    ankles, hips = ([row(side) for side in range(2)] for row in (BODY.layout.ankle_point, BODY.layout.hip_point))
    off, legs = np.zeros((2, 60, 3)), positions[:, ankles] - positions[:, hips]
    legs[:, :, 1] = [0.3, -0.3]
    positions[:, ankles] = positions[:, hips] + legs
    off[:, :, 1], off[:, :, 2] = [[-nearer], [nearer]], [[higher], [-higher]]
    went = root_follow(off, np.full((2, 60), 3), 60.0, positions, BODY)
    moved = legs.transpose(1, 0, 2) + off
    own, before = (np.linalg.norm(each, axis=-1) for each in (legs.transpose(1, 0, 2), moved))
    missed, in_the_middle = np.linalg.norm(moved - went, axis=-1) - own, before - own
    assert (np.linalg.norm(missed, axis=0) <= 0.9 * np.linalg.norm(in_the_middle, axis=0) + 1e-4).all()
    assert np.abs(went[:, :2]).max() < 0.1
    assert np.abs(went[:, 2]).max() < 0.02


def test_hips_over_feet_that_stand_as_in_the_motion_stay() -> None:
    assert not root_follow(np.zeros((2, 120, 3)), np.full((2, 120), 3), 60.0, POSITIONS, BODY).any()


@pytest.mark.parametrize("degrees", [-60.0, 60.0])
@pytest.mark.parametrize("along", [-0.035, -0.02, -0.005])
def test_a_foot_that_turns_on_its_heel_turns_about_the_heels_pad(along: float, degrees: float) -> None:
    """``along`` metres from the ankle towards the toes the actor's foot turns on; the heel's edge is at -0.05."""
    headings = np.radians(degrees) * np.clip((np.arange(120.0) - 42.0) / 30.0, 0.0, 1.0)
    feet = np.tile(np.eye(3), (120, 1, 1))
    feet[:, 0, 0] = feet[:, 1, 1] = np.cos(headings)
    feet[:, 1, 0] = np.sin(headings)
    feet[:, 0, 1] = -feet[:, 1, 0]
    ankles, anchored = [0.0, 0.0, 0.08] - along * feet[:, :, 0], np.empty((120, 3))
    states = np.where(np.abs(np.arange(120) - 57) <= 15, HEEL_STANDS, SOLE_STANDS)
    sole, level = np.array([[0.12, 0.0, -0.06, 0.08, 0.05, 0.06]]), np.zeros(120)
    anchor_ankles(ankles, feet, states, sole, level, level, 6, np.inf, anchored)
    assert np.linalg.norm(anchored - ankles, axis=1).max() < 0.02
