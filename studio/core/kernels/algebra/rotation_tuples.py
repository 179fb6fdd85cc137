"""Rotation matrices as tuples of nine numbers, row by row, and points as tuples of three.

Tuples stay in registers, where small arrays pass through memory. Kernels that pose a body in every frame use them.
"""

import math

from studio.core.kernels.compiling import kernel, small_kernel

RotationTuple = tuple[float, float, float, float, float, float, float, float, float]
IDENTITY = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
"""The identity rotation."""


@small_kernel
def rotation_from_quaternion(quaternions, first):
    """Rotation tuple of the unit quaternion (x, y, z, w) that begins at index ``first`` of ``quaternions``."""
    x, y, z, w = quaternions[first], quaternions[first + 1], quaternions[first + 2], quaternions[first + 3]
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz = x * x2, y * y2, z * z2
    xy, xz, yz = x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    return 1.0 - yy - zz, xy - wz, xz + wy, xy + wz, 1.0 - xx - zz, yz - wx, xz - wy, yz + wx, 1.0 - xx - yy


@small_kernel
def rotation_from_vector(x, y, z):
    """Rotation tuple of a rotation vector (radians), by its half-angle quaternion."""
    angle = math.sqrt(x * x + y * y + z * z)
    sine, cosine = sine_and_cosine(0.5 * angle)
    k = sine / angle if angle > 1e-9 else 0.5
    return rotation_from_quaternion((k * x, k * y, k * z, cosine), 0)


@kernel
def rotation_vector(rotation):
    """Rotation vector (x, y, z) in radians of a rotation tuple, by its quaternion: stable up to half a turn."""
    trace = rotation[0] + rotation[4] + rotation[8]
    if trace > 0.0:
        w = 0.5 * math.sqrt(1.0 + trace)
        k = 0.25 / w
        x, y, z = k * (rotation[7] - rotation[5]), k * (rotation[2] - rotation[6]), k * (rotation[3] - rotation[1])
    else:
        i = 0
        if rotation[4] > rotation[0]:
            i = 1
        if rotation[8] > rotation[4 * i]:
            i = 2
        j, k_ = (i + 1) % 3, (i + 2) % 3
        largest = 0.5 * math.sqrt(max(0.0, 1.0 + rotation[4 * i] - rotation[4 * j] - rotation[4 * k_]))
        k = 0.25 / largest
        w = k * (rotation[3 * k_ + j] - rotation[3 * j + k_])
        parts = (
            largest,
            k * (rotation[3 * j + i] + rotation[3 * i + j]),
            k * (rotation[3 * k_ + i] + rotation[3 * i + k_]),
        )
        x, y, z = parts[(3 - i) % 3], parts[(4 - i) % 3], parts[(5 - i) % 3]
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-12 else 2.0
    return scale * x, scale * y, scale * z


@small_kernel
def rotation_from_gibbs(x, y, z):
    """Rotation tuple of a Gibbs vector, axis times tan(angle / 2), without sine or cosine."""
    k = 2.0 / (1.0 + x * x + y * y + z * z)
    kx, ky, kz = k * x, k * y, k * z
    xy, xz, yz = kx * y, kx * z, ky * z
    return (
        1.0 - ky * y - kz * z, xy - kz, xz + ky,
        xy + kz, 1.0 - kx * x - kz * z, yz - kx,
        xz - ky, yz + kx, 1.0 - kx * x - ky * y,
    )  # fmt: skip


@small_kernel
def rotation_from_matrix(matrix):
    """Rotation tuple of a matrix (3, 3)."""
    return (
        matrix[0, 0], matrix[0, 1], matrix[0, 2],
        matrix[1, 0], matrix[1, 1], matrix[1, 2],
        matrix[2, 0], matrix[2, 1], matrix[2, 2],
    )  # fmt: skip


@small_kernel
def write_rotation(rotation, out_matrix):
    """Write a rotation tuple into a matrix (3, 3)."""
    out_matrix[0, 0], out_matrix[0, 1], out_matrix[0, 2] = rotation[0], rotation[1], rotation[2]
    out_matrix[1, 0], out_matrix[1, 1], out_matrix[1, 2] = rotation[3], rotation[4], rotation[5]
    out_matrix[2, 0], out_matrix[2, 1], out_matrix[2, 2] = rotation[6], rotation[7], rotation[8]


