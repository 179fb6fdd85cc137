"""Body maps by names: numbers behind them, limbs in two joints, feet that hang elsewhere."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.body.rehanging import rehang, rehung
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import from_matrix
from studio.io.figure.body_maps import find_body, loose_feet, named_sides
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


def _loose() -> tuple[Skeleton, np.ndarray]:
    """The stick figure whose feet hang from its hips."""
    joints = [
        (name, "hips" if name.endswith("Foot") else parent, place)
        for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)
    ]
    return _skeleton(joints)


def test_feet_that_hang_from_the_root_are_hung_from_the_shanks() -> None:
    skeleton, points = _loose()
    loose = loose_feet(skeleton, points)
    assert {skeleton.names[foot]: skeleton.names[shank] for foot, shank in loose.items()} == {
        "leftFoot": "leftLowerLeg", "rightFoot": "rightLowerLeg",
    }  # fmt: skip
    turns = from_matrix(random_rotations(np.random.default_rng(0), 5, skeleton.joint_count))
    poses = PoseSequence(turns, np.tile(skeleton.offsets, (5, 1, 1)))
    hanging = rehang(skeleton.parents, loose)
    after, moved = rehung(skeleton, poses, hanging)
    assert joint_positions(after, moved) == pytest.approx(joint_positions(skeleton, poses)[:, hanging.order])
    found = find_body(after, points[:, hanging.order]).body_map
    assert found is not None
    assert after.names[found[BodyPart.LEFT_FOOT]] == "leftFoot"


def test_feet_that_leave_the_legs_are_refused_with_the_reason() -> None:
    skeleton, points = _loose()
    walked = np.tile(points, (2, 1, 1))
    for name in ("leftFoot", "rightFoot", "leftToes", "rightToes"):
        walked[1, skeleton.index(name), 0] += 1.0
    with pytest.raises(StudioError, match="hangs from the root"):
        loose_feet(skeleton, walked)


def test_feet_that_hang_from_their_legs_are_left_alone() -> None:
    skeleton, points = _skeleton(
        [(name, parent, place) for (name, parent, _), place in zip(JOINTS, POINTS, strict=True)]
    )
    assert loose_feet(skeleton, points) == {}
