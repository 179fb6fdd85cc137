"""A body over two feet that stand otherwise than its motion has them: legs keep their lengths (METHOD section 4)."""

import math

from studio.core.kernels.algebra.vectors import between, distance
from studio.core.kernels.compiling import kernel

YIELDING = 0.2
"""What a metre counts that a body moves along the ground; up or down, or by which a standing leg is longer or shorter,
it counts 1, squares of all. Knees show by degrees what hips hide, which go 1 cm aside for 5 mm of a leg. Half as much
brings straight knees of high ankles to a jolt.
"""
BENT, MOST_SHOWN = 0.1, 5
"""Square of the sine of half the bend of a knee whose leg's metre counts 1, and what that of a straight one counts: it
shows what is missing of its leg many times over.
"""


@kernel
def keep_lengths(off, weights, hips, positions, way):
    """Turn the ``way`` (F, 3) that a body goes along, in place, so that legs that stand flat are as long as they were.

    Feet stand ``off`` (2, F, 3) where ``positions`` (F, P, 3) have them; ``hips`` are the rows of both hips there,
    ankles the second after. ``weights`` (F, 3): the left leg's share of the body, and how much each foot stands flat.
    """
    for frame in range(way.shape[0]):
        share = min(max(weights[frame, 0], 0.0), 1.0)
        left = _length_missing(0, off, share * weights[frame, 1], hips[0], positions, way, frame)
        right = _length_missing(1, off, (1.0 - share) * weights[frame, 2], hips[1], positions, way, frame)
        if left[3] == 0.0 and right[3] == 0.0:
            continue
        # the least move, by its own measure, for which both are right as far as it is worth it
        both = _dot(left, right)
        first, second = 1.0 + _dot(left, left), 1.0 + _dot(right, right)
        whole = first * second - both * both
        by_left = (second * left[3] - both * right[3]) / whole
        by_right = (first * right[3] - both * left[3]) / whole
        for axis in range(3):
            way[frame, axis] += (by_left * left[axis] + by_right * right[axis]) / (YIELDING if axis < 2 else 1.0)


@kernel
def _dot(a, b):
    """The product of two legs' directions, moves along the ground counting little."""
    return (a[0] * b[0] + a[1] * b[1]) / YIELDING + a[2] * b[2]


@kernel
def _length_missing(side, off, weight, hip, positions, way, frame):
    """A leg's direction, halfway to where it is to go, and metres it would be too long by, times its weight's root: the
    ``weight`` that it stands with, times how much its knee shows.
    """
    points = positions[frame]
    x, y, z = between(way[frame], off[side, frame])
    along = points[hip + 2, 0] - points[hip, 0] + 0.5 * x
    aside = points[hip + 2, 1] - points[hip, 1] + 0.5 * y
    down = points[hip + 2, 2] - points[hip, 2] + 0.5 * z
    span = max(math.sqrt(along * along + aside * aside + down * down), 1e-9)
    bones = distance(points[hip], points[hip + 1]) + distance(points[hip + 1], points[hip + 2])
    bend = max(1.0 - (distance(points[hip], points[hip + 2]) / bones) ** 2, 0.0)
    part = math.sqrt(max(weight, 0.0) / (bend / BENT + 1.0 / MOST_SHOWN)) / span
    along, aside, down = part * along, part * aside, part * down
    return along, aside, down, along * x + aside * y + down * z
