"""What one foot does on a level floor (METHOD 4)."""

import numpy as np

from studio.core.kernels.algebra.turns import inverse, product, put_turn, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import allocating_kernel
from studio.core.kernels.support.feet import keep_pitch_on_ground, level_soles, level_toes, plant_ankles, tip_rise
from studio.core.kernels.support.heels import find_tiptoe, lift_heels


@allocating_kernel
def plan_foot(states, soles, height, rolls, reach, ankle, foot, positions, rotations, out_ankles, out_feet, out_toes):
    """What one foot does on a level floor (METHOD 4): ankles (F, 3), foot and toe rotations (F, 3, 3) in the world.

    ``states`` (F,); ``soles`` (F or 1, 6); ``height`` of the floor in metres; ``rolls`` whether heels rise as
    captured; ``ankle`` the point and ``foot`` the segment, the toe next, of ``positions`` (F, P, 3) and ``rotations``
    (F, S, 3, 3) as retargeted.
    """
    count = states.shape[0]
    stands = False
    for frame in range(count):
        stands = stands or states[frame] != 0
        copy_point(positions[frame, ankle], out_ankles[frame])
        copy_matrix(rotations[frame, foot], out_feet[frame])
        copy_matrix(rotations[frame, foot + 1], out_toes[frame])
    if not stands:
        return
    ankles, source, toes = out_ankles.copy(), out_feet.copy(), np.empty_like(out_toes)
    for frame in range(count):
        put_turn(product(inverse(turn_in(source[frame])), turn_in(out_toes[frame])), toes[frame])
    level_soles(source, states, reach, out_feet)
    keep_pitch_on_ground(soles, states, reach, out_feet)
    pitches = np.zeros(count)
    if rolls:
        rises = np.empty(count)
        for frame in range(count):
            sole = soles[frame if soles.shape[0] > 1 else 0]
            rises[frame] = positions[frame, ankle + 1, 2] - height - sole[3] - sole[2]
        find_tiptoe(soles, states, rises, reach, pitches)
        for frame in range(count):
            sole = soles[frame if soles.shape[0] > 1 else 0]
            rises[frame] = ankles[frame, 2] - height - tip_rise(sole, pitches[frame])
        lift_heels(soles, states, rises, reach, out_feet)
    level_toes(out_feet, toes, states, pitches, reach, out_toes)
    plant_ankles(ankles, out_feet, states, soles, np.full(count, height), pitches, reach, out_ankles)
