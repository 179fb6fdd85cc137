"""Skeletons and their poses: one tree, finite quaternions, joints where formulas have them."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.kinematics import joint_positions, joint_world, rest_poses
from studio.core.body.moving_offsets import with_measured_offsets, with_rigid_bones
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.kernels.body.file_channels import (
    IGNORED_CHANNEL,
    POSITION_CHANNEL,
    ROTATION_CHANNEL,
    change_axes,
    pose_joints,
)
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.realize import realize_motion
from studio.core.normalized.round_trip import round_trip
from studio.core.rotations import (
    IDENTITY_QUATERNION,
    from_euler,
    inverse,
    multiply,
    normalized,
    rotate,
    sign_continuous,
    to_matrix,
)
from tests.builders import make_capture, make_morphology
from tests.core.motions import from_vectors, swaying

# A skeleton is one tree of named joints, or it is not made.


def _skeleton(names: str = "hips spine head leg foot", parents: tuple[int, ...] = (-1, 0, 1, 0, 3)) -> Skeleton:
    words = tuple(names.split())
    return Skeleton(words, np.array(parents), np.zeros((len(words), 3)), np.zeros(len(words), dtype=bool))


def test_a_skeleton_knows_its_tree() -> None:
    skeleton = _skeleton()
    assert skeleton.children == ((1, 3), (2,), (), (4,), ())
    assert skeleton.depths == (0, 1, 2, 1, 2)
    assert skeleton.path(0, 4) == (0, 3, 4)
    assert skeleton.path(1, 4) == ()
    assert skeleton.common_ancestor(2, 4) == 0
    assert skeleton.descendants(0) == (1, 2, 3, 4)


def test_its_arrays_are_frozen() -> None:
    with pytest.raises(ValueError, match="read-only"):
        _skeleton().offsets[0] = 1.0


# Poses are finite unit quaternions without jumps of sign.


def _rotations(frames: int = 4, joints: int = 3) -> np.ndarray:
    return np.random.default_rng(0).normal(size=(frames, joints, 4))


def test_quaternions_become_unit_and_continuous() -> None:
    poses = PoseSequence(_rotations(), np.zeros((4, 3, 3)))
    assert np.allclose(np.linalg.norm(poses.local_rotations, axis=2), 1.0)
    assert (np.sum(poses.local_rotations[1:] * poses.local_rotations[:-1], axis=2) >= 0).all()
    assert (poses.frame_count, poses.joint_count) == (4, 3)


def test_translations_are_copied_unless_nobody_can_write_to_them() -> None:
    rotations, own = np.tile([0.0, 0.0, 0.0, 1.0], (2, 1, 1)), np.zeros((2, 1, 3))
    poses = PoseSequence(rotations, own)
    own[:] = 1.0
    assert (poses.local_translations == 0.0).all()
    own.setflags(write=False)
    assert PoseSequence(rotations, own).local_translations is own


def test_rotations_that_their_caller_gives_up_are_not_copied() -> None:
    given = _rotations()
    copied = PoseSequence(given, np.zeros((4, 3, 3)))
    assert not np.shares_memory(copied.local_rotations, given)
    own = PoseSequence(given, np.zeros((4, 3, 3)), own=True)
    assert np.shares_memory(own.local_rotations, given)
    assert np.array_equal(own.local_rotations, copied.local_rotations)


def test_signs_are_those_that_lie_nearest_to_the_frame_before() -> None:
    given = _rotations(200, 5)
    poses = PoseSequence(given, np.zeros((200, 5, 3)))
    assert poses.local_rotations == pytest.approx(sign_continuous(normalized(given)), abs=1e-15)


def test_frames_are_counted_with_both_ends() -> None:
    poses = PoseSequence(_rotations(), np.arange(36.0).reshape(4, 3, 3))
    part = poses.frames(1, 2)
    assert part.frame_count == 2
    assert np.array_equal(part.local_translations, poses.local_translations[1:3])


# Forward kinematics: the kernel against a plain twin, and poses that can be told by eye.


def _tree(joints: int, seed: int = 0) -> Skeleton:
    random = np.random.default_rng(seed)
    parents = np.array([-1, *(random.integers(0, joint) for joint in range(1, joints))])
    names = tuple(f"joint{joint}" for joint in range(joints))
    return Skeleton(names, parents, random.normal(size=(joints, 3)), np.zeros(joints, dtype=bool))


def _joint_world_twin(skeleton: Skeleton, poses: PoseSequence) -> tuple[np.ndarray, np.ndarray]:
    rotations = to_matrix(poses.local_rotations)
    positions = np.array(poses.local_translations)
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            carried = np.einsum("fij,fj->fi", rotations[:, parent], poses.local_translations[:, joint])
            positions[:, joint] = positions[:, parent] + carried
            rotations[:, joint] = rotations[:, parent] @ rotations[:, joint]
    return positions, rotations


def test_the_kernel_agrees_with_its_twin() -> None:
    skeleton, random = _tree(20), np.random.default_rng(1)
    poses = PoseSequence(random.normal(size=(9, 20, 4)), random.normal(size=(9, 20, 3)))
    for result, expected in zip(joint_world(skeleton, poses), _joint_world_twin(skeleton, poses), strict=True):
        assert np.allclose(result, expected, atol=1e-12)


def test_a_bent_elbow_puts_the_hand_where_it_should_be() -> None:
    offsets = np.array([[0.0, 0, 1], [0.3, 0, 0], [0.2, 0, 0]])
    arm = Skeleton(("shoulder", "elbow", "hand"), np.array([-1, 0, 1]), offsets, np.zeros(3, dtype=bool))
    quarter = from_euler("Z", np.array([np.pi / 2]))
    positions, rotations = joint_world(
        arm, rest_poses(arm, np.stack([IDENTITY_QUATERNION, quarter, IDENTITY_QUATERNION]))
    )
    assert np.allclose(positions[0], [[0, 0, 1], [0.3, 0, 1], [0.3, 0.2, 1]])
    assert np.allclose(rotations[0, 2] @ [1, 0, 0], [0, 1, 0])


# Joints that move in their parents: bones point where joints are, and no joint leaves its place.


def test_rotations_that_shake_and_positions_that_take_it_back_are_one_movement() -> None:
    capture = swaying(4, frames=90, amplitude=0.4, hinged=True)
    skeleton, local = capture.skeleton, np.array(capture.poses.local_rotations)
    moves = np.array(capture.poses.local_translations)
    shakes = from_vectors(0.07 * np.random.default_rng(1).normal(size=(90, 2, 3)))
    for number, (joint, end) in enumerate((("LeftUpLeg", "LeftLeg"), ("RightArm", "RightForeArm"))):
        at, below = skeleton.index(joint), skeleton.index(end)
        back = inverse(shakes[:, number])
        local[:, at] = multiply(local[:, at], shakes[:, number])
        local[:, below], moves[:, below] = multiply(back, local[:, below]), rotate(back, moves[:, below])
    shaken = PoseSequence(local, moves)
    assert capture.body_map is not None
    followed, swing = with_rigid_bones(skeleton, shaken, capture.body_map)
    assert swing > np.radians(3.0)
    assert joint_positions(skeleton, followed) == pytest.approx(joint_positions(skeleton, capture.poses), abs=1e-9)
    steady = replace(capture, poses=followed)
    assert round_trip(steady, *normalize_capture(steady)).position < 1e-3


def test_a_motion_whose_joints_lie_still_is_left_alone() -> None:
    capture = swaying(4)
    assert capture.body_map is not None
    assert with_rigid_bones(capture.skeleton, capture.poses, capture.body_map) == (capture.poses, 0.0)
    assert with_measured_offsets(capture.skeleton, capture.poses) is capture.skeleton


def test_offsets_that_are_zero_are_taken_from_the_motion() -> None:
    capture = swaying(4)
    bare = replace(capture.skeleton, offsets=np.zeros_like(capture.skeleton.offsets))
    seen = with_measured_offsets(bare, capture.poses)
    assert seen.offsets[1:] == pytest.approx(capture.skeleton.offsets[1:])


# Channels of a motion file become the joints that whole-array formulas give.


ORDERS = ["".join(axes) for count in (1, 2, 3) for axes in permutations("XYZ", count)] + ["XYX", "ZXZ"]


@pytest.mark.parametrize("order", ORDERS)
def test_turns_follow_each_other_in_the_order_of_the_file(order: str) -> None:
    degrees = np.random.default_rng(len(order)).uniform(-400.0, 400.0, size=(5, len(order)))
    axes, turning = np.array(["XYZ".index(axis) for axis in order]), np.full(len(order), ROTATION_CHANNEL)
    rotations, translations, still = np.empty((5, 2, 4)), np.empty((5, 2, 3)), np.arange(6.0).reshape(2, 3)
    second = np.ones(len(order), dtype=np.int64)
    pose_joints(degrees, second, turning, axes, still, still, rotations, translations)
    assert rotations[:, 1] == pytest.approx(from_euler(order, np.radians(degrees)), abs=1e-15)
    assert (rotations[:, 0] == [0.0, 0.0, 0.0, 1.0]).all()
    assert (translations == still).all()


def test_a_position_is_added_to_its_start_and_a_scale_does_nothing() -> None:
    rotations, translations = np.empty((1, 2, 4)), np.empty((1, 2, 3))
    starts, offsets = np.array([[0.0, 0.0, 0.0], [7.0, 8.0, 9.0]]), np.ones((2, 3))
    joints, deeds, axes = (
        np.array([0, 1, 1]),
        np.array([POSITION_CHANNEL, POSITION_CHANNEL, IGNORED_CHANNEL]),
        np.array([1, 2, 0]),
    )
    pose_joints(np.array([[5.0, 0.5, 3.0]]), joints, deeds, axes, starts, offsets, rotations, translations)
    assert translations.tolist() == [[[1.0, 5.0, 1.0], [1.0, 1.0, 9.5]]]


@given(st.integers(0, 2**32 - 1), st.floats(1e-3, 10.0))
def test_axes_that_are_turned_turn_what_is_seen_in_them(seed: int, metres: float) -> None:
    random = np.random.default_rng(seed)
    turns, places = random.normal(size=(3, 2, 4)), random.normal(size=(3, 2, 3))
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    axes = to_matrix(from_euler("ZXY", random.uniform(-4.0, 4.0, size=3)))
    out_turns, out_places = np.empty_like(turns), np.empty_like(places)
    change_axes(turns, places, axes, metres, out_turns, out_places)
    assert to_matrix(out_turns) == pytest.approx(axes @ to_matrix(turns) @ axes.T, abs=1e-12)
    assert out_places == pytest.approx(metres * places @ axes.T, abs=1e-12)


@pytest.mark.parametrize("body", [make_morphology(), make_morphology(0.7, 1.3, 4)], ids=["alike", "other"])
def test_a_posed_body_gives_the_motion_that_poses_it_so(body):
    motion, _ = normalize_capture(make_capture(frames=40, seed=3))
    positions, rotations = realize_motion(motion, body)
    again = realize_motion(encode_motion(positions, rotations, body, motion.frame_rate), body)
    assert np.abs(again[0] - positions).max() < 1e-6
    assert np.abs(again[1] - rotations).max() < 1e-6
