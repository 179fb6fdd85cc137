"""Small vector algebra for kernels: points (3,) in, numbers out. Element by element: slices that are assigned cost."""

import math

from studio.core.kernels.compiling import kernel, small_kernel

Place = tuple[float, float, float]
ORIGIN = 0.0, 0.0, 0.0
"""No way at all."""


@small_kernel
def distance(a, b):
    """Metres between two points (3,)."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@small_kernel
def length(vector):
    """Of a vector (3,)."""
    return math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)


@small_kernel
def length_along(vector, axes):
    """Of a vector's part (2,) along the ground, or of all of it where ``axes`` is 3."""
    return math.sqrt(vector[0] ** 2 + vector[1] ** 2 + (vector[2] ** 2 if axes > 2 else 0.0))


@small_kernel
def between(a, b):
    """The way (x, y, z) from point a to point b."""
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


@small_kernel
def plus(a, b):
    """The sum (x, y, z) of two vectors (3,)."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@small_kernel
def copy_point(a, out_point):
    """``out_point`` becomes ``a``, both (3,)."""
    out_point[0], out_point[1], out_point[2] = a[0], a[1], a[2]


@small_kernel
def copy_matrix(a, out_matrix):
    """``out_matrix`` becomes ``a``, both (3, 3)."""
    for row in range(3):
        for column in range(3):
            out_matrix[row, column] = a[row, column]


@kernel
def copy_points(a, out_points):
    """``out_points`` become ``a``, both (N, 3)."""
    for row in range(a.shape[0]):
        copy_point(a[row], out_points[row])


@kernel
def clear_points(out_points):
    """``out_points`` (N, 3) become 0."""
    for row in range(out_points.shape[0]):
        out_points[row, 0] = out_points[row, 1] = out_points[row, 2] = 0.0


@kernel
def blend_points(share, a, b, out_points):
    """``out_points`` become ``a`` and a ``share`` of the way from there to ``b``, all (N, 3)."""
    for row in range(a.shape[0]):
        for axis in range(3):
            out_points[row, axis] = a[row, axis] + share * (b[row, axis] - a[row, axis])
