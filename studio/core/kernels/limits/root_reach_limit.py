"""Root displacement limited by the reach of the legs on planted feet (METHOD 11)."""

import math

from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.vectors import distance
from studio.core.kernels.body_indices import HIP_POINT, POINTS_BESIDE_SPINE, POINTS_PER_LIMB
from studio.core.kernels.compiling import kernel

ROOT_REACH_ITERATIONS = 6
"""Iterations over both legs."""
HALF_FREE_REACH = 0.3
"""Additional reach, as a fraction of the limb's length, that a half released contact gives the limb's root."""
ROOT_REACH_DAMPING = 0.1 * HALF_FREE_REACH
"""Width, as a fraction of a leg's length, of the zone before the end of the leg's reach in which the root is
decelerated.
"""


@kernel
def root_reach_of(side, body, start):
    """(length, margin) in metres: greatest distance hip-ankle that the root may cause, and width of the braking zone
    before it.

    The length is at least the distance in the unsolved pose ``start``.
    """
    measures, root_reaches, legs = body.measures, body.root_reaches, body.legs
    length = measures[measure.LEG + 2 * side] + measures[measure.LEG + 2 * side + 1]
    hip = start.positions[start.positions.shape[0] - POINTS_BESIDE_SPINE + HIP_POINT + POINTS_PER_LIMB * side]
    own = distance(hip, legs.ankles[side])
    root_reach = max(root_reaches[side] * length, own)
    return root_reach, min(root_reach - own, ROOT_REACH_DAMPING * length)


@kernel
def release_fraction(side, body):
    """Fraction to which a foot is released from the ground: 1 for a free foot, 0 for a planted one."""
    root_reach, soft_threshold = body.root_reaches[side], body.legs.soft_thresholds[side]
    return (
        1.0
        if root_reach == math.inf
        else (root_reach - soft_threshold) / (HALF_FREE_REACH + root_reach - soft_threshold)
    )


@kernel
def limit_root_step(body, start, segment_rotations, moved, displacement):
    """``displacement`` (x, y, z) of a root already ``moved`` (3,), limited so that the feet of planted legs stay in
    reach (METHOD 7).
    """
    ankles, (wx, wy, wz) = body.legs.ankles, displacement
    positions, pelvis = start.positions, segment_rotations[0]
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    for _ in range(ROOT_REACH_ITERATIONS):
        kept = True
        for side in range(2):
            if body.root_reaches[side] == math.inf:
                continue
            hip, ankle = positions[spine_count + HIP_POINT + POINTS_PER_LIMB * side], ankles[side]
            length = root_reach_of(side, body, start)[0]
            x, y, z = hip[0] - positions[0, 0], hip[1] - positions[0, 1], hip[2] - positions[0, 2]
            dx = positions[0, 0] + moved[0] + wx + pelvis[0, 0] * x + pelvis[0, 1] * y + pelvis[0, 2] * z - ankle[0]
            dy = positions[0, 1] + moved[1] + wy + pelvis[1, 0] * x + pelvis[1, 1] * y + pelvis[1, 2] * z - ankle[1]
            dz = positions[0, 2] + moved[2] + wz + pelvis[2, 0] * x + pelvis[2, 1] * y + pelvis[2, 2] * z - ankle[2]
            span = math.sqrt(dx * dx + dy * dy + dz * dz)
            over = span - length
            if over > 1e-7:
                wx, wy, wz = wx - over * dx / span, wy - over * dy / span, wz - over * dz / span
                kept = False
        if kept:
            break
    return wx, wy, wz
