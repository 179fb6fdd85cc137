"""Arms whose hands touch: an arm without task follows the other hand, or the part of the body under its hand.

The wrist of such an arm is placed on its contact in closed form, in every pose of the search, as a leg is on its ankle.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    rotation_from_matrix,
    transform_point,
)
from studio.core.kernels.algebra.vectors import distance, offset_between
from studio.core.kernels.body.parts import end_pose, limb_parts, restore_end
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.limb import MAX_EXTENSION, SOFT_IK_THRESHOLD, soft_extension
from studio.core.kernels.limbs.limb_reach import bend_and_aim, distance_range
from studio.core.kernels.tasks.task_status import INACTIVE


@kernel
def follow_contacts(level, problem):
    """Restore the hand contacts of the unsolved pose for arms without a task of levels 0 to ``level``.

    A wrist keeps its offset from the other wrist, in the axes of the thorax, or from the segment under the hand, each
    by the weight of that contact.
    """
    tasks, start, pose = problem.tasks, problem.start, problem.pose
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    chest = spine_count - 1
    for side in range(2):
        if not follows_contact(side, level, problem):
            continue
        contact, other = problem.body.hand_contacts[side], limb_parts(1 - side, spine_count)[2] + 2
        together = contact.together if has_task(1 - side, level, tasks) else 0.0
        wrist = limb_parts(side, spine_count)[2] + 2
        x, y, z = contact_wrist_position(wrist, chest, chest, start, pose)
        far, there = pose.positions[other], contact_wrist_position(other, chest, chest, start, pose)
        under = contact_wrist_position(wrist, contact.segment, contact.origin, start, pose)
        rests = (1.0 - together) * contact.resting
        goal = (
            x + together * (far[0] - there[0]) + rests * (under[0] - x),
            y + together * (far[1] - there[1]) + rests * (under[1] - y),
            z + together * (far[2] - there[2]) + rests * (under[2] - z),
        )
        lifted = end_pose(side, pose)
        extend_softly(side, distance(start.positions[wrist], start.positions[wrist - 2]), goal, pose)
        restore_end(side, lifted, pose)


@kernel
def follows_contact(side, level, problem):
    """True if an arm without task down to ``level`` has a hand contact: with a hand that has a task, or with the
    body.
    """
    contact, tasks = problem.body.hand_contacts[side], problem.tasks
    together = contact.together if has_task(1 - side, level, tasks) else 0.0
    return together + contact.resting > 0.0 and not has_task(side, level, tasks)


@kernel
def has_task(limb, level, tasks):
    """True if a task down to ``level`` that is not inactive has a point on a limb."""
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        named = row.limbs[0] == limb or row.limbs[1] == limb
        found = found or (named and row.status != INACTIVE and row.level <= level)
    return found


@small_kernel
def contact_wrist_position(point, segment, origin, start, pose):
    """Position (x, y, z) of ``point`` if it moved with ``segment``, rigidly, from the pose ``start`` to ``pose``.

    ``origin`` is the point at which the segment begins.
    """
    rotation = compose(
        rotation_from_matrix(pose.rotations[segment]), inverse_rotation(rotation_from_matrix(start.rotations[segment]))
    )
    x, y, z = offset_between(start.positions[origin], start.positions[point])
    return transform_point(pose.positions[origin], rotation, x, y, z)


@kernel
def extend_softly(side, own, target, pose):
    """Bend and aim an arm until its wrist meets ``target`` (3,); an arm that is too short extends softly.

    It extends up to its soft-IK threshold, or to its ``own`` extension in metres if that is more, since the swivel of a
    straight arm is ill-conditioned.
    """
    _, upper, shoulder = limb_parts(side, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    root, wrist = pose.positions[shoulder], pose.positions[shoulder + 2]
    reach = distance_range(root, pose.positions[shoulder + 1], pose.rotations[upper, :, 0], wrist)[1]
    x, y, z = offset_between(root, target)
    now, needed = own / reach, math.sqrt(x * x + y * y + z * z) / reach
    most = min(max(now, SOFT_IK_THRESHOLD), MAX_EXTENSION)
    freely = max(now, 2.0 * SOFT_IK_THRESHOLD - 1.0)
    if needed > freely:
        needed = most * soft_extension(needed / most, freely / most) if freely < most else most
    bend_and_aim(target, needed * reach, upper, shoulder, wrist, pose.positions, pose.rotations)
