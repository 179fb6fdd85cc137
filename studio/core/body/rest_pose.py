"""Rest pose, in which a body is measured and its skin is bound."""

from functools import lru_cache

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray, Morphology
from studio.core.rotations import cross, frame_along

REST_FORWARD = np.array([1.0, 0.0, 0.0])
REST_UP = np.array([0.0, 0.0, 1.0])
REST_UPPER_ARM_DIRECTION = np.array([0.06, np.cos(np.radians(50)), -np.sin(np.radians(50))])
"""Direction of the left upper arm in the rest pose, x forward, y left, z up."""
REST_ELBOW_RADIANS = np.radians(12)


def rest_pose(morphology: Morphology) -> tuple[FloatArray, FloatArray]:
    """Points ``positions`` (K+23, 3) and segment ``rotations`` (K+18, 3, 3) of a body in an A-pose in world axes.

    The body faces +X, with flat soles on z = 0 and the root above the origin. Rotations are in the axes of
    ``canonical``. The longer of two unequal legs bends its knee.
    """
    positions, rotations = _computed(morphology)
    return positions.copy(), rotations.copy()


@lru_cache(maxsize=64)
def _computed(morphology: Morphology) -> tuple[FloatArray, FloatArray]:
    layout = morphology.layout
    positions = np.zeros((layout.point_count, 3))
    rotations = np.tile(np.eye(3), (layout.segment_count, 1, 1))
    hips_to_sole = morphology.leg.sum(axis=1) + morphology.ankle_height - morphology.hip_offset[:, 2]
    positions[0, 2] = hips_to_sole.min()
    positions[1 : layout.neck_base + 1] = positions[0] + np.cumsum(morphology.spine, axis=0)
    neck_base = positions[layout.neck_base]
    rotations[layout.neck_base] = frame_along(morphology.neck_rest, REST_FORWARD)
    positions[layout.head_joint] = neck_base + morphology.neck * rotations[layout.neck_base][:, 2]
    positions[layout.head_end] = positions[layout.head_joint] + morphology.head * REST_UP
    for side in (0, 1):
        _hang_arm(morphology, side, positions, rotations)
        _stand_leg(morphology, side, positions, rotations)
    return positions, rotations


def flexed_frame(frame: FloatArray, flexion: float) -> FloatArray:
    """Axes ``frame`` (3, 3) rotated by ``flexion`` radians about their own x axis, the hinge."""
    c, s = np.cos(flexion), np.sin(flexion)
    return np.asarray(frame @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]))


def _hang_arm(morphology: Morphology, side: int, positions: FloatArray, rotations: FloatArray) -> None:
    outward = np.array([1.0, 1 - 2 * side, 1.0])
    clavicle = frame_along(morphology.clavicle_rest[side], REST_FORWARD)
    bone = REST_UPPER_ARM_DIRECTION * outward
    upper = frame_along(bone, cross(bone, REST_FORWARD))
    forearm = flexed_frame(upper, REST_ELBOW_RADIANS)
    lengths = (morphology.clavicle[side], *morphology.arm[side])
    first = morphology.layout.collar_point(side)
    segment = morphology.layout.segment_of_part(BodyPart.RIGHT_CLAVICLE if side else BodyPart.LEFT_CLAVICLE)
    rotations[segment : segment + 4] = clavicle, upper, forearm, forearm
    positions[first] = positions[morphology.layout.neck_base] + morphology.collar_base[side]
    for bone_index, length in enumerate(lengths):
        along = rotations[segment + bone_index][:, 2] * length
        positions[first + bone_index + 1] = positions[first + bone_index] + along
    positions[first + 4] = positions[first + 3] + forearm @ morphology.hand[side]


def _stand_leg(morphology: Morphology, side: int, positions: FloatArray, rotations: FloatArray) -> None:
    thigh, shank = morphology.leg[side]
    hip = morphology.layout.hip_point(side)
    positions[hip] = positions[0] + morphology.hip_offset[side]
    height = positions[hip, 2] - morphology.ankle_height[side]
    straight = frame_along(np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0]))
    forward = np.arccos(np.clip((height**2 + thigh**2 - shank**2) / (2 * height * thigh), -1, 1))
    back = np.arccos(np.clip((height**2 + shank**2 - thigh**2) / (2 * height * shank), -1, 1))
    segment = morphology.layout.segment_of_part(BodyPart.RIGHT_THIGH if side else BodyPart.LEFT_THIGH)
    rotations[segment : segment + 2] = flexed_frame(straight, -forward), flexed_frame(straight, back)
    positions[hip + 1] = positions[hip] + rotations[segment][:, 2] * thigh
    positions[hip + 2] = positions[hip + 1] + rotations[segment + 1][:, 2] * shank
    positions[hip + 3] = positions[hip + 2] + morphology.foot[side]
    positions[hip + 4] = positions[hip + 3] + morphology.toe[side]
