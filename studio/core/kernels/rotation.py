"""Small rotation algebra for kernels: 3x3 matrices on columns, quaternions (x, y, z, w); ``out`` comes last."""

import math

from studio.core.kernels.compiling import kernel


@kernel
def quaternion_to_matrix(quaternion, out_matrix):
    """Rotation matrix (3, 3) of a unit quaternion (4,)."""
    x, y, z, w = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    xx, yy, zz = 2.0 * x * x, 2.0 * y * y, 2.0 * z * z
    xy, xz, yz = 2.0 * x * y, 2.0 * x * z, 2.0 * y * z
    wx, wy, wz = 2.0 * w * x, 2.0 * w * y, 2.0 * w * z
    out_matrix[0, 0], out_matrix[0, 1], out_matrix[0, 2] = 1.0 - yy - zz, xy - wz, xz + wy
    out_matrix[1, 0], out_matrix[1, 1], out_matrix[1, 2] = xy + wz, 1.0 - xx - zz, yz - wx
    out_matrix[2, 0], out_matrix[2, 1], out_matrix[2, 2] = xz - wy, yz + wx, 1.0 - xx - yy


@kernel
def multiply(first, second, out_matrix):
    """Matrix product first @ second (3, 3); ``out_matrix`` is neither of them."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = (
                first[row, 0] * second[0, column]
                + first[row, 1] * second[1, column]
                + first[row, 2] * second[2, column]
            )


@kernel
def multiply_transposed(first, second, out_matrix):
    """Matrix product first^T @ second (3, 3); ``out_matrix`` is neither of them."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = (
                first[0, row] * second[0, column]
                + first[1, row] * second[1, column]
                + first[2, row] * second[2, column]
            )


