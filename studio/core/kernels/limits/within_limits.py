"""The place within the limits of a limb that is nearest to what its point misses (METHOD 6, (28)).

A limb that was drawn back to its limits turns on from there, along them: a linear least-squares step of shoulder or hip
and of elbow or knee, whose bounds are the room that swing, twist and bend have left. Every step is a continuous
function of where the limb is, and one that ends in the same place it began at where nothing is missed.
"""

import math

from studio.core.kernels.algebra.turns import about, inverse, product, turn_by, turn_in
from studio.core.kernels.body.parts import turn_part
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.reach import bend_range
from studio.core.kernels.limits.swing_twist import (
    part_of_range,
    part_of_swing,
    swing_and_twist,
    swing_slope,
    twist_slope,
)
from studio.core.kernels.tasks.task import STRICT

DAMPING, FAR_DAMPING, LEAST_DAMPING = 4.0, 0.01, 1e-4
"""What a radian squared of turning costs: of what is missed across the limb, squared (Yamashita and Fukushima
2001), and of the length of the limb, squared, where more than ``NEARLY`` is missed, and at least: as of a lever of one
metre where all joints are searched at once.
"""
NEARLY = 20.0 * STRICT
"""Metres of residual up to which a target is nearly met: late steps are taken whole, and half of ``FAR_DAMPING``
counts.
"""
SWEEPS = 4
"""Times that each bound is looked at, one after another (Hildreth 1957)."""


@small_kernel
def turned(turn, x, y, z):
    """A vector turned."""
    return (
        turn[0] * x + turn[1] * y + turn[2] * z,
        turn[3] * x + turn[4] * y + turn[5] * z,
        turn[6] * x + turn[7] * y + turn[8] * z,
    )


@small_kernel
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@small_kernel
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def step_within(part, limit, parts, moved, goal, spans, pose):
    """Turn a limb ``part`` of the way so that what is at ``moved`` (3,) nears ``goal`` (x, y, z) within its ``limit``.

    ``parts`` (carrier, upper segment, root point); ``spans`` (least, most) metres that ``moved`` may come to be
    from the root. What hangs on the limb goes with it. Returns how far it turned, in radians.
    """
    positions, rotations = pose
    carrier, upper, root = parts
    shoulder, middle, spine_count = positions[root], positions[root + 1], positions.shape[0] - 23
    frame = product(turn_in(rotations[carrier]), turn_in(limit.axes[0]))
    back = inverse(frame)
    hinge = rotations[upper, 0, 0], rotations[upper, 1, 0], rotations[upper, 2, 0]
    r = turned(back, moved[0] - shoulder[0], moved[1] - shoulder[1], moved[2] - shoulder[2])
    h = turned(back, hinge[0], hinge[1], hinge[2])
    z = turned(back, rotations[upper, 0, 2], rotations[upper, 1, 2], rotations[upper, 2, 2])
    c = cross(h, turned(back, moved[0] - middle[0], moved[1] - middle[1], moved[2] - middle[2]))
    e = turned(back, goal[0] - moved[0], goal[1] - moved[1], goal[2] - moved[2])
    bends = bend_room(shoulder, middle, hinge, moved, spans)
    x, y, w, bend = nearest_step(limit, r, c, shortened(e, r), h, z, bends)
    x, y, w, bend = part * x, part * y, part * w, part * bend
    turn_part(about(hinge, math.cos(bend), math.sin(bend)), upper + 1, spine_count, middle, positions, rotations)
    x, y, w = turned(frame, x, y, w)
    turn_part(turn_by(x, y, w), upper, spine_count, shoulder, positions, rotations)
    return math.sqrt(x * x + y * y + w * w + bend * bend)


@kernel
def shortened(e, r):
    """A miss ``e`` of what is at ``r`` from the root of its limb: its part across r as a turn of r can take it away.

    METHOD (28).
    """
    squared = max(dot(r, r), 1e-12)
    far = dot(r, r) + 2.0 * dot(r, e) + dot(e, e)
    share = math.sqrt(squared / max(far, squared))
    along = (1.0 - share) * dot(e, r) / squared
    return share * e[0] + along * r[0], share * e[1] + along * r[1], share * e[2] + along * r[2]


@kernel
def bend_room(root, middle, hinge, point, spans):
    """(least, greatest) turn about the hinge that keeps ``point`` between two distances from the root."""
    c0, c1, angle, side = bend_range(root, middle, hinge, point)
    if c1 < 1e-9:
        return 0.0, 0.0
    least = math.acos(min(max((c0 - spans[0] * spans[0]) / (2.0 * c1), -1.0), 1.0))
    most = math.acos(min(max((c0 - spans[1] * spans[1]) / (2.0 * c1), -1.0), 1.0))
    if side > 0.0:
        return min(angle - most, 0.0), max(angle - least, 0.0)
    return min(least - angle, 0.0), max(most - angle, 0.0)


