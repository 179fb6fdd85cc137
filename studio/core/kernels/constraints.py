"""The constraints of one frame, level by level: limbs in closed form, trunk and root only where limbs fall short.

Tuples that go through the functions here, for C constraints with up to two ends on a body of K spine segments:
``asked`` (kinds (C,), ranks (C,), ends (C, 2, 3), offsets (C, 2, 3), mobilities (C + 1, N), freedoms (C, 2, 2),
  importances (C,), joints (N, 4), areas (C, 10)): ends are point, segment and limb (-1 none), point -1 for an end that
  is not; freedoms are those of limb and end segment; joints as in ``kernels.joints``, areas as in ``kernels.areas``.
``goal`` (places (C, 2, 3), turns (C, 3, 3), shares (C, 2), distances (C,), wanted (C,), engaged (C,)): what is to be
  this frame; distances of look-at and area are their activation; an area is engaged once its point is where it may not.
``held`` (misses (C,), places (C, 2, 3), turns (C, 3, 3)): what higher levels have got and keep.
``body`` (measures, masses (S, 2), limits (N,), leashes (2,), legs, arm turns (2, 3, 3, 3), arm places (2, 3, 3)):
  all of the body that does not move in the search; leashes are the parts of their lengths to which the root may stretch
  the legs, inf where a foot is free; legs are channels, comforts, ankles, feet, toes and scratch.
``pose`` (positions (P, 3), rotations (S, 3, 3)).
"""

import numpy as np
from numba import njit

from studio.core.kernels.balance import centre_of_mass
from studio.core.kernels.goals import BALANCE, LOOK_AT, ORIENTATION, POSITION, end_place
from studio.core.kernels.limb import soft_reach
from studio.core.kernels.limb_constraints import (
    CLOSE_ENOUGH,
    distance,
    held_turn,
    limb_indices,
    nearest_of,
    reach_of,
)
from studio.core.kernels.placing import miss_of, note_arms, place_limbs, reset_limb
from studio.core.kernels.priorities import take_step
from studio.core.kernels.rows import TURN_ARM, add_rows, aimed_at, feet_rows, keep_feet_in_reach

TRIES = 12
COMFORT = 0.97
"""Part of its reach that a limb takes before the trunk helps."""
MENDS = 3
"""Steps that may be taken to give those above back what a step has cost them."""
KEPT = 1e-4
"""Metres by which a level may disturb those above it."""
SLOW = 0.98
"""Part of its error that a step must at least leave behind for another to be worth while."""


@njit(cache=True, nogil=True)
def solve_frame(level_count, asked, goal, held, body, work, pose):
    """Move one posed frame until its constraints hold as well as their chains and priorities allow.

    ``work`` is the tuple (rows, errors, owners, matrix, turned (2, N, 3), turn (2, 3, 3), centres, two saved
    poses as positions (2, P, 3) and rotations (2, S, 3, 3), reaches (C, 2), folds (C, 2)).
    """
    note_arms(asked, goal, body, pose)
    work[4][:] = 0.0
    comfort(asked, goal, work[5][1, 0], work[9], work[10], pose)
    for level in range(level_count):
        if wants_level(level, asked, goal):
            note_held(level, asked, goal, held, body, work, pose)
            solve_level(level, asked, goal, held, body, work, pose)


@njit(cache=True, nogil=True)
def wants_level(level, asked, goal):
    """Whether any constraint of this level acts now."""
    ranks, wanted = asked[1], goal[4]
    acts = False
    for c in range(ranks.shape[0]):
        acts = acts or (ranks[c] == level and wanted[c])
    return acts


