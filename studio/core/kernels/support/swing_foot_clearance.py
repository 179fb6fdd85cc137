"""Clearance of swing feet above a level floor: toes bend up, then the ankle rises (METHOD 5).

Both are smooth functions of the sole's height; toes bend shortly before it is necessary.
"""

import math

import numpy as np

from studio.core.kernels.algebra.smooth_steps import penetration_correction, smoothstep
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.support.sole import (
    SOLE_ANKLE_HEIGHT,
    SOLE_HEEL_LENGTH,
    TOE_LENGTH,
    TOE_STANDS,
    TOE_X,
    TOE_Y,
    TOE_Z,
    sole_down_fraction,
)

SWING_CLEARANCE = 0.2
"""Height above the floor, as a fraction of the ankle's height, below which a swing foot begins to rise; at floor level
it is raised by 3/16 of this.
"""
SWING_FADE_SECONDS = 0.15
"""Seconds from its nearest contact within which a foot becomes free, and its clearance grows from zero."""
TOE_BEND_FADE = 0.6
"""Horizontal extent of a toe, as a fraction of its length, below which the bend fades: the ankle is raised instead for
a toe that points down.
"""
TOE_BEND_LEAD_SECONDS = SWING_FADE_SECONDS / 4.0
"""Seconds before and after a necessary bend by which toes are bent, and over which the bend is averaged."""
MAX_TOE_BEND = math.radians(85.0)
"""Greatest upward bend of the toes in radians, approached softly."""


@allocating_kernel
def raise_swing_foot(soles, states, ground, frame_rate, ankles, feet, toes):
    """Raise a foot in the air and bend its toes up, in place, so that no part of it is below the floor (METHOD 5, (7)).

    ``soles`` (F or 1, 6) and ``states`` (F,) of ``kernels.support.sole``; ``ground`` the floor's height in metres;
    ``ankles`` (F, 3), ``feet``, ``toes`` (F, 3, 3). A foot that lies on its instep, sole up, stays.
    """
    count = states.shape[0]
    weights, bends, bent_early = np.empty((2, count)), np.zeros(count), np.empty(count)
    clearance_weights(states, TOE_STANDS, frame_rate, weights[0])
    clearance_weights(states, 3, frame_rate, weights[1])
    toe_bends(soles, states, ground, weights[0], ankles, feet, toes, bends)
    smooth_toe_bends((states & TOE_STANDS) != 0, round(TOE_BEND_LEAD_SECONDS * frame_rate), bends, bent_early)
    for frame in range(count):
        bend_toe_up(bent_early[frame], toes[frame])
    raise_ankles(soles, states, ground, weights[1], ankles, feet, toes)


@kernel
def toe_bends(soles, states, ground, weights, ankles, feet, toes, out_bends):
    """Write the upward bends (F,) in radians that clear the toes of a swing foot; ``weights`` (F,) scale the
    clearance.
    """
    for frame in range(states.shape[0]):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        upright = sole_down_fraction(foot)
        if upright == 0.0 or states[frame] & TOE_STANDS:
            continue
        margin, thickness = (
            SWING_CLEARANCE * max(sole[SOLE_ANKLE_HEIGHT], 0.0) * weights[frame],
            sole[SOLE_ANKLE_HEIGHT] + sole[TOE_Z],
        )
        joint = (
            ankles[frame, 2] + foot[2, 0] * sole[TOE_X] + foot[2, 1] * sole[TOE_Y] + foot[2, 2] * sole[TOE_Z] - ground
        )
        joint += penetration_correction(joint - foot[2, 2] * thickness, margin)  # a ball in the floor raises the ankle
        out_bends[frame] = toe_bend(joint, sole[TOE_LENGTH], thickness, margin, upright, toes[frame])


