"""Heels that rise as the motion's own do while the ball stands: the contact rolls over the ball (METHOD 4)."""

import math

import numpy as np

from studio.core.kernels.algebra.eases import lack, smoothstep
from studio.core.kernels.algebra.turns import put_turn, turn_by, turn_in
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.support.feet import corrected
from studio.core.kernels.support.gaps import ease_gaps, fill_gaps, free_feet
from studio.core.kernels.support.sole import ANKLE_HEIGHT, HEEL, TOE, TOE_X, TOE_Y, TOE_Z, to_pivots

FOLLOWED = 0.6
ROLLED = 0.5 * FOLLOWED
"""Parts of the time in which a foot is let go after which a heel has the height that the motion gives it, and after
which it rolls as far as its leg asks.
"""
UPRIGHT = -0.6, -0.9
"""Vertical part of a foot's forward axis from which, and up to which, its heel's height counts less and less."""
ROLL_ROOM = 0.01
"""Parts of the leg's reach before its end from which on a foot begins to roll."""
STEEPEST_FOOT = math.radians(70.0)
"""How far down a foot that rolls on may point, and never quite: beyond it stands on its tip."""
STEEPEST_HEEL = math.radians(40.0)
"""How far up one that rolls back over its heel may point, and never quite."""
SHALLOWEST = 0.4
"""Parts of the way from the ankle to what it rolls over that a leg is taken to gain a radian at least."""
TIPPED = 1.0
"""Radians by which toes on their tips point down at most, and never quite."""
HARDLY = 0.2
"""Parts of the toe's length by which a ball has risen when a foot begins to roll over the tip."""
STEEPEST = 0.6
"""Parts of the way from ankle to toe joint that a foot is taken to go along the ground at least."""


@allocating_kernel
def find_tiptoe(soles, states, heights, reach, out_pitches):
    """Radians (F,) by which toes that alone stand point down: the ball is as high over their tip as the motion has it.

    ``heights`` (F,) of the toe joint above where it is in a flat foot, as retargeted; arguments as in ``lift_heels``.
    """
    find_rolling(states, FOLLOWED * reach, out_pitches)
    for frame in range(states.shape[0]):
        length = soles[frame if soles.shape[0] > 1 else 0, 5]
        if out_pitches[frame] != 0.0:
            over = max(heights[frame] / max(length, 1e-3) - HARDLY, 0.0)
            out_pitches[frame] *= TIPPED * math.tanh(over * over / (over + HARDLY) / TIPPED)


@allocating_kernel
def lift_heels(soles, states, heights, reach, rotations):
    """Foot rotations (F, 3, 3), in place: where the toe alone stands the ankle is as high as the motion has it.

    ``heights`` (F,) of the ankle above the floor, as retargeted; ``soles`` (F or 1, 5 or more), ``states`` (F,) as in
    ``kernels.support.sole``. Eased in after the heel has left the ground, and from one contact to the next.
    """
    count = states.shape[0]
    corrections, free, left_over = np.zeros((count, 3)), np.empty(count), np.zeros(count)
    find_rolling(states, FOLLOWED * reach, free)
    find_left_over(soles, states, heights, rotations, left_over)
    for frame in range(count):
        if free[frame] == 0.0:
            continue
        foot, sole = rotations[frame], soles[frame if soles.shape[0] > 1 else 0]
        share = smoothstep(min(max((foot[2, 0] - UPRIGHT[1]) / (UPRIGHT[0] - UPRIGHT[1]), 0.0), 1.0))
        if share == 0.0 or foot[2, 2] < 0.0:
            continue
        missing = pitch_missing(foot, sole, heights[frame] - sole[ANKLE_HEIGHT] - sole[TOE_Z])
        level = math.asin(min(max(foot[2, 0], -1.0), 0.0))  # no farther up, or the ball would leave the ground
        pitch = share * within_room(foot, max(missing - (1.0 - free[frame]) * left_over[frame], level))
        along = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
        corrections[frame, 0] = -pitch * foot[1, 0] / along
        corrections[frame, 1] = pitch * foot[0, 0] / along
    ease_gaps(corrections, states != 0, reach)
    for frame in range(count):
        put_turn(corrected(corrections[frame], turn_in(rotations[frame])), rotations[frame])