@njit(cache=True, nogil=True)
def solve_level(level, asked, goal, held, body, work, pose):
    """Levenberg-Marquardt on one level: damped steps, of which only better ones are kept, those above held.

    Better is a smaller sum of squared errors; a disturbance of the levels above counts a thousand times. The damping
    falls after a good step and rises after a bad one. The end is the best pose that keeps those above.
    """
    positions, rotations = pose
    turned, saved_positions, saved_rotations = work[4], work[7], work[8]
    place_limbs(level, level, asked, goal, body, work, pose)
    best, kept, damping = np.inf, np.inf, -1.0
    for attempt in range(TRIES):
        merit, worst, harm = judge(level, asked, goal, held, body, work, pose)
        if attempt == 0 and harm >= KEPT:
            place_limbs(0, level - 1, asked, goal, body, work, pose)
            saved_positions[1], saved_rotations[1] = positions, rotations
            place_limbs(0, level, asked, goal, body, work, pose)
        for _ in range(MENDS):
            if harm < KEPT or merit > best:
                break
            step(level, 0.0, True, asked, goal, held, body, work, pose)
            place_limbs(0, level, asked, goal, body, work, pose)
            merit, worst, harm = judge(level, asked, goal, held, body, work, pose)
        if worst < CLOSE_ENOUGH and harm < KEPT:
            return
        total = merit + 1000.0 * harm * harm
        if harm < KEPT and merit < kept:
            kept = merit
            saved_positions[1], saved_rotations[1] = positions, rotations
        if total < best:
            slow = total > SLOW * best
            best, damping = total, 0.25 * damping
            saved_positions[0], saved_rotations[0], turned[1] = positions, rotations, turned[0]
            if harm < KEPT and slow:
                break
        else:
            positions[:], rotations[:], turned[0] = saved_positions[0], saved_rotations[0], turned[1]
            damping = 16.0 * max(damping, 1e-4)
        if damping < 0.0:
            damping = 0.25 * worst * worst / (worst + 0.3)
        if not step(level, damping, False, asked, goal, held, body, work, pose) and (
            harm < KEPT or not step(level, 0.0, True, asked, goal, held, body, work, pose)
        ):
            break
        place_limbs(0, level, asked, goal, body, work, pose)
    positions[:], rotations[:], turned[0] = saved_positions[1], saved_rotations[1], turned[1]


@njit(cache=True, nogil=True)
def step(level, damping, mending, asked, goal, held, body, work, pose):
    """One step of all joints for this level with those above held, or to mend those alone; feet are put back.

    False when nothing moves.
    """
    kinds, ranks, wanted = asked[0], asked[1], goal[4]
    rows, errors, owners, matrix, turned, turn = work[0], work[1], work[2], work[3], work[4], work[5]
    positions = pose[0]
    count = feet_rows(asked, body, rows, errors, owners, positions)
    for c in range(kinds.shape[0]):
        if wanted[c] and ranks[c] < level:
            count = add_rows(c, True, count, asked, goal, held, body, work, pose)
    held_count = 0 if mending else count
    for c in range(kinds.shape[0]):
        if not mending and wanted[c] and ranks[c] == level:
            count = add_rows(c, False, count, asked, goal, held, body, work, pose)
    if count == held_count:
        return False
    x, y, z = positions[0, 0], positions[0, 1], positions[0, 2]
    moved = take_step(
        rows,
        errors,
        owners,
        held_count,
        count,
        asked[4],
        asked[7],
        damping,
        body[2],
        turned[0],
        (matrix, turn[0]),
        pose,
    )
    if moved and (
        (asked[7][0, 0] == 0 and turned[0, 0].any())
        or x != positions[0, 0]
        or y != positions[0, 1]
        or z != positions[0, 2]
    ):
        keep_feet_in_reach(body, positions)
        reset_limb(2, body, pose)
        reset_limb(3, body, pose)
    return moved


