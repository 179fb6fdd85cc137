"""The body solved from a made walk: its joints lie where they should, and what is not shown rests plainly."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_world
from studio.core.markers.body_axes import arm_axes
from studio.core.markers.solve import SolvedBody, solve_body
from studio.core.markers.take import MarkerTake, track_body
from studio.core.rotations import angle_between, multiply, normalized
from tests.core.markers.made import made_body, made_trial


def _solved(only: tuple[str, ...] = ()) -> SolvedBody:
    markers, joints = made_body()
    wanted = {joint: track for joint, track in joints.items() if not only or joint.split("_")[1] in only}
    part = ("hip", "knee", "ankle", "heel", "toe", "thigh", "shank")
    tracks = {role: track for role, track in markers.items() if not only or role.endswith(part)}
    return solve_body(tracks, wanted, 0.0)


def test_every_joint_of_the_solved_body_lies_where_the_markers_put_it() -> None:
    solved = _solved()
    positions = joint_world(solved.skeleton, solved.poses)[0]
    for joint, truth in made_body()[1].items():
        off = np.linalg.norm(positions[:, solved.joints[joint]] - truth, axis=1)
        assert off.max() < 0.012, joint
    assert solved.resting == ()


def test_bones_never_change_their_length() -> None:
    solved = _solved()
    assert np.array_equal(solved.poses.local_translations[0, 1:], solved.poses.local_translations[77, 1:])


def test_the_zero_pose_is_a_t_pose_facing_x() -> None:
    solved = _solved()
    at = dict(zip(solved.skeleton.names, np.zeros((99, 3)), strict=False))
    for joint, name in enumerate(solved.skeleton.names):
        parent = int(solved.skeleton.parents[joint])
        above = at[solved.skeleton.names[parent]] if parent >= 0 else np.zeros(3)
        at[name] = above + solved.skeleton.offsets[joint]
    assert at["LeftHand"][1] > 0.6 > -0.6 > at["RightHand"][1]
    assert abs(at["LeftHand"][2] - at["LeftArm"][2]) < 1e-9
    assert at["LeftToe"][0] > at["LeftFoot"][0] + 0.1
    assert at["Head"][2] > at["Neck"][2] > at["Chest"][2] > at["Hips"][2] > at["LeftFoot"][2] > 0.0


def test_knees_bend_about_one_axis_and_the_right_way() -> None:
    """The made shank only ever turns back against the thigh, about the body's left."""
    solved = _solved()
    for side in ("LEFT", "RIGHT"):
        bend = solved.poses.local_rotations[:, solved.body_map[BodyPart[f"{side}_SHANK"]]]
        bend = bend * np.sign(bend[:, 3:])
        assert np.abs(bend[:, [0, 2]]).max() < 0.02
        assert bend[:, 1].min() > 0.0


def test_a_lower_body_has_arms_that_hang_still_and_says_so() -> None:
    solved = _solved(("hip", "knee", "ankle"))
    assert solved.resting == ("head", "arms")
    positions, _ = joint_world(solved.skeleton, solved.poses)
    at = solved.skeleton.index
    hands = positions[:, [at("LeftHand"), at("RightHand")], 2]
    shoulders = positions[:, [at("LeftArm"), at("RightArm")], 2]
    assert (shoulders - hands > 0.4).all()
    local = solved.poses.local_rotations[:, at("LeftForeArm")]
    assert angle_between(local, np.broadcast_to([0.0, 0.0, 0.0, 1.0], local.shape)).max() < 1e-6


def test_an_upper_body_stands_on_straight_legs_and_says_so() -> None:
    markers, joints = made_body()
    arms = {joint: track for joint, track in joints.items() if joint.split("_")[1] in ("shoulder", "elbow", "wrist")}
    tracks = {role: track for role, track in markers.items() if not role.endswith(("knee", "ankle", "heel", "toe"))}
    solved = solve_body(tracks, arms, 0.0)
    assert solved.resting == ("legs",)
    positions, _ = joint_world(solved.skeleton, solved.poses)
    at = solved.skeleton.index
    leg = positions[:, at("LeftUpLeg")] - positions[:, at("LeftFoot")]
    np.testing.assert_allclose(leg[:, :2], 0.0, atol=1e-6)


@pytest.mark.parametrize("turn", [0.0, 0.7, 3.0])
def test_a_body_that_walks_another_way_is_the_same_body(turn: float) -> None:
    about_z = np.array([0.0, 0.0, np.sin(turn / 2), np.cos(turn / 2)])
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    markers, joints = made_body()
    straight = solve_body(markers, joints, 0.0)
    turned = solve_body(
        {role: track @ matrix.T for role, track in markers.items()},
        {joint: track @ matrix.T for joint, track in joints.items()},
        0.0,
    )
    np.testing.assert_allclose(turned.skeleton.offsets, straight.skeleton.offsets, atol=1e-9)
    ours, theirs = turned.poses.local_rotations, straight.poses.local_rotations
    assert angle_between(ours[:, 0], multiply(about_z, theirs[:, 0])).max() < 1e-6
    assert angle_between(ours[:, 1:], theirs[:, 1:]).max() < 1e-6


def test_what_is_never_filled_moves_on_as_seen_from_the_pelvis() -> None:
    trial, marker_map = made_trial()
    points = trial.points.copy()
    points[100:, trial.labels.index("leftwrist")] = np.nan
    points[:10, [trial.labels.index(label) for label in ("leftfronthip", "rightfronthip")]] = np.nan
    followed = track_body(MarkerTake(trial.with_points(points), marker_map, steps=()))
    assert followed.first_frame == 10
    assert followed.unseen == 50
    assert all(np.isfinite(track).all() for track in followed.joints.values())


@pytest.mark.parametrize("out", [1.0, -1.0])
def test_a_forearm_with_one_point_at_its_wrist_bends_about_the_elbows_axis_wherever_it_points(out: float) -> None:
    """In a guard the forearm points forward and up; its roll came from the chest's front and flipped there."""
    bend = np.radians(np.linspace(20.0, 140.0, 50))
    side = "left" if out > 0.0 else "right"
    shoulder = np.tile([0.0, 0.2 * out, 1.4], (50, 1))
    elbow = shoulder + np.array([0.2, 0.1 * out, -0.2])
    along = normalized(elbow - shoulder)
    hinge = normalized(np.cross(along, [0.2, -0.3 * out, 1.0]))
    forearm = np.cos(bend)[:, None] * along + np.sin(bend)[:, None] * np.cross(hinge, along)
    joints = {f"{side}_elbow": elbow, f"{side}_wrist": elbow + 0.26 * forearm}
    thorax = np.tile(np.eye(3), (50, 1, 1))
    upper, lower = arm_axes(joints, {}, side, thorax, shoulder, 0.3)
    assert np.abs(np.einsum("fi,fi->f", upper[..., 2], lower[..., 2])).min() > 0.999
    assert np.einsum("fi,fi->f", lower[..., 2], upper[..., 2]).min() > 0.0


def test_a_point_of_a_hand_at_its_wrist_gives_the_hand_no_direction() -> None:
    """Sets of joint centres call the wrist a hand; the hand then pointed along the noise between the two."""
    markers, joints = made_body()
    given = markers | {f"{side}_hand": joints[f"{side}_wrist"] + 1e-4 for side in ("left", "right")}
    plain, solved = (solve_body(tracks, joints, 0.0) for tracks in (markers, given))
    assert np.array_equal(plain.poses.local_rotations, solved.poses.local_rotations)
    assert np.array_equal(plain.skeleton.offsets, solved.skeleton.offsets)