@kernel
def nearest_step(limit, r, c, e, h, z, bends):
    """(x, y, z, bend) with least |J x - e|^2 + k |x|^2 that leaves no room of the limits (METHOD (28))."""
    sx, sy, twist = swing_and_twist(h, z)
    part, half = part_of_swing(limit.radii[0], sx, sy), limit.twists[0, 1]
    turn = part_of_range(limit.twists[0, 0], half, twist)
    swings, twists = swing_slope(limit.radii[0], z, sx, sy, part), twist_slope(z)
    swing_room = max(limit.caps[0, 0] - part, 0.0)
    least_twist, most_twist = -half * max(limit.caps[0, 2] + turn, 0.0), half * max(limit.caps[0, 1] - turn, 0.0)
    long = max(dot(r, r), 1e-9)
    missed = dot(e, e)
    far = missed / (missed + NEARLY * NEARLY)
    damping = (LEAST_DAMPING + far * FAR_DAMPING) * long + DAMPING * (missed - dot(e, r) ** 2 / long)
    a = inverse_of_sum(r, c, damping)
    y = turned(a, e[0], e[1], e[2])
    x, bend = cross(r, y), dot(c, y)
    swing_turn, swing_bend = answer_to(swings, 0.0, r, c, a, damping)
    twist_turn, twist_bend = answer_to(twists, 0.0, r, c, a, damping)
    own_turn, own_bend = answer_to((0.0, 0.0, 0.0), 1.0, r, c, a, damping)
    swing_give, twist_give = max(dot(swings, swing_turn), 1e-9), max(dot(twists, twist_turn), 1e-9)
    swing_push = twist_push = bend_push = 0.0
    for _ in range(SWEEPS):
        more = pressed(swing_push, dot(swings, x), -math.inf, swing_room, swing_give) - swing_push
        swing_push, x, bend = swing_push + more, less(x, more, swing_turn), bend - more * swing_bend
        more = pressed(twist_push, dot(twists, x), least_twist, most_twist, twist_give) - twist_push
        twist_push, x, bend = twist_push + more, less(x, more, twist_turn), bend - more * twist_bend
        more = pressed(bend_push, bend, bends[0], bends[1], max(own_bend, 1e-9)) - bend_push
        bend_push, x, bend = bend_push + more, less(x, more, own_turn), bend - more * own_bend
    return x[0], x[1], x[2], bend


@small_kernel
def less(x, share, y):
    """x - share y."""
    return x[0] - share * y[0], x[1] - share * y[1], x[2] - share * y[2]


@kernel
def pressed(push, value, least, most, give):
    """How hard a bound pushes back that has left ``value`` with ``push``, each unit of it by ``give`` (METHOD (28))."""
    above, below = push + (value - most) / give, push + (value - least) / give
    return above if above > 0.0 else min(below, 0.0)


@kernel
def inverse_of_sum(r, c, damping):
    """The symmetric (J J^T + k 1)^-1 as nine numbers, J x = x_turn x r + x_bend c."""
    squared = dot(r, r) + damping
    xx, yy, zz = (
        squared - r[0] * r[0] + c[0] * c[0],
        squared - r[1] * r[1] + c[1] * c[1],
        squared - r[2] * r[2] + c[2] * c[2],
    )
    xy, xz, yz = c[0] * c[1] - r[0] * r[1], c[0] * c[2] - r[0] * r[2], c[1] * c[2] - r[1] * r[2]
    a, b, d = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    k = 1.0 / (xx * a + xy * b + xz * d)
    e, f, g = k * (xx * zz - xz * xz), k * (xy * xz - xx * yz), k * (xx * yy - xy * xy)
    a, b, d = k * a, k * b, k * d
    return a, b, d, b, e, f, d, f, g


@kernel
def answer_to(turn, bend, r, c, a, damping):
    """How turn and bend answer a unit push along (turn, bend): (1 - J^T (J J^T + k 1)^-1 J) / k times it."""
    vx, vy, vz = cross(turn, r)
    y = turned(a, vx + bend * c[0], vy + bend * c[1], vz + bend * c[2])
    x, k = cross(r, y), 1.0 / damping
    return (k * (turn[0] - x[0]), k * (turn[1] - x[1]), k * (turn[2] - x[2])), k * (bend - dot(c, y))
