"""Bodies carried by more than their feet: the root put where all that stands is in reach, arms put on their hands."""

import math

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.rotation import add_rotated, rotation_vector_to_matrix
from studio.core.kernels.algebra.turns import aimed, product, put_beside, put_turn, turn_by, turn_in, turn_of
from studio.core.kernels.body.parts import move_all, turn_part
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb import place_limb, soft_reach

TRIES = 12
LONGEST_STEP = 0.05
"""Metres that one step may go."""
LEAN = 0.6
"""Metres of travel that count as much as a turn of the body by one radian."""
CLOSE_ENOUGH = 1e-7


@allocating_kernel
def settle_frames(roots, starts, ends, least, most, seats, centres, stiffness, moves):
    """Move and turn whole bodies, as little as possible, until what stands is in reach of what carries it.

    The least squares of what is out of reach and, ``stiffness`` times, of how far the moves are from ``centres``
    (F, 6): one minimum, which follows its inputs smoothly.

    ``roots`` (F, 3); N links with ``starts`` (N, F, 3) from the root (hips, shoulders), ``ends`` (N, F, 3) in the world
    (knees, ankles, wrists) and lengths between ``least`` and ``most`` (N, F); ``seats`` (F, 7) the seat from the root,
    where it is to be, and how firmly, 1 where it stands: of its way between ``centres`` and there it goes
    f^2 / (f^2 + (1 - f)^2). ``moves`` (F, 6), in place: travel of the root and a rotation vector about
    it. Gauss-Newton from ``centres``; a link that was once too long stays taut, or it would tug and let go in turns.

    METHOD (10).
    """
    turn, arm, goal = np.empty((3, 3)), np.empty(3), np.empty(3)
    matrix, row, zero = np.empty((6, 7)), np.empty(6), np.zeros(3)
    taut = np.empty(starts.shape[0], np.bool_)
    for frame in range(roots.shape[0]):
        move, centre = moves[frame], centres[frame]
        move[:] = centre
        taut[:] = False
        for _ in range(TRIES):
            rotation_vector_to_matrix(move[3], move[4], move[5], turn)
            matrix[:] = 0.0
            for link in range(starts.shape[0]):
                start = starts[link, frame]
                add_rotated(zero, turn, start[0], start[1], start[2], arm)
                for axis in range(3):
                    goal[axis] = ends[link, frame, axis] - roots[frame, axis] - move[axis] - arm[axis]
                span = max(math.sqrt(goal[0] ** 2 + goal[1] ** 2 + goal[2] ** 2), 1e-9)
                taut[link] = taut[link] or span > most[link, frame]
                error = span - (most[link, frame] if taut[link] else max(span, least[link, frame]))
                if error != 0.0:
                    add_pull(arm, goal[0] / span, goal[1] / span, goal[2] / span, error, row, matrix)
            if seats[frame, 6] > 0.0:
                seat = seats[frame]
                add_rotated(zero, turn, seat[0], seat[1], seat[2], arm)
                firm = min(math.sqrt(stiffness) * seat[6] / max(1.0 - seat[6], 1e-9), 1.0)
                for axis in range(3):
                    error = firm * (seat[3 + axis] - roots[frame, axis] - move[axis] - arm[axis])
                    add_pull(arm, firm * (axis == 0), firm * (axis == 1), firm * (axis == 2), error, row, matrix)
            for axis in range(6):
                matrix[axis, axis] += stiffness
                matrix[axis, 6] += stiffness * (centre[axis] - move[axis]) * (1.0 if axis < 3 else LEAN)
            solve_in_place(matrix)
            step = 0.0
            for axis in range(6):
                step = max(step, abs(matrix[axis, 6]))
            share = min(1.0, LONGEST_STEP / max(step, 1e-9))
            for axis in range(6):
                move[axis] += share * matrix[axis, 6] / (1.0 if axis < 3 else LEAN)
            if step < CLOSE_ENOUGH:
                break


