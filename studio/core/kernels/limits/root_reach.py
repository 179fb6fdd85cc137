"""What planted feet allow the root: its legs are on leashes (METHOD 7)."""

import math

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.vectors import distance
from studio.core.kernels.compiling import kernel

SWEEPS = 6
"""Times both legs may pull the root back into their reach."""
LEASH = 0.3
"""Part of its length by which a limb's leash has run out when its contact is half free."""
BRAKING = 0.1 * LEASH
"""Part of a leg's length over which the root is braked before the leg's leash ends."""


@kernel
def leash_of(side, body, start):
    """(length, braking room) in metres of one leg's leash; it lets the hip be where the motion itself has it."""
    measures, leashes, legs = body.measures, body.leashes, body.legs
    length = measures[at.M_LEG + 2 * side] + measures[at.M_LEG + 2 * side + 1]
    hip = start.positions[start.positions.shape[0] - 10 + 5 * side]
    own = distance(hip, legs[2][side])
    leash = max(leashes[side] * length, own)
    return leash, min(leash - own, BRAKING * length)


@kernel
def free_part(side, body):
    """1 for a foot that is free, 0 for one that stands, and between as its leash has run out."""
    leash, comfort = body.leashes[side], body.legs[1][side]
    return 1.0 if leash == math.inf else (leash - comfort) / (LEASH + leash - comfort)


@kernel
def keep_feet_in_reach(body, start, carried, moved, way):
    """Shorten the ``way`` (3,) of a root that has ``moved`` (3,) to what both leashes allow, in turns (METHOD 7)."""
    ankles = body.legs[2]
    positions, pelvis = start.positions, carried[0]
    spine_count = positions.shape[0] - 23
    for _ in range(SWEEPS):
        kept = True
        for side in range(2):
            if body.leashes[side] == math.inf:
                continue
            hip, ankle = positions[spine_count + 13 + 5 * side], ankles[side]
            length = leash_of(side, body, start)[0]
            x, y, z = hip[0] - positions[0, 0], hip[1] - positions[0, 1], hip[2] - positions[0, 2]
            dx = positions[0, 0] + moved[0] + way[0] + pelvis[0, 0] * x + pelvis[0, 1] * y + pelvis[0, 2] * z - ankle[0]
            dy = positions[0, 1] + moved[1] + way[1] + pelvis[1, 0] * x + pelvis[1, 1] * y + pelvis[1, 2] * z - ankle[1]
            dz = positions[0, 2] + moved[2] + way[2] + pelvis[2, 0] * x + pelvis[2, 1] * y + pelvis[2, 2] * z - ankle[2]
            span = math.sqrt(dx * dx + dy * dy + dz * dz)
            over = span - length
            if over > 1e-7:
                way[0] -= over * dx / span
                way[1] -= over * dy / span
                way[2] -= over * dz / span
                kept = False
        if kept:
            return
