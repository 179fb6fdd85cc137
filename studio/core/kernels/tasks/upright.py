"""Keep upright: an axis of a segment within a cone about a direction; the segment turns about that as it likes.

A record of ``kernels.tasks.task`` has the axis, in the segment's own axes, in ``offsets[1]``, the direction in
``places[1]`` and how far the axis may lean away from it at this frame, in radians, in ``distance`` (METHOD 5).
"""

import math

from studio.core.kernels.algebra.turns import product, put_turn, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.search.joints import add_turn_row
from studio.core.kernels.tasks.goals import TURN_ARM
from studio.core.kernels.tasks.second_order import BOUND, begin_row

POINTED = 0.05
"""Radians of a cone below which a held axis is held both ways: near its tip no single way leads out of it."""
UNTOLD = 1e-9
"""Sine of the lean below which it has no way of its own."""


@kernel
def lean_of(row, pose):
    """(radians, (x, y, z)): how far the axis leans away from its direction, and the unit about which it turns back."""
    turn, own, wanted = pose.rotations[row.segments[0]], row.offsets[1], row.places[1]
    ax = turn[0, 0] * own[0] + turn[0, 1] * own[1] + turn[0, 2] * own[2]
    ay = turn[1, 0] * own[0] + turn[1, 1] * own[1] + turn[1, 2] * own[2]
    az = turn[2, 0] * own[0] + turn[2, 1] * own[1] + turn[2, 2] * own[2]
    x, y, z = ay * wanted[2] - az * wanted[1], az * wanted[0] - ax * wanted[2], ax * wanted[1] - ay * wanted[0]
    sine = math.sqrt(x * x + y * y + z * z)
    angle = math.atan2(sine, ax * wanted[0] + ay * wanted[1] + az * wanted[2])
    if sine < UNTOLD:
        side = 0 if abs(own[0]) < abs(own[1]) else 1
        side = side if abs(own[side]) < abs(own[2]) else 2
        bx, by, bz = turn[0, side], turn[1, side], turn[2, side]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        sine = math.sqrt(x * x + y * y + z * z)
    return angle, (x / sine, y / sine, z / sine)


@kernel
def begin_upright(row, direction, cone, start):
    """How far the axis may lean at this frame: as in the unsolved pose ``start`` or, by activation, within the cone."""
    copy_point(direction, row.places[1])
    lean, _ = lean_of(row, start)
    row.distance = cone + (1.0 - row.share) * max(lean - cone, 0.0)


@kernel
def miss_upright(row, pose):
    """Radians by which the axis leans beyond what it may."""
    return max(lean_of(row, pose)[0] - row.distance, 0.0)


@kernel
def follow_upright(row, pose):
    """The rotation that the segment is to have: the nearest one to that of now that leans no further than it may."""
    lean, (x, y, z) = lean_of(row, pose)
    beyond, now = max(lean - row.distance, 0.0), turn_in(pose.rotations[row.segments[0]])
    put_turn(product(turn_by(beyond * x, beyond * y, beyond * z), now), row.turn)


@kernel
def add_upright_rows(row, owner, is_held, count, problem):
    """One row that turns a segment of the trunk back; held, a bound as wide as the cone, or, at its tip, two rows."""
    rows, pose = problem.search.rows, problem.pose
    lean, (x, y, z) = lean_of(row, pose)
    missed = row.kept_miss if is_held else 0.0
    most = row.distance + missed
    beyond = lean - most
    if not is_held and beyond <= 0.0:
        return count
    count = add_axis_row((x, y, z), beyond, row.segments[0], owner, count, problem)
    if is_held and most < POINTED:
        wanted = row.places[1]
        across = y * wanted[2] - z * wanted[1], z * wanted[0] - x * wanted[2], x * wanted[1] - y * wanted[0]
        if beyond < 0.0:
            rows.errors[count - 1] = 0.0
        return add_axis_row(across, 0.0, row.segments[0], owner, count, problem)
    if is_held and missed == 0.0:
        rows.roles[count - 1] = BOUND
    return count


@kernel
def add_axis_row(axis, angle, segment, owner, count, problem):
    """A row that turns a segment about an ``axis`` (x, y, z) by an ``angle``."""
    chain, rows = problem.chain, problem.search.rows
    begin_row(rows, count, owner, TURN_ARM * angle)
    for part in range(3):
        add_turn_row(part, TURN_ARM * axis[part], segment, chain.joints, rows.jacobian[count])
    return count + 1


@kernel
def pin_upright(row, pose):
    """Ask of the axis that it leans no further than it does in a ``pose``."""
    row.distance = max(row.distance, lean_of(row, pose)[0])
