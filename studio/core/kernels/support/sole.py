"""One foot at one frame: positions of heel, ball and tip of its sole, and its heading.

``rotation`` and ``foot`` (3, 3) are world rotations with x forward, y left and z up. The state of a foot is a bit mask
of ``HEEL_STANDS`` and ``TOE_STANDS``. A ``sole`` (6,) has the measures of a foot in metres, in the columns ``TOE_X`` to
``TOE_LENGTH``.
"""

import math

from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.compiling import kernel, small_kernel

TOE_X, TOE_Y, TOE_Z, SOLE_ANKLE_HEIGHT, SOLE_HEEL_LENGTH, TOE_LENGTH = range(6)
"""Columns of a ``sole``: vector from ankle to toe joint in the foot's axes, height of the ankle above the sole,
horizontal distance of the heel behind the ankle, length of the toe.
"""
HEEL_PAD_FRACTION = 0.6
"""Distance from the heel's edge to the middle of its pad, as a fraction of the heel's length. A foot rotates about its
pad: in 36 captured turns of 13 to 153 degrees the ankle is 2.3 cm ahead of the point that moves least (median).
"""
HEEL_STANDS = 1
TOE_STANDS = 2
SOLE_STANDS = 3
"""Bits of a foot's state: the heel stands, the toe stands; both for a foot that stands on its sole."""
LYING_LEFT_AXIS_Z = 0.35
"""Vertical component of a foot's left axis from which the foot begins to lie on its side; from twice this on it does
completely.
"""
STANDING_UP_AXIS_Z = 0.5
"""Vertical component of a foot's upward axis from which the foot stands on its sole."""


@kernel
def ball_above_heel(rotation, sole):
    """Height in metres of the ball's sole above the heel's; 0 for a level foot."""
    ball = rotation[2, 0] * sole[TOE_X] + rotation[2, 1] * sole[TOE_Y] + rotation[2, 2] * sole[TOE_Z] - sole[TOE_Z]
    return (
        ball
        - sole[SOLE_ANKLE_HEIGHT]
        + rotation[2, 0] * sole[SOLE_HEEL_LENGTH]
        + rotation[2, 2] * sole[SOLE_ANKLE_HEIGHT]
    )


@kernel
def set_heading(matrix, along, across):
    """Write the level rotation (3, 3) whose x axis has the horizontal direction (``along``, ``across``) into
    ``matrix``.
    """
    length = math.sqrt(along * along + across * across)
    c, s = (along / length, across / length) if length > 1e-9 else (1.0, 0.0)
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = c, -s, 0.0
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = s, c, 0.0
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = 0.0, 0.0, 1.0


@kernel
def lying_aside(rotation):
    """Fraction to which a foot or toe (3, 3) lies on its side: 0 with its sole down, at any pitch, 1 on its side."""
    rolled = smoothstep(min(max(abs(rotation[2, 1]) / LYING_LEFT_AXIS_Z - 1.0, 0.0), 1.0))
    return rolled * smoothstep(min(max((STANDING_UP_AXIS_Z - rotation[2, 2]) / LYING_LEFT_AXIS_Z, 0.0), 1.0))


@kernel
def sole_down_fraction(rotation):
    """Fraction to which the sole of a foot (3, 3) points down: 1 flat, 0 on its instep."""
    return smoothstep(min(max(1.0 + 2.0 * rotation[2, 2], 0.0), 1.0))


@small_kernel
def toe_heading(foot):
    """Horizontal heading (x, y), of any length, of a standing toe from the rotation of its ``foot`` (3, 3).

    It does not reverse where a steep foot, on tucked toes, passes the vertical.
    """
    ahead = 1.0 + foot[2, 2]
    return ahead * foot[0, 0] - foot[2, 0] * foot[0, 2], ahead * foot[1, 0] - foot[2, 0] * foot[1, 2]


@kernel
def point_down(matrix, pitch):
    """Rotate a level rotation (3, 3), in place, about its left axis until its x axis points down by ``pitch``
    radians.
    """
    if pitch != 0.0:
        c, s = math.cos(pitch), math.sin(pitch)
        for axis in range(3):
            x, z = matrix[axis, 0], matrix[axis, 2]
            matrix[axis, 0], matrix[axis, 2] = c * x - s * z, s * x + c * z


@kernel
def toe_offset(rotation, sole, out_offset):
    """Write the vector (3,) from ankle to toe joint in the world."""
    for axis in range(3):
        out_offset[axis] = (
            rotation[axis, 0] * sole[TOE_X] + rotation[axis, 1] * sole[TOE_Y] + rotation[axis, 2] * sole[TOE_Z]
        )


@kernel
def pivot_offsets(rotation, sole, out_offsets):
    """Write the world vectors (2, 3) from the ankle to the lower edge of the heel and to the toe joint."""
    for axis in range(3):
        out_offsets[0, axis] = -rotation[axis, 0] * sole[SOLE_HEEL_LENGTH] - rotation[axis, 2] * sole[SOLE_ANKLE_HEIGHT]
    toe_offset(rotation, sole, out_offsets[1])


@kernel
def stance_offsets(rotation, sole, out_offsets):
    """Write the world vectors (2, 3) from the ankle to the heel's pad, at the height of its lower edge, and to the toe
    joint.
    """
    pivot_offsets(rotation, sole, out_offsets)
    ahead = HEEL_PAD_FRACTION * sole[SOLE_HEEL_LENGTH] / max(math.hypot(rotation[0, 0], rotation[1, 0]), 1e-9)
    for axis in range(2):
        out_offsets[0, axis] += ahead * rotation[axis, 0]


@small_kernel
def tip_rise(sole, pitch):
    """Height in metres by which the ball is above its height in a flat foot when the toe points down by ``pitch``
    radians.
    """
    return sole[TOE_LENGTH] * math.sin(pitch) - (sole[SOLE_ANKLE_HEIGHT] + sole[TOE_Z]) * (1.0 - math.cos(pitch))


@kernel
def tip_offset(rotation, sole, pitch, offsets):
    """Write the world vector from the ankle to the tip of the toe into ``offsets[2]``; returns ``tip_rise``.

    ``offsets`` (3, 3) begin with the vectors of ``stance_offsets``.
    """
    length, thick = sole[TOE_LENGTH], sole[SOLE_ANKLE_HEIGHT] + sole[TOE_Z]
    c, s = math.cos(pitch), math.sin(pitch)
    along, across = toe_heading(rotation)
    ahead = (length * c - thick * s) / max(math.sqrt(along * along + across * across), 1e-9)
    offsets[2, 0] = offsets[1, 0] + ahead * along
    offsets[2, 1] = offsets[1, 1] + ahead * across
    rise = tip_rise(sole, pitch)
    offsets[2, 2] = offsets[1, 2] - thick - rise
    return rise


@kernel
def sole_height(rotation, toe_drop, sole):
    """Height in metres of the ankle above the ground at which the lower one of heel and ball touches the ground.

    ``toe_drop`` is the vertical component of the vector from ankle to toe joint.
    """
    heel = rotation[2, 0] * sole[SOLE_HEEL_LENGTH] + rotation[2, 2] * sole[SOLE_ANKLE_HEIGHT]
    ball = sole[SOLE_ANKLE_HEIGHT] + sole[TOE_Z] - toe_drop
    return max(heel, ball)
