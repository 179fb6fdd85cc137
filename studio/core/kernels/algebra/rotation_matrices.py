"""Rotation matrices (3, 3) that act on columns; output arguments come last."""

import math

from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix, rotation_vector
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel


@kernel
def matrix_product(first, second, out_matrix):
    """Matrix product first @ second (3, 3); ``out_matrix`` is neither of them."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = (
                first[row, 0] * second[0, column]
                + first[row, 1] * second[1, column]
                + first[row, 2] * second[2, column]
            )


@kernel
def matrix_product_transposed(first, second, out_matrix):
    """Matrix product first @ second^T (3, 3): the rotation from second to first. ``out_matrix`` is neither of them."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = (
                first[row, 0] * second[column, 0]
                + first[row, 1] * second[column, 1]
                + first[row, 2] * second[column, 2]
            )


@kernel
def rotation_vector_to_matrix(wx, wy, wz, out_matrix):
    """Rotation matrix (3, 3) of a rotation vector in radians (Rodrigues, by its half-angle quaternion)."""
    angle = math.sqrt(wx * wx + wy * wy + wz * wz)
    k = math.sin(0.5 * angle) / angle if angle > 1e-9 else 0.5
    quaternion_to_matrix(k * wx, k * wy, k * wz, math.cos(0.5 * angle), out_matrix)


@kernel
def quaternion_to_matrix(x, y, z, w, out_matrix):
    """Rotation matrix (3, 3) of a unit quaternion."""
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
    """Rotation vector (3,) in radians of a rotation matrix (3, 3)."""
    copy_point(rotation_vector(rotation_from_matrix(matrix)), out_vector)
