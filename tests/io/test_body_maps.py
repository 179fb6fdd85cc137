"""Body maps by names: numbers behind them, limbs in two joints, feet that hang elsewhere."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions, joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.rehanging import reparented_motion, reparented_order, with_body_over_feet
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import from_matrix
from studio.io.figure.body_maps import find_body, loose_feet, loose_hands, named_sides
from tests.builders import make_poses, make_skeleton
from tests.core.motions import random_rotations
from tests.io.character_files import JOINTS, NAMES, PLACES

POINTS = PLACES[:, [2, 0, 1]]
HALVED = {"UpperArm": "upperarm", "LowerArm": "lowerarm", "UpperLeg": "upperleg", "LowerLeg": "lowerleg"}


def _skeleton(joints: list[tuple[str, str | None, np.ndarray]]) -> tuple[Skeleton, np.ndarray]:
    names = [name for name, _, _ in joints]
    parents = np.array([names.index(parent) if parent else -1 for _, parent, _ in joints])
    points = np.array([place for _, _, place in joints])
    offsets = points - points[np.maximum(parents, 0)]
    return Skeleton(tuple(names), parents, offsets, np.zeros(len(names), bool)), points[None]


def _halved() -> list[tuple[str, str | None, np.ndarray]]:
    """The stick figure whose limb bones have two joints each, named as MakeHuman does."""
    ends = dict(zip(NAMES, POINTS, strict=True))
    called: dict[str, str] = {}
    joints: list[tuple[str, str | None, np.ndarray]] = []
    for name, parent, _ in JOINTS:
        side = "L" if name.startswith("left") else "R"
        bare = name.removeprefix("left").removeprefix("right")
        above = called.get(parent) if parent else None
        if bare not in HALVED:
            called[name] = {"Hand": f"wrist.{side}", "Foot": f"foot.{side}", "Toes": f"toe1-1.{side}"}.get(bare, name)
            joints.append((called[name], above, ends[name]))
            continue
        below = next(ends[child] for child, carrier, _ in JOINTS if carrier == name)
        joints.append((f"{HALVED[bare]}01.{side}", above, ends[name]))
        joints.append((f"{HALVED[bare]}02.{side}", joints[-1][0], 0.5 * (ends[name] + below)))
        called[name] = joints[-1][0]
    return joints


def test_of_two_joints_in_a_limb_bone_the_upper_one_is_its_part() -> None:
    skeleton, points = _skeleton(_halved())
    found = find_body(skeleton, points).body_map
    assert found is not None
    for part, name in (
        (BodyPart.LEFT_UPPER_ARM, "upperarm01.L"),
        (BodyPart.LEFT_FOREARM, "lowerarm01.L"),
        (BodyPart.LEFT_HAND, "wrist.L"),
        (BodyPart.RIGHT_THIGH, "upperleg01.R"),
        (BodyPart.RIGHT_SHANK, "lowerleg01.R"),
        (BodyPart.RIGHT_FOOT, "foot.R"),
    ):
        assert skeleton.names[found[part]] == name


def test_of_two_joints_called_head_the_lower_one_is_the_neck_if_none_is_called_so() -> None:
    called = {"Neck": "Head", "Head": "Head1"}
    skeleton = make_skeleton()
    inner = ~skeleton.end_sites
    places = np.cumsum(inner) - 1
    names = tuple(called.get(name, name) for name, kept in zip(skeleton.names, inner, strict=True) if kept)
    parents = np.array([-1, *places[skeleton.parents[inner][1:]]])
    twice = Skeleton(names, parents, skeleton.offsets[inner], np.zeros(len(names), bool))
    found = find_body(twice, joint_positions(twice, make_poses(twice))).body_map
    assert found is not None
    assert [twice.names[found[part]] for part in (BodyPart.NECK, BodyPart.HEAD)] == ["Head", "Head1"]


@pytest.mark.parametrize("spelling", ["{s}{name}_0{number}", "{s}{name}.0{number}", "{s}{name}{number}"])
def test_names_with_a_number_behind_are_understood(spelling: str) -> None:
    words = {
        "UpperArm": "Shldr", "LowerArm": "ForeArm", "Hand": "Hand", "UpperLeg": "Thigh", "LowerLeg": "Shin",
        "Foot": "Foot", "Toes": "Toe",
    }  # fmt: skip

    def called(name: str) -> str:
        number = 40 + NAMES.index(name)
        bare = name.removeprefix("left").removeprefix("right")
        side = "" if bare == name else name[0]
        return spelling.format(s=side, name=words.get(bare, bare), number=number)

    joints = [
        (called(name), called(parent) if parent else None, place)
        for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)
    ]
    skeleton, points = _skeleton(joints)
    found = find_body(skeleton, points)
    assert found.body_map is not None
    assert skeleton.names[found.body_map[BodyPart.LEFT_THIGH]] == called("leftUpperLeg")
    assert skeleton.names[found.body_map[BodyPart.RIGHT_HAND]] == called("rightHand")
    assert named_sides(skeleton)[found.body_map[BodyPart.LEFT_FOOT]] == 1


NAMINGS = {
    "MikuMikuDance": (
        "下半身 上半身 上半身2 首 頭", "{j}腕 {j}ひじ {j}手首", "{j}足 {j}ひざ {j}足首 {j}つま先"),
    "MikuMikuDance in Blender": (
        "センター 上半身 上半身2 首 頭", "腕.{S} ひじ.{S} 手首.{S}", "足.{S} ひざ.{S} 足首.{S} つま先.{S}"),
    "MikuMikuDance in English": (
        "center upper_body upper_body2 neck head", "arm_{S} elbow_{S} wrist_{S}", "leg_{S} knee_{S} ankle_{S} toe_{S}"),
    "VRChat": (
        "Hips Spine Chest Neck Head", "{Side}_arm {Side}_elbow {Side}_wrist",
        "{Side}_leg {Side}_knee {Side}_ankle {Side}_toe"),
    "Meta Movement": (
        "Hips SpineLower Chest Neck Head", "{Side}ArmUpper {Side}ArmLower {Side}HandWrist",
        "{Side}UpperLeg {Side}LowerLeg {Side}FootAnkle {Side}FootBall"),
    "Source": (
        "pelvis spine_0 spine_1 neck_0 head", "arm_upper_{S} arm_lower_{S} hand_{S}",
        "leg_upper_{S} leg_lower_{S} ankle_{S} ball_{S}"),
    "Second Life": (
        "mPelvis mTorso mChest mNeck mHead", "mShoulder{Side} mElbow{Side} mWrist{Side}",
        "mHip{Side} mKnee{Side} mAnkle{Side} mFoot{Side}"),
    "Advanced Skeleton": (
        "Root_M Spine1_M Chest_M Neck_M Head_M", "Shoulder_{S} Elbow_{S} Wrist_{S}",
        "Hip_{S} Knee_{S} Ankle_{S} Toes_{S}"),
    "sides before an underscore": (
        "C_hip_jnt C_spine_jnt C_chest_jnt C_neck_jnt C_head_jnt", "{lf}_shoulder_jnt {lf}_elbow_jnt {lf}_wrist_jnt",
        "{lf}_hip_jnt {lf}_knee_jnt {lf}_ankle_jnt {lf}_ball_jnt"),
    "Theia": (
        "pelvis abdomen thorax neck head", "{s}_uarm {s}_larm {s}_hand", "{s}_thigh {s}_shank {s}_foot {s}_toes"),
    "Rigify": (
        "DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.004 DEF-spine.006",
        "DEF-upper_arm.{S} DEF-forearm.{S} DEF-hand.{S}", "DEF-thigh.{S} DEF-shin.{S} DEF-foot.{S} DEF-toe.{S}"),
    "Mixamo": (
        "mixamorigHips mixamorigSpine mixamorigSpine1 mixamorigNeck mixamorigHead",
        "mixamorig{Side}Arm mixamorig{Side}ForeArm mixamorig{Side}Hand",
        "mixamorig{Side}UpLeg mixamorig{Side}Leg mixamorig{Side}Foot mixamorig{Side}ToeBase"),
}  # fmt: skip
"""Names of the trunk, and of arms and legs of either side."""


def _called(trunk: str, arm: str, leg: str) -> dict[str, str]:
    """Names by those of the stick figure."""
    words = [*trunk.split()]
    for limb in (arm, leg):
        for side, j, lf in (("left", "左", "lf"), ("right", "右", "rt")):
            words += limb.format(s=side[0], S=side[0].upper(), Side=side.title(), j=j, lf=lf).split()
    return dict(zip(NAMES, words, strict=True))


@pytest.mark.parametrize("frame", ["{name}", "{name}_0{number}", "Bob{name}", "Group_1:Char_A:{name}"])
@pytest.mark.parametrize("naming", NAMINGS)
def test_the_names_of_other_programs_are_understood_behind_any_beginning(naming: str, frame: str) -> None:
    called = {
        own: frame.format(name=name, number=place)
        for place, (own, name) in enumerate(_called(*NAMINGS[naming]).items())
    }
    skeleton, points = _skeleton([(called[name], called[parent] if parent else None, place)
                                  for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)])  # fmt: skip
    found = find_body(skeleton, points).body_map
    assert found is not None
    shown = {part: skeleton.names[joint] for part, joint in found.parts.items()}
    ours = {"UpperArm": "UPPER_ARM", "LowerArm": "FOREARM", "Hand": "HAND", "UpperLeg": "THIGH", "LowerLeg": "SHANK",
            "Foot": "FOOT", "Toes": "TOE"}  # fmt: skip
    right = {BodyPart.PELVIS: called["hips"], BodyPart.NECK: called["neck"], BodyPart.HEAD: called["head"]}
    right |= {BodyPart[f"{side.upper()}_{part}"]: called[side + name]
              for side in ("left", "right") for name, part in ours.items()}  # fmt: skip
    assert shown == right


def test_the_ball_of_a_foot_is_its_toe_joint_where_the_tip_of_the_toes_is_one_too() -> None:
    called = _called("hip spine chest neck head", "{Side}Shoulder {Side}Elbow {Side}Wrist",
                     "{Side}Hip {Side}Knee {Side}Ankle {Side}Ball")  # fmt: skip
    joints = [(called[name], called[parent] if parent else None, place)
              for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)]  # fmt: skip
    tips = [(called[side + "Toes"].replace("Ball", "Toe"), called[side + "Toes"],
             POINTS[NAMES.index(side + "Toes")] + [0.07, 0.0, 0.0]) for side in ("left", "right")]  # fmt: skip
    skeleton, points = _skeleton([*joints, *tips])
    found = find_body(skeleton, points).body_map
    assert found is not None
    assert [skeleton.names[found[part]] for part in (BodyPart.LEFT_TOE, BodyPart.RIGHT_TOE)] == [
        "LeftBall",
        "RightBall",
    ]


def _loose() -> tuple[Skeleton, np.ndarray]:
    """The stick figure whose feet hang from a root below its hips."""
    joints = [
        (name, "root" if name.endswith("Foot") or parent is None else parent, place)
        for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)
    ]
    return _skeleton([("root", None, np.zeros(3)), *joints])


def test_feet_that_hang_from_the_root_are_hung_from_the_shanks() -> None:
    skeleton, points = _loose()
    loose = loose_feet(skeleton)
    assert {skeleton.names[foot]: skeleton.names[shank] for foot, shank in loose.items()} == {
        "leftFoot": "leftLowerLeg", "rightFoot": "rightLowerLeg",
    }  # fmt: skip
    turns = from_matrix(random_rotations(np.random.default_rng(0), 5, skeleton.joint_count))
    poses = PoseSequence(turns, np.tile(skeleton.offsets, (5, 1, 1)))
    hanging = reparented_order(skeleton.parents, loose)
    after, moved = reparented_motion(skeleton, poses, hanging)
    assert joint_positions(after, moved) == pytest.approx(joint_positions(skeleton, poses)[:, hanging.order])
    found = find_body(after, points[:, hanging.order]).body_map
    assert found is not None
    assert after.names[found[BodyPart.LEFT_FOOT]] == "leftFoot"


def test_hands_that_hang_from_the_root_are_hung_from_the_forearms() -> None:
    joints = [(name, "root" if name.endswith("Hand") else parent or "root", place)
              for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)]  # fmt: skip
    skeleton, points = _skeleton([("root", None, np.zeros(3)), *joints])
    hands = loose_hands(skeleton)
    assert {skeleton.names[hand]: skeleton.names[forearm] for hand, forearm in hands.items()} == {
        "leftHand": "leftLowerArm", "rightHand": "rightLowerArm",
    }  # fmt: skip
    hanging = reparented_order(skeleton.parents, hands)
    after, _ = reparented_motion(
        skeleton, PoseSequence(np.tile([0.0, 0, 0, 1], (1, skeleton.joint_count, 1)), points), hanging
    )
    found = find_body(after, points[:, hanging.order]).body_map
    assert found is not None
    assert after.names[found[BodyPart.RIGHT_HAND]] == "rightHand"


def _walking(behind: float, apart: float = 0.0) -> tuple[Skeleton, PoseSequence, PoseSequence]:
    """Legs that swing over feet of the root, with the body ``behind`` by so much at last, and as it should be."""
    skeleton, _ = _loose()
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (9, skeleton.joint_count, 1))
    swing = 0.4 * np.sin(np.linspace(0.0, 6.0, 9))
    moves = np.tile(skeleton.offsets, (9, 1, 1))
    hips = skeleton.index("hips")
    moves[:, hips, 0] += np.linspace(0.0, behind, 9)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        thigh, shank, foot = (skeleton.index(f"{side}{name}") for name in ("UpperLeg", "LowerLeg", "Foot"))
        turns[:, thigh] = np.stack([0.0 * swing, np.sin(sign * swing / 2), 0.0 * swing, np.cos(swing / 2)], axis=1)
        there, world = joint_world(skeleton, PoseSequence(turns, moves))
        still = joint_positions(skeleton, PoseSequence(turns[:1] * 0.0 + [0.0, 0.0, 0.0, 1.0], skeleton.offsets[None]))[
            0
        ]
        moves[:, foot] = there[:, shank] + world[:, shank] @ (still[foot] - still[shank])
        moves[:, foot, 0] += sign * apart
    right = PoseSequence(turns, moves)
    wrong = moves.copy()
    wrong[:, hips] = skeleton.offsets[hips]
    return skeleton, PoseSequence(turns, wrong), right


def test_a_body_that_its_feet_leave_behind_is_brought_over_them() -> None:
    skeleton, wrong, right = _walking(1.5)
    found, behind = with_body_over_feet(skeleton, wrong, loose_feet(skeleton))
    assert behind == pytest.approx(1.5)
    assert joint_positions(skeleton, found) == pytest.approx(joint_positions(skeleton, right), abs=1e-9)
    assert with_body_over_feet(skeleton, right, loose_feet(skeleton)) == (right, 0.0)


def test_feet_that_end_the_shanks_in_motion_are_left_there_wherever_the_zero_pose_has_them() -> None:
    skeleton, _, right = _walking(1.5)
    offsets = skeleton.offsets.copy()
    offsets[[skeleton.index("leftFoot"), skeleton.index("rightFoot")]] = 0.0
    skeleton = Skeleton(skeleton.names, skeleton.parents, offsets, skeleton.end_sites)
    assert with_body_over_feet(skeleton, right, loose_feet(skeleton)) == (right, 0.0)


def test_feet_that_leave_the_legs_are_refused_with_the_reason() -> None:
    skeleton, wrong, _ = _walking(1.0, apart=0.3)
    with pytest.raises(StudioError, match="is parented to the root"):
        with_body_over_feet(skeleton, wrong, loose_feet(skeleton))


def test_feet_that_hang_from_their_legs_are_left_alone() -> None:
    skeleton, _ = _skeleton([(name, parent, place) for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)])
    assert loose_feet(skeleton) == {}
