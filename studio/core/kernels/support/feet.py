"""How feet that stand are turned: soles locked level, of one heading, and toes laid on the ground (METHOD 4).

``states`` (F,) and ``soles`` (F or 1, 6) as in ``kernels.support.sole``.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation import matrix_to_rotation_vector, multiply, rotation_vector_to_matrix
from studio.core.kernels.algebra.turns import NO_TURN, product, put_turn, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix
from studio.core.kernels.compiling import allocating_kernel, small_kernel
from studio.core.kernels.support.gaps import ease_gaps, is_inside
from studio.core.kernels.support.sole import (
    FLAT,
    HEEL,
    HEEL_LENGTH,
    TOE,
    TOE_X,
    TOE_Y,
    ball_above_heel,
    lying_aside,
    point_down,
    set_heading,
    toe_heading,
    upright_part,
)


@allocating_kernel
def level_soles(rotations, states, reach, out_rotations):
    """Foot rotations (F, 3, 3), level and of one heading through each stretch of frames that stands flat.

    The heading is the mean of the stretch; the correction eases from one stretch to the next (METHOD 4).
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    known = states == FLAT
    level, turn = np.zeros((3, 3)), np.empty((3, 3))
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
            if not is_inside(standing, known):
                multiply(level, rotations[standing].T, turn)
                matrix_to_rotation_vector(turn, corrections[standing])
        frame = end
    ease_gaps(corrections, known, reach)
    for frame in range(count):
        if not known[frame]:
            put_turn(corrected(corrections[frame], turn_in(rotations[frame])), out_rotations[frame])


@small_kernel
def corrected(correction, turn):
    """A turn turned on by the rotation vector ``correction`` (3,), itself where that is nought."""
    x, y, z = correction[0], correction[1], correction[2]
    return product(turn_by(x, y, z), turn) if x != 0.0 or y != 0.0 or z != 0.0 else turn


@allocating_kernel
def keep_pitch_on_ground(soles, states, reach, rotations):
    """Foot rotations (F, 3, 3), in place: no ball below the heel in a heel stand, none above it in a toe stand."""
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    turn, turned = np.empty((3, 3)), np.empty((3, 3))
    for frame in range(count):
        if states[frame] != HEEL and states[frame] != TOE:
            continue
        sole = soles[frame if soles.shape[0] > 1 else 0]
        length = math.sqrt(sole[TOE_X] * sole[TOE_X] + sole[TOE_Y] * sole[TOE_Y]) + sole[HEEL_LENGTH]
        x, y = rotations[frame, 0, 0], rotations[frame, 1, 0]
        level = max(math.sqrt(x * x + y * y), 1e-9)
        copy_matrix(rotations[frame], turned)
        pitch = 0.0
        for _ in range(4):
            rise = ball_above_heel(turned, sole)
            if pitch == 0.0 and (rise >= 0.0) == (states[frame] == HEEL):
                break
            pitch += rise / length
            corrections[frame, 0], corrections[frame, 1] = -pitch * y / level, pitch * x / level
            rotation_vector_to_matrix(corrections[frame, 0], corrections[frame, 1], 0.0, turn)
            multiply(turn, rotations[frame], turned)
    ease_gaps(corrections, states != 0, reach)
    for frame in range(count):
        put_turn(corrected(corrections[frame], turn_in(rotations[frame])), rotations[frame])


@allocating_kernel
def level_toes(feet, toes, states, pitches, reach, out_toes):
    """Toe rotations (F, 3, 3) lying level while the toe stands, heading as the foot; eased in between (METHOD (6)).

    ``pitches`` (F,) in radians by which they point down, on their tips.

    A foot that stands steeply on its tucked toes heads where its instep looks; one that lies on its instep keeps them,
    and one that lies on its side but has their tip come down.
    ``feet`` (F, 3, 3) corrected, ``toes`` (F, 3, 3) relative to the foot; out in the world.
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    known, lies = (states & TOE) != 0, np.zeros(count, np.bool_)
    level, turn, local = np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    level[2, 2] = 1.0
    for frame in range(count):
        if known[frame]:
            foot = feet[frame]
            set_heading(level, *toe_heading(foot))
            share = upright_part(foot)
            aside = lying_aside(foot)
            lies[frame] = share == 1.0 and aside == 0.0
            point_down(level, pitches[frame])
            if lies[frame]:
                copy_matrix(level, out_toes[frame])
            if not (lies[frame] and is_inside(frame, known)):
                multiply(foot.T, level, local)
                multiply(local, toes[frame].T, turn)
                matrix_to_rotation_vector(turn, corrections[frame])
                corrections[frame] *= share * (1.0 - aside)
                if share < 1.0 or aside > 0.0:
                    lay_tip(foot, toes[frame], pitches[frame], share + aside - share * aside, corrections[frame])
    ease_gaps(corrections, known, reach)
    for frame in range(count):
        if not lies[frame]:
            local_toe = corrected(corrections[frame], turn_in(toes[frame]))
            put_turn(product(turn_in(feet[frame]), local_toe), out_toes[frame])


@allocating_kernel
def lay_tip(foot, toe, pitch, share, correction):
    """Turn a ``toe`` (3, 3) relative to its foot by a ``share`` of the shortest way to pointing down by ``pitch``.

    ``correction`` (3,) the turn that it is to make, a rotation vector in the foot's axes, turned on in place.
    """
    turned = corrected(correction, turn_in(toe))
    x, y, z = 0.0, 0.0, 0.0
    for axis in range(3):
        x += foot[0, axis] * turned[3 * axis]
        y += foot[1, axis] * turned[3 * axis]
        z += foot[2, axis] * turned[3 * axis]
    level = max(math.sqrt(x * x + y * y), 1e-9)
    way = share * (math.atan2(z, level) + pitch) / level
    across = np.empty(3)
    for axis in range(3):
        across[axis] = way * (x * foot[1, axis] - y * foot[0, axis])
    turn = np.empty((3, 3))
    put_turn(corrected(across, corrected(correction, NO_TURN)), turn)
    matrix_to_rotation_vector(turn, correction)
