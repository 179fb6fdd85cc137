"""Position tasks: a point at a target position, or at a point of its own body."""

from studio.core.kernels.algebra.rotation_tuples import (
    inverse_rotation,
    rotation_from_matrix,
    transform_point,
    write_transformed_point,
)
from studio.core.kernels.algebra.vectors import ZERO_VECTOR, copy_point, distance, offset_between
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import end_position, interpolate_point
from studio.core.kernels.tasks.task_status import UNPINNED


@kernel
def set_position_goal(row, target, start):
    """Set the goal of a position task between its unsolved point and the ``target``, by activation (METHOD 7, (12))."""
    copy_point(interpolate_point(end_position(row, 0, start), target, row.activation), row.goal_positions[0])


@kernel
def follow_position(row, start, pose):
    """Set the goal of a position task from the point that it follows.

    The goal of a pinned task keeps its offset in the axes of that point's segment.
    """
    position = end_position(row, 1, pose)
    if row.pinned == UNPINNED:
        copy_point(interpolate_point(end_position(row, 0, start), position, row.activation), row.goal_positions[0])
    else:
        axes = rotation_from_matrix(pose.rotations[row.segments[1]])
        write_transformed_point(
            position, axes, row.relative[0, 0], row.relative[0, 1], row.relative[0, 2], row.goal_positions[0]
        )


@kernel
def position_residual(row, pose):
    """Distance in metres from the point of a position task to its goal."""
    return distance(end_position(row, 0, pose), row.goal_positions[0])


@kernel
def pin_position(row, pose):
    """Pin a position task to its point in ``pose``: in the axes of the segment that it follows, or in the world."""
    point = end_position(row, 0, pose)
    if row.points[1] < 0:
        copy_point(point, row.goal_positions[0])
    else:
        x, y, z = offset_between(end_position(row, 1, pose), point)
        axes = rotation_from_matrix(pose.rotations[row.segments[1]])
        copy_point(transform_point(ZERO_VECTOR, inverse_rotation(axes), x, y, z), row.relative[0])
