"""Rising heels: while the ball stands, the foot rolls over it as captured (METHOD 5)."""

import math

import numpy as np

from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix, rotation_from_vector, write_rotation
from studio.core.kernels.algebra.smooth_steps import penetration_correction, smoothstep
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.support.foot_rotation import correct_rotation
from studio.core.kernels.support.gap_interpolation import fade_into_gaps, interpolate_gaps, release_weights
from studio.core.kernels.support.sole import (
    HEEL_STANDS,
    SOLE_ANKLE_HEIGHT,
    TOE_LENGTH,
    TOE_STANDS,
    TOE_X,
    TOE_Y,
    TOE_Z,
    pivot_offsets,
)

HEEL_RELEASE_FRACTION = 0.6
"""Fraction of the release time after which a heel has its captured height."""
ROLL_RELEASE_FRACTION = 0.5 * HEEL_RELEASE_FRACTION
"""Fraction of the release time after which a heel rolls as far as its leg requires."""
STEEP_FOOT_FORWARD_Z = -0.6, -0.9
"""Vertical components of a foot's forward axis between which raising the heel fades to zero; lowering it does not fade.
"""
ROLL_MARGIN = 0.01
"""Margin before the end of the leg's reach, as a fraction of the reach, at which a foot begins to roll."""
STEEPEST_ROLL_PITCH = math.radians(70.0)
"""Greatest downward pitch in radians of a rolling foot, approached softly: a steeper foot would stand on its tip."""
LEAST_ROLL_GAIN = 0.4
"""Least gain of leg length per radian of roll, as a fraction of the distance from the ankle to the pivot."""
STEEPEST_TOE_PITCH = 1.0
"""Greatest downward pitch in radians of toes on their tips, approached softly."""
TIPTOE_RISE = 0.1
"""Rise of a ball, in toe lengths, at which a foot begins to roll over the tip: soles of standing feet seem to rise by
as much in captures, because skin moves over bones.
"""
SOFT_TIPTOE_RISE = 0.2
"""Additional rise of a ball, in toe lengths, half of which is followed, so that toes begin to pitch without a jolt."""
LEAST_FOOT_EXTENT = 0.6
"""Least horizontal extent of a foot, as a fraction of the distance from ankle to toe joint, by which a height is
converted to a pitch.
"""


@allocating_kernel
def tiptoe_pitches(soles, states, heights, reach, out_pitches):
    """Write downward pitches (F,) in radians of toes that stand alone: the ball is as high over the tip as captured.

    ``heights`` (F,) in metres of the toe joint above its height in a flat foot, as retargeted; ``soles`` (F or 1, 6)
    and ``states`` (F,) of ``kernels.support.sole``; ``reach`` in frames.
    """
    rolling_weights(states, HEEL_RELEASE_FRACTION * reach, out_pitches)
    for frame in range(states.shape[0]):
        length = soles[frame if soles.shape[0] > 1 else 0, TOE_LENGTH]
        if out_pitches[frame] != 0.0:
            over = max(heights[frame] / max(length, 1e-3) - TIPTOE_RISE, 0.0)
            out_pitches[frame] *= STEEPEST_TOE_PITCH * math.tanh(
                over * over / (over + SOFT_TIPTOE_RISE) / STEEPEST_TOE_PITCH
            )


