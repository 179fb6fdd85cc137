"""Heels that rise as the motion's own do while the ball stands: the contact rolls over the ball (METHOD 4)."""

import math

import numpy as np

from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.feet import HEEL, corrected, ease_gaps, free_feet, smoothstep, to_toe
from studio.core.kernels.swing import lack
from studio.core.kernels.turns import product, put_turn, turn_by, turn_in

FOLLOWED = 0.6
"""Parts of the time in which a foot is let go after which a heel has the height that the motion gives it."""
UPRIGHT = -0.6, -0.9
"""Vertical part of a foot's forward axis from which, and up to which, its heel's height counts less and less."""
ROLL_ROOM = 0.01
"""Parts of the leg's reach before its end from which on a foot begins to roll."""
STEEPEST_FOOT = math.radians(70.0)
"""How far down a foot that rolls on may point, and never quite: beyond it stands on its tip."""
STEEPEST = 0.6
"""Parts of the way from ankle to toe joint that a foot is taken to go along the ground at least."""


@allocating_kernel
def lift_heels(soles, states, heights, reach, rotations):
    """Foot rotations (F, 3, 3), in place: where the toe alone stands the ankle is as high as the motion has it.

    ``heights`` (F,) of the ankle above the floor, as retargeted; ``soles`` (F or 1, 5 or more), ``states`` (F,) as in
    ``kernels.feet``. Eased in after the heel has left the ground, and from one contact to the next.
    """
    count = states.shape[0]
    corrections, free = np.zeros((count, 3)), np.empty(count)
    find_rolling(states, FOLLOWED * reach, free)
    for frame in range(count):
        if free[frame] == 0.0:
            continue
        foot, sole = rotations[frame], soles[frame if soles.shape[0] > 1 else 0]
        share = free[frame] * smoothstep(min(max((foot[2, 0] - UPRIGHT[1]) / (UPRIGHT[0] - UPRIGHT[1]), 0.0), 1.0))
        if share == 0.0 or foot[2, 2] < 0.0:
            continue
        pitch = share * within_room(foot, pitch_missing(foot, sole, heights[frame] - sole[3] - sole[2]))
        level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
        corrections[frame, 0] = -pitch * foot[1, 0] / level
        corrections[frame, 1] = pitch * foot[0, 0] / level
    ease_gaps(corrections, states != 0, reach)
    for frame in range(count):
        put_turn(corrected(corrections[frame], turn_in(rotations[frame])), rotations[frame])


@allocating_kernel
def find_rolling(states, reach, out_shares):
    """How far a foot has left its heel, (F,): 0 while it stands, eased to 1 within ``reach`` frames of that.

    0 as well in the air, and in contacts in which no heel ever stands: who kneels or lies rolls over nothing.
    """
    free_feet((states & HEEL) != 0, reach, out_shares)
    count, begin = states.shape[0], 0
    while begin < count:
        end, stood = begin, False
        while end < count and (states[end] != 0) == (states[begin] != 0):
            stood = stood or states[end] & HEEL != 0
            end += 1
        if not stood:
            out_shares[begin:end] = 0.0
        begin = end


@small_kernel
def within_room(foot, pitch):
    """A ``pitch`` in radians, less the nearer it brings a ``foot`` (3, 3) to where it would stand on its tip."""
    room = max(STEEPEST_FOOT + math.asin(min(max(foot[2, 0], -1.0), 1.0)), 1e-3)
    return room * math.tanh(pitch / room) if pitch > 0.0 else pitch


@kernel
def pitch_missing(foot, sole, height):
    """Radians, to first order, by which a ``foot`` (3, 3) is to pitch to have its ankle ``height`` over the toe."""
    level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
    ahead = 0.0
    for axis in range(2):
        along = foot[axis, 0] * sole[0] + foot[axis, 1] * sole[1] + foot[axis, 2] * sole[2]
        ahead += along * foot[axis, 0] / level
    over = -(foot[2, 0] * sole[0] + foot[2, 1] * sole[1] + foot[2, 2] * sole[2])
    length = max(math.hypot(ahead, over), 1e-9)
    return (max(height, -sole[2]) - over) / max(ahead, STEEPEST * length)


@allocating_kernel
def roll_feet(soles, states, hips, reaches, reach, ankles, feet):
    """Feet that stand on their toes roll on over the ball, in place, where their legs could not reach the ankle.

    ``hips`` (F, 3), ``reaches`` (F,) metres to which the leg stretches freely; ``ankles`` (F, 3), ``feet`` (F, 3, 3).
    People raise the heel before they bend the other knee.
    """
    count = states.shape[0]
    corrections, free = np.zeros((count, 3)), np.empty(count)
    turn, offset = np.empty((3, 3)), np.empty(3)
    find_rolling(states, FOLLOWED * reach, free)
    for frame in range(count):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        if free[frame] == 0.0 or foot[2, 2] < 0.0:
            continue
        to_toe(foot, sole, offset)
        level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
        left_x, left_y = -foot[1, 0] / level, foot[0, 0] / level
        x, y, z = (
            hips[frame, 0] - ankles[frame, 0],
            hips[frame, 1] - ankles[frame, 1],
            hips[frame, 2] - ankles[frame, 2],
        )
        span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
        # the ankle goes round the toe joint: left x (ankle - toe) a radian
        way_x, way_y, way_z = -left_y * offset[2], left_x * offset[2], left_y * offset[0] - left_x * offset[1]
        nearer = (way_x * x + way_y * y + way_z * z) / span
        room = ROLL_ROOM * reaches[frame]
        if nearer > 0.0:
            pitch = lack(reaches[frame] - span, room) / max(nearer, 0.5 * abs(sole[0]))
            pitch = free[frame] * within_room(foot, pitch)
            corrections[frame, 0], corrections[frame, 1] = pitch * left_x, pitch * left_y
    ease_gaps(corrections, states != 0, reach)
    for frame in range(count):
        correction = corrections[frame]
        if correction[0] == 0.0 and correction[1] == 0.0:
            continue
        to_toe(feet[frame], soles[frame if soles.shape[0] > 1 else 0], offset)
        turned = turn_by(correction[0], correction[1], correction[2])
        put_turn(turned, turn)
        for axis in range(3):
            before = offset[axis]
            ankles[frame, axis] += (
                before - turn[axis, 0] * offset[0] - turn[axis, 1] * offset[1] - turn[axis, 2] * offset[2]
            )
        put_turn(product(turned, turn_in(feet[frame])), feet[frame])
