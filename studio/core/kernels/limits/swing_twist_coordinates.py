"""Swing-twist coordinates of limb joints, centred on their limits (METHOD (25) to (28) and (37)).

Rotations (F, 16, 3, 3) are those of joints in their parents, angles (F, 16, 3) in radians, four joints a limb: shoulder
or hip and wrist or ankle by swing and twist, elbow or knee by bend, slant and turn, toes by a rotation vector.
``limits`` (4,) are records of ``kernels.limits.limb_joint_limits``; ``limbs`` (4,) is 1 for the limbs to be computed.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    relative_rotation,
    rotation_from_matrix,
    rotation_from_vector,
    rotation_vector,
    write_rotation,
)
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.swing_twist import swing_and_twist, swing_fraction, wrap_angle


@kernel
def write_limb_rotations(parents, segments, rotations, out_rotations):
    """Write the rotations (F, 16, 3, 3) of ``segments`` (16,) in their ``parents``, from world rotations (F, S, 3,
    3).
    """
    for frame in range(rotations.shape[0]):
        for joint in range(segments.shape[0]):
            rotation = relative_rotation(rotations[frame, parents[joint]], rotations[frame, segments[joint]])
            write_rotation(rotation, out_rotations[frame, joint])


@kernel
def write_limb_angles(limbs, rotations, limits, out_angles):
    """Write the swing-twist coordinates (F, 16, 3) of the selected limbs' joints from their rotations."""
    for frame in range(rotations.shape[0]):
        for limb in range(4):
            for joint in range(4 * limb, 4 * limb + 4):
                if limbs[limb]:
                    write_joint_angles(joint % 4, rotations[frame, joint], limits[limb], out_angles[frame, joint])


@kernel
def write_joint_angles(joint, rotation, row, out_angles):
    """Write the swing-twist coordinates (3,) of one joint from its rotation (3, 3)."""
    if joint == 3:
        copy_point(rotation_vector(rotation_from_matrix(rotation)), out_angles)
    else:
        out_angles[0], out_angles[1], out_angles[2] = limited_angles(joint, rotation_from_matrix(rotation), row)


@kernel
def limited_angles(joint, rotation, row):
    """Swing-twist coordinates, 3 numbers, of a joint that has limits."""
    if joint == 1:
        bend, slant = math.atan2(-rotation[5], rotation[8]), math.asin(min(max(rotation[2], -1.0), 1.0))
        bend -= 0.5 * (row.bends[0] + row.bends[1])
        return wrap_angle(bend), slant, wrap_angle(math.atan2(-rotation[1], rotation[0]) - row.turns[0])
    rotation = compose(inverse_rotation(rotation_from_matrix(row.axes[joint // 2])), rotation)
    x, y, twist = swing_and_twist((rotation[0], rotation[3], rotation[6]), (rotation[2], rotation[5], rotation[8]))
    return x, y, wrap_angle(twist - row.twists[joint // 2, 0])


@kernel
def write_rotations_from_angles(limbs, angles, limits, out_rotations):
    """Write the rotations (F, 16, 3, 3) of the selected limbs' joints from their swing-twist coordinates."""
    for frame in range(angles.shape[0]):
        for limb in range(4):
            for joint in range(4 * limb, 4 * limb + 4):
                if limbs[limb]:
                    write_rotation(
                        rotation_from_angles(joint % 4, angles[frame, joint], limits[limb]), out_rotations[frame, joint]
                    )


@kernel
def rotation_from_angles(joint, angles, row):
    """Rotation tuple of one joint in its parent from its swing-twist coordinates ``angles`` (3,)."""
    x, y, z = angles[0], angles[1], angles[2]
    if joint == 3:
        return rotation_from_vector(x, y, z)
    if joint == 1:
        bend, rotation = x + 0.5 * (row.bends[0] + row.bends[1]), z + row.turns[0]
        return compose(
            rotation_from_vector(bend, 0.0, 0.0),
            compose(rotation_from_vector(0.0, y, 0.0), rotation_from_vector(0.0, 0.0, rotation)),
        )
    twist = rotation_from_vector(0.0, 0.0, z + row.twists[joint // 2, 0])
    return compose(rotation_from_matrix(row.axes[joint // 2]), compose(rotation_from_vector(x, y, 0.0), twist))


@kernel
def clamp_limb_angles(limbs, own, limits, angles):
    """Clamp swing-twist coordinates, in place, to the limits or to the motion's ``own`` coordinates where those are
    beyond.
    """
    for frame in range(angles.shape[0]):
        for limb in range(4):
            row = limits[limb]
            for joint in range(4 * limb, 4 * limb + 3):
                if limbs[limb]:
                    clamp_joint_angles(joint % 4, own[frame, joint], row, angles[frame, joint])


@kernel
def clamp_joint_angles(joint, own, row, angles):
    """Clamp the coordinates ``angles`` (3,) of one joint, in place, to its limits or to the motion's ``own`` ones where
    those are beyond.
    """
    if joint == 1:
        angles[0] = clamp_angle(angles[0], own[0], 0.5 * (row.bends[1] - row.bends[0]))
        angles[1] = clamp_angle(angles[1], own[1], row.aslant)
        angles[2] = clamp_angle(angles[2], own[2], row.turns[1])
        return
    radii = row.radii[joint // 2]
    most = max(1.0, swing_fraction(radii, own[0], own[1]))
    fraction = min(most / max(swing_fraction(radii, angles[0], angles[1]), 1e-9), 1.0)
    angles[0], angles[1] = fraction * angles[0], fraction * angles[1]
    angles[2] = clamp_angle(angles[2], own[2], row.twists[joint // 2, 1])


@kernel
def clamp_angle(angle, own, half):
    """Angle clamped to -``half`` ... ``half``, or to the motion's ``own`` angle if that is beyond."""
    most = max(half, abs(own))
    return min(max(angle, -most), most)
