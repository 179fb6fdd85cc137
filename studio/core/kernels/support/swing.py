"""Feet in the air kept above a level floor: toes bent up, then the ankle raised (METHOD 4).

From how far its sole is above the floor, so that a foot which moves smoothly still does; toes bend before they must.
"""

import math

import numpy as np

from studio.core.kernels.algebra.eases import lack, smoothstep
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.support.sole import (
    ANKLE_HEIGHT,
    HEEL_LENGTH,
    TOE,
    TOE_LENGTH,
    TOE_X,
    TOE_Y,
    TOE_Z,
    lying_aside,
    upright_part,
)

ROOM = 0.2
"""Part of the ankle's height within which of the floor a foot in the air begins to be raised; 3/16 of it is kept."""
FREED_AFTER = 0.15
"""Seconds from its nearest contact in which a foot becomes free, and that room grows from nothing."""
BENDING = 0.6
"""Parts of a toe's length that it goes along the ground when it begins to bend less: one that points down is raised."""
EARLY = FREED_AFTER / 4.0
"""Seconds before and after they must for which toes are bent, and over which they come to it."""
MOST_BENT = math.radians(85.0)
"""How far toes bend up for that at most, and never quite."""


@allocating_kernel
def keep_above(soles, states, ground, frame_rate, ankles, feet, toes):
    """Raise a foot in the air and bend its toes up, in place, so that nothing of it is below the floor (METHOD 4, (7)).

    ``soles`` (F or 1, 6) as ``morphology.sole_rows`` has them, ``states`` (F,), ``ground`` a height; ``ankles`` (F, 3),
    ``feet``, ``toes`` (F, 3, 3). What lies on its instep, sole up, is left as it is.
    """
    count = states.shape[0]
    rooms, bends, bent_early = np.empty((2, count)), np.zeros(count), np.empty(count)
    find_rooms(states, TOE, frame_rate, rooms[0])
    find_rooms(states, 3, frame_rate, rooms[1])
    find_bends(soles, states, ground, rooms[0], ankles, feet, toes, bends)
    bend_early((states & TOE) != 0, round(EARLY * frame_rate), bends, bent_early)
    for frame in range(count):
        turn_up(bent_early[frame], toes[frame])
    raise_foot(soles, states, ground, rooms[1], ankles, feet, toes)


@kernel
def find_bends(soles, states, ground, rooms, ankles, feet, toes, out_bends):
    """Radians (F,) by which the toes of a foot in the air are to bend up; ``rooms`` (F,) parts of their room."""
    for frame in range(states.shape[0]):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        upright = upright_part(foot)
        if upright == 0.0 or states[frame] & TOE:
            continue
        room, thickness = ROOM * max(sole[ANKLE_HEIGHT], 0.0) * rooms[frame], sole[ANKLE_HEIGHT] + sole[TOE_Z]
        joint = (
            ankles[frame, 2] + foot[2, 0] * sole[TOE_X] + foot[2, 1] * sole[TOE_Y] + foot[2, 2] * sole[TOE_Z] - ground
        )
        joint += lack(joint - foot[2, 2] * thickness, room)  # a ball in the floor raises the ankle
        out_bends[frame] = bend_of(joint, sole[TOE_LENGTH], thickness, room, upright, toes[frame])


@allocating_kernel
def bend_early(stands, reach, bends, out_bends):
    """At least ``bends`` (F,) and smooth: the greatest within ``reach`` frames, averaged over as many, in between.

    Toes that bend only once they would be in the floor snap up in a frame. They keep to ``bends`` where they stand
    (F,), more and more the nearer to that.
    """
    count = bends.shape[0]
    greatest, free = np.empty(count), np.empty(count)
    for frame in range(count):
        greatest[frame], free[frame] = 0.0, 1.0
        for other in range(max(frame - reach, 0), min(frame + reach + 1, count)):
            greatest[frame] = max(greatest[frame], bends[other])
            free[frame] = 0.0 if stands[other] else free[frame]
    for frame in range(count):
        bend, share, weights = 0.0, 0.0, 0.0
        for step in range(-reach, reach + 1):
            other, weight = min(max(frame + step, 0), count - 1), 1.0 + math.cos(math.pi * step / (reach + 1))
            bend += weight * greatest[other]
            share += weight * free[other]
            weights += weight
        out_bends[frame] = bends[frame] + share / weights * (bend / weights - bends[frame])


@kernel
def raise_foot(soles, states, ground, rooms, ankles, feet, toes):
    """Raise the ankle of a foot in the air by what heel, ball and tip of its toes lack of their ``rooms`` (F,)."""
    for frame in range(states.shape[0]):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        upright = upright_part(foot)
        if upright == 0.0 or states[frame] != 0:
            continue
        room = ROOM * max(sole[ANKLE_HEIGHT], 0.0) * rooms[frame]
        joint = (
            ankles[frame, 2] + foot[2, 0] * sole[TOE_X] + foot[2, 1] * sole[TOE_Y] + foot[2, 2] * sole[TOE_Z] - ground
        )
        toe = toes[frame]
        tip = joint + toe[2, 0] * sole[TOE_LENGTH] - toe[2, 2] * (sole[ANKLE_HEIGHT] + sole[TOE_Z])
        ball = joint - max(foot[2, 2], toe[2, 2]) * (sole[ANKLE_HEIGHT] + sole[TOE_Z])
        heel = ankles[frame, 2] - ground - foot[2, 0] * sole[HEEL_LENGTH] - foot[2, 2] * sole[ANKLE_HEIGHT]
        ankles[frame, 2] += upright * lack(min(tip, ball, heel), room)


@kernel
def find_rooms(states, bits, frame_rate, out_rooms):
    """Parts (F,) of its room that a foot is given: none where ``bits`` of ``states`` stand, eased in and out."""
    count, reach = states.shape[0], FREED_AFTER * frame_rate
    gap = reach
    for frame in range(count):
        gap = 0.0 if states[frame] & bits else gap + 1.0
        out_rooms[frame] = gap
    gap = reach
    for frame in range(count - 1, -1, -1):
        gap = 0.0 if states[frame] & bits else gap + 1.0
        out_rooms[frame] = smoothstep(min(min(gap, out_rooms[frame]) / reach, 1.0))


@kernel
def bend_of(joint, length, thickness, room, upright, toe):
    """Radians by which a ``toe`` (3, 3) turns about its left axis until its tip is clear; ``joint`` above the floor.

    One that lies on its side would not come up so.
    """
    along, over = toe[2, 0] * length - toe[2, 2] * thickness, toe[2, 2] * length + toe[2, 0] * thickness
    raised = lack(joint + along, room)
    if raised == 0.0:
        return 0.0
    span = max(math.hypot(along, over), 1e-9)
    angle = math.atan2(over, along) - math.acos(min(max((along + raised) / span, -1.0), 1.0))
    if angle < -1.0:  # past straight down
        angle += 2.0 * math.pi
    return (
        upright
        * (1.0 - lying_aside(toe))
        * smoothstep(min(max(over / (BENDING * span), 0.0), 1.0))
        * max(angle, 0.0)
        / (1.0 + (angle / MOST_BENT) ** 4) ** 0.25
    )


@small_kernel
def turn_up(angle, toe):
    """Turn a ``toe`` (3, 3), in place, up about its left axis."""
    if angle == 0.0:
        return
    c, s = math.cos(angle), math.sin(angle)
    for axis in range(3):
        x, z = toe[axis, 0], toe[axis, 2]
        toe[axis, 0], toe[axis, 2] = c * x + s * z, c * z - s * x
