"""The constraints of one limb: the first exactly, the second by what freedom it leaves (K05 figure 11).

``asked``, ``goal`` and ``pose`` are the tuples that ``kernels.constraints`` describes.
"""

import math

from numba import njit

from studio.core.kernels.body import body_point, turn_part
from studio.core.kernels.goals import AREA, ORIENTATION
from studio.core.kernels.reach import aim_at, bend_range, bend_to, longest_reach, swivel_to
from studio.core.kernels.rotation import multiply

CLOSE_ENOUGH = 5e-5
"""Metres (or radians) of error that are left as they are."""


@njit(cache=True, nogil=True)
def distance(a, b):
    """Metres between two points (3,)."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@njit(cache=True, nogil=True)
def limb_indices(limb, spine_count):
    """(root point, upper segment) of a limb: shoulder and upper arm, hip and thigh."""
    side = limb % 2
    if limb >= 2:
        return spine_count + 13 + 5 * side, spine_count + 10 + 4 * side
    return spine_count + 4 + 5 * side, spine_count + 3 + 4 * side


@njit(cache=True, nogil=True)
def held_turn(limb, level, asked, goal, spine_count):
    """The constraint that holds the orientation of a limb's end segment at this level, -1 if none."""
    wanted = goal[4]
    kinds, ranks, ends = asked[0], asked[1], asked[2]
    _, upper = limb_indices(limb, spine_count)
    for c in range(kinds.shape[0]):
        if kinds[c] == ORIENTATION and wanted[c] and ranks[c] <= level and ends[c, 0, 1] == upper + 2:
            return c
    return -1


@njit(cache=True, nogil=True)
def reach_of(limb, segment, holds_end, point, pose):
    """Greatest distance from the root of its limb that ``point`` can have, in metres; of the end joint if held."""
    positions, rotations = pose
    root, upper = limb_indices(limb, positions.shape[0] - 23)
    if segment == upper:
        return distance(point, positions[root])
    reached = positions[root + 2] if holds_end and segment >= upper + 2 else point
    return longest_reach(positions[root], positions[root + 1], rotations[upper, :, 0], reached)


@njit(cache=True, nogil=True)
def nearest_of(limb, segment, holds_end, point, pose):
    """Least distance from the root of its limb that ``point`` can have, in metres; of the end joint if held."""
    positions, rotations = pose
    root, upper = limb_indices(limb, positions.shape[0] - 23)
    if segment == upper:
        return distance(point, positions[root])
    reached = positions[root + 2] if holds_end and segment >= upper + 2 else point
    c0, c1, _ = bend_range(positions[root], positions[root + 1], rotations[upper, :, 0], reached)
    return math.sqrt(max(0.0, c0 - 2.0 * c1))


@njit(cache=True, nogil=True)
def solve_limb(limb, level, asked, goal, turn, pose):
    """All constraints of one limb down to ``level``, in order; ``turn`` (2, 3, 3) is scratch."""
    kinds, engaged = asked[0], goal[5]
    ranks, ends, offsets, freedoms = asked[1], asked[2], asked[3], asked[5]
    places, wanted = goal[0], goal[4]
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(limb, spine_count)
    turning = held_turn(limb, level, asked, goal, spine_count)
    if turning >= 0:
        multiply(goal[1][turning], rotations[upper + 2].T, turn[0])
        turn_part(turn[0], upper + 2, spine_count, positions[root + 2], positions, rotations)
    first, point = turn[1, 0], turn[1, 1]
    solved, held_upper = 0, False
    for c in range(ranks.shape[0]):
        if not wanted[c] or ranks[c] > level or (kinds[c] == AREA and not engaged[c]):
            continue
        if kinds[c] == ORIENTATION:
            if ends[c, 0, 2] == limb and ends[c, 0, 1] != upper + 2:
                multiply(goal[1][c], rotations[ends[c, 0, 1]].T, turn[0])
                pivot = positions[root + ends[c, 0, 1] - upper]
                turn_part(turn[0], ends[c, 0, 1], spine_count, pivot, positions, rotations)
                solved += 2
            continue
        for end in range(2):
            if ends[c, end, 2] != limb:
                continue
            target, segment = places[c, end], ends[c, end, 1]
            body_point(ends[c, end, 0], segment, offsets[c, end], positions, rotations, point)
            free = freedoms[c, end, 0] > 0.0
            if not free and freedoms[c, end, 1] == 0.0:
                continue
            if free and solved == 0:
                held_upper = segment == upper
                holds_end = limb >= 2 or turning >= 0
                reach_with_limb(ends[c, end], offsets[c, end], target, holds_end, point, turn[0], pose)
            elif free and solved == 1 and held_upper:
                aim_at(target, point, upper + 1, spine_count, positions[root + 1], turn[0], positions, rotations)
            elif free and solved == 1:
                swivel_to(target, point, first, upper, spine_count, positions[root], turn[0], positions, rotations)
            body_point(ends[c, end, 0], segment, offsets[c, end], positions, rotations, point)
            if freedoms[c, end, 1] > 0.0 and segment > upper + 1 and turning < 0:
                aim_end(freedoms[c, end, 1], target, point, root + 2, upper + 2, turn[0], pose)
            if solved == 0:
                body_point(ends[c, end, 0], segment, offsets[c, end], positions, rotations, first)
            solved += 1


@njit(cache=True, nogil=True)
def reach_with_limb(end, offset, target, holds_end, point, turn, pose):
    """Bend and aim one limb so that its point meets the target, or comes as near as it can.

    A foot, or a hand whose orientation is held, keeps its orientation in the world; else it goes with the limb.
    """
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(end[2], spine_count)
    if not holds_end:
        if end[1] != upper:
            bend_to(distance(target, positions[root]), upper, spine_count, root, point, turn, positions, rotations)
            body_point(end[0], end[1], offset, positions, rotations, point)
        aim_at(target, point, upper, spine_count, positions[root], turn, positions, rotations)
        return
    tip, tip_point, past = upper + 2, root + 2, 2 if end[2] >= 2 else 1
    goal = target.copy()
    turned = rotations[tip : tip + past].copy()
    beyond = positions[tip_point + 1 : tip_point + 1 + past] - positions[tip_point]
    if end[1] >= tip:
        goal -= point - positions[tip_point]
        point[:] = positions[tip_point]
    if end[1] != upper:
        bend_to(distance(goal, positions[root]), upper, spine_count, root, point, turn, positions, rotations)
        if end[1] >= tip:
            point[:] = positions[tip_point]
        else:
            body_point(end[0], end[1], offset, positions, rotations, point)
    aim_at(goal, point, upper, spine_count, positions[root], turn, positions, rotations)
    rotations[tip : tip + past] = turned
    positions[tip_point + 1 : tip_point + 1 + past] = positions[tip_point] + beyond


@njit(cache=True, nogil=True)
def aim_end(weight, target, point, joint, end, turn, pose):
    """Turn hand or foot about its joint so that its point faces the target, ``weight`` times the whole way."""
    if distance(point, target) < CLOSE_ENOUGH:
        return
    positions, rotations = pose
    goal = point + weight * (target - point)
    aim_at(goal, point, end, positions.shape[0] - 23, positions[joint], turn, positions, rotations)
