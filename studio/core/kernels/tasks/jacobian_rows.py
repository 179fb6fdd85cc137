"""Jacobian rows of the tasks for ``kernels.search.null_space_step`` (METHOD 9).

Functions that add rows write them from row ``count`` on, and return the new number of rows. ``weight_row`` is the row
of the joint weights that moves joints for them; ``is_held`` is true for the rows of a higher level, which hold its
result. Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import rotation_error
from studio.core.kernels.algebra.vectors import distance, length, offset_between
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import HIP_POINT, POINTS_BESIDE_SPINE, POINTS_PER_LIMB
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.root_reach_limit import root_reach_of
from studio.core.kernels.search.chain_reach import reachable_target
from studio.core.kernels.search.joints import add_point_jacobian, add_rotation_jacobian, may_rotate
from studio.core.kernels.tasks.balance import accumulate_masses, add_arm_jacobian, write_balance_jacobian
from studio.core.kernels.tasks.goals import (
    RADIAN_LENGTH,
    UPRIGHT_TASK,
    end_position,
    is_balance,
    is_distance,
    is_dormant,
    is_position,
    is_rotation,
    links_two_points,
)
from studio.core.kernels.tasks.limb_rows import (
    NEARLY_MET_LIMB_RESIDUAL,
    add_point_rows,
    add_reach_rows,
    add_secondary_row,
    add_separation_row,
    add_swivel_row,
    is_point_held,
)
from studio.core.kernels.tasks.look_at import constrains_gaze
from studio.core.kernels.tasks.second_order import (
    EQUALITY_ROW,
    INEQUALITY_ROW,
    begin_filled_row,
    begin_zero_row,
    set_point_error,
)
from studio.core.kernels.tasks.task_status import ACTIVE, DROPPED
from studio.core.kernels.tasks.upright import add_upright_rows


@kernel
def add_root_reach_rows(weight_row, count, problem):
    """Add an inequality row for each planted leg, which keeps its hip within reach of its ankle; returns the new number
    of rows.
    """
    chain, body, task_rows, positions = problem.chain, problem.body, problem.search.rows, problem.pose.positions
    ankles = body.legs.ankles
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    for side in range(2):
        if body.root_reaches[side] == math.inf:
            continue
        point = spine_count + HIP_POINT + POINTS_PER_LIMB * side
        hip, ankle = positions[point], ankles[side]
        length, margin = root_reach_of(side, body, problem.start)
        span = max(distance(hip, ankle), 1e-9)
        begin_zero_row(task_rows, count, weight_row, span - length)
        task_rows.roles[count], task_rows.margins[count] = INEQUALITY_ROW, margin
        per = 1.0 / span
        x, y, z = per * (ankle[0] - hip[0]), per * (ankle[1] - hip[1]), per * (ankle[2] - hip[2])
        set_point_error(task_rows.point_errors[count], x, y, z, span, hip, 0)
        add_point_jacobian(hip, x, y, z, 0, chain.joints, positions, task_rows.jacobian[count])
        count += 1
    return count


@kernel
def add_rows(c, level, weight_row, is_held, count, problem):
    """Add the rows of one task, towards its goal or, if held, towards its saved result; returns the new number of
    rows.
    """
    tasks, search = problem.tasks, problem.search
    task_rows = search.rows
    row = tasks[c]
    first = count
    if is_dormant(row):
        return count
    if row.secondary and not is_held:
        return add_secondary_row(c, weight_row, count, problem)
    if row.kind == UPRIGHT_TASK and row.limbs[0] < 0:
        count = add_upright_rows(row, weight_row, is_held, count, problem)
    elif is_rotation(row):
        count = add_rotation_rows(row, weight_row, is_held, count, problem)
    elif is_balance(row):
        count = add_balance_rows(row, level, weight_row, is_held, count, problem)
    else:
        for end in range(2):
            if row.points[end] < 0:
                continue
            free = row.limbs[end] >= 0 and row.limb_weights[end, 0] > 0.0
            if row.status == DROPPED and row.limbs[end] >= 0:
                count = add_dropped_task_row(c, level, end, weight_row, count, problem)
                continue
            if is_held and links_two_points(row) and row.kept_residual > NEARLY_MET_LIMB_RESIDUAL:
                if end == 0:
                    count = add_separation_row(c, weight_row, count, problem)
                continue
            aims = not row.stiff or row.segment_weights[end, 0] == 1.0
            if free and aims:
                if row.secondary and row.kept_residual > NEARLY_MET_LIMB_RESIDUAL:
                    count = add_swivel_row(c, end, weight_row, count, problem)
                count = add_reach_rows(c, row, end, weight_row, is_held, count, problem)
            elif free or (end == 0 and not is_distance(row)):
                count = add_position_rows(row, end, weight_row, is_held, count, problem)
    if is_held:
        for other in range(first, count):
            task_rows.roles[other] = max(task_rows.roles[other], EQUALITY_ROW)
    elif row.relative_weight != 1.0:
        scale = math.sqrt(row.relative_weight)
        for other in range(first, count):
            task_rows.errors[other] *= scale
            task_rows.point_errors[other].weight = row.relative_weight
            for joint in range(task_rows.jacobian.shape[1]):
                for axis in range(3):
                    task_rows.jacobian[other, joint, axis] *= scale
    return count


@kernel
def add_rotation_rows(row, weight_row, is_held, count, problem):
    """Add three rows that rotate a segment of the trunk, or one row that holds the residual of a limb segment at its
    limits.

    Limb segments are rotated in closed form; a held one keeps the residual that limits leave, as if the limb were
    rigid.
    """
    chain, pose, task_rows = problem.chain, problem.pose, problem.search.rows
    segment = row.segments[0]
    if row.limbs[0] >= 0:
        if not is_held or row.kept_residual <= NEARLY_MET_LIMB_RESIDUAL:
            return count
        error = rotation_error(row.goal_rotation, pose.rotations[segment])
        size = length(error)
        begin_zero_row(task_rows, count, weight_row, RADIAN_LENGTH * (size - row.kept_residual))
        for axis in range(3):
            add_rotation_jacobian(
                axis, RADIAN_LENGTH * error[axis] / max(size, 1e-9), segment, chain.joints, task_rows.jacobian[count]
            )
        return count + 1
    if is_held and constrains_gaze(row):
        x, y, z = rotation_error(row.goal_rotation, pose.rotations[segment])
        fraction = 1.0 - row.kept_residual / max(length((x, y, z)), 0.5 * row.kept_residual, 1e-9)
        error = fraction * x, fraction * y, fraction * z
    else:
        error = rotation_error(row.kept_rotation if is_held else row.goal_rotation, pose.rotations[segment])
    for axis in range(3):
        begin_zero_row(task_rows, count, weight_row, RADIAN_LENGTH * error[axis])
        add_rotation_jacobian(axis, RADIAN_LENGTH, segment, chain.joints, task_rows.jacobian[count])
        count += 1
    return count


@kernel
def add_balance_rows(row, level, weight_row, is_held, count, problem):
    """Add two rows that move the centre of mass horizontally, or three rows if its height counts.

    Arms with position tasks down to ``level`` are taken to reach for their goals meanwhile.
    """
    tasks, chain, masses, positions = problem.tasks, problem.chain, problem.body.masses, problem.pose.positions
    task_rows, sums = problem.search.rows, problem.search.mass_sums
    accumulate_masses(masses, positions, sums)
    now = sums[sums.shape[0] - 1]
    for axis in range(row.axes):
        goal = row.kept_positions[0, axis] if is_held else row.goal_positions[1, axis]
        begin_filled_row(task_rows, count, weight_row, goal - now[axis])
        count += 1
    rows = task_rows.jacobian[count - row.axes : count]
    spine_count, down_to = (
        positions.shape[0] - POINTS_BESIDE_SPINE,
        min(tasks.shape[0] + level, chain.weights.shape[0] - 1),
    )
    write_balance_jacobian(row.axes, masses, sums, chain.joints, positions, rows)
    for c in range(tasks.shape[0]):
        other = tasks[c]
        if is_position(other) and other.status == ACTIVE and other.level <= level and not other.secondary:
            limb = other.limbs[0]
            if not 0 <= limb < 2 or other.limb_weights[0, 0] == 0.0:
                continue
            if not may_rotate(down_to, limb_parts(limb, spine_count)[1], chain):
                add_arm_jacobian(
                    limb, row.axes, other.goal_positions[0], other.goal_reaches[0], sums, chain.joints, positions, rows
                )
    return count


@kernel
def add_dropped_task_row(c, level, end, weight_row, count, problem):
    """Add a row that holds the residual of a dropped position task on an arm, which then moves rigidly with its parent.

    No row is added if another task poses the arm; its effect on the residual is checked at the end.
    """
    tasks, chain, pose, task_rows = problem.tasks, problem.chain, problem.pose, problem.search.rows
    row = tasks[c]
    if not is_position(row) or row.limbs[end] >= 2:
        return count
    for other in tasks:
        poses = other.limbs[0] == row.limbs[end] or other.limbs[1] == row.limbs[end]
        if poses and other.status == ACTIVE and other.level <= level:
            return count
    point = end_position(row, end, pose)
    x, y, z = offset_between(point, row.goal_positions[end])
    size = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    begin_zero_row(task_rows, count, weight_row, size - row.kept_residual)
    add_point_jacobian(
        point, x / size, y / size, z / size, row.segments[end], chain.joints, pose.positions, task_rows.jacobian[count]
    )
    set_point_error(task_rows.point_errors[count], 0.0, 0.0, 0.0, 0.0, point, row.segments[end])
    return count + 1


@kernel
def add_position_rows(row, end, weight_row, is_held, count, problem):
    """Add three rows that move a point of the trunk, or of a limb that the task may not bend, to its goal."""
    chain, pose, task_rows = problem.chain, problem.pose, problem.search.rows
    point, segment = end_position(row, end, pose), row.segments[end]
    first, follows = count, is_position(row) and row.points[1] >= 0
    if is_held and not follows and is_point_held(point, segment, count, task_rows):
        return count
    if is_held:
        x, y, z = offset_between(point, row.kept_positions[end])
    elif is_position(row) and end == 0:
        x, y, z = offset_between(point, reachable_target(row))
    else:
        x, y, z = offset_between(point, row.goal_positions[end])
    if is_held and follows:
        fraction, (dx, dy, dz) = row.activation, offset_between(row.kept_positions[1], end_position(row, 1, pose))
        x, y, z = x + fraction * dx, y + fraction * dy, z + fraction * dz
    count = add_point_rows(point, segment, x, y, z, weight_row, count, problem)
    if not (is_held and follows):
        set_point_error(task_rows.point_errors[first], x, y, z, 0.0, point, segment)
    if follows:
        followed = end_position(row, 1, pose)
        for axis in range(3):
            x, y, z = (1.0 if axis == 0 else 0.0), (1.0 if axis == 1 else 0.0), (1.0 if axis == 2 else 0.0)
            x, y, z = -row.activation * x, -row.activation * y, -row.activation * z
            add_point_jacobian(
                followed, x, y, z, row.segments[1], chain.joints, pose.positions, task_rows.jacobian[first + axis]
            )
    return count
