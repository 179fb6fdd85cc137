"""What one foot does on a level floor (METHOD 4)."""

from typing import NamedTuple

import numpy as np

from studio.core.kernels.algebra.turns import inverse, product, put_turn, turn_in
from studio.core.kernels.compiling import allocating_kernel
from studio.core.kernels.records import Array
from studio.core.kernels.support.feet import keep_pitch_on_ground, level_soles, level_toes
from studio.core.kernels.support.heels import find_tiptoe, lift_heels
from studio.core.kernels.support.planting import plant_ankles
from studio.core.kernels.support.sole import ANKLE_HEIGHT, TOE_Z, tip_rise


class FootPlan(NamedTuple):
    """Where one foot is over F frames."""

    ankles: Array
    """(F, 3) metres."""
    feet: Array
    """(F, 3, 3) in the world."""
    toes: Array
    """The same."""


@allocating_kernel
def plan_foot(states, soles, height, rolls, reach, balls, plan):
    """What one foot does on a level floor (METHOD 4): ``plan`` (a ``FootPlan``) as retargeted becomes as it stands.

    ``states`` (F,); ``soles`` (F or 1, 6); ``height`` of the floor in metres; ``rolls`` whether heels rise as
    captured; ``reach`` frames; ``balls`` (F,) metres, the heights of the toe joint as retargeted.
    """
    count = states.shape[0]
    if not (states != 0).any():
        return
    ankles, source, toes = plan.ankles.copy(), plan.feet.copy(), np.empty_like(plan.toes)
    for frame in range(count):
        put_turn(product(inverse(turn_in(source[frame])), turn_in(plan.toes[frame])), toes[frame])
    level_soles(source, states, reach, plan.feet)
    keep_pitch_on_ground(soles, states, reach, plan.feet)
    pitches = np.zeros(count)
    if rolls:
        rises = np.empty(count)
        for frame in range(count):
            sole = soles[frame if soles.shape[0] > 1 else 0]
            rises[frame] = balls[frame] - height - sole[ANKLE_HEIGHT] - sole[TOE_Z]
        find_tiptoe(soles, states, rises, reach, pitches)
        for frame in range(count):
            sole = soles[frame if soles.shape[0] > 1 else 0]
            rises[frame] = ankles[frame, 2] - height - tip_rise(sole, pitches[frame])
        lift_heels(soles, states, rises, reach, plan.feet)
    level_toes(plan.feet, toes, states, pitches, reach, plan.toes)
    plant_ankles(ankles, plan.feet, states, soles, np.full(count, height), pitches, reach, plan.ankles)
