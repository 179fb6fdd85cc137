"""The constraints of one frame, level by level: limbs in closed form, trunk and root only where limbs fall short.

Tuples that go through the functions here, for C constraints with up to two ends on a body of K spine segments:
``asked`` (kinds (C,), ranks (C,), ends (C, 2, 3), offsets (C, 2, 3), mobilities (C + 1, N), freedoms (C, 2, 2),
  importances (C,), joints (N, 4), areas (C, 10)): ends are point, segment and limb (-1 none), point -1 for an end that
  is not; freedoms are those of limb and end segment; joints as in ``kernels.joints``, areas as in ``kernels.areas``.
``goal`` (places (C, 2, 3), turns (C, 3, 3), shares (C, 2), distances (C,), wanted (C,), engaged (C,)): what is to be
  this frame; distances of look-at and area are their activation; an area is engaged once its point is where it may not.
``held`` (misses (C,), places (C, 2, 3), turns (C, 3, 3)): what higher levels have got and keep.
``body`` (measures, masses (S, 2), limits (N,), states (2,), legs, arm turns (2, 3, 3, 3), arm places (2, 3, 3)):
  all of the body that does not move in the search; legs are channels, comforts, ankles, feet, toes and scratch.
``pose`` (positions (P, 3), rotations (S, 3, 3)).
"""

import math

import numpy as np
from numba import njit

from studio.core.kernels import layout as at
from studio.core.kernels.areas import nearest_allowed
from studio.core.kernels.balance import add_balance_row, centre_of_mass, segment_centres
from studio.core.kernels.body import move_all
from studio.core.kernels.goals import (
    AREA,
    BALANCE,
    DISTANCE,
    LOOK_AT,
    ORIENTATION,
    POSITION,
    ease_goal,
    end_place,
    gaze_goal,
    part_to,
    second_place,
)
from studio.core.kernels.joints import add_point_row, add_turn_row
from studio.core.kernels.legs import place_leg
from studio.core.kernels.limb import soft_reach
from studio.core.kernels.limb_constraints import distance, held_turn, limb_indices, nearest_of, reach_of, solve_limb
from studio.core.kernels.priorities import take_step
from studio.core.kernels.rotation import add_rotated, matrix_to_rotation_vector, multiply, shortest_arc

TRIES = 10
COMFORT = 0.98
"""Part of its reach that a limb takes before the trunk helps."""
CLOSE_ENOUGH = 5e-5
"""Metres (or radians) of error that are left as they are."""
MENDS = 3
"""Steps that may be taken to give those above back what a step has cost them."""
KEPT = 1e-4
"""Metres by which a level may disturb those above it."""
SLOW = 0.97
SWEEPS = 12
ENGAGED = 1e-6
"""Metres into a forbidden area from which on a point counts as in it."""
TURN_ARM = 0.3
"""Metres that count as one radian where both are weighed together."""


@njit(cache=True, nogil=True)
def solve_frame(level_count, asked, goal, held, body, work, pose):
    """Move one posed frame until its constraints hold as well as their chains and priorities allow.

    ``work`` is the tuple (rows, errors, owners, matrix, turned (2, N, 3), turn (2, 3, 3), centres, two saved
    poses as positions (2, P, 3) and rotations (2, S, 3, 3), reaches (C, 2), folds (C, 2)).
    """
    note_arms(body, pose)
    work[4][:] = 0.0
    comfort(asked, goal, work[9], work[10], pose)
    for level in range(level_count):
        if wants_level(level, asked, goal):
            note_held(level, asked, goal, held, body, work, pose)
            solve_level(level, asked, goal, held, body, work, pose)


@njit(cache=True, nogil=True)
def wants_level(level, asked, goal):
    """Whether any constraint of this level acts now."""
    acts = False
    for c in range(asked[1].shape[0]):
        acts = acts or (asked[1][c] == level and goal[4][c])
    return acts


