"""Limit of the root by the legs on planted feet (METHOD 11)."""

import math

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.vectors import distance
from studio.core.kernels.body_indices import HIP_POINT, POINTS_BESIDE_SPINE, POINTS_PER_LIMB
from studio.core.kernels.compiling import kernel

ROOT_REACH_ITERATIONS = 6
"""Iterations over both legs."""
HALF_FREE_REACH = 0.3
"""Growth of the reach of a limb's root, as a fraction of its length, when its contact is half released."""
ROOT_REACH_DAMPING = 0.1 * HALF_FREE_REACH
"""Fraction of a leg's length over which the root is decelerated before the end of the leg's reach."""


@kernel
def root_reach_of(side, body, start):
    """(length, braking margin) in metres of the distance hip-ankle, at least that of the motion."""
    measures, root_reaches, legs = body.measures, body.root_reaches, body.legs
    length = measures[at.MEASURE_LEG + 2 * side] + measures[at.MEASURE_LEG + 2 * side + 1]
    hip = start.positions[start.positions.shape[0] - POINTS_BESIDE_SPINE + HIP_POINT + POINTS_PER_LIMB * side]
    own = distance(hip, legs.ankles[side])
    root_reach = max(root_reaches[side] * length, own)
    return root_reach, min(root_reach - own, ROOT_REACH_DAMPING * length)


@kernel
def release_fraction(side, body):
    """1 for a free foot, 0 for a planted one, between as the reach of the root has grown."""
    root_reach, soft_threshold = body.root_reaches[side], body.legs.soft_thresholds[side]
    return (
        1.0
        if root_reach == math.inf
        else (root_reach - soft_threshold) / (HALF_FREE_REACH + root_reach - soft_threshold)
    )


@kernel
def limit_root_step(body, start, segment_rotations, moved, displacement):
    """``displacement`` (x, y, z) of a root already ``moved`` (3,), limited to the reach of both legs in turn (METHOD
    7).
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
