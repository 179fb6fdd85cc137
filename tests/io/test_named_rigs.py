"""Rigs as fifteen kinds of programs name their joints: each part of the body is found."""

import numpy as np
import pytest

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions, rest_poses
from studio.core.body.skeleton import Skeleton
from studio.io.figure.body_maps import find_body
from tests.io.character_files import JOINTS, NAMES, PLACES

MIDDLE, LIMBS = (
    ("pelvis", "neck", "head"),
    ("clavicle", "upper_arm", "forearm", "hand", "thigh", "shank", "foot", "toe"),
)
"""Parts in the order of the names of a rig: those of the middle, those of a side."""
FIGURE = dict(zip(("hips", "neck", "head"), MIDDLE, strict=True)) | {
    f"{side}{joint}": f"{side}_{part}"
    for side in ("left", "right")
    for joint, part in zip(
        ("Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes"), LIMBS, strict=True
    )
}
"""Part of each joint of the stick figure, to which shoulders are added."""
RIGS = {
    "Mixamo": (
        ("mixamorig:Hips", "mixamorig:Neck", "mixamorig:Head", "mixamorig:{}Shoulder", "mixamorig:{}Arm",
         "mixamorig:{}ForeArm", "mixamorig:{}Hand", "mixamorig:{}UpLeg", "mixamorig:{}Leg", "mixamorig:{}Foot",
         "mixamorig:{}ToeBase"), ("mixamorig:Spine", "mixamorig:Spine1"), ("Left", "Right")),
    "HumanIK": (
        ("Hips", "Neck", "Head", "{}Shoulder", "{}Arm", "{}ForeArm", "{}Hand", "{}UpLeg", "{}Leg", "{}Foot",
         "{}ToeBase"), ("Spine", "Spine1"), ("Left", "Right")),
    "Unreal": (
        ("pelvis", "neck_01", "head", "clavicle_{}", "upperarm_{}", "lowerarm_{}", "hand_{}", "thigh_{}", "calf_{}",
         "foot_{}", "ball_{}"), ("spine_01", "spine_02"), ("l", "r")),
    "Unity": (
        ("Hips", "Neck", "Head", "{}Shoulder", "{}UpperArm", "{}LowerArm", "{}Hand", "{}UpperLeg", "{}LowerLeg",
         "{}Foot", "{}Toes"), ("Spine", "Chest"), ("Left", "Right")),
    "VRM of VRoid": (
        ("J_Bip_C_Hips", "J_Bip_C_Neck", "J_Bip_C_Head", "J_Bip_{}_Shoulder", "J_Bip_{}_UpperArm",
         "J_Bip_{}_LowerArm", "J_Bip_{}_Hand", "J_Bip_{}_UpperLeg", "J_Bip_{}_LowerLeg", "J_Bip_{}_Foot",
         "J_Bip_{}_ToeBase"), ("J_Bip_C_Spine", "J_Bip_C_Chest"), ("L", "R")),
    "Rokoko": (
        ("Hips", "Neck", "Head", "{}Shoulder", "{}Arm", "{}ForeArm", "{}Hand", "{}Thigh", "{}Shin", "{}Foot", "{}Toe"),
        ("Spine1", "Spine2"), ("Left", "Right")),
    "Xsens": (
        ("Pelvis", "Neck", "Head", "{}Shoulder", "{}UpperArm", "{}Forearm", "{}Hand", "{}UpperLeg", "{}LowerLeg",
         "{}Foot", "{}Toe"), ("L5", "T8"), ("Left", "Right")),
    "Perception Neuron": (
        ("Robot_Hips", "Robot_Neck", "Robot_Head", "Robot_{}Shoulder", "Robot_{}Arm", "Robot_{}ForeArm",
         "Robot_{}Hand", "Robot_{}UpLeg", "Robot_{}Leg", "Robot_{}Foot", "Robot_{}Toe"),
        ("Robot_Spine", "Robot_Spine1"), ("Left", "Right")),
    "OptiTrack": (
        ("Hip", "Neck", "Head", "{}Shoulder", "{}UArm", "{}FArm", "{}Hand", "{}Thigh", "{}Shin", "{}Foot", "{}Toe"),
        ("Ab", "Chest"), ("L", "R")),
    "CMU": (
        ("root", "lowerneck", "head", "{}clavicle", "{}humerus", "{}radius", "{}wrist", "{}femur", "{}tibia",
         "{}foot", "{}toes"), ("lowerback", "thorax"), ("l", "r")),
    "Biped": (
        ("Bip01 Pelvis", "Bip01 Neck", "Bip01 Head", "Bip01 {} Clavicle", "Bip01 {} UpperArm", "Bip01 {} Forearm",
         "Bip01 {} Hand", "Bip01 {} Thigh", "Bip01 {} Calf", "Bip01 {} Foot", "Bip01 {} Toe0"),
        ("Bip01 Spine", "Bip01 Spine1"), ("L", "R")),
    "Daz": (
        ("hip", "neckLower", "head", "{}Collar", "{}ShldrBend", "{}ForearmBend", "{}Hand", "{}ThighBend", "{}Shin",
         "{}Foot", "{}Toe"), ("abdomenLower", "chestLower"), ("l", "r")),
    "Reallusion": (
        ("CC_Base_Hip", "CC_Base_NeckTwist01", "CC_Base_Head", "CC_Base_{}_Clavicle", "CC_Base_{}_Upperarm",
         "CC_Base_{}_Forearm", "CC_Base_{}_Hand", "CC_Base_{}_Thigh", "CC_Base_{}_Calf", "CC_Base_{}_Foot",
         "CC_Base_{}_ToeBase"), ("CC_Base_Spine01", "CC_Base_Spine02"), ("L", "R")),
    "MakeHuman": (
        ("root", "neck01", "head", "clavicle.{}", "upperarm01.{}", "lowerarm01.{}", "wrist.{}", "upperleg01.{}",
         "lowerleg01.{}", "foot.{}", "toe1-1.{}"), ("spine05", "spine01"), ("L", "R")),
    "MikuMikuDance": (
        ("センター", "首", "頭", "{}肩", "{}腕", "{}ひじ", "{}手首", "{}足", "{}ひざ", "{}足首", "{}つま先"),
        ("上半身", "上半身2"), ("左", "右")),
    "KayKit": (
        ("hips", "neck", "head", "shoulder.{}", "upperarm.{}", "lowerarm.{}", "wrist.{}", "upperleg.{}", "lowerleg.{}",
         "foot.{}", "toes.{}"), ("spine", "chest"), ("l", "r")),
    "Quaternius": (
        ("Hips", "Neck", "Head", "Shoulder.{}", "UpperArm.{}", "LowerArm.{}", "Palm.{}", "UpperLeg.{}", "LowerLeg.{}",
         "Foot.{}", "Toes.{}"), ("Abdomen", "Torso"), ("L", "R")),
}  # fmt: skip


