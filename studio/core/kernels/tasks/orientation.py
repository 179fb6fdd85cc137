"""Orientation tasks: a segment rotated to a target in the world, or relative to a segment of its own body."""

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    interpolate_rotation,
    rotation_error,
    rotation_from_matrix,
    write_rotation,
)
from studio.core.kernels.algebra.vectors import length
from studio.core.kernels.compiling import kernel


@kernel
def set_orientation_goal(row, goal, start):
    """Set the goal rotation of an orientation task, on the shortest arc from the unsolved rotation to the target
    ``goal``, by activation.
    """
    write_rotation(
        interpolate_rotation(rotation_from_matrix(start.rotations[row.segments[0]]), goal, row.activation),
        row.goal_rotation,
    )


@kernel
def follow_orientation(row, start, pose):
    """Set the goal rotation of an orientation task from the segment that it follows."""
    axes = rotation_from_matrix(pose.rotations[row.segments[1]])
    set_orientation_goal(row, compose(axes, rotation_from_matrix(row.relative)), start)


@kernel
def rotation_residual(row, pose):
    """Angle in radians between the present rotation of a task's segment and its goal."""
    return length(rotation_error(row.goal_rotation, pose.rotations[row.segments[0]]))
