"""Bodies carried by more than their feet: the root put where all that stands is in reach, arms put on their hands."""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.rotation import rotation_vector_to_matrix
from studio.core.kernels.algebra.turns import aimed, product, put_beside, put_turn, turn_by, turn_in, turn_of
from studio.core.kernels.body.parts import move_all, turn_part
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb import place_limb, soft_reach
from studio.core.kernels.records import Array, Limb, Pose

TRIES = 12
"""Steps in which a body settles, at most."""
LONGEST_STEP = 0.05
"""Metres that one step may go."""
LEAN = 0.6
"""Metres of travel that count as much as a turn of the body by one radian."""
CLOSE_ENOUGH = 1e-7
"""Metres (or radians times ``LEAN``) of a step after which no other follows."""


class Settling(NamedTuple):
    """Scratch of ``settle_frames``."""

    turn: Array
    """(3, 3) the body's turn now."""
    arm: Array
    """(3,) from the root to where a link begins."""
    row: Array
    """(6,) how the moves bring that nearer."""
    normal: Array
    """(6, 7) the normal equations."""
    taut: Array
    """(N,) whether a link was too long once."""


@allocating_kernel
def settle_frames(roots, links, seats, centres, stiffness, moves):
    """Move and turn whole bodies, as little as possible, until what stands is in reach of what carries it.

    The least squares of what is out of reach and, ``stiffness`` times, of how far the moves are from ``centres``
    (F, 6): one minimum, which follows its inputs smoothly.

    ``roots`` (F, 3); ``links`` as in ``kernels.records``; ``seats`` (F, 7) the seat from the root, where it is to be,
    and how firmly, 1 where it stands: of its way between ``centres`` and there it goes
    f^2 / (f^2 + (1 - f)^2). ``moves`` (F, 6), in place: travel of the root and a rotation vector about
    it. Gauss-Newton from ``centres``; a link that was once too long stays taut, or it would tug and let go in turns.

    METHOD (10).
    """
    scratch = Settling(
        np.empty((3, 3)), np.empty(3), np.empty(6), np.empty((6, 7)), np.empty(len(links.starts), np.bool_)
    )
    for frame in range(roots.shape[0]):
        move, centre = moves[frame], centres[frame]
        move[:] = centre
        scratch.taut[:] = False
        for _ in range(TRIES):
            scratch.normal[:] = 0.0
            rotation_vector_to_matrix(move[3], move[4], move[5], scratch.turn)
            pull_links(frame, roots[frame], links, move, scratch)
            pull_seat(roots[frame], seats[frame], stiffness, move, scratch)
            if settling_step(stiffness, centre, move, scratch.normal) < CLOSE_ENOUGH:
                break


@kernel
def pull_links(frame, root, links, move, scratch):
    """Add what each link that is too long or too short pulls at the body."""
    arm, taut = scratch.arm, scratch.taut
    for link in range(links.starts.shape[0]):
        put_arm(links.starts[link, frame], scratch)
        x = links.ends[link, frame, 0] - root[0] - move[0] - arm[0]
        y = links.ends[link, frame, 1] - root[1] - move[1] - arm[1]
        z = links.ends[link, frame, 2] - root[2] - move[2] - arm[2]
        span, most = max(math.sqrt(x**2 + y**2 + z**2), 1e-9), links.most[link, frame]
        taut[link] = taut[link] or span > most
        error = span - (most if taut[link] else max(span, links.least[link, frame]))
        if error != 0.0:
            add_pull(x / span, y / span, z / span, error, scratch)


@kernel
def pull_seat(root, seat, stiffness, move, scratch):
    """Add what pulls the seat to where it is to be."""
    if seat[6] <= 0.0:
        return
    put_arm(seat, scratch)
    firm = min(math.sqrt(stiffness) * seat[6] / max(1.0 - seat[6], 1e-9), 1.0)
    for axis in range(3):
        error = firm * (seat[3 + axis] - root[axis] - move[axis] - scratch.arm[axis])
        add_pull(firm * (axis == 0), firm * (axis == 1), firm * (axis == 2), error, scratch)


