"""The constraints of one limb: the first exactly, the second by what freedom it leaves (K05 figure 11).

``asked`` holds the records of ``kernels.asked``; ``grips`` (4,) is the constraint that holds the orientation of each
limb's end segment, -1 for none; ``turns`` (4, 3, 3) and ``points`` (8, 3) are scratch.
"""

import math

from studio.core.kernels.body import body_point, turn_part
from studio.core.kernels.compiling import inlined_kernel, kernel
from studio.core.kernels.goals import AREA, ORIENTATION, POSITION, end_place
from studio.core.kernels.limb import soft_reach
from studio.core.kernels.reach import aim_at, bend_to, span_range, swivel_to
from studio.core.kernels.stiffness import stiff_span, turn_back
from studio.core.kernels.turns import inverse, product, turn_in
from studio.core.kernels.vectors import copy_matrix, copy_point, distance

CLOSE_ENOUGH = 5e-5
"""Metres (or radians) of error that are left as they are."""
LIMB_COMFORT = 0.985
"""Part of its reach from which on a limb that nothing helps stretches ever less (``soft_reach``)."""


@kernel
def limb_indices(limb, spine_count):
    """(root point, upper segment) of a limb: shoulder and upper arm, hip and thigh."""
    side = limb % 2
    if limb >= 2:
        return spine_count + 13 + 5 * side, spine_count + 10 + 4 * side
    return spine_count + 4 + 5 * side, spine_count + 3 + 4 * side


@inlined_kernel
def note_grips(level, asked, spine_count, out_grips):
    """Which constraint down to ``level`` holds the orientation of each limb's end segment, (4,), -1 for none."""
    for limb in range(4):
        out_grips[limb] = -1
    for c in range(asked.shape[0] - 1, -1, -1):
        row = asked[c]
        limb = row.ends[0, 2]
        if row.kind != ORIENTATION or row.wanted != 1 or row.rank > level or limb < 0:
            continue
        if row.ends[0, 1] == limb_indices(limb, spine_count)[1] + 2:
            out_grips[limb] = c


@inlined_kernel
def note_seconds(asked):
    """Which places are wanted of a limb that has to bring another point to its place first.

    They take what swivel that leaves (K05 figures 11 and 13); nothing else moves for them.
    """
    for c in range(asked.shape[0]):
        row = asked[c]
        row.second = 0
        for before in range(c):
            other = asked[before]
            if row.kind == POSITION and other.kind == POSITION and other.wanted == 1 and row.ends[0, 2] >= 0:
                row.second |= other.ends[0, 2] == row.ends[0, 2] and other.freedoms[0, 0] > 0.0


@kernel
def range_of(limb, segment, holds_end, point, pose):
    """(least, greatest) distance in metres of ``point`` from the root of its limb; of the end joint if that is held."""
    positions, rotations = pose
    root, upper = limb_indices(limb, positions.shape[0] - 23)
    if segment == upper:
        span = distance(point, positions[root])
        return span, span
    hinge = rotations[upper, :, 0]
    if holds_end and segment >= upper + 2:
        return span_range(positions[root], positions[root + 1], hinge, positions[root + 2])
    return span_range(positions[root], positions[root + 1], hinge, point)


