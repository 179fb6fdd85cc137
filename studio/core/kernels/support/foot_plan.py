"""Grounded motion of one foot on a level floor (METHOD 5)."""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels.algebra.rotation_tuples import compose, inverse_rotation, rotation_from_matrix, write_rotation
from studio.core.kernels.compiling import allocating_kernel
from studio.core.kernels.records import Array
from studio.core.kernels.support.foot_anchoring import anchor_ankles
from studio.core.kernels.support.foot_rotation import level_soles, level_toes, limit_foot_pitch
from studio.core.kernels.support.heel_roll import lift_heels, tiptoe_pitches
from studio.core.kernels.support.sole import SOLE_ANKLE_HEIGHT, TOE_Z, tip_rise


class FootPlan(NamedTuple):
    """Pose of one foot over F frames."""

    ankles: Array
    """(F, 3) metres."""
    feet: Array
    """(F, 3, 3) in the world."""
    toes: Array
    """(F, 3, 3) in the world."""


@allocating_kernel
def plan_foot(states, soles, height, is_level, reach, balls, plan):
    """Ground one foot on a level floor, in place: ``plan``, the foot as retargeted, becomes the grounded foot (METHOD
    5).

    ``states`` (F,); ``soles`` (F or 1, 6); ``height`` of the floor in metres; ``reach`` in frames; ``balls`` (F,)
    heights in metres of the toe joint as retargeted. If the ground ``is_level``, heels rise, and a foot in the air
    moves, as captured; otherwise corrections are interpolated between footprints, as the displacements to uneven ground
    will be.
    """
    count = states.shape[0]
    if not (states != 0).any():
        return
    ankles, source, toes = plan.ankles.copy(), plan.feet.copy(), np.empty_like(plan.toes)
    for frame in range(count):
        write_rotation(
            compose(inverse_rotation(rotation_from_matrix(source[frame])), rotation_from_matrix(plan.toes[frame])),
            toes[frame],
        )
    fade = reach if is_level else math.inf
    level_soles(source, states, reach, fade, plan.feet)
    limit_foot_pitch(soles, states, reach, fade, plan.feet)
    pitches = np.zeros(count)
    if is_level:
        rises = np.empty(count)
        for frame in range(count):
            sole = soles[frame if soles.shape[0] > 1 else 0]
            rises[frame] = balls[frame] - height - sole[SOLE_ANKLE_HEIGHT] - sole[TOE_Z]
        tiptoe_pitches(soles, states, rises, reach, pitches)
        for frame in range(count):
            sole = soles[frame if soles.shape[0] > 1 else 0]
            rises[frame] = ankles[frame, 2] - height - tip_rise(sole, pitches[frame])
        lift_heels(soles, states, rises, reach, fade, plan.feet)
    level_toes(plan.feet, toes, states, pitches, reach, fade, plan.toes)
    anchor_ankles(ankles, plan.feet, states, soles, np.full(count, height), pitches, reach, fade, plan.ankles)
