"""A segment's x axis, begun at a point, through a place or a point of its own body."""

import math

from studio.core.kernels.algebra.turns import product, put_turn, shortest, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import LOOK_AT, end_place
from studio.core.kernels.tasks.task import PINNED, PINNED_TURN

AWAY = 1.0
"""Radians of miss from which on a look that is held keeps its turn: what it misses has no clear direction there."""


@kernel
def begin_look(row, target, start):
    """Note where it is to look, and where ``start`` looks."""
    copy_point(target, row.places[0])
    for axis in range(3):
        row.places[1, axis] = start.rotations[row.segments[0], axis, 0]
    row.distance = row.share


@kernel
def follow_look(row, pose):
    """Its goal: the nearest turn to that of now that looks where it is to, by how much it acts."""
    if row.pinned == PINNED_TURN:
        return
    now = turn_in(pose.rotations[row.segments[0]])
    x, y, z = gaze_goal(row.places[1], row.places[0], end_place(row, 0, pose), row.distance)
    put_turn(product(shortest(now[0], now[3], now[6], x, y, z), now), row.turn)


@kernel
def keeps_looking(row):
    """Whether a look that is held keeps what it misses of its target, wherever the eyes go: unless it looks away."""
    return row.kind == LOOK_AT and row.kept_miss < AWAY


@kernel
def gaze_goal(start, target, eye, share):
    """Unit direction (x, y, z) that is ``share`` of the way from ``start`` to the line from ``eye`` to ``target``."""
    x, y, z = target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]
    length = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    x, y, z = x / length, y / length, z / length
    cosine = min(max(start[0] * x + start[1] * y + start[2] * z, -1.0), 1.0)
    angle = math.acos(cosine)
    sine = math.sin(angle)
    keep, take = 1.0 - share, share
    if sine > 1e-6:
        keep, take = math.sin((1.0 - share) * angle) / sine, math.sin(share * angle) / sine
    return keep * start[0] + take * x, keep * start[1] + take * y, keep * start[2] + take * z


@kernel
def pin_look(row, pose):
    """Ask of it to miss what it does in a ``pose``; where it looks away, to stay turned so."""
    row.pinned = PINNED
    if row.blended_miss >= AWAY:
        row.pinned, row.blended_miss = PINNED_TURN, 0.0
        copy_matrix(pose.rotations[row.segments[0]], row.turn)