@kernel
def solve_limb(limb, level, asked, grips, turns, points, pose):
    """All constraints of one limb down to ``level``, in order."""
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(limb, spine_count)
    turning = grips[limb] >= 0 and asked[grips[limb]].wanted == 1
    if turning:
        turn = product(turn_in(asked[grips[limb]].turn), inverse(turn_in(rotations[upper + 2])))
        turn_part(turn, upper + 2, spine_count, positions[root + 2], positions, rotations)
    first, point = points[2], points[3]
    solved, held_upper = 0, False
    for c in range(asked.shape[0]):
        row = asked[c]
        if row.wanted != 1 or row.rank > level or (row.kind == AREA and not row.engaged):
            continue
        if row.kind == ORIENTATION:
            segment = row.ends[0, 1]
            if row.ends[0, 2] == limb and segment < upper + 2:
                turn = product(turn_in(row.turn), inverse(turn_in(rotations[segment])))
                turn_part(turn, segment, spine_count, positions[root + segment - upper], positions, rotations)
                solved += 2
            continue
        for end in range(2):
            if row.ends[end, 2] != limb:
                continue
            segment, free, target = row.ends[end, 1], row.freedoms[end, 0] > 0.0, row.places[end]
            if not free and row.freedoms[end, 1] == 0.0:
                continue
            end_place(row, end, pose, point)
            if row.stiff:
                copy_matrix(rotations[upper + 1 if held_upper else upper], turns[5])
            if free and solved == 0:
                held_upper = segment == upper
                reach_with_limb(row, end, limb >= 2 or turning, turns, points, pose)
            elif free and solved == 1 and held_upper:
                aim_at(target, point, upper + 1, spine_count, positions[root + 1], positions, rotations)
            elif free and solved == 1:
                swivel_to(target, point, first, upper, spine_count, positions[root], positions, rotations)
            if free and solved == 1 and row.stiff:
                joint = 1 if held_upper else 0
                part = row.parts[end, joint]
                turn_back(part, math.inf, upper + joint, root + joint, turns[5], turns[0], points[0], pose)
            end_place(row, end, pose, point)
            if row.freedoms[end, 1] > 0.0 and segment > upper + 1 and not turning:
                aim_end(row.freedoms[end, 1], target, point, root + 2, upper + 2, points[4], pose)
            if solved == 0:
                end_place(row, end, pose, first)
            solved += 1


@kernel
def reach_with_limb(row, end, holds_end, turns, points, pose):
    """Bend and aim one limb so that its point meets the target, or comes as near as it can.

    A foot, or a hand whose orientation is held, keeps its orientation in the world; else it goes with the limb.
    ``points[3]`` is the point; it moves along.
    """
    positions, rotations = pose
    limb, segment = row.ends[end, 2], row.ends[end, 1]
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(limb, spine_count)
    tip, point, goal = root + 2, points[3], points[4]
    copy_point(row.places[end], goal)
    past = 2 if limb >= 2 else 1
    if holds_end:
        for other in range(past):
            copy_matrix(rotations[upper + 2 + other], turns[1 + other])
            for axis in range(3):
                points[5 + other, axis] = positions[tip + 1 + other, axis] - positions[tip, axis]
        if segment >= upper + 2:
            for axis in range(3):
                goal[axis] -= point[axis] - positions[tip, axis]
            copy_point(positions[tip], point)
    if segment != upper:
        span = comfortable(row, end, distance(goal, positions[root]))
        if row.stiff:
            span = stiff_span(row, end, distance(point, positions[root]), span)
        bend_to(span, upper, spine_count, root, point, positions, rotations)
        if holds_end and segment >= upper + 2:
            copy_point(positions[tip], point)
        else:
            body_point(row.ends[end, 0], segment, row.offsets[end], positions, rotations, point)
    aim_at(goal, point, upper, spine_count, positions[root], positions, rotations)
    if row.stiff:
        row.change[end, 0] = turn_back(1.0, row.most[end, 0], upper, root, turns[5], turns[0], points[0], pose)
    if holds_end:
        for other in range(past):
            copy_matrix(turns[1 + other], rotations[upper + 2 + other])
            for axis in range(3):
                positions[tip + 1 + other, axis] = positions[tip, axis] + points[5 + other, axis]


@kernel
def comfortable(row, end, span):
    """How far a limb stretches for a place ``span`` metres from its root: as far as agreed, or softly if alone."""
    if row.helped:
        return min(span, row.reaches[end])
    longest = row.longest[end]
    return longest * soft_reach(span / longest, row.comforts[end]) if longest > 0.0 else span


@kernel
def aim_end(weight, target, point, joint, end, goal, pose):
    """Turn hand or foot about its joint so that its point faces the target, ``weight`` times the whole way."""
    if distance(point, target) < CLOSE_ENOUGH:
        return
    positions, rotations = pose
    for axis in range(3):
        goal[axis] = point[axis] + weight * (target[axis] - point[axis])
    aim_at(goal, point, end, positions.shape[0] - 23, positions[joint], positions, rotations)
