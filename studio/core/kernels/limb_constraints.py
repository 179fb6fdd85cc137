"""The constraints of one limb: the first exactly, the second by what freedom it leaves (K05 figure 11).

``asked`` and ``pose`` are the tuples that ``kernels.constraints`` describes.
"""

import math

import numpy as np
from numba import njit

from studio.core.kernels.body import body_point
from studio.core.kernels.reach import aim_at, bend_to, longest_reach, swivel_to

CLOSE_ENOUGH = 5e-5
"""Metres of error that are left as they are."""


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
def reach_of(code, point, pose):
    """Greatest distance of ``point`` from the root of its limb, in metres."""
    positions, rotations = pose
    root, upper = limb_indices(code[2], positions.shape[0] - 23)
    if code[1] == upper:
        return distance(point, positions[root])
    return longest_reach(positions[root], positions[root + 1], rotations[upper, :, 0], point)


@njit(cache=True, nogil=True)
def solve_limb(limb, asked, turn, pose):
    """All constraints of one limb, in order; ``turn`` (3, 3) is scratch."""
    codes, offsets, chains, targets, wanted = asked
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(limb, spine_count)
    held, point = np.empty(3), np.empty(3)
    solved, held_upper = 0, False
    for c in range(codes.shape[0]):
        if not wanted[c] or codes[c, 2] != limb:
            continue
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        if chains[c, 0] > 0.0 and solved == 0:
            held_upper = codes[c, 1] == upper
            reach_with_limb(codes[c], offsets[c], targets[c], point, turn, pose)
        elif chains[c, 0] > 0.0 and solved == 1 and held_upper:
            aim_at(targets[c], point, upper + 1, spine_count, positions[root + 1], turn, positions, rotations)
        elif chains[c, 0] > 0.0 and solved == 1:
            swivel_to(targets[c], point, held, upper, spine_count, positions[root], turn, positions, rotations)
        body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, point)
        if chains[c, 1] > 0.0 and codes[c, 1] > upper + 1:
            aim_end(chains[c, 1], targets[c], point, root + 2, upper + 2, turn, pose)
        if solved == 0:
            body_point(codes[c, 0], codes[c, 1], offsets[c], positions, rotations, held)
        solved += 1


@njit(cache=True, nogil=True)
def reach_with_limb(code, offset, target, point, turn, pose):
    """Bend and aim one limb so that its point meets the target, or comes as near as it can.

    A foot keeps its orientation in the world; a hand goes with its forearm.
    """
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(code[2], spine_count)
    end, end_point = upper + 2, root + 2
    goal = target.copy()
    on_foot = code[2] >= 2 and code[1] >= end
    foot = rotations[end : end + 2].copy()
    toes = positions[end_point + 1 : end_point + 3] - positions[end_point]
    if on_foot:
        goal -= point - positions[end_point]
        point[:] = positions[end_point]
    if code[1] != upper:
        bend_to(distance(goal, positions[root]), upper, spine_count, root, point, turn, positions, rotations)
        if on_foot:
            point[:] = positions[end_point]
        else:
            body_point(code[0], code[1], offset, positions, rotations, point)
    aim_at(goal, point, upper, spine_count, positions[root], turn, positions, rotations)
    if on_foot:
        rotations[end : end + 2] = foot
        positions[end_point + 1 : end_point + 3] = positions[end_point] + toes


@njit(cache=True, nogil=True)
def aim_end(weight, target, point, joint, end, turn, pose):
    """Turn hand or foot about its joint so that its point faces the target, ``weight`` times the whole way."""
    if distance(point, target) < CLOSE_ENOUGH:
        return
    positions, rotations = pose
    goal = point + weight * (target - point)
    aim_at(goal, point, end, positions.shape[0] - 23, positions[joint], turn, positions, rotations)
