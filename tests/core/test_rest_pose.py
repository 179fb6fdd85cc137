"""Poses of reference: at rest, neutral, and of single parts."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.morphology import Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.captures.capture import Capture
from studio.core.captures.reference_pose import find_reference_pose
from studio.core.mannequin.physiques import BUNDLED_PHYSIQUES
from studio.core.normalized.alignment import align_soles, find_alignments
from studio.core.normalized.landmarks import find_landmarks
from studio.core.rigs.zero_pose import with_zero_pose
from studio.core.rotations import angle_between, from_matrix, inverse, multiply, to_matrix
from studio.core.stage.local_pose import LocalPose, local_pose, posed_rotations
from tests.core.motions import HINGES, about, swaying

# The rest pose is the morphology, stood up.


BODIES = {name: physique.morphology() for name, (_, _, physique) in BUNDLED_PHYSIQUES.items()}


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


# The neutral pose: one for a skeleton, whatever its takes show.


UP, LEFT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
WITHIN = 10.0
"""Degrees."""


def _axes(seed: int, count: int) -> np.ndarray:
    """(J, 3, 3) axes of joints that lie along the body's own in any order."""
    random = np.random.default_rng(seed)
    frames = np.eye(3)[[random.permutation(3) for _ in range(count)]] * random.choice([-1.0, 1.0], (count, 1, 3))
    frames[:, :, 0] *= np.linalg.det(frames)[:, None]
    return np.asarray(frames)


def _turned(capture: Capture, joint: str, turn: np.ndarray) -> Capture:
    """The same motion with a joint turned by one more rotation."""
    rotations = np.array(capture.poses.local_rotations)
    index = capture.skeleton.index(joint)
    rotations[:, index] = multiply(turn, rotations[:, index])
    return replace(capture, poses=replace(capture.poses, local_rotations=rotations))


def _errors(capture: Capture, axes: np.ndarray) -> dict[str, float]:
    """Degrees between the reference pose that is found and that of a body whose zero pose is ``axes`` (J, 3, 3)."""
    assert capture.body_map is not None
    found = find_reference_pose(capture.skeleton, capture.poses, capture.body_map)
    assert found.source == "all frames"
    turns = joint_world(capture.skeleton, rest_poses(capture.skeleton, found.rotations))[1][0]
    apart = np.degrees(angle_between(from_matrix(turns), from_matrix(np.swapaxes(axes, 1, 2))))
    errors = {name: float(apart[capture.skeleton.index(name)]) for name in ("Head", "Chest", "LeftFoot", "RightFoot")}
    for side in ("Left", "Right"):  # the neutral elbow is bent, the neutral wrist is not
        hand, forearm = (capture.skeleton.index(f"{side}{name}") for name in ("Hand", "ForeArm"))
        bent = turns[hand].T @ turns[forearm] @ axes[forearm] @ axes[hand].T
        errors[f"{side}Hand"] = float(np.degrees(2 * np.arccos(np.clip(abs(from_matrix(bent)[3]), 0.0, 1.0))))
    return errors


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("joint", "axis", "degrees"),
    [("Head", UP, 40.0), ("Head", UP, -40.0), ("Head", LEFT, 20.0), ("Hips", LEFT, 60.0), ("Chest", UP, 30.0)],
    ids=["looks left", "looks right", "looks down", "leans far forward", "turns the shoulders"],
)
def test_head_hands_and_feet_are_found_whatever_the_take_does(
    seed: int, joint: str, axis: tuple[float, float, float], degrees: float
) -> None:
    calm = swaying(seed, frames=120, amplitude=0.15, hinged=True)
    take = _turned(calm, joint, about(axis, np.radians(degrees)))
    axes = np.swapaxes(_axes(seed, take.skeleton.joint_count), 1, 2)
    errors = _errors(with_zero_pose(take, axes), axes)
    assert max(errors.values()) < WITHIN, errors


