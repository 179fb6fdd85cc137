"""The Virtual Motion Capture protocol: bones in Unity's axes, rotated relative to a T-pose.

Unity has x right, y up, z forward, left-handed; ours are x forward, y left, z up: v = (z, -x, y), and a rotation (x, y,
z, w) becomes (-z, x, -y, w).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.finger_joints import Digit, FingerJoint
from studio.core.body.finger_poses import FingerPoses
from studio.core.body.morphology import Morphology
from studio.core.body.standing import standing_points
from studio.core.rigs.driven_fingers import t_pose_rotations_of_fingers
from studio.core.rotations import frame_along, from_matrix, to_matrix

FloatArray = NDArray[np.float64]

BONE_ADDRESS, ROOT_ADDRESS, TRACKER_ADDRESS, HMD_ADDRESS, OK_ADDRESS, TIME_ADDRESS = (
    "/VMC/Ext/Bone/Pos",
    "/VMC/Ext/Root/Pos",
    "/VMC/Ext/Tra/Pos",
    "/VMC/Ext/Hmd/Pos",
    "/VMC/Ext/OK",
    "/VMC/Ext/T",
)
VMC_SPINE_BONES = ("Spine", "Chest", "UpperChest")
VMC_ARM_BONES, VMC_LEG_BONES = ("Shoulder", "UpperArm", "LowerArm", "Hand"), ("UpperLeg", "LowerLeg", "Foot", "Toes")
VMC_FINGER_BONES = "Proximal", "Intermediate", "Distal"
FINGER_ROOTS = np.array([[0.2, 0.2, 0.0], [0.15, 0.55, 0.0], [0.05, 0.55, 0.0], [-0.05, 0.55, 0.0], [-0.15, 0.5, 0.0]])
"""(5, 3) positions of the first finger joints in hand lengths: forward, outward and up in a T-pose."""
FINGER_BONE_LENGTH = 0.16
"""Length of a finger bone in hand lengths."""
TOE_HEIGHT_LEGS = 0.037
"""Height of the toe joint above the sole in leg lengths; packets do not contain it."""
MIN_VMC_BONE_METRES = 1e-3
"""Minimum length of a received bone in metres; a shorter one has no direction, and a default is used."""
MODEL_FORWARD = np.array([1.0, 0.0, 0.0])
NEEDED_BONES = (
    "Hips",
    "Spine",
    "Head",
    *(f"{side}{bone}" for side in ("Left", "Right") for bone in (*VMC_ARM_BONES[1:], *VMC_LEG_BONES[:3])),
)
"""Bones without which no body can be built."""


@dataclass(frozen=True, eq=False)
class Bone:
    """Bone as sent: its position relative to the parent in metres, and its rotation (x, y, z, w), in our axes."""

    position: FloatArray
    rotation: FloatArray


def from_unity(position: ArrayLike, turn: ArrayLike) -> Bone:
    """Bone in our axes, from its position and rotation in Unity's."""
    (x, y, z), (a, b, c, w) = np.asarray(position, dtype=np.float64), np.asarray(turn, dtype=np.float64)
    return Bone(np.array([z, -x, y]), np.array([-c, a, -b, w]))


def to_unity(bone: Bone) -> tuple[FloatArray, FloatArray]:
    """Position (3,) and rotation (4,) of a bone in Unity's axes."""
    (x, y, z), (a, b, c, w) = bone.position, bone.rotation
    return np.array([-y, z, x]), np.array([b, -c, -a, w])


@dataclass(frozen=True)
class BoneSegment:
    """Bone and the body segment that it rotates; ``parent`` is the name of a bone, empty for the hips."""

    name: str
    parent: str
    segment: int


