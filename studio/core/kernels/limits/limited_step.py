"""Steps of a limb along its joint limits to the least residual of its point (METHOD 10, (28)).

Each step of a clamped limb is a linear least-squares step of shoulder or hip and of elbow or knee, bounded by the
margins of swing, twist and bend. It is a continuous function of the pose, and zero where the residual is zero.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    rotation_about_axis,
    rotation_from_matrix,
    rotation_from_vector,
)
from studio.core.kernels.body.parts import rotate_part
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.limb_reach import bend_coefficients
from studio.core.kernels.limits.swing_twist import (
    range_fraction,
    swing_and_twist,
    swing_fraction,
    swing_gradient,
    twist_gradient,
)
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE

SIDEWAYS_DAMPING, FAR_DAMPING, LEAST_DAMPING = 4.0, 0.01, 1e-4
"""Terms of the damping of a step, per radian squared: factor of the squared residual across the limb (Yamashita and
Fukushima 2001), and factors of the squared limb length, the first where more than ``NEARLY_MET_RESIDUAL`` is left, the
second always, which equals the damping of a full step for a lever of one metre.
"""
NEARLY_MET_RESIDUAL = 20.0 * PRIORITY_TOLERANCE
"""Residual in metres at which a target is nearly met: late steps are full up to it, and half of ``FAR_DAMPING`` applies
at it.
"""
HILDRETH_ITERATIONS = 4
"""Iterations over the bounds in Hildreth's method (Hildreth 1957)."""


@small_kernel
def rotate_vector(rotation, x, y, z):
    """Vector (x, y, z) rotated by a rotation tuple."""
    return (
        rotation[0] * x + rotation[1] * y + rotation[2] * z,
        rotation[3] * x + rotation[4] * y + rotation[5] * z,
        rotation[6] * x + rotation[7] * y + rotation[8] * z,
    )


