"""How far planted feet let the root go: no farther than their legs reach (METHOD 7)."""

import math

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.vectors import distance
from studio.core.kernels.compiling import kernel

SWEEPS = 6
"""Times both legs may pull the root back into their reach."""
HALF_FREE_REACH = 0.3
"""Part of its length by which the reach of a limb's root has grown when its contact is half free."""
BRAKING = 0.1 * HALF_FREE_REACH
"""Part of a leg's length over which the root is braked before the leg's reach ends."""


@kernel
def root_reach_of(side, body, start):
    """(length, braking room) in metres of how far a hip may be from its ankle: it may be where the motion has it."""
    measures, root_reaches, legs = body.measures, body.root_reaches, body.legs
    length = measures[at.M_LEG + 2 * side] + measures[at.M_LEG + 2 * side + 1]
    hip = start.positions[start.positions.shape[0] - 10 + 5 * side]
    own = distance(hip, legs.ankles[side])
    root_reach = max(root_reaches[side] * length, own)
    return root_reach, min(root_reach - own, BRAKING * length)


@kernel
def free_part(side, body):
    """1 for a foot that is free, 0 for one that stands, and between as the reach of the root has grown."""
    root_reach, comfort = body.root_reaches[side], body.legs.comforts[side]
    return 1.0 if root_reach == math.inf else (root_reach - comfort) / (HALF_FREE_REACH + root_reach - comfort)


@kernel
def keep_feet_in_reach(body, start, carried, moved, way):
    """The ``way`` (x, y, z) of a root that has ``moved`` (3,) as far as both legs let it go, in turns (METHOD 7)."""
    ankles, (wx, wy, wz) = body.legs.ankles, way
    positions, pelvis = start.positions, carried[0]
    spine_count = positions.shape[0] - 23
    for _ in range(SWEEPS):
        kept = True
        for side in range(2):
            if body.root_reaches[side] == math.inf:
                continue
            hip, ankle = positions[spine_count + 13 + 5 * side], ankles[side]
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
