"""Rotation and translation of parts of a posed body. Everything distal to a segment is one range of points and one of
segments.
"""

from typing import NamedTuple

from studio.core.kernels.algebra.rotation_tuples import (
    RotationTuple,
    compose,
    rotation_from_matrix,
    transform_point,
    write_rotation,
    write_transformed_point,
)
from studio.core.kernels.algebra.vectors import Point, add_vectors, copy_matrix, copy_point, offset_between
from studio.core.kernels.body_indices import (
    CLAVICLE_SEGMENT,
    COLLAR_POINT,
    HIP_POINT,
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_BESIDE_SPINE,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    THIGH_SEGMENT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import kernel, small_kernel


@kernel
def distal_range(segment, spine_count):
    """(first segment, past last segment, first point, past last point) of the subtree that rotates with ``segment``.

    The proximal point of the segment, about which it rotates, is not included.
    """
    if segment < spine_count:
        if segment == 0:
            return 0, spine_count + SEGMENTS_BESIDE_SPINE, 1, spine_count + POINTS_BESIDE_SPINE
        return segment, spine_count + 10, segment + 1, spine_count + 13
    number = segment - spine_count
    if number < 2:
        return segment, spine_count + 2, segment + 1, spine_count + 3
    chain, bone = (number - 2) // 4, (number - 2) % 4
    first_point = spine_count + COLLAR_POINT + POINTS_PER_LIMB * chain + bone + 1
    return segment, segment + 4 - bone, first_point, first_point + 4 - bone


@kernel
def limb_parts(limb, spine_count):
    """(parent segment, upper segment, root point) of a limb: clavicle, upper arm and shoulder, or pelvis, thigh and
    hip.
    """
    side = limb % 2
    if limb >= 2:
        return (
            0,
            spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side,
            spine_count + HIP_POINT + POINTS_PER_LIMB * side,
        )
    return (
        spine_count + CLAVICLE_SEGMENT + SEGMENTS_PER_LIMB * side,
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
    )


@kernel
def rotate_part(rotation, segment, spine_count, pivot, positions, rotations):
    """Rotate ``segment`` and its subtree by ``rotation`` (``kernels.algebra.rotation_tuples``, world) about ``pivot``
    (3,), in place.
    """
    first, past, first_point, past_point = distal_range(segment, spine_count)
    x, y, z = pivot[0], pivot[1], pivot[2]
    for point in range(first_point, past_point):
        position = positions[point]
        write_transformed_point((x, y, z), rotation, position[0] - x, position[1] - y, position[2] - z, position)
    for other in range(first, past):
        write_rotation(compose(rotation, rotation_from_matrix(rotations[other])), rotations[other])


@kernel
def translate_points(x, y, z, positions):
    """Translate all points of a frame (P, 3), in place."""
    for point in range(positions.shape[0]):
        positions[point, 0] += x
        positions[point, 1] += y
        positions[point, 2] += z


@small_kernel
def body_point_position(point, segment, offset, positions, rotations):
    """Position (x, y, z) = positions[point] + rotations[segment] @ offset of a point fixed to a segment."""
    return transform_point(positions[point], rotation_from_matrix(rotations[segment]), offset[0], offset[1], offset[2])


class EndPose(NamedTuple):
    """World rotations and extent of a hand, or of foot and toe."""

    rotation: RotationTuple
    toe_rotation: RotationTuple
    tip: Point
    """Offset in metres from wrist or ankle to the tip of the hand or the toe joint."""
    toe_tip: Point
    """Offset in metres from the wrist or the ankle to the tip of the toe."""


@small_kernel
def end_pose(limb, pose):
    """``EndPose`` of the hand, or of foot and toe, of a limb."""
    positions, rotations = pose.positions, pose.rotations
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    end, toe, joint = upper + 2, upper + (3 if limb >= 2 else 2), root + 2
    last = joint + (2 if limb >= 2 else 1)
    tip, toe_tip = (
        offset_between(positions[joint], positions[joint + 1]),
        offset_between(positions[joint], positions[last]),
    )
    return EndPose(rotation_from_matrix(rotations[end]), rotation_from_matrix(rotations[toe]), tip, toe_tip)


@small_kernel
def restore_end(limb, end, pose):
    """Write the world pose ``end`` of a hand, or of foot and toe, back, beginning at the present wrist or ankle."""
    positions, rotations = pose.positions, pose.rotations
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    joint = positions[root + 2]
    write_rotation(end.rotation, rotations[upper + 2])
    copy_point(add_vectors(joint, end.tip), positions[root + 3])
    if limb >= 2:
        write_rotation(end.toe_rotation, rotations[upper + 3])
        copy_point(add_vectors(joint, end.toe_tip), positions[root + 4])


@kernel
def copy_pose(start, pose):
    """Copy the pose ``start`` to ``pose``."""
    for point in range(pose.positions.shape[0]):
        copy_point(start.positions[point], pose.positions[point])
    for segment in range(pose.rotations.shape[0]):
        copy_matrix(start.rotations[segment], pose.rotations[segment])
