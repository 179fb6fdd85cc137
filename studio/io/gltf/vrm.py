"""The humanoid map of VRM 0 and 1 and of VRM animations: which node plays which part of the body."""

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


def vrm_bones(root: Record, node_count: int) -> dict[str, int]:
    """Nodes by part (``pelvis``, ``spine_1``, ``left_hand``); empty where the file is no VRM.

    Raises StudioError when the map lacks a bone that every VRM has.
    """
    extensions = root.inner("extensions")
    version_1 = next((name for name in _VERSION_1 if name in extensions), None)
    if version_1 is not None:
        named = _version_1(extensions.inner(version_1).inner("humanoid").inner("humanBones"), node_count)
    elif "VRM" in extensions:
        named = _version_0(extensions.inner("VRM").inner("humanoid"), node_count)
    else:
        return {}
    missing = [bone for bone in _NEEDED if bone not in named and not bone.endswith(("Shoulder", "Toes"))]
    if missing:
        raise StudioError(
            f"{root.where}: its humanoid has no {', '.join(missing[:4])}. Assign the bone in the program it comes from."
        )
    spine = [named[bone] for bone in _SPINE if bone in named]
    bones = {f"spine_{place}": node for place, node in enumerate(spine, 1)}
    return {_BONES[bone]: node for bone, node in named.items() if bone in _BONES} | bones


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
