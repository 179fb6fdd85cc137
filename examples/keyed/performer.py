"""The performer of the example captures: an ordinary adult of 1.76 m, and the skeleton that is written for it."""

import numpy as np

from studio.core.body.morphology import FloatArray
from studio.core.body.rest_pose import REST_FORWARD
from studio.core.body.skeleton import Skeleton
from studio.core.mannequin.physique import Physique
from studio.core.rotations import frame_along

BODY = Physique(stature=1.76).morphology()
LAYOUT = BODY.layout
THORAX, NECK, HEAD = LAYOUT.spine_count - 1, LAYOUT.spine_count, LAYOUT.spine_count + 1
STANDING = float(BODY.leg[0].sum() + BODY.ankle_height[0] - BODY.hip_offset[0, 2])
"""Height of the root above the ground on straight legs."""
OUTWARD = np.array([1.0, -1.0])
"""Sign of y on each side."""

_ARM, _LEG = ("Shoulder", "Arm", "ForeArm", "Hand"), ("UpLeg", "Leg", "Foot", "ToeBase")
NAMES = (
    *("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"),
    *(f"{side}{bone}" for limb in (_ARM, _LEG) for side in ("Left", "Right") for bone in limb),
)
_ENDS = ("Head", "LeftHand", "RightHand", "LeftToeBase", "RightToeBase")


def clavicle(side: int) -> int:
    """Segment of the clavicle; upper arm, forearm and hand follow it."""
    return LAYOUT.spine_count + 2 + 4 * side


def thigh(side: int) -> int:
    """Segment of the thigh; shank, foot and toe follow it."""
    return LAYOUT.spine_count + 10 + 4 * side


def t_pose() -> FloatArray:
    """World axes (S, 3, 3) of the canonical segments in the T-pose, where every joint's rotation is zero."""
    axes = np.tile(np.eye(3), (LAYOUT.segment_count, 1, 1))
    for side, outward in enumerate(OUTWARD):
        sideways = np.array([0.0, outward, 0.0])
        axes[clavicle(side)] = frame_along(BODY.clavicle_rest[side], REST_FORWARD)
        axes[clavicle(side) + 1 : clavicle(side) + 4] = frame_along(sideways, np.cross(sideways, REST_FORWARD))
        axes[thigh(side) : thigh(side) + 2] = frame_along(np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0]))
    return axes


def bones() -> FloatArray:
    """Each segment's bone (S, 3) in its own axes, from its joint to its far end."""
    vectors = np.zeros((LAYOUT.segment_count, 3))
    vectors[: LAYOUT.spine_count] = BODY.spine
    vectors[[NECK, HEAD], 2] = BODY.neck, BODY.head
    for side in (0, 1):
        arm, leg = clavicle(side), thigh(side)
        vectors[arm : arm + 3, 2] = BODY.clavicle[side], *BODY.arm[side]
        vectors[arm + 3] = BODY.hand[side]
        vectors[leg : leg + 2, 2] = BODY.leg[side]
        vectors[leg + 2 : leg + 4] = BODY.foot[side], BODY.toe[side]
    return vectors


def joint_places() -> FloatArray:
    """Places of each segment's joint (S, 3), in the axes of the segment that carries it."""
    places = bones()[list(LAYOUT.parent_segments())]
    places[0] = 0.0, 0.0, STANDING
    for side in (0, 1):
        places[clavicle(side)] = BODY.spine[THORAX] + BODY.collar_base[side]
        places[thigh(side)] = BODY.hip_offset[side]
    return places


def make_skeleton() -> Skeleton:
    """The performer's joints in T-pose, one a segment, and the ends of head, hands and toes."""
    axes, parents = t_pose(), list(LAYOUT.parent_segments())
    carriers = axes[parents]
    carriers[0] = np.eye(3)
    offsets = np.einsum("sij,sj->si", carriers, joint_places())
    ending = [NAMES.index(name) for name in _ENDS]
    ends = np.einsum("sij,sj->si", axes[ending], bones()[ending])
    return Skeleton(
        (*NAMES, *(f"{name}_end" for name in _ENDS)),
        np.array(parents + ending),
        np.concatenate([offsets, ends]),
        np.arange(len(NAMES) + len(_ENDS)) >= len(NAMES),
    )