@njit(cache=True, nogil=True)
def solve_level(level, asked, goal, held, body, work, pose):
    """Levenberg-Marquardt on one level: damped steps, of which only better ones are kept, those above held.

    Better is a smaller sum of squared errors; a disturbance of the levels above counts a thousand times. The damping
    falls after a good step and rises after a bad one. The end is the best pose that keeps those above.
    """
    positions, rotations = pose
    turned, saved_positions, saved_rotations = work[4], work[7], work[8]
    if level > 0:
        saved_positions[1], saved_rotations[1] = positions, rotations
    place_limbs(level, asked, goal, body, work, pose)
    best, kept, damping = np.inf, np.inf, -1.0
    for _ in range(TRIES):
        merit, worst, harm = judge(level, asked, goal, held, body, work, pose)
        for _ in range(MENDS):
            if harm < KEPT or merit > best:
                break
            step(level, 0.0, True, asked, goal, held, body, work, pose)
            place_limbs(level, asked, goal, body, work, pose)
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
        place_limbs(level, asked, goal, body, work, pose)
    positions[:], rotations[:], turned[0] = saved_positions[1], saved_rotations[1], turned[1]


@njit(cache=True, nogil=True)
def note_arms(body, pose):
    """Remember how both arms lie in their clavicles, so that they can be put back before each reach."""
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    for side in range(2):
        shoulder, upper = limb_indices(side, spine_count)
        carrier = rotations[upper - 1]
        for bone in range(3):
            multiply(carrier.T, rotations[upper + bone], body[5][side, bone])
            place = positions[shoulder + 1 + bone] - positions[shoulder]
            for axis in range(3):
                body[6][side, bone, axis] = (
                    carrier[0, axis] * place[0] + carrier[1, axis] * place[1] + carrier[2, axis] * place[2]
                )


@njit(cache=True, nogil=True)
def reset_limb(limb, body, pose):
    """Put a limb back as the unsolved pose has it: arms in their clavicles, legs on their ankles."""
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    if limb >= 2:
        channels, comforts, ankles, feet, toes, scratch = body[4]
        side = limb - 2
        place_leg(
            channels, body[0], side, comforts[side], ankles[side], feet[side], toes[side], scratch, positions, rotations
        )
        return
    shoulder, upper = limb_indices(limb, spine_count)
    for bone in range(3):
        multiply(rotations[upper - 1], body[5][limb, bone], rotations[upper + bone])
        place = body[6][limb, bone]
        add_rotated(
            positions[shoulder],
            rotations[upper - 1],
            place[0],
            place[1],
            place[2],
            positions[shoulder + 1 + bone],
        )


@njit(cache=True, nogil=True)
def place_limbs(level, asked, goal, body, work, pose):
    """Every limb that has a constraint down to this level: put back, then solved; again if it ends where it may not."""
    kinds, ranks, ends = asked[0], asked[1], asked[2]
    busy, moving = 0, False
    for c in range(kinds.shape[0]):
        if goal[4][c] and ranks[c] <= level:
            moving = moving or kinds[c] == DISTANCE or kinds[c] == AREA or kinds[c] == LOOK_AT
            goal[5][c] = False
            for end in range(2):
                if ends[c, end, 2] >= 0:
                    busy |= 1 << ends[c, end, 2]
    again = True
    for attempt in range(4):
        for limb in range(4):
            if again and busy >> limb & 1:
                reset_limb(limb, body, pose)
        if moving:
            follow(level, asked, goal, work, pose)
        for limb in range(4):
            if busy >> limb & 1:
                solve_limb(limb, level, asked, goal, work[5], pose)
        again = moving and engage(level, asked, goal, pose)
        if not again and not (moving and attempt < 3 and falls_short(level, asked, goal, body, work, pose)):
            return


