"""Look-at tasks: a segment's x axis, from a point of the segment, through a position or a point of the own body."""

import math

from studio.core.kernels.algebra.rotation_tuples import compose, rotation_from_matrix, shortest_rotation, write_rotation
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import LOOK_AT_TASK, end_position
from studio.core.kernels.tasks.task_status import PINNED_TO_RESIDUAL, PINNED_TO_ROTATION

LOOKING_AWAY_ANGLE = 1.0
"""Residual in radians from which a held look-at task keeps its rotation instead of its residual, which has no clear
direction there.
"""


@kernel
def set_look_goal(row, target, start):
    """Set the target of a look-at task, and the gaze direction in ``start``."""
    copy_point(target, row.goal_positions[0])
    for axis in range(3):
        row.goal_positions[1, axis] = start.rotations[row.segments[0], axis, 0]
    row.goal_distance = row.activation


@kernel
def follow_look(row, pose):
    """Set the goal rotation of a look-at task: the nearest to the present one that looks at the target, by
    activation.
    """
    if row.pinned == PINNED_TO_ROTATION:
        return
    now = rotation_from_matrix(pose.rotations[row.segments[0]])
    x, y, z = gaze_direction(
        row.goal_positions[1], row.goal_positions[0], end_position(row, 0, pose), row.goal_distance
    )
    write_rotation(compose(shortest_rotation(now[0], now[3], now[6], x, y, z), now), row.goal_rotation)


@kernel
def constrains_gaze(row):
    """True if a held look-at task keeps its angle to the target when the eyes move; False if it looks away from the
    target.
    """
    return row.kind == LOOK_AT_TASK and row.kept_residual < LOOKING_AWAY_ANGLE


@kernel
def gaze_direction(start, target, eye, fraction):
    """Unit direction (x, y, z) at ``fraction`` of the arc from the direction ``start`` to that from ``eye`` to
    ``target``.
    """
    x, y, z = target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]
    length = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    x, y, z = x / length, y / length, z / length
    cosine = min(max(start[0] * x + start[1] * y + start[2] * z, -1.0), 1.0)
    angle = math.acos(cosine)
    sine = math.sin(angle)
    keep, take = 1.0 - fraction, fraction
    if sine > 1e-6:
        keep, take = math.sin((1.0 - fraction) * angle) / sine, math.sin(fraction * angle) / sine
    return keep * start[0] + take * x, keep * start[1] + take * y, keep * start[2] + take * z


@kernel
def pin_look(row, pose):
    """Pin a look-at task to its residual, or to its rotation in ``pose`` if it looks away from the target."""
    row.pinned = PINNED_TO_RESIDUAL
    if row.blended_residual >= LOOKING_AWAY_ANGLE:
        row.pinned, row.blended_residual = PINNED_TO_ROTATION, 0.0
        copy_matrix(pose.rotations[row.segments[0]], row.goal_rotation)
