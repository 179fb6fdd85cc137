"""The rest pose is the morphology, stood up."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.mannequin.physiques import BUNDLED

BODIES = {name: physique.morphology() for name, (_, _, physique) in BUNDLED.items()}


@pytest.fixture(params=BODIES)
def body(request: pytest.FixtureRequest) -> Morphology:
    return BODIES[request.param]


def test_every_bone_of_the_rest_pose_has_the_length_its_morphology_says(body: Morphology):
    positions, _ = rest_pose(body)
    layout = body.layout
    assert np.diff(positions[: layout.neck_base + 1], axis=0) == pytest.approx(body.spine)
    for side in (0, 1):
        arm, leg = layout.collar_point(side), layout.hip_point(side)
        arm_bones = np.linalg.norm(np.diff(positions[arm : arm + 5], axis=0), axis=1)
        expected = (body.clavicle[side], *body.arm[side], np.linalg.norm(body.hand[side]))
        assert arm_bones == pytest.approx(expected)
        leg_bones = np.linalg.norm(np.diff(positions[leg : leg + 3], axis=0), axis=1)
        assert leg_bones == pytest.approx(body.leg[side])


def test_every_segment_points_along_its_bone_in_a_right_handed_frame(body: Morphology):
    positions, rotations = rest_pose(body)
    assert np.einsum("sji,sjk->sik", rotations, rotations) == pytest.approx(np.tile(np.eye(3), (22, 1, 1)))
    assert np.linalg.det(rotations) == pytest.approx(np.ones(22))
    layout = body.layout
    for part in BodyPart:
        segment = layout.segment_of_part(part)
        if part.value.split("_")[-1] in (
            "neck",
            "head",
            "clavicle",
            "arm",
            "forearm",
            "thigh",
            "shank",
            "hand",
        ):
            bone = positions[layout.distal_points()[segment]] - positions[layout.proximal_points()[segment]]
            assert rotations[segment][:, 2] == pytest.approx(bone / np.linalg.norm(bone))


def test_it_stands_with_flat_feet_below_the_root_and_the_crown_at_its_stature(body: Morphology):
    positions, _ = rest_pose(body)
    layout = body.layout
    assert positions[0, :2] == pytest.approx([0, 0])
    assert positions[layout.head_end, 2] == pytest.approx(body.stature)
    for side in (0, 1):
        assert positions[layout.ankle_point(side), 2] == pytest.approx(body.ankle_height[side])
        assert positions[layout.toe_point(side), 2] == pytest.approx(body.toe_height[side])


def test_flexion_about_the_hinge_brings_the_hand_forward_and_the_shank_back(body: Morphology):
    _, rotations = rest_pose(body)
    for part, forward in (
        (BodyPart.LEFT_UPPER_ARM, 1),
        (BodyPart.RIGHT_UPPER_ARM, 1),
        (BodyPart.LEFT_THIGH, -1),
        (BodyPart.RIGHT_THIGH, -1),
    ):
        frame = rotations[body.layout.segment_of_part(part)]
        assert forward * np.cross(frame[:, 0], frame[:, 2])[0] > 0.99


def test_the_sides_mirror_each_other(body: Morphology):
    positions, _ = rest_pose(body)
    layout = body.layout
    for left, right in ((layout.collar_point(0), layout.collar_point(1)), (layout.hip_point(0), layout.hip_point(1))):
        assert positions[left : left + 5] * [1, -1, 1] == pytest.approx(positions[right : right + 5])


def test_the_longer_of_two_unequal_legs_bends_its_knee_forward():
    body = BODIES["tall_man"]
    longer = replace(body, leg=body.leg + np.array([[0, 0], [0.03, 0.02]]))
    positions, _ = rest_pose(longer)
    hip, knee, ankle = positions[longer.layout.hip_point(1) :][:3]
    assert ankle[2] == pytest.approx(longer.ankle_height[1])
    assert np.linalg.norm(knee - hip) == pytest.approx(longer.leg[1, 0])
    assert np.linalg.norm(ankle - knee) == pytest.approx(longer.leg[1, 1])
    assert knee[0] > ankle[0] + 0.05
