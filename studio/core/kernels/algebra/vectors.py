"""Vector algebra on points (3,), element by element: assigning slices is slow in kernels."""

import math

from studio.core.kernels.compiling import kernel, small_kernel

Point = tuple[float, float, float]
ZERO_VECTOR = 0.0, 0.0, 0.0
"""Zero displacement, or the origin."""


@small_kernel
def distance(a, b):
    """Distance of two points (3,), in their unit."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@small_kernel
def length(vector):
    """Length of a vector (3,)."""
    return math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)


@small_kernel
def length_in_axes(vector, axes):
    """Length of a vector (3,): of its horizontal components if ``axes`` is 2, of all three if it is 3."""
    return math.sqrt(vector[0] ** 2 + vector[1] ** 2 + (vector[2] ** 2 if axes > 2 else 0.0))


@small_kernel
def offset_between(a, b):
    """Vector (x, y, z) from point a to point b."""
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


@small_kernel
def add_vectors(a, b):
    """Sum (x, y, z) of two vectors (3,)."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@small_kernel
def copy_point(a, out_point):
    """Copy the point ``a`` (3,) into ``out_point``."""
    out_point[0], out_point[1], out_point[2] = a[0], a[1], a[2]


@small_kernel
def copy_matrix(a, out_matrix):
    """Copy the matrix ``a`` (3, 3) into ``out_matrix``."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = a[row, column]


@kernel
def copy_points(a, out_points):
    """Copy the points ``a`` (N, 3) into ``out_points``."""
    for row in range(a.shape[0]):
        copy_point(a[row], out_points[row])


@kernel
def zero_points(out_points):
    """Set ``out_points`` (N, 3) to zero."""
    for row in range(out_points.shape[0]):
        out_points[row, 0] = out_points[row, 1] = out_points[row, 2] = 0.0


@kernel
def blend_points(fraction, a, b, out_points):
    """Write a + ``fraction`` (b - a) into ``out_points``, all (N, 3)."""
    for row in range(a.shape[0]):
        for axis in range(3):
            out_points[row, axis] = a[row, axis] + fraction * (b[row, axis] - a[row, axis])
