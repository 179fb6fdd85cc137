"""Limbs put where their constraints want them, and how well each constraint holds then.

``asked``, ``goal``, ``held``, ``body`` and ``pose`` are the tuples that ``kernels.constraints`` describes; ``work`` is
the one of ``kernels.constraints.solve_frame``.
"""

import math

import numpy as np
from numba import njit

from studio.core.kernels.areas import nearest_allowed
from studio.core.kernels.balance import centre_of_mass, segment_centres
from studio.core.kernels.goals import (
    AREA,
    BALANCE,
    DISTANCE,
    LOOK_AT,
    ORIENTATION,
    ease_goal,
    end_place,
    gaze_goal,
    part_to,
    second_place,
)
from studio.core.kernels.legs import place_leg
from studio.core.kernels.limb_constraints import CLOSE_ENOUGH, distance, limb_indices, solve_limb
from studio.core.kernels.rotation import add_rotated, matrix_to_rotation_vector, multiply, shortest_arc

ENGAGED = 1e-6
"""Metres into a forbidden area from which on a point counts as in it."""


@njit(cache=True, nogil=True)
def note_arms(asked, goal, body, pose):
    """Remember how constrained arms lie in their clavicles, so that they can be put back before each reach."""
    kinds, ends, wanted = asked[0], asked[2], goal[4]
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    for side in range(2):
        used = False
        for c in range(kinds.shape[0]):
            used = used or (wanted[c] and (ends[c, 0, 2] == side or ends[c, 1, 2] == side))
        if not used:
            continue
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
def place_limbs(first_level, level, asked, goal, body, work, pose):
    """Every limb with a constraint from ``first_level`` on: put back and solved down to ``level``.

    Once more where a point ends in an area that it may not be in, or a distance is not shared well.
    """
    wanted, engaged = goal[4], goal[5]
    kinds, ranks, ends = asked[0], asked[1], asked[2]
    busy, moving = 0, False
    for c in range(kinds.shape[0]):
        if wanted[c] and ranks[c] <= level:
            moving = moving or kinds[c] == DISTANCE or kinds[c] == AREA or kinds[c] == LOOK_AT
            engaged[c] = False
            for end in range(2):
                if ends[c, end, 2] >= 0 and (ranks[c] >= first_level or kinds[c] == AREA or kinds[c] == DISTANCE):
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
    places, distances, wanted, engaged = goal[0], goal[3], goal[4], goal[5]
    kinds, ranks, ends, offsets = asked[0], asked[1], asked[2], asked[3]
    points = np.empty((2, 3))
    for c in range(kinds.shape[0]):
        if not wanted[c] or ranks[c] > level:
            continue
        if kinds[c] == DISTANCE:
            end_place(ends, offsets, c, 0, pose, points[0])
            second_place(asked, goal, c, pose, points[1])
            part_to(points[0], points[1], distances[c], goal[2][c], places[c])
        elif kinds[c] == LOOK_AT:
            rotation = pose[1][ends[c, 0, 1]]
            end_place(ends, offsets, c, 0, pose, points[0])
            gaze_goal(places[c, 1], places[c, 0], points[0], distances[c], points[1])
            x, y, z = points[1, 0], points[1, 1], points[1, 2]
            shortest_arc(rotation[0, 0], rotation[1, 0], rotation[2, 0], x, y, z, work[5][0])
            multiply(work[5][0], rotation, goal[1][c])
        elif kinds[c] == AREA and not engaged[c]:
            engage_one(c, asked, goal, points, pose)


@njit(cache=True, nogil=True)
def falls_short(level, asked, goal, body, work, pose):
    """Whether a distance is missed because one of its limbs could not do its share: then the other does more."""
    kinds, ranks, wanted = asked[0], asked[1], goal[4]
    short = False
    for c in range(kinds.shape[0]):
        if kinds[c] == DISTANCE and wanted[c] and ranks[c] <= level:
            short = short or miss_of(c, asked, goal, body, work, pose) > CLOSE_ENOUGH
    return short


@njit(cache=True, nogil=True)
def engage(level, asked, goal, pose):
    """Areas whose points are where they may not be after all else was solved; True when there are new ones."""
    kinds, ranks, wanted, engaged = asked[0], asked[1], goal[4], goal[5]
    found = False
    points = np.empty((2, 3))
    for c in range(kinds.shape[0]):
        if kinds[c] == AREA and wanted[c] and ranks[c] <= level and not engaged[c]:
            found = engage_one(c, asked, goal, points, pose) or found
    return found


@njit(cache=True, nogil=True)
def engage_one(c, asked, goal, points, pose):
    """Engage one area if its point is where it may not be: the goal is the nearest place where it may."""
    places, distances, engaged = goal[0], goal[3], goal[5]
    end_place(asked[2], asked[3], c, 0, pose, points[0])
    if nearest_allowed(asked[8][c], points[0], points[1]) > ENGAGED:
        engaged[c] = True
        ease_goal(points[0], points[1], distances[c], places[c, 0])
    return engaged[c]


@njit(cache=True, nogil=True)
def miss_of(c, asked, goal, body, work, pose):
    """By how much a constraint is missed now: metres, or radians for an orientation or a look."""
    places, distances, engaged = goal[0], goal[3], goal[5]
    kinds, ends, offsets = asked[0], asked[2], asked[3]
    point, other = work[5][1, 0], work[5][1, 1]
    if kinds[c] == ORIENTATION or kinds[c] == LOOK_AT:
        turn_error(goal[1][c], pose[1][ends[c, 0, 1]], work[5][0], point)
        return math.sqrt(point[0] ** 2 + point[1] ** 2 + point[2] ** 2)
    if kinds[c] == BALANCE:
        segment_centres(body[1], pose[0], work[6])
        centre_of_mass(body[1], work[6], point)
        return math.hypot(point[0] - places[c, 0, 0], point[1] - places[c, 0, 1])
    end_place(ends, offsets, c, 0, pose, point)
    if kinds[c] == DISTANCE:
        second_place(asked, goal, c, pose, other)
        return abs(distance(point, other) - distances[c])
    if kinds[c] == AREA and not engaged[c]:
        return distances[c] * nearest_allowed(asked[8][c], point, other)
    return distance(point, places[c, 0])


@njit(cache=True, nogil=True)
def turn_error(wanted, now, turn, out_vector):
    """Rotation vector (3,) in radians that turns ``now`` to ``wanted`` (3, 3)."""
    multiply(wanted, now.T, turn)
    matrix_to_rotation_vector(turn, out_vector)