@allocating_kernel
def lift_heels(soles, states, heights, reach, fade, rotations):
    """Pitch foot rotations (F, 3, 3), in place, so that the ankle has its captured height where the toe alone stands.

    ``heights`` (F,) in metres of the ankle above the floor, as retargeted; ``soles`` (F or 1, 6) and ``states`` (F,) of
    ``kernels.support.sole``. The pitch fades in within ``reach`` frames after the heel has left the ground, and fades
    between contacts.
    """
    count = states.shape[0]
    corrections, free, left_over = np.zeros((count, 3)), np.empty(count), np.zeros(count)
    rolling_weights(states, HEEL_RELEASE_FRACTION * reach, free)
    stance_pitch_offsets(soles, states, heights, rotations, left_over)
    for frame in range(count):
        if free[frame] == 0.0:
            continue
        foot, sole = rotations[frame], soles[frame if soles.shape[0] > 1 else 0]
        fraction = smoothstep(
            min(
                max((foot[2, 0] - STEEP_FOOT_FORWARD_Z[1]) / (STEEP_FOOT_FORWARD_Z[0] - STEEP_FOOT_FORWARD_Z[1]), 0.0),
                1.0,
            )
        )
        if foot[2, 2] < 0.0:
            continue
        missing = pitch_for_height(foot, sole, heights[frame] - sole[SOLE_ANKLE_HEIGHT] - sole[TOE_Z])
        level = math.asin(min(max(foot[2, 0], -1.0), 0.0))  # no farther up, or the ball would leave the ground
        pitch = limited_toe_pitch(foot, max(missing - (1.0 - free[frame]) * left_over[frame], level))
        pitch *= fraction if pitch > 0.0 else 1.0
        along = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
        corrections[frame, 0] = -pitch * foot[1, 0] / along
        corrections[frame, 1] = pitch * foot[0, 0] / along
    fade_into_gaps(corrections, states != 0, rotations[:, :, 0], reach, fade)
    for frame in range(count):
        write_rotation(correct_rotation(corrections[frame], rotation_from_matrix(rotations[frame])), rotations[frame])


@allocating_kernel
def stance_pitch_offsets(soles, states, heights, rotations, out_pitches):
    """Write the pitch errors (F,) in radians of the foot at the nearest frame of the same contact in which its heel
    stands.

    ``soles``, ``states`` and ``heights`` are the arguments of ``lift_heels``.
    """
    count = states.shape[0]
    gaps = np.full(count, math.inf)
    for sweep_direction in range(2):
        gap, missing = math.inf, 0.0
        for step in range(count):
            frame = step if sweep_direction == 0 else count - 1 - step
            gap = math.inf if states[frame] == 0 else gap + 1.0
            if states[frame] & HEEL_STANDS:
                sole = soles[frame if soles.shape[0] > 1 else 0]
                gap, missing = (
                    0.0,
                    pitch_for_height(rotations[frame], sole, heights[frame] - sole[SOLE_ANKLE_HEIGHT] - sole[TOE_Z]),
                )
            if gap < gaps[frame]:
                gaps[frame], out_pitches[frame] = gap, missing


@allocating_kernel
def rolling_weights(states, reach, out_weights):
    """Write rolling weights (F,): 0 while the heel stands, rising to 1 within ``reach`` frames.

    Also 0 in the air, and in contacts in which no heel stands: a foot that kneels or lies does not roll.
    """
    release_weights((states & HEEL_STANDS) != 0, reach, out_weights)
    count, begin = states.shape[0], 0
    while begin < count:
        end, stood = begin, False
        while end < count and (states[end] != 0) == (states[begin] != 0):
            stood = stood or states[end] & HEEL_STANDS != 0
            end += 1
        if not stood:
            out_weights[begin:end] = 0.0
        begin = end


@small_kernel
def limited_toe_pitch(foot, pitch):
    """``pitch`` in radians, limited softly so that the ``foot`` (3, 3) does not stand on its tip."""
    margin = max(STEEPEST_ROLL_PITCH + math.asin(min(max(foot[2, 0], -1.0), 1.0)), 1e-3)
    return margin * math.tanh(pitch / margin) if pitch > 0.0 else pitch


@kernel
def pitch_for_height(foot, sole, height):
    """Pitch in radians, to first order, that raises the ankle of a ``foot`` (3, 3) to ``height`` metres above the toe
    joint.
    """
    level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
    ahead = 0.0
    for axis in range(2):
        along = foot[axis, 0] * sole[TOE_X] + foot[axis, 1] * sole[TOE_Y] + foot[axis, 2] * sole[TOE_Z]
        ahead += along * foot[axis, 0] / level
    over = -(foot[2, 0] * sole[TOE_X] + foot[2, 1] * sole[TOE_Y] + foot[2, 2] * sole[TOE_Z])
    length = max(math.hypot(ahead, over), 1e-9)
    return (max(height, -sole[TOE_Z]) - over) / max(ahead, LEAST_FOOT_EXTENT * length)


