"""What each constraint asks of one frame: places and rotations between the unsolved pose and the target (METHOD 5)."""

import math

from studio.core.kernels.algebra.turns import beside, inverse, turn_in
from studio.core.kernels.algebra.vectors import ORIGIN, between
from studio.core.kernels.body.parts import body_point
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.tasks.task import ACTIVE, GIVEN_UP

POSITION = 0
ORIENTATION = 1
DISTANCE = 2
BALANCE = 3
LOOK_AT = 4
AREA = 5
UPRIGHT = 6
"""Kinds as the solver knows them."""
TURN_ARM = 0.3
"""Metres that count as one radian where both are weighed together."""


@small_kernel
def counts(row):
    """Whether a constraint acts at this frame: what it has is its own, also where it was given up."""
    return row.status == ACTIVE or row.status == GIVEN_UP


@small_kernel
def brings_point(row):
    """Whether a constraint brings a point of the body somewhere: neither a turn, nor the centre of mass."""
    return row.kind == POSITION or row.kind == DISTANCE or row.kind == AREA


@small_kernel
def turns_segment(row):
    """Whether a constraint turns a segment, and its miss is an angle."""
    return row.kind == ORIENTATION or row.kind == LOOK_AT or row.kind == UPRIGHT


@small_kernel
def end_place(row, end, pose):
    """Where one end of a constraint (a record of ``kernels.tasks.task``) is now, (x, y, z)."""
    return body_point(row.points[end], row.segments[end], row.offsets[end], pose.positions, pose.rotations)


@small_kernel
def ease_goal(start, target, share):
    """Goal (x, y, z) between where a point is and where it is to be (METHOD 5, (12): interpolate the target)."""
    return (
        start[0] + share * (target[0] - start[0]),
        start[1] + share * (target[1] - start[1]),
        start[2] + share * (target[2] - start[2]),
    )


@kernel
def part_to(first, second, distance, shares, out_goals):
    """Goals (2, 3) of two points that are to be ``distance`` apart, moved along their line by their shares.

    Written without a direction, so that distance zero needs none (METHOD 5, (13)).
    """
    x, y, z = second[0] - first[0], second[1] - first[1], second[2] - first[2]
    now = math.sqrt(x * x + y * y + z * z)
    step = 1.0 - distance / max(now, 1e-6)
    out_goals[0, 0], out_goals[0, 1], out_goals[0, 2] = (
        first[0] + shares[0] * step * x,
        first[1] + shares[0] * step * y,
        first[2] + shares[0] * step * z,
    )
    out_goals[1, 0], out_goals[1, 1], out_goals[1, 2] = (
        second[0] - shares[1] * step * x,
        second[1] - shares[1] * step * y,
        second[2] - shares[1] * step * z,
    )


@kernel
def second_place(row, pose):
    """Where the other point of a distance is now, (x, y, z): on the body, or the place outside."""
    if row.points[1] >= 0:
        return end_place(row, 1, pose)
    return row.places[1, 0], row.places[1, 1], row.places[1, 2]


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
def place_as_followed(row, pose):
    """Where a constraint has its first point: in the axes of what it follows on its own body, or in the world."""
    point = end_place(row, 0, pose)
    if row.points[1] < 0:
        return point
    x, y, z = between(end_place(row, 1, pose), point)
    return beside(ORIGIN, inverse(turn_in(pose.rotations[row.segments[1]])), x, y, z)