@kernel
def multiply_by_transposed(first, second, out_matrix):
    """Matrix product first @ second^T (3, 3): the turn from second to first; ``out_matrix`` is neither of them."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = (
                first[row, 0] * second[column, 0]
                + first[row, 1] * second[column, 1]
                + first[row, 2] * second[column, 2]
            )


@kernel
def add_rotated(origin, matrix, x, y, z, out_point):
    """Point origin + matrix @ (x, y, z), all (3,)."""
    for axis in range(3):
        out_point[axis] = origin[axis] + matrix[axis, 0] * x + matrix[axis, 1] * y + matrix[axis, 2] * z


@kernel
def shortest_arc(ax, ay, az, bx, by, bz, out_matrix):
    """Rotation (3, 3) turning unit a to unit b by the shortest way (METHOD 0); half a turn when they oppose."""
    cosine = ax * bx + ay * by + az * bz
    if cosine < -0.9:
        long_arc(ax, ay, az, bx, by, bz, out_matrix)
        return
    vx, vy, vz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    k = 1.0 / (1.0 + cosine)
    out_matrix[0, 0], out_matrix[0, 1], out_matrix[0, 2] = (
        cosine + k * vx * vx,
        k * vx * vy - vz,
        k * vx * vz + vy,
    )
    out_matrix[1, 0], out_matrix[1, 1], out_matrix[1, 2] = (
        k * vx * vy + vz,
        cosine + k * vy * vy,
        k * vy * vz - vx,
    )
    out_matrix[2, 0], out_matrix[2, 1], out_matrix[2, 2] = (
        k * vx * vz - vy,
        k * vy * vz + vx,
        cosine + k * vz * vz,
    )


@kernel
def long_arc(ax, ay, az, bx, by, bz, out_matrix):
    """The same where a and b nearly oppose, as two half turns: about a, then about the middle h of both.

    4 (h . a) h a^T - 2 h h^T - 2 a a^T + I is a rotation however badly h is known; the usual form divides by 1 + a . b.
    """
    hx, hy, hz = ax + bx, ay + by, az + bz
    length = math.sqrt(hx * hx + hy * hy + hz * hz)
    if length < 1e-6:
        half_turn(ax, ay, az, out_matrix)
        return
    h, a = (hx / length, hy / length, hz / length), (ax, ay, az)
    k = 4.0 * (h[0] * ax + h[1] * ay + h[2] * az)
    for row in range(3):
        for column in range(3):
            one = 1.0 if row == column else 0.0
            out_matrix[row, column] = k * h[row] * a[column] - 2.0 * (h[row] * h[column] + a[row] * a[column]) + one


@kernel
def half_turn(ax, ay, az, out_matrix):
    """Half a turn (3, 3) about some fixed axis perpendicular to unit a: 2 p p^T - I."""
    if abs(az) < 0.9:
        px, py, pz = -ay, ax, 0.0
    else:
        px, py, pz = 0.0, -az, ay
    length = math.sqrt(px * px + py * py + pz * pz)
    px, py, pz = px / length, py / length, pz / length
    out_matrix[0, 0], out_matrix[0, 1], out_matrix[0, 2] = 2.0 * px * px - 1.0, 2.0 * px * py, 2.0 * px * pz
    out_matrix[1, 0], out_matrix[1, 1], out_matrix[1, 2] = 2.0 * px * py, 2.0 * py * py - 1.0, 2.0 * py * pz
    out_matrix[2, 0], out_matrix[2, 1], out_matrix[2, 2] = 2.0 * px * pz, 2.0 * py * pz, 2.0 * pz * pz - 1.0


@kernel
def turn_columns(matrix, angle):
    """Turn a rotation (3, 3) in place about its own z axis: matrix @ Rz(angle)."""
    c, s = math.cos(angle), math.sin(angle)
    for row in range(3):
        x, y = matrix[row, 0], matrix[row, 1]
        matrix[row, 0], matrix[row, 1] = c * x + s * y, c * y - s * x


@kernel
def rotation_vector_to_matrix(wx, wy, wz, out_matrix):
    """Rotation matrix (3, 3) of a rotation vector in radians (Rodrigues, by its half-angle quaternion)."""
    angle = math.sqrt(wx * wx + wy * wy + wz * wz)
    k = math.sin(0.5 * angle) / angle if angle > 1e-9 else 0.5
    x, y, z, w = k * wx, k * wy, k * wz, math.cos(0.5 * angle)
    out_matrix[0, 0], out_matrix[0, 1], out_matrix[0, 2] = (
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
    )
    out_matrix[1, 0], out_matrix[1, 1], out_matrix[1, 2] = (
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
    )
    out_matrix[2, 0], out_matrix[2, 1], out_matrix[2, 2] = (
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )


@kernel
def orthonormalize(matrix):
    """Make a nearly orthonormal (3, 3) exact in place: z kept in direction, x made orthogonal to it, y = z x x."""
    for pair in range(2):
        column = 2 - 2 * pair
        if pair == 1:
            along = matrix[0, 0] * matrix[0, 2] + matrix[1, 0] * matrix[1, 2] + matrix[2, 0] * matrix[2, 2]
            for row in range(3):
                matrix[row, 0] -= along * matrix[row, 2]
        length = math.sqrt(matrix[0, column] ** 2 + matrix[1, column] ** 2 + matrix[2, column] ** 2)
        for row in range(3):
            matrix[row, column] /= length
    matrix[0, 1] = matrix[1, 2] * matrix[2, 0] - matrix[2, 2] * matrix[1, 0]
    matrix[1, 1] = matrix[2, 2] * matrix[0, 0] - matrix[0, 2] * matrix[2, 0]
    matrix[2, 1] = matrix[0, 2] * matrix[1, 0] - matrix[1, 2] * matrix[0, 0]


@kernel
def matrix_to_rotation_vector(matrix, out_vector):
    """Rotation vector (3,) in radians of a rotation matrix (3, 3), by its quaternion (stable up to half a turn)."""
    trace = matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
    if trace > 0.0:
        w = 0.5 * math.sqrt(1.0 + trace)
        k = 0.25 / w
        x = k * (matrix[2, 1] - matrix[1, 2])
        y = k * (matrix[0, 2] - matrix[2, 0])
        z = k * (matrix[1, 0] - matrix[0, 1])
    else:
        i = 0
        if matrix[1, 1] > matrix[i, i]:
            i = 1
        if matrix[2, 2] > matrix[i, i]:
            i = 2
        j, k_ = (i + 1) % 3, (i + 2) % 3
        largest = 0.5 * math.sqrt(max(0.0, 1.0 + matrix[i, i] - matrix[j, j] - matrix[k_, k_]))
        k = 0.25 / largest
        w = k * (matrix[k_, j] - matrix[j, k_])
        parts = (largest, k * (matrix[j, i] + matrix[i, j]), k * (matrix[k_, i] + matrix[i, k_]))
        x, y, z = parts[(3 - i) % 3], parts[(4 - i) % 3], parts[(5 - i) % 3]
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(sine, w) / sine if sine > 1e-12 else 2.0
    out_vector[0], out_vector[1], out_vector[2] = scale * x, scale * y, scale * z


@kernel
def frame_along(zx, zy, zz, out_matrix):
    """Rotation (3, 3) whose z axis is unit z and whose x axis is as near to world X as that allows."""
    x, y, w = 1.0 - zx * zx, -zx * zy, -zx * zz
    length = math.sqrt(x * x + y * y + w * w)
    if length < 1e-6:
        x, y, w = (zy, -zx, 0.0) if abs(zz) < 0.9 else (0.0, zz, -zy)
        length = math.sqrt(x * x + y * y + w * w)
    x, y, w = x / length, y / length, w / length
    out_matrix[0, 0], out_matrix[1, 0], out_matrix[2, 0] = x, y, w
    out_matrix[0, 1], out_matrix[1, 1], out_matrix[2, 1] = zy * w - zz * y, zz * x - zx * w, zx * y - zy * x
    out_matrix[0, 2], out_matrix[1, 2], out_matrix[2, 2] = zx, zy, zz
