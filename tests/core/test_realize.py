"""Realising: channels on a body, against a twin and by laws."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Proportions
from studio.core.kernels import layout as at
from studio.core.kernels.body.pose_from_channels import spine_sampling
from studio.core.kernels.limbs.limb import BONE_LINE_TOLERANCE
from studio.core.normalized.motion import NormalizedMotion
from studio.core.normalized.realize import girdle_of, realize_motion
from studio.core.rotations import inverse, normalized
from tests.builders import make_morphology
from tests.core.motions import walk
from tests.core.twins import body as body_twin
from tests.core.twins import realize as twin

seeds = st.integers(0, 2**32 - 1)
WALK = walk(30)[0]


def random_motion(seed: int, spine_count: int = 3, frames: int = 4) -> NormalizedMotion:
    """Any channels that mean something: unit quaternions, slack between 0 and 1."""
    random = np.random.default_rng(seed)
    channels = 0.3 * random.normal(size=(frames, at.SPINE + 4 * (spine_count - 1)))
    for first, count in (
        (at.PELVIS, 1), (at.NECK, 1), (at.HEAD, 1), (at.CLAVICLE, 2), (at.LIMB_FRAME, 4), (at.HAND, 2), (at.FOOT, 2),
        (at.TOE, 2), (at.SPINE, spine_count - 1),
    ):  # fmt: skip
        block = random.normal(size=(frames, count, 4))
        block /= np.linalg.norm(block, axis=-1, keepdims=True)
        channels[:, first : first + 4 * count] = block.reshape(frames, -1)
    channels[:, at.LIMB_SLACK : at.LIMB_SLACK + 4] = random.uniform(0.001, 0.8, size=(frames, 4))
    channels[:, at.LIMB_BEND : at.LIMB_BEND + 4] = random.choice([-1.0, 1.0], size=(frames, 4))
    places = np.concatenate([[0.0], np.sort(random.uniform(0.1, 0.9, size=spine_count - 2)), [1.0]])
    return NormalizedMotion("random", 60.0, channels, places)


@pytest.mark.parametrize("play", [False, True])
@given(seed=seeds, spine_count=st.integers(2, 6), own=st.integers(2, 7))
@settings(max_examples=15)
def test_the_kernel_agrees_with_its_twin(play: bool, seed: int, spine_count: int, own: int) -> None:
    motion, body = random_motion(seed, spine_count), make_morphology(spine_count=own)
    for result, expected in zip(realize_motion(motion, body, play=play), twin.realize(motion, body, play), strict=True):
        assert np.allclose(result, expected, atol=1e-8)


@given(seed=seeds, spine_count=st.integers(2, 6))
@settings(max_examples=15)
def test_bones_have_the_lengths_of_the_body(seed: int, spine_count: int) -> None:
    body = make_morphology(leg_scale=1.2, spine_count=spine_count)
    positions, rotations = realize_motion(random_motion(seed), body)
    lengths = body_twin.bone_lengths(body.layout, positions)
    hand, foot, toe = (np.linalg.norm(getattr(body, name), axis=1) for name in ("hand", "foot", "toe"))
    expected = [
        *np.linalg.norm(body.spine, axis=1), body.neck, body.head,
        *(x for s in (0, 1) for x in (body.clavicle[s], *body.arm[s], hand[s])),
        *(x for s in (0, 1) for x in (*body.leg[s], foot[s], toe[s])),
        *np.linalg.norm(body.collar_base, axis=1), *np.linalg.norm(body.hip_offset, axis=1),
    ]  # fmt: skip
    assert np.allclose(lengths, expected, atol=1e-9)
    assert np.allclose(np.swapaxes(rotations, -1, -2) @ rotations, np.eye(3), atol=1e-9)


@given(st.floats(0.3, 4.0))
@settings(max_examples=15)
def test_a_body_scaled_as_a_whole_moves_scaled_as_a_whole(factor: float) -> None:
    body = make_morphology()
    positions, rotations = realize_motion(WALK, body)
    larger, same = realize_motion(WALK, Proportions(stature=factor).applied_to(body))
    assert np.allclose(larger, factor * positions, atol=1e-12)
    assert np.allclose(same, rotations, atol=1e-12)


@given(seeds, st.integers(2, 12))
@settings(max_examples=15)
def test_however_many_vertebrae_wrists_keep_their_place_under_the_neck(seed: int, spine_count: int) -> None:
    motion = random_motion(seed)
    arms = {}
    for count in (3, spine_count):
        body = make_morphology(spine_count=count)
        positions, rotations = realize_motion(motion, body)
        neck, wrists = body.layout.neck_base, [body.layout.wrist_point(side) for side in (0, 1)]
        arms[count] = positions[:, wrists] - positions[:, [neck]], rotations[:, body.layout.segment_count - 16 :]
    for few, many in zip(arms[3], arms[spine_count], strict=True):
        assert np.allclose(few, many, atol=1e-12)


def test_the_pelvis_takes_the_pelvis_and_the_thorax_the_thorax() -> None:
    for spine_count in (2, 3, 5, 9):
        start, share = spine_sampling(np.array([0.0, 0.3, 0.8, 1.0]), make_morphology(spine_count=spine_count).packed)
        assert (start[0], share[0]) == (0, 0.0)
        assert (start[-1], share[-1]) == (3, 0.0)
        assert (np.diff(start + share) > 0.0).all()


def test_its_own_vertebrae_are_taken_as_they_are() -> None:
    spine = np.array([[0.0, 0.0, 0.1], [0.02, 0.0, 0.2], [0.0, 0.0, 0.15], [0.0, 0.0, 0.3]])
    places = np.cumsum([0.0, *np.linalg.norm(spine[:-1], axis=1)])
    start, share = spine_sampling(places / places[-1], replace(make_morphology(), spine=spine).packed)
    assert start.tolist() == [0, 1, 2, 3]
    assert not share.any()


def test_hips_and_head_stray_only_where_the_actor_is_played() -> None:
    still = WALK.channels.copy()
    still[:, at.HIP_SHIFT : at.HEAD_SHIFT + 3] = 0.0
    strayed = still + 0.0
    strayed[:, at.HIP_SHIFT : at.HEAD_SHIFT + 3] = 0.1
    body = make_morphology()
    rigid = realize_motion(replace(WALK, channels=still), body, play=True)[0]
    assert np.array_equal(realize_motion(replace(WALK, channels=strayed), body)[0], rigid)
    played = realize_motion(replace(WALK, channels=strayed), body, play=True)[0]
    moved = np.linalg.norm(played - rigid, axis=-1)[0]
    assert moved[body.layout.hip_point(0)] == pytest.approx(0.1 * body.leg_length * np.sqrt(3))
    assert moved[body.layout.head_joint] == pytest.approx(0.1 * body.neck * np.sqrt(3))
    assert moved[body.layout.neck_base] == 0.0


@given(st.floats(1.2, 5.0))
@settings(max_examples=10)
def test_wide_hips_go_over_the_feet_as_far_as_the_actors(wider: float) -> None:
    """Ahead of each other, and up: who turns on feet that stand keeps its legs, and its trunk turns as it is meant."""
    body = make_morphology()
    wide = replace(body, hip_offset=body.hip_offset * [1.0, wider, 1.0])
    turns = np.linspace(-1.0, 1.0, WALK.frame_count)[:, None] * [0.1, 0.0, 0.5, 0.0]
    channels, pelvis = WALK.channels.copy(), normalized(turns + np.array([0.0, 0.0, 0.0, 1.0]))
    channels[:, at.YAW], channels[:, at.PELVIS : at.PELVIS + 4] = 0.0, pelvis
    channels[:, at.FOOT : at.FOOT + 8] = np.tile(inverse(pelvis), 2)
    motion = replace(WALK, channels=channels, girdle=girdle_of(body))
    poses = [realize_motion(motion, each) for each in (body, wide)]
    left, right = (body.layout.hip_point(side) for side in (0, 1))
    ways = [positions[:, left] - positions[:, right] for positions, _ in poses]
    assert np.ptp(ways[0][:, [0, 2]], axis=0).min() > 0.03
    assert np.allclose(ways[0][:, [0, 2]], ways[1][:, [0, 2]], atol=1e-9)
    for part in (1, body.layout.segment_of_part(BodyPart.LEFT_THIGH), body.layout.segment_of_part(BodyPart.RIGHT_FOOT)):
        assert np.allclose(poses[0][1][:, part], poses[1][1][:, part], atol=1e-12)
    again = realize_motion(replace(motion, girdle=girdle_of(wide)), wide)
    assert np.allclose(again[1], poses[0][1], atol=1e-12)


def test_hips_whose_feet_lie_on_their_sides_turn_as_they_are_meant() -> None:
    body = make_morphology()
    wide = replace(body, hip_offset=body.hip_offset * [1.0, 3.0, 1.0])
    channels, aside = WALK.channels.copy(), [np.sin(np.pi / 4.0), 0.0, 0.0, np.cos(np.pi / 4.0)]
    channels[:, at.PELVIS : at.PELVIS + 4] = aside
    channels[:, at.FOOT : at.FOOT + 8] = [0.0, 0.0, 0.0, 1.0] * 2
    motion = replace(WALK, channels=channels, girdle=girdle_of(body))
    assert np.allclose(realize_motion(motion, wide)[1], realize_motion(motion, body)[1], atol=1e-12)


@given(st.floats(0.35, 0.65), st.floats(0.15, 0.98))
@settings(max_examples=20)
def test_bones_that_share_their_limb_otherwise_lie_nearly_as_the_actors_however_it_is_folded(part: float, reach: float):
    """A knee that is drawn up is drawn up on a long thigh too; the limb's line gives way, not the posture."""
    body = make_morphology()
    body = replace(body, leg=np.full((2, 2), body.leg.mean()))
    other = replace(body, leg=2.0 * body.leg.mean() * np.array([[part, 1.0 - part]] * 2))
    channels = WALK.channels.copy()
    channels[:, at.LIMB_SLACK + 2 : at.LIMB_SLACK + 4] = 1.0 - reach
    motion = replace(WALK, channels=channels, girdle=girdle_of(body))
    (_, own), (_, others) = (realize_motion(motion, each) for each in (body, other))
    for bone in (BodyPart.LEFT_THIGH, BodyPart.LEFT_SHANK):
        ways = (rotations[:, body.layout.segment_of_part(bone), :, 2] for rotations in (own, others))
        assert (np.sum(np.prod(np.stack(list(ways)), axis=0), axis=1) > np.cos(3.2 * BONE_LINE_TOLERANCE)).all()
    again = realize_motion(replace(motion, girdle=girdle_of(other)), other)[0]
    hip, ankle = body.layout.hip_point(0), body.layout.ankle_point(0)
    ways = [positions[:, ankle] - positions[:, hip] for positions in (again, realize_motion(motion, body)[0])]
    assert np.allclose(*(way / np.linalg.norm(way, axis=1, keepdims=True) for way in ways), atol=1e-9)


def test_channels_that_do_not_fit_their_spine_are_refused() -> None:
    with pytest.raises(ValueError, match="do not fit 5 spine segments"):
        replace(WALK, spine_places=np.linspace(0, 1, 5))


def test_a_motion_cannot_be_changed_afterwards() -> None:
    with pytest.raises(ValueError, match="read-only"):
        WALK.channels[0, 0] = 1.0