@small_kernel
def cross_product(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@small_kernel
def dot_product(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def limited_limb_step(fraction, limit, parts, moved, goal, spans, pose):
    """Move the point at ``moved`` (3,) of a limb by ``fraction`` of a step towards ``goal`` (x, y, z) within its joint
    limits.

    Returns the angle of the step in radians. ``limit`` is a ``LIMB_LIMITS`` record, ``parts`` (parent, upper segment,
    root point), ``spans`` the (least, greatest) distance in metres of the point from the root. The subtree moves along.
    """
    positions, rotations = pose
    parent, upper, root = parts
    shoulder, middle, spine_count = positions[root], positions[root + 1], positions.shape[0] - POINTS_BESIDE_SPINE
    frame = compose(rotation_from_matrix(rotations[parent]), rotation_from_matrix(limit.axes[0]))
    back = inverse_rotation(frame)
    hinge = rotations[upper, 0, 0], rotations[upper, 1, 0], rotations[upper, 2, 0]
    r = rotate_vector(back, moved[0] - shoulder[0], moved[1] - shoulder[1], moved[2] - shoulder[2])
    h = rotate_vector(back, hinge[0], hinge[1], hinge[2])
    z = rotate_vector(back, rotations[upper, 0, 2], rotations[upper, 1, 2], rotations[upper, 2, 2])
    c = cross_product(h, rotate_vector(back, moved[0] - middle[0], moved[1] - middle[1], moved[2] - middle[2]))
    e = rotate_vector(back, goal[0] - moved[0], goal[1] - moved[1], goal[2] - moved[2])
    bends = bend_margins(shoulder, middle, hinge, moved, spans)
    x, y, w, bend = hildreth_step(limit, r, c, radial_error(e, r), h, z, bends)
    x, y, w, bend = fraction * x, fraction * y, fraction * w, fraction * bend
    rotate_part(
        rotation_about_axis(hinge, math.cos(bend), math.sin(bend)), upper + 1, spine_count, middle, positions, rotations
    )
    x, y, w = rotate_vector(frame, x, y, w)
    rotate_part(rotation_from_vector(x, y, w), upper, spine_count, shoulder, positions, rotations)
    return math.sqrt(x * x + y * y + w * w + bend * bend)


@kernel
def radial_error(e, r):
    """Error vector ``e`` of a point at ``r`` from the root of its limb, reduced across r to the part that a rotation
    about the root removes (METHOD (28)).
    """
    squared = max(dot_product(r, r), 1e-12)
    far = dot_product(r, r) + 2.0 * dot_product(r, e) + dot_product(e, e)
    fraction = math.sqrt(squared / max(far, squared))
    along = (1.0 - fraction) * dot_product(e, r) / squared
    return fraction * e[0] + along * r[0], fraction * e[1] + along * r[1], fraction * e[2] + along * r[2]


@kernel
def bend_margins(root, middle, hinge, point, spans):
    """(least, greatest) rotation in radians about the hinge that keeps the distance of ``point`` from ``root`` within
    ``spans``, a pair in metres.
    """
    c0, c1, angle, side = bend_coefficients(root, middle, hinge, point)
    if c1 < 1e-9:
        return 0.0, 0.0
    least = math.acos(min(max((c0 - spans[0] * spans[0]) / (2.0 * c1), -1.0), 1.0))
    most = math.acos(min(max((c0 - spans[1] * spans[1]) / (2.0 * c1), -1.0), 1.0))
    if side > 0.0:
        return min(angle - most, 0.0), max(angle - least, 0.0)
    return min(least - angle, 0.0), max(most - angle, 0.0)


@kernel
def hildreth_step(limit, r, c, e, h, z, bends):
    """Damped least-squares step (x, y, z, bend) of a limb within its joint limits: rotation vector of its root and bend
    of its middle joint, radians.

    It minimises |J x - e|^2 + k |x|^2 under the linear inequalities of the limits, by Hildreth's method (METHOD (28)).
    ``r`` and ``c`` are the point's lever and its velocity by the bend, ``e`` its error, ``h`` and ``z`` the axes of
    hinge and bone.
    """
    sx, sy, twist = swing_and_twist(h, z)
    fraction, half = swing_fraction(limit.radii[0], sx, sy), limit.twists[0, 1]
    rotation = range_fraction(limit.twists[0, 0], half, twist)
    swings, twists = swing_gradient(limit.radii[0], z, sx, sy, fraction), twist_gradient(z)
    swing_room = max(limit.caps[0, 0] - fraction, 0.0)
    least_twist, most_twist = (
        -half * max(limit.caps[0, 2] + rotation, 0.0),
        half * max(limit.caps[0, 1] - rotation, 0.0),
    )
    long = max(dot_product(r, r), 1e-9)
    residual = dot_product(e, e)
    far = residual / (residual + NEARLY_MET_RESIDUAL * NEARLY_MET_RESIDUAL)
    damping = (LEAST_DAMPING + far * FAR_DAMPING) * long + SIDEWAYS_DAMPING * (residual - dot_product(e, r) ** 2 / long)
    a = damped_inverse(r, c, damping)
    y = rotate_vector(a, e[0], e[1], e[2])
    x, bend = cross_product(r, y), dot_product(c, y)
    swing_turn, swing_bend = bound_response(swings, 0.0, r, c, a, damping)
    twist_turn, twist_bend = bound_response(twists, 0.0, r, c, a, damping)
    own_turn, own_bend = bound_response((0.0, 0.0, 0.0), 1.0, r, c, a, damping)
    swing_give, twist_give = max(dot_product(swings, swing_turn), 1e-9), max(dot_product(twists, twist_turn), 1e-9)
    swing_push = twist_push = bend_push = 0.0
    for _ in range(HILDRETH_ITERATIONS):
        more = bound_multiplier(swing_push, dot_product(swings, x), -math.inf, swing_room, swing_give) - swing_push
        swing_push, x, bend = swing_push + more, subtract_scaled(x, more, swing_turn), bend - more * swing_bend
        more = bound_multiplier(twist_push, dot_product(twists, x), least_twist, most_twist, twist_give) - twist_push
        twist_push, x, bend = twist_push + more, subtract_scaled(x, more, twist_turn), bend - more * twist_bend
        more = bound_multiplier(bend_push, bend, bends[0], bends[1], max(own_bend, 1e-9)) - bend_push
        bend_push, x, bend = bend_push + more, subtract_scaled(x, more, own_turn), bend - more * own_bend
    return x[0], x[1], x[2], bend


@small_kernel
def subtract_scaled(x, fraction, y):
    """Vector x - ``fraction`` y of two vectors (3,)."""
    return x[0] - fraction * y[0], x[1] - fraction * y[1], x[2] - fraction * y[2]


@kernel
def bound_multiplier(push, value, least, most, give):
    """Updated Lagrange multiplier of the bounds ``least`` to ``most`` of a ``value``, from its present multiplier
    ``push``.

    ``give`` is the response of the value to a unit multiplier (METHOD (28)).
    """
    above, below = push + (value - most) / give, push + (value - least) / give
    return above if above > 0.0 else min(below, 0.0)


@kernel
def damped_inverse(r, c, damping):
    """Symmetric inverse (J J^T + k 1)^-1 as nine numbers, for J (rotation, bend) = rotation × r + bend c and the
    damping k.
    """
    squared = dot_product(r, r) + damping
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
def bound_response(rotation, bend, r, c, a, damping):
    """Change (rotation, bend) of the damped least-squares step for a unit multiplier of a bound whose gradient is
    (``rotation``, ``bend``).

    It is (1 - J^T (J J^T + k 1)^-1 J) / k times the gradient, with ``a`` the result of ``damped_inverse``.
    """
    vx, vy, vz = cross_product(rotation, r)
    y = rotate_vector(a, vx + bend * c[0], vy + bend * c[1], vz + bend * c[2])
    x, k = cross_product(r, y), 1.0 / damping
    return (k * (rotation[0] - x[0]), k * (rotation[1] - x[1]), k * (rotation[2] - x[2])), k * (
        bend - dot_product(c, y)
    )