@njit(cache=True, nogil=True)
def follow(level, asked, goal, work, pose):
    """Goals that depend on where things are now: both ends of distances, areas, the line of sight (METHOD 5)."""
    kinds, ranks, ends, offsets = asked[0], asked[1], asked[2], asked[3]
    points = np.empty((2, 3))
    for c in range(kinds.shape[0]):
        if not goal[4][c] or ranks[c] > level:
            continue
        if kinds[c] == DISTANCE:
            end_place(ends, offsets, c, 0, pose, points[0])
            second_place(asked, goal, c, pose, points[1])
            part_to(points[0], points[1], goal[3][c], goal[2][c], goal[0][c])
        elif kinds[c] == LOOK_AT:
            rotation = pose[1][ends[c, 0, 1]]
            end_place(ends, offsets, c, 0, pose, points[0])
            gaze_goal(goal[0][c, 1], goal[0][c, 0], points[0], goal[3][c], points[1])
            x, y, z = points[1, 0], points[1, 1], points[1, 2]
            shortest_arc(rotation[0, 0], rotation[1, 0], rotation[2, 0], x, y, z, work[5][0])
            multiply(work[5][0], rotation, goal[1][c])
        elif kinds[c] == AREA and not goal[5][c]:
            engage_one(c, asked, goal, points, pose)


@njit(cache=True, nogil=True)
def falls_short(level, asked, goal, body, work, pose):
    """Whether a distance is missed because one of its limbs could not do its share: then the other does more."""
    short = False
    for c in range(asked[0].shape[0]):
        if asked[0][c] == DISTANCE and goal[4][c] and asked[1][c] <= level:
            short = short or miss_of(c, asked, goal, body, work, pose) > CLOSE_ENOUGH
    return short


@njit(cache=True, nogil=True)
def engage(level, asked, goal, pose):
    """Areas whose points are where they may not be after all else was solved; True when there are new ones."""
    found = False
    points = np.empty((2, 3))
    for c in range(asked[0].shape[0]):
        if asked[0][c] == AREA and goal[4][c] and asked[1][c] <= level and not goal[5][c]:
            found = engage_one(c, asked, goal, points, pose) or found
    return found


@njit(cache=True, nogil=True)
def engage_one(c, asked, goal, points, pose):
    """Engage one area if its point is where it may not be: the goal is the nearest place where it may."""
    end_place(asked[2], asked[3], c, 0, pose, points[0])
    if nearest_allowed(asked[8][c], points[0], points[1]) > ENGAGED:
        goal[5][c] = True
        ease_goal(points[0], points[1], goal[3][c], goal[0][c, 0])
    return goal[5][c]


@njit(cache=True, nogil=True)
def miss_of(c, asked, goal, body, work, pose):
    """By how much a constraint is missed now: metres, or radians for an orientation or a look."""
    kinds, ends, offsets = asked[0], asked[2], asked[3]
    point, other = np.empty(3), np.empty(3)
    if kinds[c] == ORIENTATION or kinds[c] == LOOK_AT:
        turn_error(goal[1][c], pose[1][ends[c, 0, 1]], work[5][0], point)
        return math.sqrt(point[0] ** 2 + point[1] ** 2 + point[2] ** 2)
    if kinds[c] == BALANCE:
        segment_centres(body[1], pose[0], work[6])
        centre_of_mass(body[1], work[6], point)
        return math.hypot(point[0] - goal[0][c, 0, 0], point[1] - goal[0][c, 0, 1])
    end_place(ends, offsets, c, 0, pose, point)
    if kinds[c] == DISTANCE:
        second_place(asked, goal, c, pose, other)
        return abs(distance(point, other) - goal[3][c])
    if kinds[c] == AREA and not goal[5][c]:
        return goal[3][c] * nearest_allowed(asked[8][c], point, other)
    return distance(point, goal[0][c, 0])


@njit(cache=True, nogil=True)
def turn_error(wanted, now, turn, out_vector):
    """Rotation vector (3,) in radians that turns ``now`` to ``wanted`` (3, 3)."""
    multiply(wanted, now.T, turn)
    matrix_to_rotation_vector(turn, out_vector)


