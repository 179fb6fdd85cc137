"""Joints out of the channels of a motion file: positions, and rotations about one axis after the other."""

import math

from studio.core.kernels.compiling import kernel

NOTHING, PLACE, TURN = 0, 1, 2
"""What a channel does to its joint."""


@kernel
def pose_joints(numbers, joints, deeds, axes, starts, offsets, out_rotations, out_translations):
    """Local quaternions (N, J, 4) and translations (N, J, 3) of ``numbers`` (N, C), lengths and degrees.

    Of each channel (C,) the joint, what it does and its axis from 0 to 2; ``starts`` (J, 3) is what positions are added
    to, ``offsets`` (J, 3) where joints without any lie. A later turn is about an axis that the earlier ones turned:
    of channels Z, X, Y the matrix is R_Z R_X R_Y.
    """
    for frame in range(numbers.shape[0]):
        for joint in range(offsets.shape[0]):
            for axis in range(3):
                out_rotations[frame, joint, axis] = 0.0
                out_translations[frame, joint, axis] = offsets[joint, axis]
            out_rotations[frame, joint, 3] = 1.0
        for channel in range(numbers.shape[1]):
            joint, axis, number = joints[channel], axes[channel], numbers[frame, channel]
            if deeds[channel] == PLACE:
                out_translations[frame, joint, axis] = starts[joint, axis] + number
            elif deeds[channel] == TURN:
                turn_about(axis, 0.5 * math.radians(number), out_rotations[frame, joint])


@kernel
def turn_about(axis, half, quaternion):
    """A quaternion (4,) times the turn about one of its axes by twice ``half`` radians, in place."""
    sine, cosine = math.sin(half), math.cos(half)
    i, j, k = axis, (axis + 1) % 3, (axis + 2) % 3
    a, b, c, w = quaternion[i], quaternion[j], quaternion[k], quaternion[3]
    quaternion[i] = a * cosine + w * sine
    quaternion[j] = b * cosine + c * sine
    quaternion[k] = c * cosine - b * sine
    quaternion[3] = w * cosine - a * sine


@kernel
def turn_axes(rotations, translations, turn, metres, out_rotations, out_translations):
    """Rotations (N, J, 4) and translations (N, J, 3) in axes turned by ``turn`` C (3, 3): C R C^T and C t ``metres``.

    Turned like that, a quaternion has its axis turned.
    """
    for frame in range(rotations.shape[0]):
        for joint in range(rotations.shape[1]):
            for row in range(3):
                axis, place = 0.0, 0.0
                for column in range(3):
                    axis += turn[row, column] * rotations[frame, joint, column]
                    place += turn[row, column] * translations[frame, joint, column]
                out_rotations[frame, joint, row] = axis
                out_translations[frame, joint, row] = metres * place
            out_rotations[frame, joint, 3] = rotations[frame, joint, 3]
