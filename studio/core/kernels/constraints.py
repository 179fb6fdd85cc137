"""Position constraints of one frame: limbs in closed form, the trunk only where limbs fall short (K05 section 9).

``asked`` is the tuple (codes (C, 4), offsets (C, 3), chains (C, 5), targets (C, 3), wanted (C,)): codes are point,
segment, limb (-1 none) and rank of the priority, in that order; chains as ``trunk.mobility`` reads them; targets are
where the points are to be; wanted says which act now. ``pose`` is (positions (P, 3), rotations (S, 3, 3)).
"""

import numpy as np
from numba import njit

from studio.core.kernels import layout as at
from studio.core.kernels.body import body_point, move_all
from studio.core.kernels.legs import place_leg
from studio.core.kernels.limb import soft_reach
from studio.core.kernels.limb_constraints import CLOSE_ENOUGH, distance, limb_indices, reach_of, solve_limb
from studio.core.kernels.trunk import trunk_step

TRIES = 12
COMFORT = 0.98
"""Part of its reach that a limb takes before the trunk helps."""
SLOW = 0.98
"""Part of its error that a step must at least leave behind for another to be worth while."""
SWEEPS = 12
"""Times both legs may pull the root back into their reach."""


@njit(cache=True, nogil=True)
def solve_frame(asked, states, legs, measures, scratch, pose):
    """Move one posed frame until its constraints hold as well as their chains and priorities allow.

    ``states`` (2,) of the feet; ``legs`` the tuple (channels, comforts (2,), ankles (2, 3), feet, toes (2, 3, 3),
    work (3, 3, 3)); ``scratch`` the tuple (rows, row_codes, matrix, turned (2, K + 4, 3), turn, reaches, best
    positions, best rotations).
    """
    comfort(asked, scratch[5], pose)
    help_limbs(asked, states, legs, measures, scratch, pose)
    for limb in range(4):
        solve_limb(limb, asked, scratch[4], pose)


@njit(cache=True, nogil=True)
def help_limbs(asked, states, legs, measures, scratch, pose):
    """Trunk, neck and root towards what limbs cannot reach: damped steps, of which only better ones are kept.

    Better is a smaller sum of squared errors, a hundred times more for each higher priority; the damping falls
    after a good step and rises after a bad one (Levenberg, Marquardt).
    """
    positions, rotations = pose
    rows, row_codes, matrix, turned, turn, reaches, best_positions, best_rotations = scratch
    turned[:] = 0.0
    best, damping = np.inf, -1.0
    for _ in range(TRIES):
        count, error, merit = gather_rows(asked, reaches, rows, row_codes, pose)
        if count == 0 or error < CLOSE_ENOUGH:
            return
        if damping < 0.0:
            damping = 0.25 * error * error / (error + 0.3)
        if merit < best:
            slow = merit > SLOW * best
            best, damping = merit, 0.25 * damping
            best_positions[:], best_rotations[:], turned[1] = positions, rotations, turned[0]
            if slow:
                return
        else:
            damping = 16.0 * max(damping, 1e-4)
            positions[:], rotations[:], turned[0] = best_positions, best_rotations, turned[1]
            count, error, merit = gather_rows(asked, reaches, rows, row_codes, pose)
        if not trunk_step(rows, row_codes, count, asked[2], damping, matrix, turned[0], turn, pose):
            return
        if distance(positions[0], best_positions[0]) > 0.0:
            keep_feet_in_reach(states, legs, measures, positions)
            put_feet_back(legs, measures, pose)
    positions[:], rotations[:] = best_positions, best_rotations