@njit(cache=True, nogil=True)
def judge(level, asked, goal, held, body, work, pose):
    """(merit of this level, its largest miss, how much those above are disturbed), all in metres."""
    kinds, ranks = asked[0], asked[1]
    merit, worst, harm = 0.0, 0.0, 0.0
    for c in range(kinds.shape[0]):
        if not goal[4][c] or ranks[c] > level:
            continue
        miss = miss_of(c, asked, goal, body, work, pose)
        if kinds[c] == ORIENTATION or kinds[c] == LOOK_AT:
            miss *= TURN_ARM
        if ranks[c] == level:
            merit += asked[6][c] * miss * miss
            worst = max(worst, miss)
        else:
            harm = max(harm, miss - held[0][c])
    return merit, worst, harm


@njit(cache=True, nogil=True)
def note_held(level, asked, goal, held, body, work, pose):
    """Note what the constraints above this level have got: it is theirs to keep."""
    kinds, ranks, ends, offsets = asked[0], asked[1], asked[2], asked[3]
    for c in range(kinds.shape[0]):
        if not goal[4][c] or ranks[c] >= level:
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
def comfort(asked, goal, out_reaches, out_folds, pose):
    """How far each limb will stretch for each end, and how near it can fold, (C, 2) metres; the chain does the rest.

    Beyond 98 % of the reach (or what the motion itself stretches) the limb takes ``soft_reach``, so its extension is
    smooth in time and the trunk does the rest without error (METHOD 6, "reach sharing").
    """
    kinds, ends, offsets, mobilities = asked[0], asked[2], asked[3], asked[4]
    spine_count = pose[0].shape[0] - 23
    point = np.empty(3)
    for c in range(kinds.shape[0]):
        for end in range(2):
            limb = ends[c, end, 2]
            if not goal[4][c] or limb < 0 or kinds[c] == ORIENTATION:
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


@njit(cache=True, nogil=True)
def aimed_at(c, end, holds_end, upper, root, asked, goal, point, pose):
    """Where the limb itself must bring what it bends: the goal, or the wrist's or ankle's part of it.

    ``point`` (3,) is the constrained point; it becomes the point that the limb moves there.
    """
    aimed = goal[0][c, end].copy()
    if holds_end and asked[2][c, end, 1] >= upper + 2:
        aimed -= point - pose[0][root + 2]
        point[:] = pose[0][root + 2]
    return aimed


@njit(cache=True, nogil=True)
def step(level, damping, mending, asked, goal, held, body, work, pose):
    """One step of all joints for this level with those above held, or to mend those alone; feet are put back.

    False when nothing moves.
    """
    rows, errors, owners, matrix, turned, turn = work[0], work[1], work[2], work[3], work[4], work[5]
    positions = pose[0]
    count = feet_rows(asked, body, rows, errors, owners, positions)
    for c in range(asked[0].shape[0]):
        if goal[4][c] and asked[1][c] < level:
            count = add_rows(c, True, count, asked, goal, held, body, work, pose)
    held_count = 0 if mending else count
    for c in range(asked[0].shape[0]):
        if not mending and goal[4][c] and asked[1][c] == level:
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
def add_rows(c, is_held, count, asked, goal, held, body, work, pose):
    """Rows of one constraint, towards its goal or, when held, towards what it has; the new number of rows."""
    kinds, ends, offsets, freedoms = asked[0], asked[2], asked[3], asked[5]
    rows, errors, owners = work[0], work[1], work[2]
    positions, rotations = pose
    joints = asked[7]
    first, vector, point = count, np.empty(3), np.empty(3)
    if kinds[c] == AREA and not goal[5][c]:
        return count
    if kinds[c] == ORIENTATION or kinds[c] == LOOK_AT:
        if ends[c, 0, 2] >= 0:
            return count
        target = held[2][c] if is_held else goal[1][c]
        turn_error(target, rotations[ends[c, 0, 1]], work[5][0], vector)
        for axis in range(3):
            begin_row(rows, errors, owners, count, c, TURN_ARM * vector[axis])
            add_turn_row(axis, TURN_ARM, ends[c, 0, 1], joints, rows[count])
            count += 1
    elif kinds[c] == BALANCE:
        segment_centres(body[1], positions, work[6])
        centre_of_mass(body[1], work[6], point)
        for axis in range(2):
            target_xy = held[1][c, 0, axis] if is_held else goal[0][c, 0, axis]
            begin_row(rows, errors, owners, count, c, target_xy - point[axis])
            add_balance_row(axis, body[1], work[6], joints, positions, rows[count])
            count += 1
    else:
        for end in range(2):
            if ends[c, end, 0] < 0:
                continue
            if ends[c, end, 2] >= 0 and freedoms[c, end, 0] > 0.0:
                count = add_reach_row(c, end, is_held, count, asked, goal, held, work, pose)
            elif kinds[c] != DISTANCE:
                end_place(ends, offsets, c, end, pose, point)
                target = held[1][c, end] if is_held else goal[0][c, end]
                for axis in range(3):
                    begin_row(rows, errors, owners, count, c, target[axis] - point[axis])
                    x, y, z = axis == 0, axis == 1, axis == 2
                    add_point_row(point, 1.0 * x, 1.0 * y, 1.0 * z, ends[c, end, 1], joints, positions, rows[count])
                    count += 1
    scale = math.sqrt(asked[6][c])
    if scale != 1.0:
        for row in range(first, count):
            rows[row] *= scale
            errors[row] *= scale
    return count


