"""Joints of the search: their Jacobians, and the body posed from their state (METHOD 9).

``joints`` (N,) are records of ``SEARCH_JOINT``, one for each joint that any chain frees; ``joint_of_segment`` (S + 1,)
is the joint of each segment, of the root last, -1 for none.

The state of a search (N, 3) has for each joint the Gibbs vector (axis times tan(angle / 2)) of its rotation away from
the motion, in the axes of its parent segment, and for the root metres. The damping of a joint (``JOINT_DAMPING``) is 1
until ``SOFT_JOINT_LIMIT`` and 0 at the limit, so that limits are approached ever more slowly.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    rotation_from_gibbs,
    rotation_from_matrix,
    transform_point,
    write_rotation,
    write_transformed_point,
)
from studio.core.kernels.algebra.vectors import ZERO_VECTOR, offset_between
from studio.core.kernels.body.parts import distal_range
from studio.core.kernels.body_indices import (
    CLAVICLE_SEGMENT,
    COLLAR_POINT,
    HIP_POINT,
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_BESIDE_SPINE,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.records import SEARCH_JOINT

ROOT_TRANSLATION = -1
"""Value of a joint's ``segment`` for the translation of the root."""
SOFT_JOINT_LIMIT = 0.7
"""Fraction of its limit up to which a joint rotates freely."""


@kernel
def may_rotate(row, segment, chain):
    """True if the joint of ``segment`` has a weight in ``row`` of the joint weights."""
    joint = chain.joint_of_segment[segment]
    return joint >= 0 and chain.weights[row, joint] > 0.0


@kernel
def pivot_point(segment, spine_count):
    """Index of the proximal point of ``segment``, about which it rotates."""
    if segment < spine_count + 2:
        return segment
    chain, bone = (segment - spine_count - 2) // 4, (segment - spine_count - 2) % 4
    return spine_count + COLLAR_POINT + POINTS_PER_LIMB * chain + bone


@kernel
def parent_segment(segment, spine_count):
    """Index of the parent of ``segment`` in the search; one past the last segment for root, pelvis and thighs.

    Thighs have no parent because legs are placed on their ankles.
    """
    if segment <= 0:
        return spine_count + SEGMENTS_BESIDE_SPINE
    if segment < spine_count + 2:
        return segment - 1
    chain, bone = (segment - spine_count - 2) // 4, (segment - spine_count - 2) % 4
    if bone > 0:
        return segment - 1
    return spine_count - 1 if chain < 2 else spine_count + SEGMENTS_BESIDE_SPINE


@allocating_kernel
def joint_table(segments, spine_count):
    """``SEARCH_JOINT`` records (N,) of the given segments (N,); ``ROOT_TRANSLATION`` stands for the root's
    translation.
    """
    table = np.zeros(segments.shape[0], SEARCH_JOINT)
    for number in range(segments.shape[0]):
        joint, segment = table[number], segments[number]
        joint.segment = segment
        joint.pivot = 0 if segment == ROOT_TRANSLATION else pivot_point(segment, spine_count)
        first, past, _, _ = distal_range(max(segment, 0), spine_count)
        joint.first, joint.past = first, past
        joint.parent = parent_segment(segment, spine_count)
    return table


@kernel
def add_point_jacobian(point, vx, vy, vz, segment, joints, positions, row):
    """Add the Jacobian row of a point of ``segment`` along the direction v to ``row`` (N, 3): (p - o) × v for each
    joint at o.
    """
    for joint in range(joints.shape[0]):
        if joints[joint].segment == ROOT_TRANSLATION:
            row[joint, 0] += vx
            row[joint, 1] += vy
            row[joint, 2] += vz
        elif joints[joint].first <= segment < joints[joint].past:
            origin = joints[joint].pivot
            x = point[0] - positions[origin, 0]
            y = point[1] - positions[origin, 1]
            z = point[2] - positions[origin, 2]
            row[joint, 0] += y * vz - z * vy
            row[joint, 1] += z * vx - x * vz
            row[joint, 2] += x * vy - y * vx


@kernel
def add_rotation_jacobian(axis, arm, segment, joints, row):
    """Add to ``row`` (N, 3) the derivative by each joint of the rotation of ``segment`` about world axis ``axis``, in
    units of ``arm`` metres a radian.
    """
    for joint in range(joints.shape[0]):
        if joints[joint].segment != ROOT_TRANSLATION and joints[joint].first <= segment < joints[joint].past:
            row[joint, axis] += arm


@kernel
def update_joint_damping(state, joints, limits, segment_rotations, out_damping):
    """Write the ``JOINT_DAMPING`` of all joints in their present state."""
    for k in range(joints.shape[0]):
        out_damping[k].fraction = 1.0
        x, y, z = state[k, 0], state[k, 1], state[k, 2]
        squared, freely = x * x + y * y + z * z, SOFT_JOINT_LIMIT * limits[k]
        if joints[k].segment == ROOT_TRANSLATION or squared <= freely * freely:
            continue
        rotation, size = segment_rotations[joints[k].parent], math.sqrt(squared)
        x, y, z = x / size, y / size, z / size
        for axis in range(3):
            out_damping[k].axis[axis] = rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2] * z
        out_damping[k].fraction = math.sqrt(max((limits[k] - size) / ((1.0 - SOFT_JOINT_LIMIT) * limits[k]), 0.0))


