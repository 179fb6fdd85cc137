"""Keep-upright tasks: an axis of a segment within a cone about a direction; the rotation about the direction is free.

In a record of ``kernels.tasks.task``, ``offsets[1]`` is the axis in the segment's own axes, ``goal_positions[1]`` the
direction, and ``goal_distance`` the greatest lean in radians at this frame (METHOD 7). If the task follows another
segment of its own body, the direction is fixed to that segment: the first column of ``relative``; ``end_fractions[1]``
is then 1 if rows count the rotation of that segment too.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    rotation_from_matrix,
    rotation_from_vector,
    write_rotation,
)
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.search.joints import add_rotation_jacobian
from studio.core.kernels.tasks.goals import RADIAN_LENGTH
from studio.core.kernels.tasks.second_order import INEQUALITY_ROW, begin_zero_row

NARROW_CONE_ANGLE = 0.05
"""Angle in radians of a cone below which a held axis is held in both directions: near the tip no single direction leads
out of the cone.
"""
LEAST_LEAN_SINE = 1e-9
"""Sine of a lean below which the lean has no direction."""


@kernel
def upright_direction(row, pose):
    """Unit direction (x, y, z) about which a keep-upright task keeps its axis: fixed in the world or in another
    segment.
    """
    if row.points[1] < 0:
        goal = row.goal_positions[1]
        return goal[0], goal[1], goal[2]
    rotation, own = pose.rotations[row.segments[1]], row.relative
    return (
        rotation[0, 0] * own[0, 0] + rotation[0, 1] * own[1, 0] + rotation[0, 2] * own[2, 0],
        rotation[1, 0] * own[0, 0] + rotation[1, 1] * own[1, 0] + rotation[1, 2] * own[2, 0],
        rotation[2, 0] * own[0, 0] + rotation[2, 1] * own[1, 0] + rotation[2, 2] * own[2, 0],
    )


@kernel
def axis_lean(row, pose):
    """(lean in radians, (x, y, z)): angle of a task's axis from its direction, and the unit axis of the rotation
    back.
    """
    rotation, own, goal = pose.rotations[row.segments[0]], row.offsets[1], upright_direction(row, pose)
    ax = rotation[0, 0] * own[0] + rotation[0, 1] * own[1] + rotation[0, 2] * own[2]
    ay = rotation[1, 0] * own[0] + rotation[1, 1] * own[1] + rotation[1, 2] * own[2]
    az = rotation[2, 0] * own[0] + rotation[2, 1] * own[1] + rotation[2, 2] * own[2]
    x, y, z = ay * goal[2] - az * goal[1], az * goal[0] - ax * goal[2], ax * goal[1] - ay * goal[0]
    sine = math.sqrt(x * x + y * y + z * z)
    angle = math.atan2(sine, ax * goal[0] + ay * goal[1] + az * goal[2])
    if sine < LEAST_LEAN_SINE:
        side = 0 if abs(own[0]) < abs(own[1]) else 1
        side = side if abs(own[side]) < abs(own[2]) else 2
        bx, by, bz = rotation[0, side], rotation[1, side], rotation[2, side]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        sine = math.sqrt(x * x + y * y + z * z)
    return angle, (x / sine, y / sine, z / sine)


@kernel
def set_upright_goal(row, direction, cone, start):
    """Set the allowed lean of a keep-upright task at this frame: by activation between that in the unsolved pose
    ``start`` and the angle of the ``cone``.
    """
    copy_point(direction, row.goal_positions[1])
    lean, _ = axis_lean(row, start)
    row.goal_distance = cone + (1.0 - row.activation) * max(lean - cone, 0.0)


@kernel
def upright_residual(row, pose):
    """Lean in radians of a keep-upright task beyond its allowed lean."""
    return max(axis_lean(row, pose)[0] - row.goal_distance, 0.0)


@kernel
def follow_upright(row, pose):
    """Set the goal rotation of a keep-upright task: the nearest to the present one within the allowed lean."""
    lean, (x, y, z) = axis_lean(row, pose)
    beyond, now = max(lean - row.goal_distance, 0.0), rotation_from_matrix(pose.rotations[row.segments[0]])
    write_rotation(compose(rotation_from_vector(beyond * x, beyond * y, beyond * z), now), row.goal_rotation)


@kernel
def add_upright_rows(row, weight_row, is_held, count, problem):
    """Add a row that tilts a segment of the trunk back; returns the new number of rows.

    A held task has an inequality row at the cone instead, or two rows at its apex.
    """
    rows, pose = problem.search.rows, problem.pose
    lean, (x, y, z) = axis_lean(row, pose)
    residual = row.kept_residual if is_held else 0.0
    most = row.goal_distance + residual
    beyond = lean - most
    if not is_held and beyond <= 0.0:
        return count
    count = add_axis_row((x, y, z), beyond, row, weight_row, count, problem)
    if is_held and most < NARROW_CONE_ANGLE:
        goal = upright_direction(row, pose)
        across = y * goal[2] - z * goal[1], z * goal[0] - x * goal[2], x * goal[1] - y * goal[0]
        if beyond < 0.0:
            rows.errors[count - 1] = 0.0
        return add_axis_row(across, 0.0, row, weight_row, count, problem)
    if is_held and residual == 0.0:
        rows.roles[count - 1] = INEQUALITY_ROW
    return count


@kernel
def add_axis_row(axis, angle, row, weight_row, count, problem):
    """Add a row that rotates a task's segment about ``axis`` (x, y, z) by ``angle`` radians, relative to the segment
    that it follows.
    """
    chain, rows = problem.chain, problem.search.rows
    begin_zero_row(rows, count, weight_row, RADIAN_LENGTH * angle)
    for fraction in range(3):
        arm, jacobian = RADIAN_LENGTH * axis[fraction], rows.jacobian[count]
        add_rotation_jacobian(fraction, arm, row.segments[0], chain.joints, jacobian)
        if row.points[1] >= 0 and row.end_fractions[1] > 0.0:
            add_rotation_jacobian(fraction, -arm, row.segments[1], chain.joints, jacobian)
    return count + 1


@kernel
def pin_upright(row, pose):
    """Set the allowed lean of a keep-upright task to its lean in ``pose``, if that is greater."""
    row.goal_distance = max(row.goal_distance, axis_lean(row, pose)[0])