@pytest.mark.parametrize(
    ("joint", "axis", "degrees"),
    [
        ("LeftForeArm", LEFT, 25.0),
        ("RightForeArm", LEFT, -25.0),
        ("LeftForeArm", LEFT, 50.0),
        ("RightFoot", (1.0, 0.0, 0.0), 15.0),
    ],
    ids=["a palm up", "a palm down", "a palm far up, the other as usual", "a foot on its edge"],
)
def test_what_a_take_keeps_twisted_is_not_neutral(joint: str, axis: tuple[float, float, float], degrees: float) -> None:
    calm = swaying(2, frames=120, amplitude=0.15, hinged=True)
    rotations = np.array(calm.poses.local_rotations)
    index = calm.skeleton.index(joint)
    rotations[:, index] = multiply(rotations[:, index], about(axis, np.radians(degrees)))
    take = replace(calm, poses=replace(calm.poses, local_rotations=rotations))
    axes = np.swapaxes(_axes(2, take.skeleton.joint_count), 1, 2)
    odd = [with_zero_pose(each, axes) for each in (calm, take)]
    found = [find_reference_pose(each.skeleton, each.poses, each.body_map).rotations for each in odd if each.body_map]
    assert np.degrees(angle_between(*found)[index]) < 5.0


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("degrees", [20.0, -40.0])
def test_soles_that_stand_are_level_however_the_joints_of_feet_are_rolled(seed: int, degrees: float) -> None:
    calm = swaying(seed, frames=120, amplitude=0.15, hinged=True)
    axes = np.swapaxes(_axes(seed, calm.skeleton.joint_count), 1, 2)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        foot, toe = (calm.skeleton.index(f"{side}{name}") for name in ("Foot", "ToeBase"))
        bone = calm.skeleton.offsets[toe] / np.linalg.norm(calm.skeleton.offsets[toe])
        axes[foot] = axes[foot] @ to_matrix(about(tuple(bone), sign * np.radians(degrees))).T
    errors = _errors(with_zero_pose(calm, axes), axes)
    assert max(errors["LeftFoot"], errors["RightFoot"]) < WITHIN, errors


def test_a_heel_that_is_raised_all_the_time_is_no_sole() -> None:
    take = _turned(swaying(3, frames=120, amplitude=0.05), "RightFoot", about(LEFT, np.radians(25.0)))
    assert take.body_map is not None
    marks = find_landmarks(take, take.body_map)
    alignments = find_alignments(marks)
    align_soles(marks, alignments, np.ones((len(marks.points), 2), dtype=bool), 60.0)
    left, right = (marks.layout.spine_count + 12 + 4 * side for side in (0, 1))
    assert np.degrees(angle_between(*from_matrix(alignments[[left, right]]))) < WITHIN


@pytest.mark.parametrize("standing", [(1.0, 1.0), (0.5, 1.0), (0.0, 0.0)], ids=["both", "one longer", "none"])
@pytest.mark.parametrize("degrees", [15.0, 25.0])
def test_a_raised_heel_tells_nothing_of_the_sole_of_a_skeleton_without_human_zero_pose(
    degrees: float, standing: tuple[float, float]
) -> None:
    calm = swaying(3, frames=120, amplitude=0.05)
    takes = [calm, _turned(calm, "RightFoot", about(LEFT, np.radians(degrees)))]
    axes = np.swapaxes(_axes(3, calm.skeleton.joint_count), 1, 2)
    feet = []
    for take in takes:
        odd = with_zero_pose(take, axes)
        assert odd.body_map is not None
        reference = find_reference_pose(odd.skeleton, odd.poses, odd.body_map)
        assert reference.source == "all frames"
        marks = find_landmarks(replace(odd, reference_rotations=reference.rotations), odd.body_map)
        alignments = find_alignments(marks)
        frames = np.arange(len(marks.points))[:, None]
        align_soles(marks, alignments, frames < np.array(standing) * len(frames), 60.0)
        feet.append(from_matrix(alignments[marks.layout.spine_count + 16]))
    assert np.degrees(angle_between(*feet)) < WITHIN


def test_an_elbow_that_bends_shows_its_hinge_and_one_that_is_straight_hardly_any() -> None:
    """Straight elbows bend aside by some degrees in captures of markers; the hinge is that of the frames which bend."""
    calm = swaying(4, frames=120, amplitude=0.1, hinged=True)
    rotations = np.array(calm.poses.local_rotations)
    index = calm.skeleton.index("LeftForeArm")
    bend = np.where(np.arange(120) < 80, np.radians(8.0), np.radians(90.0))
    aside = np.where(np.arange(120) < 80, np.radians(18.0), 0.0)
    rotations[:, index] = multiply(about(HINGES["LeftForeArm"], bend), about((1.0, 0.0, 0.0), aside))
    take = replace(calm, poses=replace(calm.poses, local_rotations=rotations))
    apart = []
    for each in (calm, take):
        assert each.body_map is not None
        marks = find_landmarks(each, each.body_map)
        apart.append(from_matrix(find_alignments(marks)[marks.layout.upper_arm_segment(0)]))
    assert np.degrees(angle_between(*apart)) < 5.0