@allocating_kernel
def find_left_over(soles, states, heights, rotations, out_missing):
    """Radians (F,) by which a foot is not pitched as its heel's height asks where that last stood, or stands next.

    Of the nearer of the two within the same contact; arguments as in ``lift_heels``.
    """
    count = states.shape[0]
    gaps = np.full(count, math.inf)
    for way in range(2):
        gap, missing = math.inf, 0.0
        for step in range(count):
            frame = step if way == 0 else count - 1 - step
            gap = math.inf if states[frame] == 0 else gap + 1.0
            if states[frame] & HEEL:
                sole = soles[frame if soles.shape[0] > 1 else 0]
                gap, missing = (
                    0.0,
                    pitch_missing(rotations[frame], sole, heights[frame] - sole[ANKLE_HEIGHT] - sole[TOE_Z]),
                )
            if gap < gaps[frame]:
                gaps[frame], out_missing[frame] = gap, missing


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
        along = foot[axis, 0] * sole[TOE_X] + foot[axis, 1] * sole[TOE_Y] + foot[axis, 2] * sole[TOE_Z]
        ahead += along * foot[axis, 0] / level
    over = -(foot[2, 0] * sole[TOE_X] + foot[2, 1] * sole[TOE_Y] + foot[2, 2] * sole[TOE_Z])
    length = max(math.hypot(ahead, over), 1e-9)
    return (max(height, -sole[TOE_Z]) - over) / max(ahead, STEEPEST * length)


@allocating_kernel
def roll_feet(soles, states, hips, reaches, reach, ankles, feet):
    """Feet that stand on their balls or on their heels roll on over these, in place, where legs could not reach.

    ``hips`` (F, 3), ``reaches`` (F,) metres to which the leg stretches freely; ``ankles`` (F, 3), ``feet`` (F, 3, 3).
    People raise the heel before they bend the other knee, and land on it with the toes higher.
    """
    count = states.shape[0]
    turns, moves, shares = np.zeros((count, 3)), np.zeros((count, 3)), np.empty((2, count))
    turn, offsets = np.empty((3, 3)), np.empty((2, 3))
    free_feet((states & TOE) != 0, ROLLED * reach, shares[0])
    find_rolling(states, ROLLED * reach, shares[1])
    for frame in range(count):
        foot, sole, pivot = feet[frame], soles[frame if soles.shape[0] > 1 else 0], 0 if states[frame] == HEEL else 1
        if states[frame] == 0 or shares[pivot, frame] == 0.0 or foot[2, 2] < 0.0:
            continue
        to_pivots(foot, sole, offsets)
        pitch = pitch_to_reach(foot, offsets, pivot, ankles[frame], hips[frame], reaches[frame])
        if pitch == 0.0:
            continue
        level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
        pitch *= shares[pivot, frame] / level
        turns[frame, 0], turns[frame, 1] = -pitch * foot[1, 0], pitch * foot[0, 0]
        put_turn(turn_by(turns[frame, 0], turns[frame, 1], 0.0), turn)
        for axis in range(3):
            along = turn[axis, 0] * offsets[pivot, 0] + turn[axis, 1] * offsets[pivot, 1]
            moves[frame, axis] = offsets[pivot, axis] - along - turn[axis, 2] * offsets[pivot, 2]
    fill_gaps(turns, states != 0)
    fill_gaps(moves, states != 0)
    for frame in range(count):
        for axis in range(3):
            ankles[frame, axis] += moves[frame, axis]
        put_turn(corrected(turns[frame], turn_in(feet[frame])), feet[frame])


@kernel
def pitch_to_reach(foot, offsets, pivot, ankle, hip, reach):
    """Radians by which a ``foot`` (3, 3) is to roll for its leg to stretch no farther than ``reach`` metres, softly.

    ``offsets`` (2, 3) from the ``ankle`` (3,) to the heel, ``pivot`` 0, over which it rolls back, and to the ball, 1.
    """
    level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
    left_x, left_y = -foot[1, 0] / level, foot[0, 0] / level
    x, y, z = hip[0] - ankle[0], hip[1] - ankle[1], hip[2] - ankle[2]
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    over_x, over_y, over_z = offsets[pivot, 0], offsets[pivot, 1], offsets[pivot, 2]
    # the ankle goes round what it rolls over: left x (ankle - pivot) a radian
    nearer = -left_y * over_z * x + left_x * over_z * y + (left_y * over_x - left_x * over_y) * z
    nearer *= (2.0 * pivot - 1.0) / span
    if nearer <= 0.0:
        return 0.0
    length = math.sqrt(over_x * over_x + over_y * over_y + over_z * over_z)
    pitch = lack(reach - span, ROLL_ROOM * reach) / max(nearer, SHALLOWEST * length)
    return within_room(foot, pitch) if pivot == 1 else -within_heel_room(foot, pitch)


@small_kernel
def within_heel_room(foot, pitch):
    """A ``pitch`` in radians back over the heel, less the nearer the toes of a ``foot`` (3, 3) point to the sky."""
    room = max(STEEPEST_HEEL - math.asin(min(max(foot[2, 0], -1.0), 1.0)), 1e-3)
    return room * math.tanh(pitch / room)
