"""Root poses of bodies supported by more than their feet, with all contacts in reach, and arms placed on their
contacts.
"""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels import channel_columns as channel
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.rotation_matrices import rotation_vector_to_matrix
from studio.core.kernels.algebra.rotation_tuples import (
    aim_z_axis,
    compose,
    rotation_from_matrix,
    rotation_from_quaternion,
    rotation_from_vector,
    write_rotation,
    write_transformed_point,
)
from studio.core.kernels.body.parts import rotate_part, translate_points
from studio.core.kernels.body_indices import (
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb import place_limb, soft_extension
from studio.core.kernels.records import Array, LimbShape, Pose

SETTLING_STEPS = 12
"""Greatest number of Gauss-Newton steps."""
LONGEST_SETTLING_STEP = 0.05
"""Greatest length in metres of one step."""
METRES_PER_RADIAN = 0.6
"""Travel in metres that costs as much as a rotation of the body by one radian."""
SETTLED_STEP = 1e-7
"""Length of a step, in metres (or radians times ``METRES_PER_RADIAN``), below which no further one is taken."""


class SettlingScratch(NamedTuple):
    """Scratch of ``settle_frames``."""

    rotation: Array
    """(3, 3) present rotation of the body."""
    arm: Array
    """(3,) from the root to the start of a link."""
    row: Array
    """(6,) Jacobian row of a link's length."""
    normal: Array
    """(6, 7) normal equations."""
    taut: Array
    """(N,) True for a link that has been longer than its limit."""


@allocating_kernel
def settle_frames(roots, links, seats, centres, stiffness, moves):
    """Find the least translation and rotation of whole bodies that bring all contacts into reach of their limbs.

    The result is the least-squares solution of the excess lengths and, ``stiffness`` times, of the distance of the
    moves from ``centres`` (F, 6): one minimum, a smooth function of its inputs.

    ``moves`` (F, 6) receive the translation of the root and a rotation vector about it. ``roots`` (F, 3); ``links`` is
    a ``SupportLinks`` record; ``seats`` (F, 7) the position of the seat relative to the root, its target, and the
    weight f of its contact, 1 in contact: the seat goes f^2 / (f^2 + (1 - f)^2) of the way from ``centres`` to its
    target. Gauss-Newton steps begin at ``centres``; a link that has been too long stays an equality, since it would
    alternate. METHOD (10).
    """
    scratch = SettlingScratch(
        np.empty((3, 3)), np.empty(3), np.empty(6), np.empty((6, 7)), np.empty(len(links.starts), np.bool_)
    )
    for frame in range(roots.shape[0]):
        move, centre = moves[frame], centres[frame]
        for axis in range(6):
            move[axis] = centre[axis]
        scratch.taut[:] = False
        for _ in range(SETTLING_STEPS):
            scratch.normal[:] = 0.0
            rotation_vector_to_matrix(move[3], move[4], move[5], scratch.rotation)
            add_link_errors(frame, roots[frame], links, move, scratch)
            add_seat_error(roots[frame], seats[frame], stiffness, move, scratch)
            if settling_step(stiffness, centre, move, scratch.normal) < SETTLED_STEP:
                break


@kernel
def add_link_errors(frame, root, links, move, scratch):
    """Add the length errors of all links to the normal equations."""
    arm, taut = scratch.arm, scratch.taut
    for link in range(links.starts.shape[0]):
        write_lever(links.starts[link, frame], scratch)
        x = links.ends[link, frame, 0] - root[0] - move[0] - arm[0]
        y = links.ends[link, frame, 1] - root[1] - move[1] - arm[1]
        z = links.ends[link, frame, 2] - root[2] - move[2] - arm[2]
        span, most = max(math.sqrt(x**2 + y**2 + z**2), 1e-9), links.max_lengths[link, frame]
        taut[link] = taut[link] or span > most
        error = span - (most if taut[link] else max(span, links.min_lengths[link, frame]))
        if error != 0.0:
            add_direction_error(x / span, y / span, z / span, error, scratch)


@kernel
def add_seat_error(root, seat, stiffness, move, scratch):
    """Add the position error of the seat to the normal equations."""
    if seat[6] <= 0.0:
        return
    write_lever(seat, scratch)
    firm = min(math.sqrt(stiffness) * seat[6] / max(1.0 - seat[6], 1e-9), 1.0)
    for axis in range(3):
        error = firm * (seat[3 + axis] - root[axis] - move[axis] - scratch.arm[axis])
        add_direction_error(firm * (axis == 0), firm * (axis == 1), firm * (axis == 2), error, scratch)


@kernel
def write_lever(start, scratch):
    """Write ``start`` (3,), relative to the root, rotated with the body into ``scratch.arm``."""
    arm, rotation = scratch.arm, scratch.rotation
    for axis in range(3):
        arm[axis] = 0.0
    write_transformed_point(arm, rotation_from_matrix(rotation), start[0], start[1], start[2], arm)


@kernel
def settling_step(stiffness, centre, move, normal):
    """Take the Gauss-Newton step of the ``normal`` equations on ``move`` (6,); returns the greatest component of the
    step.
    """
    for axis in range(6):
        normal[axis, axis] += stiffness
        normal[axis, 6] += stiffness * (centre[axis] - move[axis]) * (1.0 if axis < 3 else METRES_PER_RADIAN)
    solve_positive_definite(normal)
    step = 0.0
    for axis in range(6):
        step = max(step, abs(normal[axis, 6]))
    fraction = min(1.0, LONGEST_SETTLING_STEP / max(step, 1e-9))
    for axis in range(6):
        move[axis] += fraction * normal[axis, 6] / (1.0 if axis < 3 else METRES_PER_RADIAN)
    return step


@kernel
def add_direction_error(x, y, z, error, scratch):
    """Add a required displacement to the normal equations: ``error`` metres of the point at ``scratch.arm`` along (x,
    y, z).

    METHOD (10).
    """
    arm, row, normal = scratch.arm, scratch.row, scratch.normal
    row[0], row[1], row[2] = x, y, z
    row[3] = (arm[1] * z - arm[2] * y) / METRES_PER_RADIAN
    row[4] = (arm[2] * x - arm[0] * z) / METRES_PER_RADIAN
    row[5] = (arm[0] * y - arm[1] * x) / METRES_PER_RADIAN
    for i in range(6):
        for j in range(6):
            normal[i, j] += row[i] * row[j]
        normal[i, 6] += row[i] * error


@kernel
def solve_positive_definite(matrix):
    """Solve a symmetric positive definite system (N, N + 1), in place; its last column becomes the solution."""
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
    """Rotate every frame's body about its root and translate it, in place, by ``moves`` (F, 6): translation and
    rotation vector.
    """
    spine_count = positions.shape[1] - POINTS_BESIDE_SPINE
    for frame in range(positions.shape[0]):
        move = moves[frame]
        if move[3] != 0.0 or move[4] != 0.0 or move[5] != 0.0:
            rotation = rotation_from_vector(move[3], move[4], move[5])
            rotate_part(rotation, 0, spine_count, positions[frame, 0], positions[frame], rotations[frame])
        translate_points(move[0], move[1], move[2], positions[frame])


@kernel
def place_arms(measures, arms, positions, rotations):
    """Place the arms of all frames with their wrists at the targets, in place (METHOD 6).

    ``arms`` is an ``ArmTargets`` record; ``measures`` (F or 1, n). An arm extends freely to its soft-IK threshold, and
    softly beyond.
    """
    for frame in range(positions.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        for side in range(2):
            if arms.soft_thresholds[side, frame] > 0.0:
                place_arm(frame, side, row, arms, Pose(positions[frame], rotations[frame]))


@kernel
def place_arm(frame, side, measures, arms, pose):
    """Place one arm of one frame: shoulder on the clavicle, wrist at its target, hand with its target rotation."""
    channels, wrist = arms.channels[frame], arms.wrists[side, frame]
    spine_count = (measures.shape[0] - measure.SPINE) // 3
    shoulder, upper_arm = (
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    t = channel.LIMB_TWIST + 2 * side
    parent = compose(
        rotation_from_matrix(pose.rotations[spine_count - 1]),
        rotation_from_quaternion(channels, channel.CLAVICLE + 4 * side),
    )
    axes = compose(parent, rotation_from_quaternion(channels, channel.LIMB_FRAME + 4 * side))
    origin = pose.positions[shoulder]
    upper, lower = measures[measure.ARM + 2 * side], measures[measure.ARM + 2 * side + 1]
    length = upper + lower
    x, y, z = wrist[0] - origin[0], wrist[1] - origin[1], wrist[2] - origin[2]
    distance = math.sqrt(x * x + y * y + z * z)
    if distance > 1e-9:
        axes = aim_z_axis(axes, x / distance, y / distance, z / distance)
    limb = LimbShape(
        (upper, lower),
        max(length * soft_extension(distance / length, arms.soft_thresholds[side, frame]), abs(upper - lower) + 1e-6),
        channels[channel.LIMB_OFF_PLANE + side] * length,
        arms.bends[side, frame],
        (channels[t], channels[t + 1]),
    )
    end, _ = place_limb(shoulder, upper_arm, axes, limb, pose)
    rotation = rotation_from_matrix(arms.hands[side, frame])
    write_rotation(rotation, pose.rotations[upper_arm + 2])
    m = measure.HAND + 3 * side
    write_transformed_point(end, rotation, measures[m], measures[m + 1], measures[m + 2], pose.positions[shoulder + 3])
