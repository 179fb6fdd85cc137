"""Goals and residuals of the tasks, dispatched by kind.

Each kind has its own file. A new kind is added to each list here, to ``kernels.tasks.jacobian_rows`` and to
``solver/task_assembly/kinds``.
"""

from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.area_shapes import activate_area, area_residual, follow_area, set_area_pose
from studio.core.kernels.tasks.balance import balance_residual, follow_balance, pin_balance, set_balance_goal
from studio.core.kernels.tasks.distance import distance_residual, follow_distance, length_between, set_distance_goal
from studio.core.kernels.tasks.goals import (
    AREA_TASK,
    BALANCE_TASK,
    DISTANCE_TASK,
    LOOK_AT_TASK,
    ORIENTATION_TASK,
    POSITION_TASK,
    UPRIGHT_TASK,
    end_position,
    follows_own_body,
    has_residual,
)
from studio.core.kernels.tasks.look_at import follow_look, pin_look, set_look_goal
from studio.core.kernels.tasks.orientation import follow_orientation, rotation_residual, set_orientation_goal
from studio.core.kernels.tasks.position import follow_position, pin_position, position_residual, set_position_goal
from studio.core.kernels.tasks.task_status import ACTIVE, UNPINNED
from studio.core.kernels.tasks.upright import follow_upright, pin_upright, set_upright_goal, upright_residual


@kernel
def set_goal(c, frame, targets, problem):
    """Set the goal of task ``c`` at a frame: between the unsolved pose and its target, by activation (METHOD 7)."""
    row, area, start = problem.tasks[c], problem.areas[c], problem.start
    position = targets.positions[c, frame if targets.positions.shape[1] > 1 else 0]
    rotation = targets.rotations[c, frame if targets.rotations.shape[1] > 1 else 0]
    number = targets.distances[c, frame if targets.distances.shape[1] > 1 else 0]
    if row.kind == ORIENTATION_TASK:
        set_orientation_goal(row, rotation_from_matrix(rotation), start)
    elif row.kind == BALANCE_TASK:
        set_balance_goal(row, position, problem.body.mass_fractions, start)
    elif row.kind == LOOK_AT_TASK:
        set_look_goal(row, position, start)
    elif row.kind == UPRIGHT_TASK:
        set_upright_goal(row, position, number, start)
    elif row.kind == AREA_TASK:
        set_area_pose(row, area, position, rotation)
    elif row.kind == DISTANCE_TASK:
        set_distance_goal(row, position, number, start)
    else:
        set_position_goal(row, position, start)
    if follows_own_body(row):
        follow_own_body(c, problem)


@kernel
def update_goals(level, solved, problem):
    """Update the goals, down to a ``level``, that depend on the present pose: of distances, areas, looks, and followed
    points (METHOD 7).

    ``solved`` is true after limbs have been solved; distances and areas then keep their goals.
    """
    tasks, pose = problem.tasks, problem.pose
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not has_residual(row) or row.level > level:
            continue
        if follows_own_body(row):
            follow_own_body(c, problem)
        if row.kind == DISTANCE_TASK and not solved:
            follow_distance(row, pose)
        elif row.kind == LOOK_AT_TASK:
            follow_look(row, pose)
        elif row.kind == UPRIGHT_TASK:
            follow_upright(row, pose)
        elif row.kind == AREA_TASK and row.status == ACTIVE and not row.engaged and not solved:
            activate_area(row, problem.areas[c], pose)


@kernel
def follow_own_body(c, problem):
    """Update the goal of task ``c`` from the point or segment of its own body that it follows."""
    row, start, pose = problem.tasks[c], problem.start, problem.pose
    if row.kind == POSITION_TASK:
        follow_position(row, start, pose)
    elif row.kind == ORIENTATION_TASK:
        follow_orientation(row, start, pose)
    elif row.kind == LOOK_AT_TASK:
        copy_point(end_position(row, 1, pose), row.goal_positions[0])
    elif row.kind == BALANCE_TASK:
        follow_balance(row, pose)
    else:
        follow_area(row, problem.areas[c], pose)


@kernel
def residual_of(c, problem):
    """Present residual of task ``c``: metres, or radians for a rotation."""
    row, pose = problem.tasks[c], problem.pose
    if row.kind == UPRIGHT_TASK:
        return upright_residual(row, pose)
    if row.kind == ORIENTATION_TASK or row.kind == LOOK_AT_TASK:
        return rotation_residual(row, pose)
    if row.kind == BALANCE_TASK:
        return balance_residual(row, problem.body.mass_fractions, pose)
    if row.kind == DISTANCE_TASK:
        return distance_residual(row, pose)
    if row.kind == AREA_TASK:
        return area_residual(row, problem.areas[c], pose)
    return position_residual(row, pose)


@kernel
def pin_goal(c, above):
    """Freeze the goal of task ``c`` at its result in the problem ``above``, whose pose is that of the higher levels."""
    row, pose = above.tasks[c], above.pose
    if row.kind == DISTANCE_TASK:
        row.goal_distance = length_between(row, pose)
    elif row.kind == POSITION_TASK:
        pin_position(row, pose)
    elif row.kind == ORIENTATION_TASK and row.points[1] < 0:
        copy_matrix(pose.rotations[row.segments[0]], row.goal_rotation)
    elif row.kind == UPRIGHT_TASK:
        pin_upright(row, pose)
    elif row.kind == BALANCE_TASK and row.points[1] < 0:
        pin_balance(row, above.body.mass_fractions, pose)
    else:
        row.engaged = 0
        update_goals(row.level, False, above)
        row.pinned, row.blended_residual = UNPINNED, residual_of(c, above)
        if row.kind == LOOK_AT_TASK:
            pin_look(row, pose)
