"""Small vector algebra for kernels: points (3,) in, numbers out. Element by element: slices that are assigned cost."""

import math

from studio.core.kernels.compiling import small_kernel


@small_kernel
def distance(a, b):
    """Metres between two points (3,)."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


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
