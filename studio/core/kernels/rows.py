"""What each constraint asks of the joints in one step: rows for ``kernels.priorities``.

``asked``, ``goal``, ``held``, ``body`` and ``pose`` are the tuples that ``kernels.constraints`` describes; ``work`` is
the one of ``kernels.constraints.solve_frame``.
"""

import math

import numpy as np
from numba import njit

from studio.core.kernels import layout as at
from studio.core.kernels.balance import add_balance_row, centre_of_mass, segment_centres
from studio.core.kernels.body import move_all
from studio.core.kernels.goals import AREA, BALANCE, DISTANCE, LOOK_AT, ORIENTATION, end_place
from studio.core.kernels.joints import add_point_row, add_turn_row
from studio.core.kernels.limb_constraints import distance, held_turn, limb_indices
from studio.core.kernels.placing import turn_error

SWEEPS = 12
"""Times both legs may pull the root back into their reach."""
TURN_ARM = 0.3
"""Metres that count as one radian where both are weighed together."""


@njit(cache=True, nogil=True)
def aimed_at(c, end, holds_end, upper, root, asked, goal, point, pose):
    """Where the limb itself must bring what it bends: the goal, or the wrist's or ankle's part of it.

    ``point`` (3,) is the constrained point; it becomes the point that the limb moves there.
    """
    ends, places = asked[2], goal[0]
    aimed = places[c, end].copy()
    if holds_end and ends[c, end, 1] >= upper + 2:
        aimed -= point - pose[0][root + 2]
        point[:] = pose[0][root + 2]
    return aimed


@njit(cache=True, nogil=True)
def add_rows(c, is_held, count, asked, goal, held, body, work, pose):
    """Rows of one constraint, towards its goal or, when held, towards what it has; the new number of rows."""
    places, engaged = goal[0], goal[5]
    kinds, ends, offsets, freedoms = asked[0], asked[2], asked[3], asked[5]
    rows, errors, owners = work[0], work[1], work[2]
    positions, rotations = pose
    joints = asked[7]
    first, vector, point = count, np.empty(3), np.empty(3)
    if kinds[c] == AREA and not engaged[c]:
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
            target_xy = held[1][c, 0, axis] if is_held else places[c, 0, axis]
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
                target = held[1][c, end] if is_held else places[c, end]
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
    """Rows of legs stretched to the end of their leash: their hips go no further. The number of rows."""
    kinds = asked[0]
    measures, leashes, legs = body[0], body[3], body[4]
    spine_count = positions.shape[0] - 23
    count = 0
    for side in range(2):
        if leashes[side] == np.inf:
            continue
        hip, ankle = positions[spine_count + 13 + 5 * side], legs[2][side]
        length = leashes[side] * (measures[at.M_LEG + 2 * side] + measures[at.M_LEG + 2 * side + 1])
        span = distance(hip, ankle)
        if span > length - 1e-5:
            x, y, z = (ankle[0] - hip[0]) / span, (ankle[1] - hip[1]) / span, (ankle[2] - hip[2]) / span
            begin_row(rows, errors, owners, count, kinds.shape[0], span - length)
            add_point_row(hip, x, y, z, 0, asked[7], positions, rows[count])
            count += 1
    return count


@njit(cache=True, nogil=True)
def keep_feet_in_reach(body, positions):
    """Bring the root back to where every ankle is within its leg's leash, in turns (METHOD 7)."""
    measures, leashes, legs = body[0], body[3], body[4]
    spine_count = positions.shape[0] - 23
    for _ in range(SWEEPS):
        moved = False
        for side in range(2):
            if leashes[side] == np.inf:
                continue
            hip, ankle = positions[spine_count + 13 + 5 * side], legs[2][side]
            length = leashes[side] * (measures[at.M_LEG + 2 * side] + measures[at.M_LEG + 2 * side + 1])
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