@allocating_kernel
def find_roll_pitches(soles, states, hips, reaches, ankles, feet, out_pitches):
    """Write the pitches (F, 2) in radians about heel and ball by which a foot rolls to bring its ankle into the leg's
    reach.

    ``hips`` (F, 3); ``reaches`` (F,) metres to which the leg extends freely; ``ankles`` (F, 3), ``feet`` (F, 3, 3). In
    the air the pitches are interpolated.
    """
    count = states.shape[0]
    offsets = np.empty((2, 3))
    out_pitches[:] = 0.0
    for frame in range(count):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        if states[frame] != 0 and foot[2, 2] >= 0.0:
            pivot = 0 if states[frame] == HEEL_STANDS else 1
            pivot_offsets(foot, sole, offsets)
            out_pitches[frame, pivot] = pitch_to_reach(foot, offsets, pivot, ankles[frame], hips[frame], reaches[frame])
    interpolate_gaps(out_pitches, states != 0)


@allocating_kernel
def roll_feet(soles, states, pitches, reach, ankles, feet):
    """Roll standing feet by ``pitches`` (F, 2) in radians about heel and ball, in place.

    ``ankles`` (F, 3), ``feet`` (F, 3, 3); ``reach`` in frames, over which the roll fades in. People raise the heel
    before they bend the other knee, and land on it with raised toes.
    """
    count = states.shape[0]
    rotations, moves, fractions = np.zeros((count, 3)), np.zeros((count, 3)), np.empty((2, count))
    rotation, offsets = np.empty((3, 3)), np.empty((2, 3))
    release_weights((states & TOE_STANDS) != 0, ROLL_RELEASE_FRACTION * reach, fractions[0])
    rolling_weights(states, ROLL_RELEASE_FRACTION * reach, fractions[1])
    for frame in range(count):
        foot, sole = feet[frame], soles[frame if soles.shape[0] > 1 else 0]
        pivot = 0 if states[frame] == HEEL_STANDS else 1
        pitch = pitches[frame, pivot] * fractions[pivot, frame]
        if states[frame] == 0 or pitch == 0.0 or foot[2, 2] < 0.0:
            continue
        pivot_offsets(foot, sole, offsets)
        level = max(math.hypot(foot[0, 0], foot[1, 0]), 1e-9)
        rotations[frame, 0], rotations[frame, 1] = -pitch * foot[1, 0] / level, pitch * foot[0, 0] / level
        write_rotation(rotation_from_vector(rotations[frame, 0], rotations[frame, 1], 0.0), rotation)
        for axis in range(3):
            along = rotation[axis, 0] * offsets[pivot, 0] + rotation[axis, 1] * offsets[pivot, 1]
            moves[frame, axis] = offsets[pivot, axis] - along - rotation[axis, 2] * offsets[pivot, 2]
    interpolate_gaps(rotations, states != 0)
    interpolate_gaps(moves, states != 0)
    for frame in range(count):
        for axis in range(3):
            ankles[frame, axis] += moves[frame, axis]
        write_rotation(correct_rotation(rotations[frame], rotation_from_matrix(feet[frame])), feet[frame])


@kernel
def pitch_to_reach(foot, offsets, pivot, ankle, hip, reach):
    """Pitch in radians of a foot that keeps the distance from ankle to hip within ``reach`` metres, softly.

    ``offsets`` (2, 3) from the ``ankle`` (3,) to both pivots: with ``pivot`` 0 the foot rolls back over the heel, with
    1 over the ball.
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
    pitch = penetration_correction(reach - span, ROLL_MARGIN * reach) / max(nearer, LEAST_ROLL_GAIN * length)
    return limited_toe_pitch(foot, pitch) if pivot == 1 else -pitch
