"""Root displacement that keeps the lengths of legs on displaced feet (METHOD section 4)."""

import math

from studio.core.kernels.algebra.vectors import distance, offset_between
from studio.core.kernels.compiling import kernel

HORIZONTAL_COST = 0.2
"""Squared cost of a horizontal metre of the body, relative to a vertical metre or to a metre of a standing leg's
length. Knees show a change of length gradually, which hips hide: they move 1 cm sideways for 5 mm of a leg. Half of
this gives straight knees of high ankles an acceleration peak.
"""
VISIBLE_BEND, STRAIGHT_KNEE_COST = 0.1, 5
"""Squared sine of half the bend of a knee at which a metre of the leg's length costs 1, and the cost for a straight
knee, which shows a lack of length many times over.
"""


@kernel
def keep_leg_lengths(off, weights, hips, positions, displacement):
    """Correct the ``displacement`` (F, 3) of a body, in place, so that legs that stand flat keep their lengths.

    ``off`` (2, F, 3) are the displacements of the feet from their ``positions`` (F, P, 3); ``hips`` are the indices of
    both hip points, with the ankles two points later. ``weights`` (F, 3): the left leg's fraction of the body's weight,
    and the flatness of each foot.
    """
    for frame in range(displacement.shape[0]):
        fraction = min(max(weights[frame, 0], 0.0), 1.0)
        left = _weighted_length_error(0, off, fraction * weights[frame, 1], hips[0], positions, displacement, frame)
        right = _weighted_length_error(
            1, off, (1.0 - fraction) * weights[frame, 2], hips[1], positions, displacement, frame
        )
        if left[3] == 0.0 and right[3] == 0.0:
            continue
        # the least move, by its own measure, for which both are right as far as it is worth it
        both = _cost_product(left, right)
        first, second = 1.0 + _cost_product(left, left), 1.0 + _cost_product(right, right)
        whole = first * second - both * both
        by_left = (second * left[3] - both * right[3]) / whole
        by_right = (first * right[3] - both * left[3]) / whole
        for axis in range(3):
            displacement[frame, axis] += (by_left * left[axis] + by_right * right[axis]) / (
                HORIZONTAL_COST if axis < 2 else 1.0
            )


@kernel
def _cost_product(a, b):
    """Inner product of two legs' directions, with cheap horizontal moves."""
    return (a[0] * b[0] + a[1] * b[1]) / HORIZONTAL_COST + a[2] * b[2]


@kernel
def _weighted_length_error(side, off, weight, hip, positions, displacement, frame):
    """Weighted direction (3) of one leg, halfway to its target, and its weighted excess length in metres, four numbers.

    Both are multiplied by the root of the leg's weight: the standing ``weight`` times the cost of its knee.
    """
    points = positions[frame]
    x, y, z = offset_between(displacement[frame], off[side, frame])
    along = points[hip + 2, 0] - points[hip, 0] + 0.5 * x
    aside = points[hip + 2, 1] - points[hip, 1] + 0.5 * y
    down = points[hip + 2, 2] - points[hip, 2] + 0.5 * z
    span = max(math.sqrt(along * along + aside * aside + down * down), 1e-9)
    bones = distance(points[hip], points[hip + 1]) + distance(points[hip + 1], points[hip + 2])
    bend = max(1.0 - (distance(points[hip], points[hip + 2]) / bones) ** 2, 0.0)
    fraction = math.sqrt(max(weight, 0.0) / (bend / VISIBLE_BEND + 1.0 / STRAIGHT_KNEE_COST)) / span
    along, aside, down = fraction * along, fraction * aside, fraction * down
    return along, aside, down, along * x + aside * y + down * z