def rig_as(names: tuple[str, ...], spine: tuple[str, str], sides: tuple[str, str]) -> tuple[Skeleton, dict[str, str]]:
    """The stick figure with these names, and the name of the joint of each part."""
    called = dict(zip(("spine", "chest"), spine, strict=True)) | dict(
        zip(("hips", "neck", "head"), names[: len(MIDDLE)], strict=True)
    )
    for side, letters in zip(("left", "right"), sides, strict=True):
        limbs = [each for each, part in FIGURE.items() if part.startswith(side)]
        called |= dict(zip(limbs, (name.format(letters) for name in names[len(MIDDLE) :]), strict=True))
    joints = [(name, parent, np.array(PLACES[NAMES.index(name)])) for name, parent, _ in JOINTS]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        at = next(place for place, joint in enumerate(joints) if joint[0] == f"{side}UpperArm")
        joints[at] = (f"{side}UpperArm", f"{side}Shoulder", joints[at][2])
        joints.insert(at, (f"{side}Shoulder", "chest", np.array([sign * 0.04, 1.43, 0.0])))
    order = [name for name, _, _ in joints]
    parents = np.array([order.index(parent) if parent else -1 for _, parent, _ in joints])
    points = np.array([place for _, _, place in joints])[:, [2, 0, 1]]
    offsets = points - points[np.maximum(parents, 0)]
    skeleton = Skeleton(tuple(called[name] for name in order), parents, offsets, np.zeros(len(order), bool))
    return skeleton, {part: called[joint] for joint, part in FIGURE.items()}


@pytest.mark.parametrize("program", RIGS)
def test_each_part_is_found_by_the_names_of_a_program(program: str) -> None:
    skeleton, expected = rig_as(*RIGS[program])
    still = rest_poses(skeleton, np.tile([0.0, 0.0, 0.0, 1.0], (skeleton.joint_count, 1)))
    found = find_body(skeleton, joint_positions(skeleton, still))
    assert found.body_map is not None
    assert found.family
    assert {part: skeleton.names[found.body_map.parts[BodyPart(part)]] for part in expected} == expected
