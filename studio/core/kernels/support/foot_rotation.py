"""Rotations of standing feet: level soles with one heading a contact, and toes on the ground (METHOD 5).

``states`` (F,) and ``soles`` (F or 1, 6) are those of ``kernels.support.sole``; ``reach`` and ``fade`` are ``reach``
and ``least`` of ``fade_into_gaps``.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation_matrices import (
    matrix_product,
    matrix_to_rotation_vector,
    rotation_vector_to_matrix,
)
from studio.core.kernels.algebra.rotation_tuples import (
    IDENTITY,
    compose,
    rotation_from_matrix,
    rotation_from_vector,
    write_rotation,
)
from studio.core.kernels.algebra.vectors import copy_matrix
from studio.core.kernels.compiling import allocating_kernel, small_kernel
from studio.core.kernels.support.gap_interpolation import fade_into_gaps, is_inside_run
from studio.core.kernels.support.sole import (
    HEEL_STANDS,
    SOLE_HEEL_LENGTH,
    SOLE_STANDS,
    TOE_STANDS,
    TOE_X,
    TOE_Y,
    ball_above_heel,
    lying_aside,
    point_down,
    set_heading,
    sole_down_fraction,
    toe_heading,
)


@allocating_kernel
def level_soles(rotations, states, reach, fade, out_rotations):
    """Write foot rotations (F, 3, 3) that are level and have one heading through each run of flat frames.

    The heading is the mean of the run; the correction is interpolated between runs (METHOD 5).
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    known = states == SOLE_STANDS
    level, rotation = np.zeros((3, 3)), np.empty((3, 3))
    level[2, 2] = 1.0
    frame = 0
    while frame < count:
        if not known[frame]:
            frame += 1
            continue
        end, along, across = frame, 0.0, 0.0
        while end < count and known[end]:
            along += rotations[end, 0, 0]
            across += rotations[end, 1, 0]
            end += 1
        set_heading(level, along, across)
        for standing in range(frame, end):
            copy_matrix(level, out_rotations[standing])
            if not is_inside_run(standing, known):
                matrix_product(level, rotations[standing].T, rotation)
                matrix_to_rotation_vector(rotation, corrections[standing])
        frame = end
    fade_into_gaps(corrections, known, rotations[:, :, 0], reach, math.inf)
    if fade < math.inf:
        fade_into_gaps(corrections, states != 0, rotations[:, :, 0], reach, fade)
    for frame in range(count):
        if not known[frame]:
            write_rotation(
                correct_rotation(corrections[frame], rotation_from_matrix(rotations[frame])), out_rotations[frame]
            )


@small_kernel
def correct_rotation(correction, rotation):
    """Rotation tuple ``rotation`` followed by the rotation vector ``correction`` (3,); unchanged to the bit if that is
    zero.
    """
    x, y, z = correction[0], correction[1], correction[2]
    return compose(rotation_from_vector(x, y, z), rotation) if x != 0.0 or y != 0.0 or z != 0.0 else rotation


