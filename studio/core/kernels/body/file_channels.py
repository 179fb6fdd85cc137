"""Joint poses from the channels of a motion file: positions, and Euler rotations in the order of the channels."""

import math

from studio.core.kernels.compiling import kernel

IGNORED_CHANNEL, POSITION_CHANNEL, ROTATION_CHANNEL = 0, 1, 2
"""Kinds of channels of a motion file."""


@kernel
def pose_joints(numbers, joints, kinds, axes, starts, offsets, out_rotations, out_translations):
    """Write local quaternions (N, J, 4) and translations (N, J, 3) of joints from channel ``numbers`` (N, C), in
    degrees and the file's unit of length.

    ``joints``, ``kinds`` and ``axes`` (C,) give each channel's joint, kind (``ROTATION_CHANNEL`` ...) and axis from 0
    to 2; ``starts`` (J, 3) is added to positions, ``offsets`` (J, 3) is the translation of joints without position
    channels. Each rotation is about an axis that the rotations before it have rotated: the matrix of channels Z, X, Y
    is R_Z R_X R_Y.
    """
    for frame in range(numbers.shape[0]):
        for joint in range(offsets.shape[0]):
            for axis in range(3):
                out_rotations[frame, joint, axis] = 0.0
                out_translations[frame, joint, axis] = offsets[joint, axis]
            out_rotations[frame, joint, 3] = 1.0
        for channel in range(numbers.shape[1]):
            joint, axis, number = joints[channel], axes[channel], numbers[frame, channel]
            if kinds[channel] == POSITION_CHANNEL:
                out_translations[frame, joint, axis] = starts[joint, axis] + number
            elif kinds[channel] == ROTATION_CHANNEL:
                rotate_quaternion_about_axis(axis, 0.5 * math.radians(number), out_rotations[frame, joint])


@kernel
def rotate_quaternion_about_axis(axis, half, quaternion):
    """Multiply a quaternion (4,) on its right by a rotation of 2 ``half`` radians about axis 0, 1 or 2, in place."""
    sine, cosine = math.sin(half), math.cos(half)
    i, j, k = axis, (axis + 1) % 3, (axis + 2) % 3
    a, b, c, w = quaternion[i], quaternion[j], quaternion[k], quaternion[3]
    quaternion[i] = a * cosine + w * sine
    quaternion[j] = b * cosine + c * sine
    quaternion[k] = c * cosine - b * sine
    quaternion[3] = w * cosine - a * sine


@kernel
def change_axes(rotations, translations, rotation, metres, out_rotations, out_translations):
    """Write joint poses after a change of basis by C, ``rotation`` (3, 3): rotations C R C^T (N, J, 4) and translations
    C t ``metres`` (N, J, 3).

    ``metres`` is the length of one unit. The change of basis rotates the axis of each quaternion.
    """
    for frame in range(rotations.shape[0]):
        for joint in range(rotations.shape[1]):
            for row in range(3):
                axis, position = 0.0, 0.0
                for column in range(3):
                    axis += rotation[row, column] * rotations[frame, joint, column]
                    position += rotation[row, column] * translations[frame, joint, column]
                out_rotations[frame, joint, row] = axis
                out_translations[frame, joint, row] = metres * position
            out_rotations[frame, joint, 3] = rotations[frame, joint, 3]