@njit(cache=True, nogil=True)
def judge(level, asked, goal, held, body, work, pose):
    """(merit of this level, its largest miss, how much those above are disturbed), all in metres."""
    wanted = goal[4]
    kinds, ranks = asked[0], asked[1]
    merit, worst, harm = 0.0, 0.0, 0.0
    for c in range(kinds.shape[0]):
        if not wanted[c] or ranks[c] > level:
            continue
        miss = miss_of(c, asked, goal, body, work, pose)
        if kinds[c] == ORIENTATION or kinds[c] == LOOK_AT:
            miss *= TURN_ARM
        if ranks[c] == level:
            if kinds[c] == POSITION:
                miss = max(miss, strain(c, asked[2], asked[5], work[9], work[5][1, 0], pose[0]))
            merit += asked[6][c] * miss * miss
            worst = max(worst, miss)
        else:
            harm = max(harm, miss - held[0][c])
    return merit, worst, harm


@njit(cache=True, nogil=True)
def strain(c, ends, freedoms, reaches, point, positions):
    """Metres by which the limb of a position is stretched beyond its comfort: the chain is to take that over.

    ``point`` (3,) is where the constrained point is.
    """
    limb = ends[c, 0, 2]
    if limb < 0 or freedoms[c, 0, 0] == 0.0:
        return 0.0
    root, upper = limb_indices(limb, positions.shape[0] - 23)
    if limb >= 2 and ends[c, 0, 1] >= upper + 2:
        return distance(positions[root + 2], positions[root]) - reaches[c, 0]
    return distance(point, positions[root]) - reaches[c, 0]


@njit(cache=True, nogil=True)
def note_held(level, asked, goal, held, body, work, pose):
    """Note what the constraints above this level have got: it is theirs to keep."""
    wanted = goal[4]
    kinds, ranks, ends, offsets = asked[0], asked[1], asked[2], asked[3]
    for c in range(kinds.shape[0]):
        if not wanted[c] or ranks[c] >= level:
            continue
        held[0][c] = miss_of(c, asked, goal, body, work, pose)
        if kinds[c] == ORIENTATION or kinds[c] == LOOK_AT:
            held[0][c] *= TURN_ARM
            held[2][c] = pose[1][ends[c, 0, 1]]
        elif kinds[c] == BALANCE:
            centre_of_mass(body[1], work[6], held[1][c, 0])
        else:
            for end in range(2):
                if ends[c, end, 0] >= 0:
                    end_place(ends, offsets, c, end, pose, held[1][c, end])


@njit(cache=True, nogil=True)
def comfort(asked, goal, point, out_reaches, out_folds, pose):
    """How far each limb will stretch for each end, and how near it can fold, (C, 2) metres; the chain does the rest.

    Beyond 98 % of the reach (or what the motion itself stretches) the limb takes ``soft_reach``, so its extension is
    smooth in time and the trunk does the rest without error (METHOD 6, "reach sharing"). ``point`` (3,) is scratch.
    """
    wanted = goal[4]
    kinds, ends, offsets, mobilities = asked[0], asked[2], asked[3], asked[4]
    spine_count = pose[0].shape[0] - 23
    for c in range(kinds.shape[0]):
        for end in range(2):
            limb = ends[c, end, 2]
            if not wanted[c] or limb < 0 or kinds[c] == ORIENTATION:
                continue
            holds_end = limb >= 2 or held_turn(limb, 1 << 30, asked, goal, spine_count) >= 0
            end_place(ends, offsets, c, end, pose, point)
            root, upper = limb_indices(limb, spine_count)
            reach = reach_of(limb, ends[c, end, 1], holds_end, point, pose)
            out_reaches[c, end] = reach
            out_folds[c, end] = nearest_of(limb, ends[c, end, 1], holds_end, point, pose)
            if kinds[c] == POSITION and ends[c, end, 1] != upper and mobilities[c].sum() > 0.0:
                aimed = aimed_at(c, end, holds_end, upper, root, asked, goal, point, pose)
                a = min(max(distance(point, pose[0][root]) / reach, COMFORT), 0.9999)
                needed = distance(aimed, pose[0][root]) / reach
                if needed > a:
                    out_reaches[c, end] = reach * min(soft_reach(needed, a), 0.9999)