@kernel
def add_pull(arm, x, y, z, error, row, matrix):
    """Add to the normal equations (6, 7) that a point at ``arm`` from the root is to go ``error`` along a direction.

    METHOD (10).
    """
    row[0], row[1], row[2] = x, y, z
    row[3] = (arm[1] * z - arm[2] * y) / LEAN
    row[4] = (arm[2] * x - arm[0] * z) / LEAN
    row[5] = (arm[0] * y - arm[1] * x) / LEAN
    for i in range(6):
        for j in range(6):
            matrix[i, j] += row[i] * row[j]
        matrix[i, 6] += row[i] * error


@kernel
def solve_in_place(matrix):
    """Solve a symmetric positive system (N, N + 1); the answer stands in its last column."""
    count = matrix.shape[0]
    for i in range(count):
        for j in range(i + 1, count):
            factor = matrix[j, i] / matrix[i, i]
            for column in range(i, count + 1):
                matrix[j, column] -= factor * matrix[i, column]
    for i in range(count - 1, -1, -1):
        for j in range(i + 1, count):
            matrix[i, count] -= matrix[i, j] * matrix[j, count]
        matrix[i, count] /= matrix[i, i]


@allocating_kernel
def move_bodies(moves, positions, rotations):
    """Turn every frame's body about its root and move it, in place; ``moves`` (F, 6) as in ``settle_frames``."""
    spine_count = positions.shape[1] - 23
    for frame in range(positions.shape[0]):
        move = moves[frame]
        if move[3] != 0.0 or move[4] != 0.0 or move[5] != 0.0:
            turn = turn_by(move[3], move[4], move[5])
            turn_part(turn, 0, spine_count, positions[frame, 0], positions[frame], rotations[frame])
        move_all(move[0], move[1], move[2], positions[frame])


@allocating_kernel
def place_arms(channels, measures, wrists, hands, bends, comforts, positions, rotations):
    """Arms of all frames on their wrists, in place, where ``comforts`` (2, F) are not 0; hands as given (METHOD 6).

    ``wrists`` (2, F, 3); ``hands`` (2, F, 3, 3) world rotations; ``bends`` (2, F) sign of the side to which the elbow
    bends. An arm stretches freely to its comfort, a part of its length, and ever less beyond (``soft_reach``).
    """
    for frame in range(positions.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        for side in range(2):
            if comforts[side, frame] > 0.0:
                place_arm(
                    channels[frame],
                    row,
                    side,
                    wrists[side, frame],
                    hands[side, frame],
                    bends[side, frame],
                    comforts[side, frame],
                    positions[frame],
                    rotations[frame],
                )


@kernel
def place_arm(channels, measures, side, wrist, hand, bend, comfort, positions, rotations):
    """One arm of one frame: shoulder from the clavicle, wrist (3,) at its target, hand (3, 3) as given."""
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    shoulder, upper_arm = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
    t = at.LIMB_TWIST + 2 * side
    carrier = product(turn_in(rotations[spine_count - 1]), turn_of(channels, at.CLAVICLE + 4 * side))
    frame = product(carrier, turn_of(channels, at.LIMB_FRAME + 4 * side))
    origin = positions[shoulder]
    upper, lower = measures[at.M_ARM + 2 * side], measures[at.M_ARM + 2 * side + 1]
    length = upper + lower
    x, y, z = wrist[0] - origin[0], wrist[1] - origin[1], wrist[2] - origin[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if distance > 1e-9:
        frame = aimed(frame, x / distance, y / distance, z / distance)
    end, _ = place_limb(
        origin,
        frame,
        max(length * soft_reach(distance / length, comfort), abs(upper - lower) + 1e-6),
        (upper, lower),
        channels[at.LIMB_OFF_PLANE + side] * length,
        bend,
        (channels[t], channels[t + 1]),
        positions[shoulder + 1],
        positions[shoulder + 2],
        rotations[upper_arm],
        rotations[upper_arm + 1],
    )
    turn = turn_in(hand)
    put_turn(turn, rotations[upper_arm + 2])
    m = at.M_HAND + 3 * side
    put_beside(end, turn, measures[m], measures[m + 1], measures[m + 2], positions[shoulder + 3])