@kernel
def scale_along_axis(fraction, axis, vector):
    """Scale ``vector`` (3,) by ``fraction`` along a unit ``axis`` (3,)."""
    along = (fraction - 1.0) * (axis[0] * vector[0] + axis[1] * vector[1] + axis[2] * vector[2])
    vector[0] += along * axis[0]
    vector[1] += along * axis[1]
    vector[2] += along * axis[2]


@kernel
def pose_segment(segment, parent, state, joint_of_segment, start, segment_rotations, pose):
    """World rotation of one segment away from the motion: its parent's, followed by that of its own joint.

    It is written into ``segment_rotations`` (S + 1, 3, 3), and the segment's rotation into ``pose``.
    """
    joint, rotation = joint_of_segment[segment], rotation_from_matrix(segment_rotations[parent])
    if joint >= 0:
        x, y, z = state[joint, 0], state[joint, 1], state[joint, 2]
        if x != 0.0 or y != 0.0 or z != 0.0:
            rotation = compose(rotation, rotation_from_gibbs(x, y, z))
    write_rotation(rotation, segment_rotations[segment])
    write_rotation(compose(rotation, rotation_from_matrix(start.rotations[segment])), pose.rotations[segment])
    return rotation


@kernel
def pose_point(point, origin, rotation, start, positions):
    """Write the position of ``point`` of a segment whose ``rotation`` from the pose ``start`` is given, from that of
    its point ``origin``.
    """
    before, past, here = start.positions[origin], start.positions[point], positions[origin]
    x, y, z = past[0] - before[0], past[1] - before[1], past[2] - before[2]
    write_transformed_point((here[0], here[1], here[2]), rotation, x, y, z, positions[point])


@kernel
def pose_arm(side, state, joint_of_segment, start, segment_rotations, pose):
    """Pose an arm relative to its clavicle as in the motion, rotated about its shoulder if the search frees that."""
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    shoulder, upper = (
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    rotation = pose_segment(upper, upper - 1, state, joint_of_segment, start, segment_rotations, pose)
    pose_point(shoulder + 1, shoulder, rotation, start, pose.positions)
    for bone in range(1, 3):
        write_rotation(
            compose(rotation, rotation_from_matrix(start.rotations[upper + bone])), pose.rotations[upper + bone]
        )
        pose_point(shoulder + bone + 1, shoulder, rotation, start, pose.positions)


@kernel
def pose_limb(parent, upper, root, first, rotations, start, pose):
    """Pose a limb from the rotations of its segments in their parents, ``rotations[first:]`` (n, 3, 3)."""
    before = parent
    for bone in range(3 if parent > 0 else 4):
        segment, point = upper + bone, root + bone
        write_rotation(
            compose(rotation_from_matrix(pose.rotations[before]), rotation_from_matrix(rotations[first + bone])),
            pose.rotations[segment],
        )
        x, y, z = offset_between(start.positions[point], start.positions[point + 1])
        x, y, z = transform_point(
            ZERO_VECTOR, inverse_rotation(rotation_from_matrix(start.rotations[segment])), x, y, z
        )
        now = rotation_from_matrix(pose.rotations[segment])
        write_transformed_point(pose.positions[point], now, x, y, z, pose.positions[point + 1])
        before = segment


@kernel
def pose_trunk(state, joint_of_segment, start, segment_rotations, pose):
    """Pose root, spine, neck, head, clavicles and hip joints from the joints' state; limbs are posed later.

    ``start`` is the unsolved pose, ``pose`` the one being written.
    """
    positions = pose.positions
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    root = joint_of_segment[joint_of_segment.shape[0] - 1]
    for axis in range(3):
        positions[0, axis] = start.positions[0, axis] + (state[root, axis] if root >= 0 else 0.0)
    for segment in range(spine_count + 2):
        parent = segment - 1 if segment > 0 else spine_count + SEGMENTS_BESIDE_SPINE
        rotation = pose_segment(segment, parent, state, joint_of_segment, start, segment_rotations, pose)
        pose_point(segment + 1, segment, rotation, start, positions)
    chest, pelvis = rotation_from_matrix(segment_rotations[spine_count - 1]), rotation_from_matrix(segment_rotations[0])
    for side in range(2):
        collar, clavicle = (
            spine_count + COLLAR_POINT + POINTS_PER_LIMB * side,
            spine_count + CLAVICLE_SEGMENT + SEGMENTS_PER_LIMB * side,
        )
        pose_point(collar, spine_count, chest, start, positions)
        rotation = pose_segment(clavicle, spine_count - 1, state, joint_of_segment, start, segment_rotations, pose)
        pose_point(collar + 1, collar, rotation, start, positions)
        pose_point(spine_count + HIP_POINT + POINTS_PER_LIMB * side, 0, pelvis, start, positions)
