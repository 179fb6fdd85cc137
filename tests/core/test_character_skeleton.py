"""A character is an ordinary skeleton to other programs, and nothing is lost on the way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.character_skeleton import (
    character_body_map,
    character_poses,
    character_skeleton,
    joint_points,
    t_pose_rotations,
)
from studio.core.rotations import IDENTITY_QUATERNION
from studio.core.solver.adapt import adapt
from studio.core.solver.request import AdaptRequest
from studio.io.figure.body_maps import find_body
from studio.io.project.character_file import bundled_characters
from tests.builders import make_capture, make_morphology

BODIES = {name: character.morphology for name, character in bundled_characters().items()}
BODIES["five vertebrae"] = make_morphology(spine_count=5)


@pytest.fixture(params=BODIES)
def body(request):
    return BODIES[request.param]


def t_pose(body):
    skeleton = character_skeleton(body)
    poses = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    return dict(zip(skeleton.names, joint_world(skeleton, poses)[0][0], strict=True))


def test_the_zero_pose_has_level_arms_straight_legs_and_flat_soles(body):
    places = t_pose(body)
    for side, name in enumerate(("Left", "Right")):
        shoulder, elbow, wrist = (places[f"{name}{bone}"] for bone in ("Arm", "ForeArm", "Hand"))
        outward = np.array([0.0, 1.0 - 2.0 * side, 0.0])
        assert elbow - shoulder == pytest.approx(body.arm[side, 0] * outward)
        assert wrist - elbow == pytest.approx(body.arm[side, 1] * outward)
        hip, ankle = places[f"{name}UpLeg"], places[f"{name}Foot"]
        assert hip - ankle == pytest.approx([0.0, 0.0, body.leg[side].sum()])
        assert ankle[2] == pytest.approx(body.ankle_height[side])
        assert places[f"{name}ToeBase"] - ankle == pytest.approx(body.foot[side])


def test_it_is_as_tall_as_the_body(body):
    assert t_pose(body)["HeadEnd"][2] == pytest.approx(body.stature)


def test_joints_stand_depth_first_with_the_names_other_programs_know(body):
    skeleton = character_skeleton(body)
    assert skeleton.names[:2] == ("Hips", "Spine")
    assert all(
        skeleton.descendants(joint) == tuple(range(joint + 1, joint + 1 + len(skeleton.descendants(joint))))
        for joint in range(skeleton.joint_count)
    )


def test_our_own_search_finds_the_body_that_was_meant(body):
    skeleton = character_skeleton(body)
    poses = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    found = find_body(skeleton, joint_world(skeleton, poses)[0])
    assert found.body_map == character_body_map(body.layout)
    assert len(found.body_map.parts) == len(BodyPart) - 2


def test_an_adapted_motion_stands_in_its_joints_exactly(body):
    motion, _actor = normalize_capture(make_capture(frames=20))
    adapted = adapt(AdaptRequest(motion, body))
    positions, rotations = joint_world(character_skeleton(body), character_poses(adapted))
    points = list(joint_points(body.layout))
    assert np.abs(positions - adapted.positions[:, points]).max() < 1e-12
    canonical = rotations[:, :3] @ t_pose_rotations(body)[:3]
    assert canonical == pytest.approx(adapted.rotations[:, :3])


@given(leg=st.floats(0.5, 2.0), vertebrae=st.integers(2, 8), turn=st.floats(-3.0, 3.0))
def test_axes_of_the_t_pose_are_rotations_for_any_body(leg, vertebrae, turn):
    body = make_morphology(leg_scale=leg, spine_count=vertebrae)
    axes = t_pose_rotations(body)
    assert np.linalg.det(axes) == pytest.approx(np.ones(len(axes)))
    turned = Rotation.from_euler("z", turn).as_matrix() @ axes
    assert np.swapaxes(turned, 1, 2) @ turned == pytest.approx(np.tile(np.eye(3), (len(axes), 1, 1)))