@small_kernel
def compose(a, b):
    """Rotation tuple of the product a b: rotation ``b`` first, then ``a``."""
    return (
        a[0] * b[0] + a[1] * b[3] + a[2] * b[6],
        a[0] * b[1] + a[1] * b[4] + a[2] * b[7],
        a[0] * b[2] + a[1] * b[5] + a[2] * b[8],
        a[3] * b[0] + a[4] * b[3] + a[5] * b[6],
        a[3] * b[1] + a[4] * b[4] + a[5] * b[7],
        a[3] * b[2] + a[4] * b[5] + a[5] * b[8],
        a[6] * b[0] + a[7] * b[3] + a[8] * b[6],
        a[6] * b[1] + a[7] * b[4] + a[8] * b[7],
        a[6] * b[2] + a[7] * b[5] + a[8] * b[8],
    )


@small_kernel
def inverse_rotation(a):
    """Inverse (transpose) of a rotation tuple."""
    return a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]


@small_kernel
def relative_rotation(parent, segment):
    """Rotation tuple of a segment in the axes of its parent, from their world rotations (3, 3)."""
    return compose(inverse_rotation(rotation_from_matrix(parent)), rotation_from_matrix(segment))


@small_kernel
def transform_point(origin, rotation, x, y, z):
    """Point (x', y', z') = ``origin`` + ``rotation`` (x, y, z)."""
    return (
        origin[0] + rotation[0] * x + rotation[1] * y + rotation[2] * z,
        origin[1] + rotation[3] * x + rotation[4] * y + rotation[5] * z,
        origin[2] + rotation[6] * x + rotation[7] * y + rotation[8] * z,
    )


@small_kernel
def write_transformed_point(origin, rotation, x, y, z, out_point):
    """Write the point ``origin`` + ``rotation`` (x, y, z) into ``out_point`` (3,) and return it."""
    position = transform_point(origin, rotation, x, y, z)
    out_point[0], out_point[1], out_point[2] = position
    return position


@kernel
def shortest_rotation(ax, ay, az, bx, by, bz):
    """Rotation tuple of the least rotation from unit vector a to unit vector b, METHOD (1); for opposite ones, half a
    turn.

    Nearly opposite vectors are joined by two half turns, about a and about the middle h of both: 4 (h . a) h a^T - 2 h
    h^T - 2 a a^T + I is a rotation however inexact h is. The usual form divides by 1 + a . b.
    """
    cosine = ax * bx + ay * by + az * bz
    if cosine > -0.9:
        vx, vy, vz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        k = 1.0 / (1.0 + cosine)
        xy, xz, yz = k * vx * vy, k * vx * vz, k * vy * vz
        return (
            cosine + k * vx * vx, xy - vz, xz + vy,
            xy + vz, cosine + k * vy * vy, yz - vx,
            xz - vy, yz + vx, cosine + k * vz * vz,
        )  # fmt: skip
    hx, hy, hz = ax + bx, ay + by, az + bz
    length = math.sqrt(hx * hx + hy * hy + hz * hz)
    if length < 1e-6:
        px, py, pz = (-ay, ax, 0.0) if abs(az) < 0.9 else (0.0, -az, ay)
        length = math.sqrt(px * px + py * py + pz * pz)
        return rotation_by_pi(px / length, py / length, pz / length)
    return compose(rotation_by_pi(hx / length, hy / length, hz / length), rotation_by_pi(ax, ay, az))


@small_kernel
def rotation_by_pi(x, y, z):
    """Rotation by pi about a unit axis p: 2 p p^T - I."""
    xy, xz, yz = 2.0 * x * y, 2.0 * x * z, 2.0 * y * z
    return 2.0 * x * x - 1.0, xy, xz, xy, 2.0 * y * y - 1.0, yz, xz, yz, 2.0 * z * z - 1.0


