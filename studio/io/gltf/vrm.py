"""Humanoid maps of VRM 0 and 1 and of VRM animations: the node of each body part."""

from collections.abc import Container

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.finger_joints import Digit, find_fingers
from studio.core.body.humanoid import BodyMap
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.io.json_record import Record

_SIDED = {
    "Shoulder": "clavicle",
    "UpperArm": "upper_arm",
    "LowerArm": "forearm",
    "Hand": "hand",
    "UpperLeg": "thigh",
    "LowerLeg": "shank",
    "Foot": "foot",
    "Toes": "toe",
}
_BONES = {"hips": "pelvis", "neck": "neck", "head": "head"} | {
    f"{side}{bone}": f"{side}_{part}" for side in ("left", "right") for bone, part in _SIDED.items()
}
_VERSION_1 = ("VRMC_vrm", "VRMC_vrm_animation")
_SPINE = ("spine", "chest", "upperChest")
_NEEDED = ("hips", "spine", "head", *(f"{side}{bone}" for side in ("left", "right") for bone in _SIDED))


_FINGER_BONES = ("Proximal", "Intermediate", "Distal")
_THUMB_BONES = ("Metacarpal", "Proximal", "Distal")


def humanoid_joints(skeleton: Skeleton, body: BodyMap) -> dict[str, int]:
    """Joint of ``skeleton`` for each bone of VRM 1, parents first.

    Of a spine with more than three joints above the pelvis the first, the middle and the last are bones. Raises
    StudioError if a bone that every VRM has is missing.
    """
    named = {bone: body.parts[BodyPart(part)] for bone, part in _BONES.items() if BodyPart(part) in body.parts}
    above = body.spine[1:]
    places = np.linspace(0, len(above) - 1, min(len(above), len(_SPINE))).round().astype(int).tolist()
    named |= {bone: above[place] for bone, place in zip(_SPINE, places, strict=False)}
    for finger, joint in find_fingers(skeleton, body).items():
        bones = _THUMB_BONES if finger.digit is Digit.THUMB else _FINGER_BONES
        side = ("left", "right")[finger.side]
        named[f"{side}{finger.digit.capitalize()}{bones[finger.place]}"] = joint
    if missing := _missing(named):
        raise StudioError(f"No joint is mapped to {', '.join(missing)}. Choose one in the inspector, under Body map.")
    return dict(sorted(named.items(), key=lambda item: item[1]))


def vrm_bones(root: Record, node_count: int) -> dict[str, int]:
    """Nodes by part (``pelvis``, ``spine_1``, ``left_hand``); empty if the file is no VRM.

    Raises StudioError if the map lacks a bone that every VRM has.
    """
    extensions = root.inner("extensions")
    version_1 = next((name for name in _VERSION_1 if name in extensions), None)
    if version_1 is not None:
        named = _version_1(extensions.inner(version_1).inner("humanoid").inner("humanBones"), node_count)
    elif "VRM" in extensions:
        named = _version_0(extensions.inner("VRM").inner("humanoid"), node_count)
    else:
        return {}
    if missing := _missing(named):
        raise StudioError(
            f"{root.where}: its humanoid has no {', '.join(missing[:4])}. Assign the bone in the program it comes from."
        )
    spine = [named[bone] for bone in _SPINE if bone in named]
    bones = {f"spine_{index}": node for index, node in enumerate(spine, 1)}
    return {_BONES[bone]: node for bone, node in named.items() if bone in _BONES} | bones


def _missing(named: Container[str]) -> list[str]:
    return [bone for bone in _NEEDED if bone not in named and not bone.endswith(("Shoulder", "Toes"))]


def _version_1(bones: Record, node_count: int) -> dict[str, int]:
    named = {}
    for bone, record in bones.items():
        node = record.index("node", node_count)
        if node is not None:
            named[bone] = node
    return named


def _version_0(humanoid: Record, node_count: int) -> dict[str, int]:
    named = {}
    for record in humanoid.records("humanBones"):
        node = record.index("node", node_count)
        if node is not None:
            named[record.text("bone")] = node
    return named
