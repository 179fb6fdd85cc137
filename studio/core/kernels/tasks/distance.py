"""Distance tasks: between two points of the body, or between one and a fixed position."""

import math

from studio.core.kernels.algebra.vectors import copy_point, distance
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import end_position


@kernel
def second_end_position(row, pose):
    """Present position (x, y, z) of the second end of a distance task: a point of the body, or the fixed position."""
    if row.points[1] >= 0:
        return end_position(row, 1, pose)
    return row.goal_positions[1, 0], row.goal_positions[1, 1], row.goal_positions[1, 2]


@kernel
def length_between(row, pose):
    """Present distance in metres between both ends of a distance task."""
    return distance(end_position(row, 0, pose), second_end_position(row, pose))


@kernel
def set_distance_goal(row, target, goal, start):
    """Set the goal of a distance task between the distance in ``start`` and the target distance ``goal``, by
    activation.
    """
    copy_point(target, row.goal_positions[1])
    now = length_between(row, start)
    row.goal_distance = now + row.activation * (goal - now)


@kernel
def follow_distance(row, pose):
    """Set the goal positions of both ends of a distance task for the present pose."""
    write_end_goals(
        end_position(row, 0, pose),
        second_end_position(row, pose),
        row.goal_distance,
        row.end_fractions,
        row.goal_positions,
    )


@kernel
def write_end_goals(first, second, distance, fractions, out_goals):
    """Write goals (2, 3) of two points, displaced along their line by ``fractions`` (2,) of the correction to
    ``distance`` metres.

    The form without a unit direction permits a zero distance (METHOD 7, (13)).
    """
    x, y, z = second[0] - first[0], second[1] - first[1], second[2] - first[2]
    now = math.sqrt(x * x + y * y + z * z)
    step = 1.0 - distance / max(now, 1e-6)
    out_goals[0, 0], out_goals[0, 1], out_goals[0, 2] = (
        first[0] + fractions[0] * step * x,
        first[1] + fractions[0] * step * y,
        first[2] + fractions[0] * step * z,
    )
    out_goals[1, 0], out_goals[1, 1], out_goals[1, 2] = (
        second[0] - fractions[1] * step * x,
        second[1] - fractions[1] * step * y,
        second[2] - fractions[1] * step * z,
    )


@kernel
def distance_residual(row, pose):
    """Absolute difference in metres between the present distance and the goal of a distance task."""
    return abs(length_between(row, pose) - row.goal_distance)
