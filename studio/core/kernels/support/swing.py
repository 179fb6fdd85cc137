"""Feet in the air kept above a level floor: toes bent up, then the ankle raised (METHOD 4).

Every frame by itself, from how far its sole is above the floor, so that a foot which moves smoothly still does.
"""

import math

import numpy as np

from studio.core.kernels.algebra.eases import lack, smoothstep
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.support.sole import TOE, lying_aside, upright_part

ROOM = 0.2
"""Part of the ankle's height within which of the floor a foot in the air begins to be raised; 3/16 of it is kept."""
FREED_AFTER = 0.15
"""Seconds from its nearest contact in which a foot becomes free, and that room grows from nothing."""
BENDING = 0.6
"""Parts of a toe's length that it goes along the ground when it begins to bend less: one that points down is raised."""
MOST_BENT = math.radians(85.0)
"""How far toes bend up for that at most, and never quite."""


@allocating_kernel
def keep_above(soles, states, ground, frame_rate, ankles, feet, toes):
    """Raise a foot in the air and bend its toes up, in place, so that nothing of it is below the floor (METHOD 4, (7)).

    ``soles`` (F or 1, 6) as ``morphology.sole_rows`` has them, ``states`` (F,), ``ground`` a height; ``ankles`` (F, 3),
    ``feet``, ``toes`` (F, 3, 3). What lies on its instep, sole up, is left as it is.
    """
    rooms = np.empty((2, states.shape[0]))
    find_rooms(states, TOE, frame_rate, rooms[0])
    find_rooms(states, 3, frame_rate, rooms[1])
    raise_foot(soles, states, ground, rooms, ankles, feet, toes)


@kernel
def raise_foot(soles, states, ground, rooms, ankles, feet, toes):
    """``keep_above`` with the parts ``rooms`` (2, F) of their room that toes and foot are given."""
    for frame in range(states.shape[0]):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        upright = upright_part(foot)
        if upright == 0.0 or states[frame] & TOE:
            continue
        room = ROOM * max(sole[3], 0.0)
        joint = ankles[frame, 2] + foot[2, 0] * sole[0] + foot[2, 1] * sole[1] + foot[2, 2] * sole[2] - ground
        toe = toes[frame]
        bend_up(joint, sole[5], sole[3] + sole[2], room * rooms[0, frame], upright, toe)
        if states[frame] != 0:
            continue
        tip = joint + toe[2, 0] * sole[5] - toe[2, 2] * (sole[3] + sole[2])
        ball = joint - max(foot[2, 2], toe[2, 2]) * (sole[3] + sole[2])
        heel = ankles[frame, 2] - ground - foot[2, 0] * sole[4] - foot[2, 2] * sole[3]
        ankles[frame, 2] += upright * lack(min(tip, ball, heel), room * rooms[1, frame])


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
def bend_up(joint, length, thickness, room, upright, toe):
    """Turn a ``toe`` (3, 3), in place, about its left axis until its tip is clear; ``joint`` above the floor.

    One that lies on its side would not come up so.
    """
    along, over = toe[2, 0] * length - toe[2, 2] * thickness, toe[2, 2] * length + toe[2, 0] * thickness
    raised = lack(joint + along, room)
    if raised == 0.0:
        return
    span = max(math.hypot(along, over), 1e-9)
    angle = math.atan2(over, along) - math.acos(min(max((along + raised) / span, -1.0), 1.0))
    if angle < -1.0:  # past straight down
        angle += 2.0 * math.pi
    angle = (
        upright
        * (1.0 - lying_aside(toe))
        * smoothstep(min(max(over / (BENDING * span), 0.0), 1.0))
        * max(angle, 0.0)
        / (1.0 + (angle / MOST_BENT) ** 4) ** 0.25
    )
    c, s = math.cos(angle), math.sin(angle)
    for axis in range(3):
        x, z = toe[axis, 0], toe[axis, 2]
        toe[axis, 0], toe[axis, 2] = c * x + s * z, c * z - s * x
