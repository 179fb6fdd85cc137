"""Small rotation algebra for kernels: 3x3 matrices on columns; ``out`` comes last."""

import math

from studio.core.kernels.compiling import kernel, small_kernel


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
def multiply_by_transposed(first, second, out_matrix):
    """Matrix product first @ second^T (3, 3): the turn from second to first; ``out_matrix`` is neither of them."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = (
                first[row, 0] * second[column, 0]
                + first[row, 1] * second[column, 1]
                + first[row, 2] * second[column, 2]
            )


@small_kernel
def add_rotated(origin, matrix, x, y, z, out_point):
    """Point origin + matrix @ (x, y, z), all (3,)."""
    for axis in range(3):
        out_point[axis] = origin[axis] + matrix[axis, 0] * x + matrix[axis, 1] * y + matrix[axis, 2] * z


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
