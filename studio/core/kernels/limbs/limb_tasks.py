"""Tasks of one limb in closed form: the primary one exactly, the secondary one with the remaining freedom (K05 figure
11).

The primary task is the first that moves a point of the limb; it sets bend and aim. The secondary one sets the swivel
about the axis from the limb's root through the primary point or, where that point is the elbow or the knee, the aim of
the lower segment. Hand or foot is rotated before both. Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    rotation_from_matrix,
    rotation_from_vector,
)
from studio.core.kernels.algebra.vectors import copy_point, distance
from studio.core.kernels.body.parts import end_pose, limb_parts, restore_end, rotate_part
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_limits import allowed_reach, effective_point, limit_limb
from studio.core.kernels.limbs.limb_reach import (
    aim_at,
    bend_and_aim,
    bend_coefficients,
    distance_range,
    swivel_rotation,
    swivel_to,
)
from studio.core.kernels.limbs.stiffness import limit_rotation, stiff_reach
from studio.core.kernels.limits.limb_joint_limits import clamp_elbow_or_knee, damped_swivel, soft_clamp_above
from studio.core.kernels.limits.swing_twist import bend_carrying_twist
from studio.core.kernels.tasks.goals import end_position, interpolate_point, is_dormant, is_position, is_rotation
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.kernels.tasks.task_status import ACTIVE

NEGLIGIBLE_ERROR = 0.25 * PRIORITY_TOLERANCE
"""Error in metres or radians that is ignored."""
BLENDED_POSE_KEPT = 1
"""Value of ``blended_limbs`` for a limb that keeps the pose of ``kernels.time.activation_blend``."""


@kernel
def find_end_tasks(level, tasks, spine_count, out_ends):
    """Write, for each limb (4,), the index of the task of levels 0 to ``level`` that sets the orientation of hand or
    foot, -1 for none.

    Returns a bit mask of the limbs whose task has changed.
    """
    changed = 0
    for limb in range(4):
        grip, end = -1, limb_parts(limb, spine_count)[1] + 2
        for c in range(tasks.shape[0]):
            row = tasks[c]
            holds = is_rotation(row) and row.status == ACTIVE and row.level <= level and row.segments[0] == end
            if holds and grip < 0:
                grip = c
        changed |= (grip != out_ends[limb]) << limb
        out_ends[limb] = grip
    return changed


@kernel
def mark_secondary_tasks(tasks):
    """Mark position tasks as secondary if an earlier position task moves the same limb.

    A secondary task sets the remaining swivel (K05 figures 11 and 13); no other joint moves for it.
    """
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.secondary = 0
        for before in range(c):
            other = tasks[before]
            if is_position(row) and is_position(other) and other.status == ACTIVE and row.limbs[0] >= 0:
                row.secondary |= other.limbs[0] == row.limbs[0] and other.limb_weights[0, 0] > 0.0


@kernel
def reach_range(limb, segment, holds_end, point, limits, pose):
    """(least, greatest, present) distance in metres of ``point`` from the root of its limb.

    If hand or foot is held (``holds_end``), distances of wrist or ankle. With ``limits``, the range is that of elbow or
    knee within them, widened to its bend in the unsolved ``pose``.
    """
    positions, rotations = pose
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    if segment == upper:
        span = distance(point, positions[root])
        return span, span, span
    hinge, wrist = rotations[upper, :, 0], positions[root + 2]
    tip = (wrist[0], wrist[1], wrist[2]) if holds_end and segment >= upper + 2 else point
    own = distance(tip, positions[root])
    if limits.shape[0] == 0:
        fold, reach = distance_range(positions[root], positions[root + 1], hinge, tip)
        return fold, reach, own
    c0, c1, angle, side = bend_coefficients(positions[root], positions[root + 1], hinge, tip)
    bend, bends = bend_carrying_twist(rotations[upper], rotations[upper + 1])[0], limits[limb].bends
    first, last = angle + side * min(bend - bends[1], 0.0), angle + side * max(bend - bends[0], 0.0)
    least, most = max(min(first, last), 0.0), min(max(first, last), math.pi)
    fold, reach = c0 - 2.0 * c1 * math.cos(least), c0 - 2.0 * c1 * math.cos(most)
    return math.sqrt(max(0.0, fold)), math.sqrt(max(0.0, reach)), own


@kernel
def solve_limb(limb, level, problem):
    """Solve all tasks of one limb of levels 0 to ``level`` in order of priority, then clamp its joints.

    A limb in a blended activation transition is within its limits already; it bends and aims from its present pose.
    """
    tasks, limits, state = problem.tasks, problem.body.limits, problem.search.limbs[limb]
    reset_limb(limb, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status != ACTIVE or row.level > level or is_dormant(row):
            continue
        if is_rotation(row):
            if row.limbs[0] == limb:
                rotate_bone(row, limb, problem)
            continue
        for end in range(2):
            if row.limbs[end] == limb and (row.limb_weights[end, 0] > 0.0 or row.limb_weights[end, 1] != 0.0):
                solve_limb_point(c, end, problem)
    if state.has_limits:
        limit_limb(limb, problem)
        if limits[limb].is_active and (state.swivels or state.aims_upper):
            limits[limb].blocked_task = state.primary
        limits[limb].caps_unset = 0


@kernel
def reset_limb(limb, problem):
    """Reset the ``LIMB_STATE`` of a limb, and rotate its hand or foot to the orientation of its task."""
    tasks, search, limits, state = problem.tasks, problem.search, problem.body.limits, problem.search.limbs[limb]
    _, upper, root = limb_parts(limb, problem.pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    turns_end = search.end_tasks[limb] >= 0 and tasks[search.end_tasks[limb]].status == ACTIVE
    state.has_limits = limits.shape[0] > 0 and search.blended_limbs[limb] != BLENDED_POSE_KEPT
    state.end_has_task, state.holds_end = turns_end, limb >= 2 or turns_end
    state.freedoms_used, state.primary, state.primary_end = 0, 0, 0
    state.aims_upper, state.swivels, state.lower_rotated = 0, 0, 0
    if limits.shape[0] > 0:
        limits[limb].is_active, limits[limb].blocked_task, limits[limb].end_rotates = 0, -1, state.holds_end
    if turns_end:
        rotate_segment(tasks[search.end_tasks[limb]].goal_rotation, upper + 2, root + 2, problem.pose)


@kernel
def solve_limb_point(c, end, problem):
    """Move one end of a task to its goal.

    The primary task bends and aims the limb, a secondary one uses the remaining freedom, and a point of hand or foot is
    moved by wrist or ankle alone.
    """
    tasks, pose, limits = problem.tasks, problem.pose, problem.body.limits
    row, segment, limb = tasks[c], tasks[c].segments[end], tasks[c].limbs[end]
    state, free = problem.search.limbs[limb], row.limb_weights[end, 0] > 0.0
    _, upper, root = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    before = rotation_from_matrix(pose.rotations[upper + 1 if state.aims_upper else upper])
    is_primary = state.freedoms_used == 0
    if free and is_primary:
        state.primary, state.primary_end = c, end
        state.aims_upper, state.swivels = segment == upper, segment != upper and not row.stiff
        solve_primary_task(row, end, before, problem)
    elif free and state.freedoms_used == 1:
        if state.has_limits:
            limit_limb(limb, problem)
            copy_point(end_position(tasks[state.primary], state.primary_end, pose), state.primary_point)
        solve_secondary_task(row, end, before, problem)
        state.lower_rotated = state.lower_rotated or (state.has_limits and state.aims_upper)
    if row.limb_weights[end, 1] > 0.0 and segment > upper + 1 and not state.end_has_task:
        aim_hand_or_foot(row, end, root + 2, upper + 2, pose)
        if limits.shape[0] > 0:
            limits[limb].end_rotates = 1
    if is_primary:
        copy_point(end_position(row, end, pose), state.primary_point)
    state.freedoms_used += 1


@kernel
def rotate_bone(row, limb, problem):
    """Rotate the upper or lower segment of a limb to its goal.

    A lower segment that is rotated before any other task rotates the upper one as well, within the limits of elbow or
    knee.
    """
    pose, limits, state = problem.pose, problem.body.limits, problem.search.limbs[limb]
    _, upper, root = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    segment = row.segments[0]
    if segment >= upper + 2:
        return
    rotate_segment(row.goal_rotation, segment, root + segment - upper, pose)
    if state.has_limits and state.freedoms_used == 0 and segment == upper + 1:
        clamp_elbow_or_knee(limb, limits, pose)
        rotation = compose(
            rotation_from_matrix(row.goal_rotation), inverse_rotation(rotation_from_matrix(pose.rotations[segment]))
        )
        rotate_part(
            rotation,
            upper,
            pose.positions.shape[0] - POINTS_BESIDE_SPINE,
            pose.positions[root],
            pose.positions,
            pose.rotations,
        )
    state.freedoms_used += 2
    state.swivels = 0
    state.lower_rotated = state.lower_rotated or (segment == upper + 1 and state.freedoms_used > 2)


@kernel
def rotate_segment(goal, segment, pivot, pose):
    """Rotate a segment of a limb, and its subtree, about the point ``pivot`` to the world rotation ``goal`` (3, 3)."""
    rotation = compose(rotation_from_matrix(goal), inverse_rotation(rotation_from_matrix(pose.rotations[segment])))
    rotate_part(
        rotation,
        segment,
        pose.positions.shape[0] - POINTS_BESIDE_SPINE,
        pose.positions[pivot],
        pose.positions,
        pose.rotations,
    )


@kernel
def solve_primary_task(row, end, before, problem):
    """Bend and aim a limb until its point meets the goal, or is as near as its reach, its soft-IK threshold or a blend
    allows.

    ``before`` is the rotation of the upper segment before. A foot, or a hand with a held orientation, keeps its world
    orientation; otherwise it moves with the limb.
    """
    pose, limits, limb = problem.pose, problem.body.limits, row.limbs[end]
    positions, rotations, holds_end = pose.positions, pose.rotations, problem.search.limbs[limb].holds_end
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    lifted = end_pose(limb, pose)
    point, goal = effective_point(row, end, row.goal_positions[end], holds_end, pose)
    if row.segments[end] == upper:
        aim_at(goal, point, upper, positions.shape[0] - POINTS_BESIDE_SPINE, positions[root], positions, rotations)
    else:
        span = distance(goal, positions[root])
        is_kept = problem.search.blended_limbs[limb] == BLENDED_POSE_KEPT and is_position(row)
        span = row.goal_reaches[end] if is_kept else allowed_reach(row, end, span)
        if limits.shape[0] > 0 and span < row.flexion_thresholds[end]:
            span = -soft_clamp_above(-span, -math.inf, -row.flexion_thresholds[end], -row.min_reach[end])
            limits[limb].is_active = 1
        if row.stiff:
            span = stiff_reach(row, end, distance(point, positions[root]), span)
        bend_and_aim(goal, span, upper, root, point, positions, rotations)
    if row.stiff:
        row.free_change[end, 0] = limit_rotation(1.0, row.max_change[end, 0], upper, root, before, pose)
    if holds_end:
        restore_end(limb, lifted, pose)


@kernel
def solve_secondary_task(row, end, before, problem):
    """Swivel a limb about the point of its primary task, within its limits, towards the goal of its secondary task.

    Where the primary point is on the upper segment, aim the lower segment, whose rotation was ``before``, instead.
    Hands and feet with a held world orientation keep it.
    """
    pose, limits, limb = problem.pose, problem.body.limits, row.limbs[end]
    positions, rotations, state = pose.positions, pose.rotations, problem.search.limbs[limb]
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    _, upper, root = limb_parts(limb, spine_count)
    lifted = end_pose(limb, pose)
    point, goal = effective_point(row, end, row.goal_positions[end], state.holds_end, pose)
    if state.has_limits:
        limited_swivel(limb, goal, point, state.primary_point, limits, pose)
    elif not state.aims_upper:
        swivel_to(goal, point, state.primary_point, upper, spine_count, positions[root], positions, rotations)
    if state.aims_upper:
        point, _ = effective_point(row, end, row.goal_positions[end], state.holds_end, pose)
        aim_at(goal, point, upper + 1, spine_count, positions[root + 1], positions, rotations)
    if row.stiff:
        joint = 1 if state.aims_upper else 0
        limit_rotation(row.segment_weights[end, joint], math.inf, upper + joint, root + joint, before, pose)
    if state.holds_end:
        restore_end(limb, lifted, pose)


@kernel
def limited_swivel(limb, target, point, held, limits, pose):
    """Swivel a limb until ``point`` is nearest to ``target``, about the axis from its root through ``held``, within its
    limits.
    """
    positions, rotations = pose
    parent, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    (x, y, z), sine, cosine = swivel_rotation(target, point, held, positions[root])
    desired = math.atan2(sine, cosine)
    angle = damped_swivel(limits[limb], rotations[parent], rotations[upper], x, y, z, desired)
    rotation = rotation_from_vector(angle * x, angle * y, angle * z)
    rotate_part(rotation, upper, positions.shape[0] - POINTS_BESIDE_SPINE, positions[root], positions, rotations)


@kernel
def aim_hand_or_foot(row, end, joint, segment, pose):
    """Rotate hand or foot about its ``joint`` to aim its point at the goal, by the fraction that is its weight in the
    chain.
    """
    positions, rotations, weight = pose.positions, pose.rotations, row.limb_weights[end, 1]
    point, target = end_position(row, end, pose), row.goal_positions[end]
    if distance(point, target) < NEGLIGIBLE_ERROR:
        return
    goal = interpolate_point(point, target, weight)
    aim_at(goal, point, segment, positions.shape[0] - POINTS_BESIDE_SPINE, positions[joint], positions, rotations)
