"""Position constraints of one frame: limbs in closed form, the trunk only where limbs fall short (K05 section 9)."""

import math

import numpy as np
from numba import njit

from studio.core.kernels import layout as at
from studio.core.kernels.body import body_point, move_all
from studio.core.kernels.legs import place_leg
from studio.core.kernels.limb import soft_reach
from studio.core.kernels.reach import aim_at, bend_to, longest_reach, swivel_to
from studio.core.kernels.trunk import trunk_step

TRIES = 12
CLOSE_ENOUGH = 5e-5
"""Metres of error at which the trunk is left as it is."""
COMFORT = 0.98
"""Part of its reach that a limb takes before the trunk helps."""
SLOW = 0.98
"""Part of its error that a step must at least leave behind for another to be worth while."""
SWEEPS = 12
"""Times both legs may pull the root back into their reach."""


@njit(cache=True, nogil=True)
def solve_frame(
    codes,
    offsets,
    chains,
    targets,
    wanted,
    states,
    legs,
    spine_count,
    measures,
    scratch,
    positions,
    rotations,
):
    """Move one posed frame until its constraints hold as well as their chains and priorities allow.

    ``codes`` (C, 4) point, segment, limb (-1 none), rank of the priority, highest first; ``wanted`` (C,) which act
    now; ``targets`` (C, 3) where their points are to be; ``states`` (2,) of the feet; ``legs`` the tuple (channels,
    comforts (2,), ankles (2, 3), feet, toes (2, 3, 3), work (3, 3, 3)); ``scratch`` the tuple (rows, row_codes,
    matrix, turned (2, K + 4, 3), turn, reaches, best positions, best rotations).
    """
    turn, reaches = scratch[4], scratch[5]
    comfort(codes, offsets, chains, targets, wanted, spine_count, reaches, positions, rotations)
    help_limbs(
        codes,
        offsets,
        chains,
        targets,
        wanted,
        states,
        legs,
        spine_count,
        measures,
        scratch,
        positions,
        rotations,
    )
    for limb in range(4):
        solve_limb(limb, codes, offsets, chains, targets, wanted, spine_count, turn, positions, rotations)


@njit(cache=True, nogil=True)
def help_limbs(
    codes,
    offsets,
    chains,
    targets,
    wanted,
    states,
    legs,
    spine_count,
    measures,
    scratch,
    positions,
    rotations,
):
    """Trunk, neck and root towards what limbs cannot reach: damped steps, of which only better ones are kept.

    Better is a smaller sum of squared errors, a hundred times more for each higher priority; the damping falls
    after a good step and rises after a bad one (Levenberg, Marquardt).
    """
    rows, row_codes, matrix, turned, turn, reaches, best_positions, best_rotations = scratch
    turned[:] = 0.0
    best, damping = np.inf, -1.0
    for _ in range(TRIES):
        count, error, merit = gather_rows(
            codes,
            offsets,
            chains,
            targets,
            wanted,
            spine_count,
            reaches,
            rows,
            row_codes,
            positions,
            rotations,
        )
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
            gather_rows(
                codes,
                offsets,
                chains,
                targets,
                wanted,
                spine_count,
                reaches,
                rows,
                row_codes,
                positions,
                rotations,
            )
        if not trunk_step(
            rows,
            row_codes,
            count,
            chains,
            spine_count,
            damping,
            matrix,
            turned[0],
            turn,
            positions,
            rotations,
        ):
            return
        if distance(positions[0], best_positions[0]) > 0.0:
            keep_feet_in_reach(states, legs, spine_count, measures, positions)
            for side in range(2):
                place_leg(
                    legs[0], measures, side, legs[1][side], legs[2][side], legs[3][side], legs[4][side], legs[5],
                    positions, rotations,
                )  # fmt: skip
    positions[:], rotations[:] = best_positions, best_rotations


@njit(cache=True, nogil=True)
def limb_indices(limb, spine_count):
    """(root point, upper segment) of a limb: shoulder and upper arm, hip and thigh."""
    side = limb % 2
    if limb >= 2:
        return spine_count + 13 + 5 * side, spine_count + 10 + 4 * side
    return spine_count + 4 + 5 * side, spine_count + 3 + 4 * side


@njit(cache=True, nogil=True)
def reach_of(code, offset, spine_count, point, positions, rotations):
    """Greatest distance of ``point`` from the root of its limb, in metres."""
    root, upper = limb_indices(code[2], spine_count)
    if code[1] == upper:
        x = point[0] - positions[root, 0]
        y = point[1] - positions[root, 1]
        z = point[2] - positions[root, 2]
        return math.sqrt(x * x + y * y + z * z)
    return longest_reach(positions[root], positions[root + 1], rotations[upper, :, 0], point)


@njit(cache=True, nogil=True)
def comfort(codes, offsets, chains, targets, wanted, spine_count, out_reaches, positions, rotations):
    """How far each limb will stretch, (C,) metres, the rest being left to the chain: a soft knee near full reach.

    Beyond 98 % of the reach (or what the motion itself stretches) the limb takes ``soft_reach``, so its extension is
    smooth in time and the trunk does the rest without error (METHOD 6, "reach sharing").
    """
    point = np.empty(3)
    for c in range(codes.shape[0]):
        if not wanted[c] or codes[c, 2] < 0:
            continue
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        reach = reach_of(codes[c], offsets[c], spine_count, point, positions, rotations)
        root, upper = limb_indices(codes[c, 2], spine_count)
        out_reaches[c] = reach
        if codes[c, 1] == upper or chains[c, 2] + chains[c, 3] + chains[c, 4] == 0.0:
            continue
        own = distance(point, positions[root]) / reach
        needed = distance(targets[c], positions[root]) / reach
        a = min(max(own, COMFORT), 0.9999)
        if needed > a:
            out_reaches[c] = reach * min(soft_reach(needed, a), 0.9999)