@kernel
def put_arm(start, scratch):
    """What is ``start`` (3,) from the root as it is turned now."""
    arm, turn = scratch.arm, scratch.turn
    for axis in range(3):
        arm[axis] = 0.0
    put_beside(arm, turn_in(turn), start[0], start[1], start[2], arm)


@kernel
def settling_step(stiffness, centre, move, normal):
    """Take the step that the ``normal`` equations ask for; its greatest number."""
    for axis in range(6):
        normal[axis, axis] += stiffness
        normal[axis, 6] += stiffness * (centre[axis] - move[axis]) * (1.0 if axis < 3 else LEAN)
    solve_in_place(normal)
    step = 0.0
    for axis in range(6):
        step = max(step, abs(normal[axis, 6]))
    share = min(1.0, LONGEST_STEP / max(step, 1e-9))
    for axis in range(6):
        move[axis] += share * normal[axis, 6] / (1.0 if axis < 3 else LEAN)
    return step


@kernel
def add_pull(x, y, z, error, scratch):
    """Add to the normal equations that the point at ``arm`` from the root is to go ``error`` along a direction.

    METHOD (10).
    """
    arm, row, normal = scratch.arm, scratch.row, scratch.normal
    row[0], row[1], row[2] = x, y, z
    row[3] = (arm[1] * z - arm[2] * y) / LEAN
    row[4] = (arm[2] * x - arm[0] * z) / LEAN
    row[5] = (arm[0] * y - arm[1] * x) / LEAN
    for i in range(6):
        for j in range(6):
            normal[i, j] += row[i] * row[j]
        normal[i, 6] += row[i] * error


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


@kernel
def place_arms(measures, arms, positions, rotations):
    """``arms`` (``kernels.records``) of all frames on their wrists, in place, hands as given (METHOD 6).

    ``measures`` (F or 1, n). An arm stretches freely to its comfort, a part of its length, and ever less beyond
    (``soft_reach``).
    """
    for frame in range(positions.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        for side in range(2):
            if arms.comforts[side, frame] > 0.0:
                place_arm(frame, side, row, arms, Pose(positions[frame], rotations[frame]))


@kernel
def place_arm(frame, side, measures, arms, pose):
    """One arm of one frame: shoulder from the clavicle, wrist at its target, hand as given."""
    channels, wrist = arms.channels[frame], arms.wrists[side, frame]
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    shoulder, upper_arm = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
    t = at.LIMB_TWIST + 2 * side
    carrier = product(turn_in(pose.rotations[spine_count - 1]), turn_of(channels, at.CLAVICLE + 4 * side))
    axes = product(carrier, turn_of(channels, at.LIMB_FRAME + 4 * side))
    origin = pose.positions[shoulder]
    upper, lower = measures[at.M_ARM + 2 * side], measures[at.M_ARM + 2 * side + 1]
    length = upper + lower
    x, y, z = wrist[0] - origin[0], wrist[1] - origin[1], wrist[2] - origin[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if distance > 1e-9:
        axes = aimed(axes, x / distance, y / distance, z / distance)
    limb = Limb(
        (upper, lower),
        max(length * soft_reach(distance / length, arms.comforts[side, frame]), abs(upper - lower) + 1e-6),
        channels[at.LIMB_OFF_PLANE + side] * length,
        arms.bends[side, frame],
        (channels[t], channels[t + 1]),
    )
    end, _ = place_limb(shoulder, upper_arm, axes, limb, pose)
    turn = turn_in(arms.hands[side, frame])
    put_turn(turn, pose.rotations[upper_arm + 2])
    m = at.M_HAND + 3 * side
    put_beside(end, turn, measures[m], measures[m + 1], measures[m + 2], pose.positions[shoulder + 3])
