"""One foot at one frame: where heel, ball and tip of its sole are, and where it looks.

States of a foot: bit 1 the heel stands, bit 2 the toe stands. A ``sole`` (6,) is the measures of a foot, by ``TOE_X``
and so on.
"""

import math

from studio.core.kernels.algebra.eases import smoothstep
from studio.core.kernels.compiling import kernel, small_kernel

TOE_X, TOE_Y, TOE_Z, ANKLE_HEIGHT, HEEL_LENGTH, TOE_LENGTH = range(6)
"""The numbers of a ``sole``: ankle to toe joint in foot axes, ankle above the sole, heel behind the ankle, toe."""
HEEL = 1
TOE = 2
FLAT = 3
ASIDE = 0.35
"""Vertical part of a foot's left axis from which it lies on its side, wholly at twice that."""
SOLE_DOWN = 0.5
"""Vertical part of its upward axis from which it stands on its sole."""


@kernel
def ball_above_heel(rotation, sole):
    """How much higher the ball's sole is than the heel's, in metres; 0 for a level foot."""
    ball = rotation[2, 0] * sole[TOE_X] + rotation[2, 1] * sole[TOE_Y] + rotation[2, 2] * sole[TOE_Z] - sole[TOE_Z]
    return ball - sole[ANKLE_HEIGHT] + rotation[2, 0] * sole[HEEL_LENGTH] + rotation[2, 2] * sole[ANKLE_HEIGHT]


@kernel
def set_heading(matrix, along, across):
    """Write the level rotation (3, 3) whose x axis points (along, across) on the ground."""
    length = math.sqrt(along * along + across * across)
    c, s = (along / length, across / length) if length > 1e-9 else (1.0, 0.0)
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = c, -s, 0.0
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = s, c, 0.0
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = 0.0, 0.0, 1.0


@kernel
def lying_aside(rotation):
    """0 where a foot or toe (3, 3) stands, its sole down however it rolls, 1 where it lies on its side."""
    rolled = smoothstep(min(max(abs(rotation[2, 1]) / ASIDE - 1.0, 0.0), 1.0))
    return rolled * smoothstep(min(max((SOLE_DOWN - rotation[2, 2]) / ASIDE, 0.0), 1.0))


@kernel
def upright_part(rotation):
    """1 where the sole of a foot (3, 3) looks down, 0 where it looks up: the foot lies on its instep."""
    return smoothstep(min(max(1.0 + 2.0 * rotation[2, 2], 0.0), 1.0))


@small_kernel
def toe_heading(foot):
    """(along, across) the ground, of any length: where a standing toe looks, as the foot does and across its left axis.

    So it does not turn round where a steep foot, on tucked toes, passes straight down.
    """
    ahead = 1.0 + foot[2, 2]
    return ahead * foot[0, 0] - foot[2, 0] * foot[0, 2], ahead * foot[1, 0] - foot[2, 0] * foot[1, 2]


@kernel
def point_down(matrix, pitch):
    """Turn a level rotation (3, 3), in place, about its left axis until its x axis points down by ``pitch``."""
    if pitch != 0.0:
        c, s = math.cos(pitch), math.sin(pitch)
        for axis in range(3):
            x, z = matrix[axis, 0], matrix[axis, 2]
            matrix[axis, 0], matrix[axis, 2] = c * x - s * z, s * x + c * z


@kernel
def to_toe(rotation, sole, out_offset):
    """Vector (3,) from ankle to toe joint in the world."""
    for axis in range(3):
        out_offset[axis] = (
            rotation[axis, 0] * sole[TOE_X] + rotation[axis, 1] * sole[TOE_Y] + rotation[axis, 2] * sole[TOE_Z]
        )


@kernel
def to_pivots(rotation, sole, out_offsets):
    """Vectors (2, 3) in the world from the ankle to what a foot rolls over: the heel's lower edge, the toe joint."""
    for axis in range(3):
        out_offsets[0, axis] = -rotation[axis, 0] * sole[HEEL_LENGTH] - rotation[axis, 2] * sole[ANKLE_HEIGHT]
    to_toe(rotation, sole, out_offsets[1])


@small_kernel
def tip_rise(sole, pitch):
    """How much higher than in a flat foot the ball is over the tip of a toe that points down by ``pitch``."""
    return sole[TOE_LENGTH] * math.sin(pitch) - (sole[ANKLE_HEIGHT] + sole[TOE_Z]) * (1.0 - math.cos(pitch))


@kernel
def to_tip(rotation, sole, pitch, offsets):
    """``tip_rise`` of a foot.

    Writes the vector from the ankle to that tip into the last of ``offsets`` (3, 3), the others as from ``to_pivots``.
    """
    length, thick = sole[TOE_LENGTH], sole[ANKLE_HEIGHT] + sole[TOE_Z]
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
    """Height of the ankle at which the lowest of heel and ball touches the ground.

    ``toe_drop`` z of the vector ankle to toe in the world.
    """
    heel = rotation[2, 0] * sole[HEEL_LENGTH] + rotation[2, 2] * sole[ANKLE_HEIGHT]
    ball = sole[ANKLE_HEIGHT] + sole[TOE_Z] - toe_drop
    return max(heel, ball)