@njit(cache=True, nogil=True)
def distance(a, b):
    """Metres between two points (3,)."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@njit(cache=True, nogil=True)
def gather_rows(codes, offsets, chains, targets, wanted, spine_count, reaches, rows, row_codes, positions, rotations):
    """Fill the rows of a trunk step; (number of rows, largest error in metres, merit: less is better)."""
    count, largest, merit = 0, 0.0, 0.0
    point = np.empty(3)
    for c in range(codes.shape[0]):
        if not wanted[c]:
            continue
        if codes[c, 2] >= 0 and chains[c, 0] > 0.0:
            root, upper = limb_indices(codes[c, 2], spine_count)
            span = max(distance(targets[c], positions[root]), 1e-9)
            if span > reaches[c] or codes[c, 1] == upper:
                for axis in range(3):
                    rows[count, axis] = positions[root, axis]
                    rows[count, 3 + axis] = (targets[c, axis] - positions[root, axis]) / span
                rows[count, 6] = span - reaches[c]
                row_codes[count, 0], row_codes[count, 1] = c, carrier_of(codes[c], spine_count)
                largest = max(largest, abs(rows[count, 6]))
                merit += 0.01 ** codes[c, 3] * rows[count, 6] ** 2
                count += 1
            continue
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        for axis in range(3):
            for other in range(3):
                rows[count, other] = point[other]
                rows[count, 3 + other] = 1.0 if other == axis else 0.0
            rows[count, 6] = targets[c, axis] - point[axis]
            row_codes[count, 0], row_codes[count, 1] = c, carrier_of(codes[c], spine_count)
            count += 1
        miss = distance(point, targets[c])
        largest = max(largest, miss)
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
def keep_feet_in_reach(states, legs, spine_count, measures, positions):
    """Bring the root back to where every planted ankle is within its leg's comfort, in turns (METHOD 7)."""
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
def solve_limb(limb, codes, offsets, chains, targets, wanted, spine_count, turn, positions, rotations):
    """All constraints of one limb in order: the first exactly, the second by what freedom is left."""
    root, upper = limb_indices(limb, spine_count)
    held, point = np.empty(3), np.empty(3)
    solved, held_upper = 0, False
    for c in range(codes.shape[0]):
        if not wanted[c] or codes[c, 2] != limb:
            continue
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        if chains[c, 0] == 0.0:
            pass
        elif solved == 0:
            held_upper = codes[c, 1] == upper
            reach_with_limb(codes[c], offsets[c], targets[c], limb, spine_count, point, turn, positions, rotations)
        elif solved == 1 and held_upper:
            pivot = positions[root + 1]
            aim_at(targets[c], point, upper + 1, spine_count, pivot, turn, positions, rotations)
        elif solved == 1:
            swivel_to(targets[c], point, held, upper, spine_count, positions[root], turn, positions, rotations)
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        if chains[c, 1] > 0.0 and codes[c, 1] > upper + 1:
            aim_end(
                codes[c, 1],
                chains[c, 1],
                targets[c],
                point,
                spine_count,
                root + 2,
                upper + 2,
                turn,
                positions,
                rotations,
            )
        if solved == 0:
            body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, held)
        solved += 1


@njit(cache=True, nogil=True)
def reach_with_limb(code, offset, target, limb, spine_count, point, turn, positions, rotations):
    """Bend and aim one limb so that its point meets the target, or comes as near as it can.

    A foot keeps its orientation in the world; a hand goes with its forearm.
    """
    root, upper = limb_indices(limb, spine_count)
    goal = target.copy()
    foot = np.empty((2, 3, 3))
    on_foot = limb >= 2 and code[1] >= upper + 2
    if on_foot:
        for axis in range(3):
            goal[axis] -= point[axis] - positions[root + 2, axis]
            point[axis] = positions[root + 2, axis]
        foot[:] = rotations[upper + 2 : upper + 4]
    toes = positions[root + 3 : root + 5] - positions[root + 2]
    if code[1] != upper:
        bend_to(distance(goal, positions[root]), upper, spine_count, root, point, turn, positions, rotations)
        if on_foot:
            point[:] = positions[root + 2]
        else:
            body_point(code[0], code[1], offset, positions, rotations, point)
    aim_at(goal, point, upper, spine_count, positions[root], turn, positions, rotations)
    if on_foot:
        rotations[upper + 2 : upper + 4] = foot
        positions[root + 3 : root + 5] = positions[root + 2] + toes


@njit(cache=True, nogil=True)
def aim_end(segment, weight, target, point, spine_count, joint, end, turn, positions, rotations):
    """Turn the hand or foot about its joint so that its point faces the target, ``weight`` times the whole way."""
    if distance(point, target) < CLOSE_ENOUGH:
        return
    goal = point + weight * (target - point)
    aim_at(goal, point, end, spine_count, positions[joint], turn, positions, rotations)
