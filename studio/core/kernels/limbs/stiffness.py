"""Limbs with a stiff upper or lower segment in their chain: each segment makes a fraction of its free change (METHOD
(19)).

The free changes, those without stiffness, are measured when a level begins. After that the shoulder rotates, and the
elbow changes the distance, by no more than the fraction, and the rest of the chain covers the remainder. A task record
with ``stiff`` set has, for upper and lower segment of each end, the fractions ``segment_weights`` (2, 2), the
``free_change`` (2, 2) in radians and metres, and the ``max_change`` (2, 2); and for each end the ``own_reach`` (2,),
the reach in metres at the motion's own bend.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    rotation_from_matrix,
    rotation_from_vector,
    rotation_vector,
    write_rotation,
)
from studio.core.kernels.algebra.vectors import copy_matrix, length
from studio.core.kernels.body.parts import rotate_part
from studio.core.kernels.body_indices import (
    HIP_POINT,
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    THIGH_SEGMENT,
)
from studio.core.kernels.compiling import kernel
from studio.core.kernels.search.joints import pose_point
from studio.core.kernels.tasks.task_status import ACTIVE

RELEASE_POWER = 32
"""Exponent of the fraction p in the bound p c / (1 - p^32), which vanishes as p approaches 1: a weight of 0.9 acts as
0.93.
"""


@kernel
def release_stiff_limbs(level, tasks):
    """Remove the bounds of the stiff limbs of a level, to measure their free changes; True if the level has any."""
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.stiff and row.level == level and row.status == ACTIVE:
            found = True
            for end in range(2):
                for joint in range(2):
                    row.free_change[end, joint], row.max_change[end, joint] = 0.0, math.inf
    return found


@kernel
def restrict_stiff_limbs(level, tasks):
    """Bound the changes of stiff limbs of a level to p c / (1 - p^32), with c the free change and p the segment's
    weight (METHOD (19)).
    """
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.stiff and row.level == level and row.status == ACTIVE:
            for end in range(2):
                for joint in range(2):
                    fraction = row.segment_weights[end, joint]
                    if fraction < 1.0:
                        row.max_change[end, joint] = (
                            row.free_change[end, joint] * fraction / (1.0 - fraction**RELEASE_POWER)
                        )


@kernel
def move_stiff_leg(side, start, segment_rotations, pose):
    """Pose a leg in its pelvis as in the unsolved pose ``start``, with the foot's world rotation, so that a stiff leg
    moves with the hips.
    """
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    hip, thigh, pelvis = (
        spine_count + HIP_POINT + POINTS_PER_LIMB * side,
        spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side,
        rotation_from_matrix(segment_rotations[0]),
    )
    for bone in range(4):
        if bone < 2:
            write_rotation(
                compose(pelvis, rotation_from_matrix(start.rotations[thigh + bone])), pose.rotations[thigh + bone]
            )
            pose_point(hip + bone + 1, hip, pelvis, start, pose.positions)
        else:
            copy_matrix(start.rotations[thigh + bone], pose.rotations[thigh + bone])
            for axis in range(3):
                along = start.positions[hip + bone + 1, axis] - start.positions[hip + 2, axis]
                pose.positions[hip + bone + 1, axis] = pose.positions[hip + 2, axis] + along


@kernel
def stiff_reach(row, end, now, goal):
    """Reach in metres of a stiff limb for a goal at ``goal`` metres; ``now`` is its reach at the motion's own bend.

    Also writes ``own_reach`` and the free change of the task record ``row``.
    """
    row.own_reach[end] = now
    most = row.max_change[end, 1]
    row.free_change[end, 1] = abs(goal - now)
    return min(max(goal, now - most), now + most)


@kernel
def limit_rotation(fraction, most, segment, pivot, before, pose):
    """Reduce the rotation of ``segment`` since its rotation ``before`` to ``fraction`` of its angle, and to ``most``
    radians.

    Returns the angle in radians before the reduction.
    """
    x, y, z = rotation_vector(compose(rotation_from_matrix(pose.rotations[segment]), inverse_rotation(before)))
    angle = length((x, y, z))
    left = min(fraction * angle, most)
    if left < angle:
        scale = left / angle - 1.0
        less = rotation_from_vector(scale * x, scale * y, scale * z)
        rotate_part(
            less,
            segment,
            pose.positions.shape[0] - POINTS_BESIDE_SPINE,
            pose.positions[pivot],
            pose.positions,
            pose.rotations,
        )
    return angle