@njit(cache=True, nogil=True)
def comfort(asked, out_reaches, pose):
    """How far each limb will stretch, (C,) metres, the rest being left to the chain: a soft knee near full reach.

    Beyond 98 % of the reach (or what the motion itself stretches) the limb takes ``soft_reach``, so its extension is
    smooth in time and the trunk does the rest without error (METHOD 6, "reach sharing").
    """
    codes, offsets, chains, targets, wanted = asked
    positions, rotations = pose
    point = np.empty(3)
    for c in range(codes.shape[0]):
        if not wanted[c] or codes[c, 2] < 0:
            continue
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        reach = reach_of(codes[c], point, pose)
        root, upper = limb_indices(codes[c, 2], positions.shape[0] - 23)
        out_reaches[c] = reach
        if codes[c, 1] == upper or chains[c, 2] + chains[c, 3] + chains[c, 4] == 0.0:
            continue
        a = min(max(distance(point, positions[root]) / reach, COMFORT), 0.9999)
        needed = distance(targets[c], positions[root]) / reach
        if needed > a:
            out_reaches[c] = reach * min(soft_reach(needed, a), 0.9999)


@njit(cache=True, nogil=True)
def gather_rows(asked, reaches, rows, row_codes, pose):
    """Fill the rows of a trunk step; (number of rows, largest error in metres, merit: less is better)."""
    codes, offsets, chains, targets, wanted = asked
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    count, largest, merit = 0, 0.0, 0.0
    point = np.empty(3)
    for c in range(codes.shape[0]):
        if not wanted[c]:
            continue
        first = count
        if codes[c, 2] >= 0 and chains[c, 0] > 0.0:
            root, upper = limb_indices(codes[c, 2], spine_count)
            span = max(distance(targets[c], positions[root]), 1e-9)
            miss = span - reaches[c]
            if miss > 0.0 or codes[c, 1] == upper:
                for axis in range(3):
                    rows[count, axis] = positions[root, axis]
                    rows[count, 3 + axis] = (targets[c, axis] - positions[root, axis]) / span
                rows[count, 6] = miss
                count += 1
        else:
            body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
            miss = distance(point, targets[c])
            for axis in range(3):
                rows[count, :3] = point
                rows[count, 3:6] = 0.0
                rows[count, 3 + axis] = 1.0
                rows[count, 6] = targets[c, axis] - point[axis]
                count += 1
        for row in range(first, count):
            row_codes[row, 0], row_codes[row, 1] = c, carrier_of(codes[c], spine_count)
        if count > first:
            largest = max(largest, abs(miss))
            merit += 0.01 ** codes[c, 3] * miss * miss
    return count, largest, merit


@njit(cache=True, nogil=True)
def carrier_of(code, spine_count):
    """What carries a constraint's point, as ``trunk.carries`` counts: spine, arm, neck, head or leg."""
    if code[2] >= 2:
        return spine_count + 4
    if code[2] >= 0:
        return spine_count + code[2]
    segment = code[1]
    if segment < spine_count:
        return segment
    if segment < spine_count + 2:
        return segment + 2
    return spine_count + (segment - spine_count - 2) // 4


@njit(cache=True, nogil=True)
def keep_feet_in_reach(states, legs, measures, positions):
    """Bring the root back to where every planted ankle is within its leg's comfort, in turns (METHOD 7)."""
    spine_count = positions.shape[0] - 23
    for _ in range(SWEEPS):
        moved = False
        for side in range(2):
            if states[side] == 0:
                continue
            hip, ankle = positions[spine_count + 13 + 5 * side], legs[2][side]
            length = legs[1][side] * (measures[at.M_LEG + 2 * side] + measures[at.M_LEG + 2 * side + 1])
            span = distance(hip, ankle)
            if span > length + 1e-6:
                moved, share = True, (span - length) / span
                move_all(
                    share * (ankle[0] - hip[0]),
                    share * (ankle[1] - hip[1]),
                    share * (ankle[2] - hip[2]),
                    positions,
                )
        if not moved:
            return


@njit(cache=True, nogil=True)
def put_feet_back(legs, measures, pose):
    """Both legs on their ankles again after the root has moved."""
    channels, comforts, ankles, feet, toes, work = legs
    for side in range(2):
        place_leg(
            channels, measures, side, comforts[side], ankles[side], feet[side], toes[side], work, pose[0], pose[1]
        )
