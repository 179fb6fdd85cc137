"""Joints that move in their parents: bones point where joints are, and no joint leaves its place."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.kinematics import joint_positions
from studio.core.body.moving_offsets import with_measured_offsets, with_rigid_bones
from studio.core.body.pose import PoseSequence
from studio.core.normalized.normalize import normalize_capture
from studio.core.normalized.round_trip import round_trip
from studio.core.rotations import inverse, multiply, rotate
from tests.core.motions import from_vectors, swaying


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