@small_kernel
def rotation_about_axis(axis, cosine, sine):
    """Rotation tuple about a unit axis (3,) by an angle given by its ``cosine`` and ``sine`` (Rodrigues)."""
    x, y, z = axis[0], axis[1], axis[2]
    k = 1.0 - cosine
    xy, xz, yz = k * x * y, k * x * z, k * y * z
    return (
        cosine + k * x * x, xy - sine * z, xz + sine * y,
        xy + sine * z, cosine + k * y * y, yz - sine * x,
        xz - sine * y, yz + sine * x, cosine + k * z * z,
    )  # fmt: skip


@small_kernel
def rotation_with_z_axis(x, y, z):
    """Rotation tuple with the unit z axis (x, y, z) and its x axis as near to world X as possible."""
    a, b, c = 1.0 - x * x, -x * y, -x * z
    length = math.sqrt(a * a + b * b + c * c)
    if length < 1e-6:
        a, b, c = (y, -x, 0.0) if abs(z) < 0.9 else (0.0, z, -y)
        length = math.sqrt(a * a + b * b + c * c)
    a, b, c = a / length, b / length, c / length
    return a, y * c - z * b, x, b, z * a - x * c, y, c, x * b - y * a, z


@small_kernel
def aim_z_axis(rotation, x, y, z):
    """``rotation`` premultiplied by the least rotation that brings its z axis to the unit vector (x, y, z).

    From the opposite direction the result is half a turn about x.
    """
    ax, ay, az = rotation[0], rotation[3], rotation[6]
    hx, hy, hz = rotation[2] + x, rotation[5] + y, rotation[8] + z
    squared = hx * hx + hy * hy + hz * hz
    if squared > 1e-12:
        k = 2.0 * (hx * ax + hy * ay + hz * az) / squared
        ax, ay, az = ax - k * hx, ay - k * hy, az - k * hz
    astray = ax * x + ay * y + az * z
    ax, ay, az = ax - astray * x, ay - astray * y, az - astray * z
    return ax, y * az - z * ay, x, ay, z * ax - x * az, y, az, x * ay - y * ax, z


@small_kernel
def twist_about_z(rotation, angle):
    """``rotation`` after a rotation by ``angle`` about its own z axis."""
    s, c = sine_and_cosine(angle)
    return (
        c * rotation[0] + s * rotation[1], c * rotation[1] - s * rotation[0], rotation[2],
        c * rotation[3] + s * rotation[4], c * rotation[4] - s * rotation[3], rotation[5],
        c * rotation[6] + s * rotation[7], c * rotation[7] - s * rotation[6], rotation[8],
    )  # fmt: skip


@small_kernel
def sine_and_cosine(angle):
    """Sine and cosine of an angle, exact to the last digit but one, by polynomials about the nearest multiple of pi /
    2.

    Range reduction in two parts (Cody and Waite 1980); coefficients of fdlibm's __kernel_sin and __kernel_cos.
    """
    if not abs(angle) < 1e5:
        return math.sin(angle), math.cos(angle)
    quarters = math.floor(angle * (2.0 / math.pi) + 0.5)
    r = angle - quarters * 1.57079632673412561417 - quarters * 6.07710050650619224932e-11
    z = r * r
    s = 2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    s = r + r * z * (
        -1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * s))
    )
    c = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)
    c = 4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * c))
    c = 1.0 - 0.5 * z + z * z * c
    turned = int(quarters) & 3
    if turned & 1:
        s, c = c, -s
    if turned & 2:
        s, c = -s, -c
    return s, c


@kernel
def interpolate_rotation(begin, goal, fraction):
    """Rotation at ``fraction`` of the shortest arc from ``begin`` to ``goal``."""
    x, y, z = rotation_vector(compose(goal, inverse_rotation(begin)))
    return compose(rotation_from_vector(fraction * x, fraction * y, fraction * z), begin)


@small_kernel
def rotation_error(goal, now):
    """Rotation vector (x, y, z), radians, from ``now`` to ``goal``, both (3, 3)."""
    return rotation_vector(compose(rotation_from_matrix(goal), inverse_rotation(rotation_from_matrix(now))))