def test_palms_of_a_human_zero_pose_look_down_wherever_elbows_bend() -> None:
    """The elbow of an actor with palms down bends upwards by some degrees; the palm is that of the T-pose."""
    forward = swaying(4, frames=120, amplitude=0.1, hinged=True)
    turn = about(LEFT, np.radians(30.0))
    elbow = forward.skeleton.index("LeftForeArm")
    rotations = np.array(forward.poses.local_rotations)
    rotations[:, elbow] = multiply(
        multiply(turn, about(HINGES["LeftForeArm"], np.full(120, np.radians(90.0)))), inverse(turn)
    )
    upward = replace(forward, poses=replace(forward.poses, local_rotations=rotations))
    arms = []
    for each in (forward, upward):
        assert each.body_map is not None
        marks = find_landmarks(each, each.body_map)
        first = marks.layout.upper_arm_segment(0)
        arms.append(from_matrix(find_alignments(marks)[first : first + 3]))
    upper_arm, forearm, hand = np.degrees(angle_between(*arms))
    assert upper_arm > 20.0
    assert forearm > 20.0
    assert hand < 0.01


def test_a_foot_that_stands_on_its_edge_for_a_while_keeps_a_level_sole() -> None:
    calm = swaying(3, frames=120, amplitude=0.02)
    rotations = np.array(calm.poses.local_rotations)
    index = calm.skeleton.index("RightFoot")
    edge = np.where(np.arange(120) < 50, np.radians(30.0), 0.0)
    rotations[:, index] = multiply(rotations[:, index], about((1.0, 0.0, 0.0), edge))
    feet = []
    for each in (calm, replace(calm, poses=replace(calm.poses, local_rotations=rotations))):
        assert each.body_map is not None
        marks = find_landmarks(each, each.body_map)
        alignments = find_alignments(marks)
        align_soles(marks, alignments, np.ones((len(marks.points), 2), dtype=bool), 60.0)
        feet.append(from_matrix(alignments[marks.layout.foot_segment(1)]))
    assert np.degrees(angle_between(*feet)) < 5.0


def test_a_take_in_which_nobody_stands_is_told_as_doubtful() -> None:
    lying = _turned(swaying(1, frames=60, amplitude=0.1), "Hips", about(LEFT, np.radians(90.0)))
    axes = np.swapaxes(_axes(1, lying.skeleton.joint_count), 1, 2)
    odd = with_zero_pose(lying, axes)
    assert odd.body_map is not None
    assert "never in a neutral stance" in find_reference_pose(odd.skeleton, odd.poses, odd.body_map).reason


def test_frames_in_which_all_joints_lie_in_one_place_decide_nothing() -> None:
    """Scales of zero in a few frames of a file: widths divided by each other were no numbers, and the eigenvalues."""
    calm = swaying(1, frames=120, amplitude=0.15, hinged=True)
    axes = np.swapaxes(_axes(1, calm.skeleton.joint_count), 1, 2)
    take = with_zero_pose(calm, axes)
    moves = np.array(take.poses.local_translations)
    moves[30:40, 1:] = 0.0
    flat = replace(take, poses=replace(take.poses, local_translations=moves))
    assert max(_errors(flat, axes).values()) < WITHIN


# Local poses: rotations of the parts of a body that fit bodies of any build.


@given(seed=st.integers(0, 2**32), spine_count=st.integers(3, 6))
def test_a_body_that_is_posed_has_that_pose(seed, spine_count):
    random = np.random.default_rng(seed)
    rotations = {part: tuple(random.uniform(-1.2, 1.2, 3)) for part in BodyPart}
    rotations[BodyPart.PELVIS] = (*rotations[BodyPart.PELVIS][:2], 0.0)
    layout = BodyLayout(spine_count)
    first = local_pose(layout, posed_rotations(layout, LocalPose(rotations, 1.0)), 1.0)
    again = local_pose(layout, posed_rotations(layout, first), 1.0)
    for part in BodyPart:
        assert again.rotations[part] == pytest.approx(first.rotations[part], abs=1e-7)
        if part is not BodyPart.PELVIS:
            assert first.rotations[part] == pytest.approx(rotations[part], abs=1e-7)


def test_a_body_of_two_vertebrae_bends_its_thorax_for_the_missing_abdomen():
    rotations = dict.fromkeys(BodyPart, (0.0, 0.0, 0.0))
    rotations |= {BodyPart.ABDOMEN: (0.0, 0.4, 0.0), BodyPart.THORAX: (0.0, 0.3, 0.0)}
    layout = BodyLayout(2)
    found = local_pose(layout, posed_rotations(layout, LocalPose(rotations, 1.0)), 1.0)
    assert found.rotations[BodyPart.THORAX] == pytest.approx((0.0, 0.7, 0.0))