@njit(cache=True, nogil=True)
def begin_row(rows, errors, owners, count, c, error):
    """Start an empty row."""
    rows[count] = 0.0
    errors[count], owners[count] = error, c


@njit(cache=True, nogil=True)
def add_reach_row(c, end, is_held, count, asked, goal, held, work, pose):
    """The row of a limb as a link of variable length: its root nears the goal by what the limb falls short."""
    ends, offsets = asked[2], asked[3]
    positions, _ = pose
    spine_count = positions.shape[0] - 23
    limb = ends[c, end, 2]
    root, upper = limb_indices(limb, spine_count)
    holds_end = limb >= 2 or held_turn(limb, 1 << 30, asked, goal, spine_count) >= 0
    point = np.empty(3)
    end_place(ends, offsets, c, end, pose, point)
    aimed = aimed_at(c, end, holds_end, upper, root, asked, goal, point, pose)
    span = max(distance(aimed, positions[root]), 1e-9)
    error = span - min(max(span, work[10][c, end]), work[9][c, end])
    if error == 0.0 and (not is_held or work[10][c, end] + 1e-4 < span < work[9][c, end] - 1e-4):
        return count
    if is_held:
        error = math.copysign(max(abs(error) - held[0][c], 0.0), error)
    begin_row(work[0], work[1], work[2], count, c, error)
    x, y, z = aimed[0] - positions[root, 0], aimed[1] - positions[root, 1], aimed[2] - positions[root, 2]
    carrier = 0 if limb >= 2 else upper - 1
    add_point_row(positions[root], x / span, y / span, z / span, carrier, asked[7], positions, work[0][count])
    return count + 1


@njit(cache=True, nogil=True)
def feet_rows(asked, body, rows, errors, owners, positions):
    """Rows of planted legs that are stretched to their comfort: their hips go no further. The number of rows."""
    measures, states, legs = body[0], body[3], body[4]
    spine_count = positions.shape[0] - 23
    count = 0
    for side in range(2):
        if states[side] == 0:
            continue
        hip, ankle = positions[spine_count + 13 + 5 * side], legs[2][side]
        length = legs[1][side] * (measures[at.M_LEG + 2 * side] + measures[at.M_LEG + 2 * side + 1])
        span = distance(hip, ankle)
        if span > length - 1e-5:
            x, y, z = (ankle[0] - hip[0]) / span, (ankle[1] - hip[1]) / span, (ankle[2] - hip[2]) / span
            begin_row(rows, errors, owners, count, asked[0].shape[0], span - length)
            add_point_row(hip, x, y, z, 0, asked[7], positions, rows[count])
            count += 1
    return count


@njit(cache=True, nogil=True)
def keep_feet_in_reach(body, positions):
    """Bring the root back to where every planted ankle is within its leg's comfort, in turns (METHOD 7)."""
    measures, states, legs = body[0], body[3], body[4]
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