@allocating_kernel
def limit_foot_pitch(soles, states, reach, fade, rotations):
    """Limit the pitch of foot rotations (F, 3, 3), in place: the ball is not below the heel in a heel stand, nor above
    it in a toe stand.
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    rotation, turned = np.empty((3, 3)), np.empty((3, 3))
    for frame in range(count):
        if states[frame] != HEEL_STANDS and states[frame] != TOE_STANDS:
            continue
        sole = soles[frame if soles.shape[0] > 1 else 0]
        length = math.sqrt(sole[TOE_X] * sole[TOE_X] + sole[TOE_Y] * sole[TOE_Y]) + sole[SOLE_HEEL_LENGTH]
        x, y = rotations[frame, 0, 0], rotations[frame, 1, 0]
        level = max(math.sqrt(x * x + y * y), 1e-9)
        copy_matrix(rotations[frame], turned)
        pitch = 0.0
        for _ in range(4):
            rise = ball_above_heel(turned, sole)
            if pitch == 0.0 and (rise >= 0.0) == (states[frame] == HEEL_STANDS):
                break
            pitch += rise / length
            corrections[frame, 0], corrections[frame, 1] = -pitch * y / level, pitch * x / level
            rotation_vector_to_matrix(corrections[frame, 0], corrections[frame, 1], 0.0, rotation)
            matrix_product(rotation, rotations[frame], turned)
    fade_into_gaps(corrections, states != 0, rotations[:, :, 0], reach, fade)
    for frame in range(count):
        write_rotation(correct_rotation(corrections[frame], rotation_from_matrix(rotations[frame])), rotations[frame])


@allocating_kernel
def level_toes(feet, toes, states, pitches, reach, fade, out_toes):
    """Write toe rotations (F, 3, 3), in the world: level with the foot's heading while the toe stands, interpolated
    between (METHOD (6)).

    ``feet`` (F, 3, 3) corrected; ``toes`` (F, 3, 3) relative to the foot; ``pitches`` (F,) in radians lower toes that
    stand on their tips. A steep foot on tucked toes takes its heading from the instep; a foot that lies on its instep
    keeps its toes, and one on its side has only its tip lowered.
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    known, lies = (states & TOE_STANDS) != 0, np.zeros(count, np.bool_)
    level, rotation, local = np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    level[2, 2] = 1.0
    for frame in range(count):
        if known[frame]:
            foot = feet[frame]
            set_heading(level, *toe_heading(foot))
            fraction = sole_down_fraction(foot)
            aside = lying_aside(foot)
            lies[frame] = fraction == 1.0 and aside == 0.0
            point_down(level, pitches[frame])
            if lies[frame]:
                copy_matrix(level, out_toes[frame])
            if not (lies[frame] and is_inside_run(frame, known)):
                matrix_product(foot.T, level, local)
                matrix_product(local, toes[frame].T, rotation)
                matrix_to_rotation_vector(rotation, corrections[frame])
                for axis in range(3):
                    corrections[frame, axis] *= fraction * (1.0 - aside)
                if fraction < 1.0 or aside > 0.0:
                    rotate_toe_down(
                        foot, toes[frame], pitches[frame], fraction + aside - fraction * aside, corrections[frame]
                    )
    fade_into_gaps(corrections, known, feet[:, :, 0], reach, math.inf)
    if fade < math.inf:
        fade_into_gaps(corrections, states != 0, feet[:, :, 0], reach, fade)
    for frame in range(count):
        if not lies[frame]:
            local_toe = correct_rotation(corrections[frame], rotation_from_matrix(toes[frame]))
            write_rotation(compose(rotation_from_matrix(feet[frame]), local_toe), out_toes[frame])


@allocating_kernel
def rotate_toe_down(foot, toe, pitch, fraction, correction):
    """Add to a toe's ``correction`` (3,) ``fraction`` of the shortest rotation that pitches the toe down by ``pitch``
    radians.

    ``correction`` is a rotation vector in the foot's axes, changed in place; ``toe`` (3, 3) is relative to the ``foot``
    (3, 3).
    """
    turned = correct_rotation(correction, rotation_from_matrix(toe))
    x, y, z = 0.0, 0.0, 0.0
    for axis in range(3):
        x += foot[0, axis] * turned[3 * axis]
        y += foot[1, axis] * turned[3 * axis]
        z += foot[2, axis] * turned[3 * axis]
    level = max(math.sqrt(x * x + y * y), 1e-9)
    displacement = fraction * (math.atan2(z, level) + pitch) / level
    across = np.empty(3)
    for axis in range(3):
        across[axis] = displacement * (x * foot[1, axis] - y * foot[0, axis])
    rotation = np.empty((3, 3))
    write_rotation(correct_rotation(across, correct_rotation(correction, IDENTITY)), rotation)
    matrix_to_rotation_vector(rotation, correction)
