"""Joint rotations as swing and twist, or as bend, slant and turn, relative to their limits (METHOD (25) and (26))."""

import math

from studio.core.kernels.compiling import kernel


@kernel
def direction_in_axes(parent, axes, x, y, z):
    """World direction (x, y, z) in the ``axes`` (3, 3) of a joint on a segment with world rotation ``parent`` (3,
    3).
    """
    px = parent[0, 0] * x + parent[1, 0] * y + parent[2, 0] * z
    py = parent[0, 1] * x + parent[1, 1] * y + parent[2, 1] * z
    pz = parent[0, 2] * x + parent[1, 2] * y + parent[2, 2] * z
    return (
        axes[0, 0] * px + axes[1, 0] * py + axes[2, 0] * pz,
        axes[0, 1] * px + axes[1, 1] * py + axes[2, 1] * pz,
        axes[0, 2] * px + axes[1, 2] * py + axes[2, 2] * pz,
    )


@kernel
def swing_and_twist(x, z):
    """(swing x, swing y, twist) in radians of a rotation with columns ``x`` and ``z``: rotation vector about x and y,
    and twist about z (METHOD (25)).
    """
    twist = math.atan2(x[1] - (z[1] * x[2] - z[2] * x[1]), x[0] + z[2] * x[0] - z[0] * x[2])
    across = math.sqrt(z[0] * z[0] + z[1] * z[1])
    k = math.atan2(across, z[2]) / across if across > 1e-9 else 1.0
    return -k * z[1], k * z[0], twist


@kernel
def swing_fraction(radii, x, y):
    """Swing (x, y) relative to its limit: 1 on a cone whose section is a quarter of an ellipse in each quadrant (METHOD
    (26)).

    ``radii`` (4,) are the limits in radians about x, -x, y and -y.
    """
    along, across = x / radii[0 if x >= 0.0 else 1], y / radii[2 if y >= 0.0 else 3]
    return math.sqrt(along * along + across * across)


@kernel
def wrap_angle(angle):
    """Angle in radians, wrapped to the range -pi to pi."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@kernel
def range_fraction(middle, half, angle):
    """Angle relative to its range: 0 in the ``middle``, 1 and -1 at the ends, ``half`` away from it (radians)."""
    return wrap_angle(angle - middle) / half


@kernel
def bend_carrying_twist(upper, lower):
    """(flexion, carrying angle, twist) of elbow or knee: R_upper^T R_lower = Rx(flexion) Ry(carrying) Rz(twist)."""
    xx = yx = zx = zy = zz = 0.0
    for axis in range(3):
        xx += upper[axis, 0] * lower[axis, 0]
        yx += upper[axis, 0] * lower[axis, 1]
        zx += upper[axis, 0] * lower[axis, 2]
        zy += upper[axis, 1] * lower[axis, 2]
        zz += upper[axis, 2] * lower[axis, 2]
    return math.atan2(-zy, zz), math.asin(min(max(zx, -1.0), 1.0)), math.atan2(-yx, xx)


@kernel
def swing_gradient(radii, z, sx, sy, fraction):
    """Gradient (x, y, z) of ``swing_fraction`` at the swing (sx, sy) with respect to a rotation of the bone along
    ``z``.
    """
    across = max(math.sqrt(z[0] * z[0] + z[1] * z[1]), 1e-6)
    size = math.sqrt(sx * sx + sy * sy)
    px, py = sx / radii[0 if sx >= 0.0 else 1] ** 2, sy / radii[2 if sy >= 0.0 else 3] ** 2
    scale = 1.0 / (max(fraction, 1e-6) * across)
    out = scale * (py * z[0] - px * z[1]) / across
    about = -scale * (px * z[0] + py * z[1]) * size / (across * across)
    return -out * z[1] - about * z[0] * z[2], out * z[0] - about * z[1] * z[2], about * across * across


@kernel
def twist_gradient(z):
    """Gradient (x, y, z) of the twist with respect to a rotation of the bone along ``z``."""
    scale = 1.0 / max(1.0 + z[2], 1e-3)
    return scale * z[0], scale * z[1], 1.0


@kernel
def rotate_about_axis(a, angle, v):
    """Vector ``v`` (3,) rotated by ``angle`` radians about the unit axis ``a`` (Rodrigues)."""
    c, s = math.cos(angle), math.sin(angle)
    along = (1.0 - c) * (a[0] * v[0] + a[1] * v[1] + a[2] * v[2])
    return (
        c * v[0] + s * (a[1] * v[2] - a[2] * v[1]) + along * a[0],
        c * v[1] + s * (a[2] * v[0] - a[0] * v[2]) + along * a[1],
        c * v[2] + s * (a[0] * v[1] - a[1] * v[0]) + along * a[2],
    )