def bone_segments(layout: BodyLayout) -> tuple[BoneSegment, ...]:
    """Bones of a body, each after its parent; of a long spine the lowest, the middle and the thorax segment."""
    count = layout.spine_count
    inner = sorted({1, max(1, count // 2), count - 1})
    spine = [BoneSegment(name, "", segment) for name, segment in zip(VMC_SPINE_BONES, inner, strict=False)]
    chain = [BoneSegment("Hips", "", 0)]
    for each in spine:
        chain.append(BoneSegment(each.name, chain[-1].name, each.segment))
    top = chain[-1].name
    chain += [BoneSegment("Neck", top, count), BoneSegment("Head", "Neck", count + 1)]
    for side, name in enumerate(("Left", "Right")):
        for bones, carrier, first in (
            (VMC_ARM_BONES, top, layout.clavicle_segment(side)),
            (VMC_LEG_BONES, "Hips", layout.thigh_segment(side)),
        ):
            for index, bone in enumerate(bones):
                parent = f"{name}{bones[index - 1]}" if index else carrier
                chain.append(BoneSegment(f"{name}{bone}", parent, first + index))
    return tuple(chain)


@lru_cache(maxsize=16)
def t_pose_axes(body: Morphology) -> FloatArray:
    """Rotations (S, 3, 3) of the canonical segments in the T-pose that bone rotations are relative to."""
    layout = body.layout
    axes = np.tile(np.eye(3), (layout.segment_count, 1, 1))
    axes[layout.spine_count] = frame_along(body.neck_rest, MODEL_FORWARD)
    for side, name in enumerate(("left", "right")):
        outward = np.array([0.0, 1.0 - 2.0 * side, 0.0])
        clavicle, thigh = (layout.segment_of_part(BodyPart(f"{name}_{part}")) for part in ("clavicle", "thigh"))
        axes[clavicle] = frame_along(body.clavicle_rest[side], MODEL_FORWARD)
        axes[clavicle + 1 : clavicle + 4] = frame_along(outward, np.cross(outward, MODEL_FORWARD))
        axes[thigh : thigh + 2] = frame_along(np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0]))
    return axes


def finger_bone(finger: FingerJoint) -> str:
    """Name of the bone of a finger joint: ``LeftIndexProximal``."""
    return f"{('Left', 'Right')[finger.side]}{finger.digit.capitalize()}{VMC_FINGER_BONES[finger.place]}"


def finger_bones(poses: FingerPoses, body: Morphology) -> dict[str, Bone]:
    """Bones of the fingers in the first frame of ``poses``; they have the proportions of a usual hand."""
    turns, bones = t_pose_rotations_of_fingers(poses)[0], {}
    for cell in np.ndindex(turns.shape[:3]):
        side, digit, place = cell
        size = float(np.linalg.norm(body.hand[side])) * (1.0 - 2.0 * side)
        away = (
            FINGER_ROOTS[digit] * [abs(size), size, 0.0]
            if place == 0
            else np.array([0.0, FINGER_BONE_LENGTH * size, 0.0])
        )
        bones[finger_bone(FingerJoint(side, tuple(Digit)[digit], place))] = Bone(away, turns[cell])
    return bones


def bones_of(
    positions: FloatArray, rotations: FloatArray, body: Morphology, fingers: FingerPoses | None = None
) -> dict[str, Bone]:
    """Bones of one frame of a body by name; positions (K+23, 3), rotations (K+18, 3, 3), ``fingers`` of that frame."""
    world = rotations @ np.swapaxes(t_pose_axes(body), 1, 2)
    points = body.layout.proximal_points()
    segments = {each.name: each.segment for each in bone_segments(body.layout)}
    bones = {}
    for each in bone_segments(body.layout):
        place, turn = positions[points[each.segment]], world[each.segment]
        if each.parent:
            carrier = segments[each.parent]
            turn = world[carrier].T @ turn
            place = world[carrier].T @ (place - positions[points[carrier]])
        bones[each.name] = Bone(np.asarray(place), from_matrix(turn))
    return bones | finger_bones(fingers, body) if fingers else bones


def posed_body(bones: dict[str, Bone]) -> tuple[FloatArray, FloatArray, Morphology] | None:
    """Positions (K+23, 3), rotations (K+18, 3, 3) and body of received bones; None if a needed bone is missing or the
    trunk has no length.
    """
    if any(name not in bones for name in NEEDED_BONES):
        return None
    if (
        sum(float(np.linalg.norm(bones[name].position)) for name in VMC_SPINE_BONES if name in bones)
        < MIN_VMC_BONE_METRES
    ):
        return None
    # Of all offsets from parents only the hips' changes while somebody moves; else the body comes from the cache.
    body = _body(tuple((name, *bone.position.tolist()) for name, bone in bones.items() if name != "Hips"))
    layout, axes = body.layout, t_pose_axes(body)
    world: dict[str, FloatArray] = {}
    rotations = np.empty((layout.segment_count, 3, 3))
    for each in bone_segments(layout):
        turn = to_matrix(bones[each.name].rotation) if each.name in bones else np.eye(3)
        world[each.name] = world[each.parent] @ turn if each.parent else turn
        rotations[each.segment] = world[each.name] @ axes[each.segment]
    positions = standing_points(body, rotations)
    return positions + bones["Hips"].position - positions[0], rotations, body


@lru_cache(maxsize=16)
def _body(known: tuple[tuple[str, float, float, float], ...]) -> Morphology:
    """Body measured by the positions of bones; hands, toes, head and soles have default proportions."""
    bones = {name: np.array(place) for name, *place in known}

    def place(name: str, usual: tuple[float, float, float]) -> FloatArray:
        return bones.get(name, np.array(usual))

    def length(name: str) -> float:
        return max(float(np.linalg.norm(bones[name])), MIN_VMC_BONE_METRES)

    spine = [name for name in VMC_SPINE_BONES if name in bones]
    neck = place("Neck", (0.0, 0.0, 0.25))
    sides = "Left", "Right"
    leg = np.array([[length(f"{side}LowerLeg"), length(f"{side}Foot")] for side in sides])
    arm = np.array([[length(f"{side}LowerArm"), length(f"{side}Hand")] for side in sides])
    size = float(leg.sum(axis=1).mean())
    shoulders = [place(f"{side}Shoulder", (0.0, 0.03 * (1 - 2 * k), 0.2)) for k, side in enumerate(sides)]
    outward = np.array([bones[f"{side}UpperArm"] for side in sides])
    clavicle = np.linalg.norm(outward, axis=1)
    outward[clavicle < MIN_VMC_BONE_METRES] = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])[
        clavicle < MIN_VMC_BONE_METRES
    ]
    head = bones["Head"]
    foot = np.array([place(f"{side}Toes", (0.16 * size, 0.0, -0.05 * size)) for side in sides])
    return Morphology(
        spine=np.array([*(bones[name] for name in spine), neck]),
        neck=max(float(np.linalg.norm(head)), MIN_VMC_BONE_METRES),
        head=0.22 * size,
        collar_base=np.array(shoulders) - neck,
        clavicle=np.maximum(clavicle, MIN_VMC_BONE_METRES),
        arm=arm,
        hand=np.stack([[0.0, 0.0, 0.7 * forearm] for forearm in arm[:, 1]]),
        hip_offset=np.array([bones[f"{side}UpperLeg"] for side in sides]),
        leg=leg,
        foot=foot,
        toe=np.tile([0.08 * size, 0.0, 0.0], (2, 1)),
        ankle_height=np.maximum(-foot[:, 2], 0.0) + TOE_HEIGHT_LEGS * size,
        toe_height=np.full(2, TOE_HEIGHT_LEGS * size),
        heel_length=np.full(2, 0.077 * size),
        neck_rest=head if np.linalg.norm(head) > MIN_VMC_BONE_METRES else np.array([0.0, 0.0, 1.0]),
        clavicle_rest=outward,
    )
