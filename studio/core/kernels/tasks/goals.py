"""Properties of the kinds of task, and positions of their ends (METHOD 7)."""

from studio.core.kernels.body.parts import body_point_position
from studio.core.kernels.compiling import small_kernel
from studio.core.kernels.tasks.task_status import ACTIVE, DROPPED

POSITION_TASK = 0
ORIENTATION_TASK = 1
DISTANCE_TASK = 2
BALANCE_TASK = 3
LOOK_AT_TASK = 4
AREA_TASK = 5
UPRIGHT_TASK = 6
"""Kinds of task, values of the field ``kind``."""
RADIAN_LENGTH = 0.3
"""Length in metres that counts as one radian where metres and radians are weighted together."""


@small_kernel
def has_residual(row):
    """True if a task is active or dropped: its residual has to be measured."""
    return row.status == ACTIVE or row.status == DROPPED


@small_kernel
def moves_point(row):
    """True if a task moves a point of the body: position, distance and area tasks."""
    return row.kind == POSITION_TASK or row.kind == DISTANCE_TASK or row.kind == AREA_TASK


@small_kernel
def is_position(row):
    """True for a position task."""
    return row.kind == POSITION_TASK


@small_kernel
def is_distance(row):
    """True for a distance task."""
    return row.kind == DISTANCE_TASK


@small_kernel
def is_balance(row):
    """True for a balance task."""
    return row.kind == BALANCE_TASK


@small_kernel
def is_dormant(row):
    """True for an area task whose point is in an allowed position."""
    return row.kind == AREA_TASK and not row.engaged


@small_kernel
def has_own_goal(row):
    """True if the goal of a position, orientation or balance task does not depend on the present pose."""
    return (row.kind == POSITION_TASK or row.kind == ORIENTATION_TASK or row.kind == BALANCE_TASK) and row.points[1] < 0


@small_kernel
def limb_follows(row):
    """True if a task moves a limb to a point or a segment of its own body."""
    kind = row.kind
    follows = kind == POSITION_TASK or kind == ORIENTATION_TASK or kind == UPRIGHT_TASK
    return follows and row.points[1] >= 0 and row.limbs[0] >= 0


@small_kernel
def links_two_points(row):
    """True if a position or distance task is between two points of the body, both of which may move."""
    return (row.kind == POSITION_TASK or row.kind == DISTANCE_TASK) and row.points[1] >= 0


@small_kernel
def follows_own_body(row):
    """True if the goal of a task moves with a point or a segment of its own body."""
    return row.kind != DISTANCE_TASK and row.kind != UPRIGHT_TASK and row.points[1] >= 0


@small_kernel
def is_rotation(row):
    """True if a task rotates a segment, so that its residual is an angle."""
    return row.kind == ORIENTATION_TASK or row.kind == LOOK_AT_TASK or row.kind == UPRIGHT_TASK


@small_kernel
def end_position(row, end, pose):
    """Present position (x, y, z) of end 0 or 1 of a task."""
    return body_point_position(row.points[end], row.segments[end], row.offsets[end], pose.positions, pose.rotations)


@small_kernel
def interpolate_point(start, target, fraction):
    """Point (x, y, z) at ``fraction`` of the way from ``start`` to ``target`` (METHOD 7, (12))."""
    return (
        start[0] + fraction * (target[0] - start[0]),
        start[1] + fraction * (target[1] - start[1]),
        start[2] + fraction * (target[2] - start[2]),
    )