@allocating_kernel
def smooth_toe_bends(stands, reach, bends, out_bends):
    """Write a smooth upper envelope of ``bends`` (F,): the maximum within ``reach`` frames, averaged over as many.

    Toes that bend only at the moment when they would touch the floor snap up in a frame. Near contacts (``stands``) the
    result follows ``bends``.
    """
    count = bends.shape[0]
    greatest, free = np.empty(count), np.empty(count)
    for frame in range(count):
        greatest[frame], free[frame] = 0.0, 1.0
        for other in range(max(frame - reach, 0), min(frame + reach + 1, count)):
            greatest[frame] = max(greatest[frame], bends[other])
            free[frame] = 0.0 if stands[other] else free[frame]
    for frame in range(count):
        bend, fraction, weights = 0.0, 0.0, 0.0
        for step in range(-reach, reach + 1):
            other, weight = min(max(frame + step, 0), count - 1), 1.0 + math.cos(math.pi * step / (reach + 1))
            bend += weight * greatest[other]
            fraction += weight * free[other]
            weights += weight
        out_bends[frame] = bends[frame] + fraction / weights * (bend / weights - bends[frame])


@kernel
def raise_ankles(soles, states, ground, weights, ankles, feet, toes):
    """Raise the ankle of a swing foot until heel, ball and tip of its toes are clear of the floor; ``weights`` (F,)
    scale the clearance.
    """
    for frame in range(states.shape[0]):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        upright = sole_down_fraction(foot)
        if upright == 0.0 or states[frame] != 0:
            continue
        margin = SWING_CLEARANCE * max(sole[SOLE_ANKLE_HEIGHT], 0.0) * weights[frame]
        joint = (
            ankles[frame, 2] + foot[2, 0] * sole[TOE_X] + foot[2, 1] * sole[TOE_Y] + foot[2, 2] * sole[TOE_Z] - ground
        )
        toe = toes[frame]
        tip = joint + toe[2, 0] * sole[TOE_LENGTH] - toe[2, 2] * (sole[SOLE_ANKLE_HEIGHT] + sole[TOE_Z])
        ball = joint - max(foot[2, 2], toe[2, 2]) * (sole[SOLE_ANKLE_HEIGHT] + sole[TOE_Z])
        heel = ankles[frame, 2] - ground - foot[2, 0] * sole[SOLE_HEEL_LENGTH] - foot[2, 2] * sole[SOLE_ANKLE_HEIGHT]
        ankles[frame, 2] += upright * penetration_correction(min(tip, ball, heel), margin)


@kernel
def clearance_weights(states, bits, frame_rate, out_weights):
    """Write the weights (F,) of the clearance: 0 in frames whose state has any of ``bits``, fading to 1 in the air."""
    count, reach = states.shape[0], SWING_FADE_SECONDS * frame_rate
    gap = reach
    for frame in range(count):
        gap = 0.0 if states[frame] & bits else gap + 1.0
        out_weights[frame] = gap
    gap = reach
    for frame in range(count - 1, -1, -1):
        gap = 0.0 if states[frame] & bits else gap + 1.0
        out_weights[frame] = smoothstep(min(min(gap, out_weights[frame]) / reach, 1.0))


@kernel
def toe_bend(joint, length, thickness, margin, upright, toe):
    """Rotation in radians of a ``toe`` (3, 3) about its left axis that clears its tip.

    ``joint`` is the height of the toe joint above the floor, ``thickness`` that of the joint above the sole, ``margin``
    the clearance, all in metres; ``upright`` scales the result.
    """
    along, over = toe[2, 0] * length - toe[2, 2] * thickness, toe[2, 2] * length + toe[2, 0] * thickness
    raised = penetration_correction(joint + along, margin)
    if raised == 0.0:
        return 0.0
    span = max(math.hypot(along, over), 1e-9)
    angle = math.atan2(over, along) - math.acos(min(max((along + raised) / span, -1.0), 1.0))
    if angle < -1.0:  # past straight down
        angle += 2.0 * math.pi
    return (
        upright
        * smoothstep(min(max(over / (TOE_BEND_FADE * span), 0.0), 1.0))
        * max(angle, 0.0)
        / (1.0 + (angle / MAX_TOE_BEND) ** 4) ** 0.25
    )


@small_kernel
def bend_toe_up(angle, toe):
    """Rotate a ``toe`` (3, 3), in place, up about its left axis by ``angle`` radians."""
    if angle == 0.0:
        return
    c, s = math.cos(angle), math.sin(angle)
    for axis in range(3):
        x, z = toe[axis, 0], toe[axis, 2]
        toe[axis, 0], toe[axis, 2] = c * x + s * z, c * z - s * x
