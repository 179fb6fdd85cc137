"""Channels of a posed capture: the inverse of ``kernels.body.pose_from_channels`` (METHOD 2)."""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels import channel_columns as channel
from studio.core.kernels.algebra import rotation_tuples
from studio.core.kernels.algebra.rotation_matrices import matrix_product, matrix_product_transposed
from studio.core.kernels.body_indices import (
    CLAVICLE_SEGMENT,
    HIP_POINT,
    POINTS_PER_LIMB,
    SEGMENTS_BESIDE_SPINE,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    THIGH_SEGMENT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.records import Array, Pose

SHORTEST_HINGE = 1e-12
"""Length of the component of a unit hinge axis across its limb below which it has no direction."""


class ActorSizes(NamedTuple):
    """Proportions of the captured actor, which are removed from the normalised motion."""

    rests: Array
    """(3, 3, 3) rest rotations of neck, left and right clavicle in the thorax."""
    hips: Array
    """(2, 3) offsets in metres of both hip joints from the pelvis' origin, in its axes."""
    limbs: Array
    """(4,) lengths of arms and legs, metres."""
    ankle_height: float
    leg: float
    neck: float
    """Height of the ankles above the sole, length of the legs and of the neck, all in metres."""


class EncodeScratch(NamedTuple):
    """Scratch rotations (3, 3) of ``encode_frames``."""

    arm_parents: Array
    """(2, 3, 3) rotation of the thorax followed by that of each clavicle from rest: parent axes of the arms."""
    limb_frame: Array
    rotation: Array
    local: Array


@kernel
def align_segments(joint_rotations, joints, alignments, out_rotations):
    """Write segment rotations (F, S, 3, 3) in the canonical axes, R_canonical = R_joint A (METHOD 2).

    ``joint_rotations`` (F, J, 3, 3); ``joints`` (S,) is the joint that moves each segment, ``alignments`` (S, 3, 3) the
    A of each segment.
    """
    for frame in range(out_rotations.shape[0]):
        for segment in range(out_rotations.shape[1]):
            joint = joint_rotations[frame, joints[segment]]
            matrix_product(joint, alignments[segment], out_rotations[frame, segment])


@allocating_kernel
def encode_frames(points, rotations, yaw, actor, out_channels):
    """Write the channels (F, 93 + 4 (K - 1)) of a moving body (METHOD 2), each frame by itself.

    ``points`` (F, K + 23, 3) and ``rotations`` (F, K + 18, 3, 3) are those of a canonical body, in the motion's space;
    ``yaw`` (F,) is the low-passed heading in radians; ``actor`` an ``ActorSizes`` record. ``unwrap_channels`` makes the
    result continuous in time.
    """
    scratch = EncodeScratch(np.empty((2, 3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)))
    for frame in range(out_channels.shape[0]):
        pose, channels = Pose(points[frame], rotations[frame]), out_channels[frame]
        channels[channel.YAW] = yaw[frame]
        encode_trunk(pose, actor, scratch, channels)
        for limb in range(4):
            encode_limb(limb, pose, actor.limbs[limb], scratch, channels)


@kernel
def unwrap_channels(quaternion_columns, channels):
    """Make channels continuous from frame to frame, in place: signs of quaternions and multiples of 2 pi of limb
    twists.

    Each quaternion, from one of ``quaternion_columns`` on, takes the sign nearer to the frame before.
    """
    for frame in range(1, channels.shape[0]):
        before, now = channels[frame - 1], channels[frame]
        for column in quaternion_columns:
            dot = 0.0
            for component in range(4):
                dot += now[column + component] * before[column + component]
            if dot < 0.0:
                for component in range(4):
                    now[column + component] = -now[column + component]
        for column in range(channel.LIMB_TWIST, channel.LIMB_TWIST + 8):
            beyond = now[column] - before[column] + math.pi
            now[column] -= 2.0 * math.pi * math.floor(beyond / (2.0 * math.pi))


@kernel
def encode_trunk(pose, actor, scratch, out):
    """Write the channels of root, spine, neck, head, clavicles, hip and head shifts of one frame (METHOD 3.1 to 3.3
    inverted).

    The heading in ``out`` must be set. Also writes the parent axes of both arms into ``scratch.arm_parents``.
    """
    points, rotations = pose
    spine_count = rotations.shape[0] - SEGMENTS_BESIDE_SPINE
    pelvis, thorax, neck = rotations[0], rotations[spine_count - 1], spine_count
    encode_hips(points[0], pelvis, actor, out)
    rotation, local = scratch.rotation, scratch.local
    c, s = math.cos(out[channel.YAW]), math.sin(out[channel.YAW])
    for column in range(3):
        rotation[0, column] = c * pelvis[0, column] + s * pelvis[1, column]
        rotation[1, column] = c * pelvis[1, column] - s * pelvis[0, column]
        rotation[2, column] = pelvis[2, column]
    write_quaternion(out, channel.PELVIS, rotation)
    for segment in range(1, spine_count):
        write_relative_quaternion(out, channel.SPINE + 4 * (segment - 1), pelvis, rotations[segment], local)
    matrix_product_transposed(rotations[neck], actor.rests[0], rotation)
    write_relative_quaternion(out, channel.NECK, thorax, rotation, local)
    write_relative_quaternion(out, channel.HEAD, rotation, rotations[neck + 1], local)
    for side in range(2):
        parent = scratch.arm_parents[side]
        matrix_product_transposed(
            rotations[spine_count + CLAVICLE_SEGMENT + SEGMENTS_PER_LIMB * side], actor.rests[1 + side], parent
        )
        write_relative_quaternion(out, channel.CLAVICLE + 4 * side, thorax, parent, local)
        for axis in range(3):
            hip = offset_along_axis(points[0], points[spine_count + HIP_POINT + POINTS_PER_LIMB * side], pelvis, axis)
            out[channel.HIP_SHIFT + 3 * side + axis] = (hip - actor.hips[side, axis]) / actor.leg
    for axis in range(3):
        head = offset_along_axis(points[neck], points[neck + 1], rotations[neck], axis)
        out[channel.HEAD_SHIFT + axis] = head / actor.neck - (1.0 if axis == 2 else 0.0)


@kernel
def encode_hips(root, pelvis, actor, out_channel):
    """Write the position (3,) of the hips' centre above the plane of the ankles, in leg lengths."""
    for axis in range(3):
        position = root[axis] - (actor.ankle_height if axis == 2 else 0.0)
        for column in range(3):
            position += pelvis[axis, column] * 0.5 * (actor.hips[0, column] + actor.hips[1, column])
        out_channel[channel.HIPS + axis] = position / actor.leg


@kernel
def encode_limb(limb, pose, length, scratch, out):
    """Write the channels of one arm (``limb`` 0, 1) or leg (2, 3): frame, slack, bend, twists and end rotation (METHOD
    2).

    ``length`` is the limb's length in metres; its slack is 1 - (distance of its end from its root) / ``length``.
    """
    points, rotations = pose
    spine_count = rotations.shape[0] - SEGMENTS_BESIDE_SPINE
    side, is_leg = limb % 2, limb >= 2
    root = spine_count + (HIP_POINT if is_leg else SHOULDER_POINT) + POINTS_PER_LIMB * side
    upper = spine_count + (THIGH_SEGMENT if is_leg else UPPER_ARM_SEGMENT) + SEGMENTS_PER_LIMB * side
    parent = rotations[0] if is_leg else scratch.arm_parents[side]
    limb_frame, arc, local = scratch.limb_frame, scratch.rotation, scratch.local
    ux, uy, uz, _ = direction_and_length(points[root], points[root + 1])
    fx, fy, fz, _ = direction_and_length(points[root + 1], points[root + 2])
    zx, zy, zz, reach = direction_and_length(points[root], points[root + 2])
    rotation_tuples.write_rotation(rotation_tuples.shortest_rotation(ux, uy, uz, zx, zy, zz), arc)
    frame_of_hinge(arc, rotations[upper], zx, zy, zz, limb_frame)
    write_relative_quaternion(out, channel.LIMB_FRAME + 4 * limb, parent, limb_frame, local)
    out[channel.LIMB_SLACK + limb] = 1.0 - reach / length
    out[channel.LIMB_OFF_PLANE + limb] = offset_along_axis(points[root], points[root + 1], limb_frame, 0) / length
    out[channel.LIMB_BEND + limb] = (
        -1.0 if offset_along_axis(points[root], points[root + 1], limb_frame, 1) < 0.0 else 1.0
    )
    for bone in range(2):
        dx, dy, dz = (ux, uy, uz) if bone == 0 else (fx, fy, fz)
        straight = rotation_tuples.compose(
            rotation_tuples.shortest_rotation(zx, zy, zz, dx, dy, dz), rotation_tuples.rotation_from_matrix(limb_frame)
        )
        rotation = rotation_tuples.compose(
            rotation_tuples.inverse_rotation(straight), rotation_tuples.rotation_from_matrix(rotations[upper + bone])
        )
        out[channel.LIMB_TWIST + 2 * limb + bone] = math.atan2(rotation[3] - rotation[1], rotation[0] + rotation[4])
    if is_leg:
        write_relative_quaternion(out, channel.FOOT + 4 * side, rotations[0], rotations[upper + 2], local)
        write_relative_quaternion(out, channel.TOE + 4 * side, rotations[upper + 2], rotations[upper + 3], local)
    else:
        write_relative_quaternion(out, channel.HAND + 4 * side, rotations[upper + 1], rotations[upper + 2], local)


@kernel
def frame_of_hinge(arc, upper, zx, zy, zz, out_frame):
    """Write the limb frame (3, 3): z along the unit vector (zx, zy, zz), x as near as possible to the hinge axis.

    The hinge axis is the x axis of ``upper`` rotated by ``arc``.
    """
    x = arc[0, 0] * upper[0, 0] + arc[0, 1] * upper[1, 0] + arc[0, 2] * upper[2, 0]
    y = arc[1, 0] * upper[0, 0] + arc[1, 1] * upper[1, 0] + arc[1, 2] * upper[2, 0]
    w = arc[2, 0] * upper[0, 0] + arc[2, 1] * upper[1, 0] + arc[2, 2] * upper[2, 0]
    out_of_plane = x * zx + y * zy + w * zz
    x, y, w = x - out_of_plane * zx, y - out_of_plane * zy, w - out_of_plane * zz
    scale = 1.0 / max(math.sqrt(x * x + y * y + w * w), SHORTEST_HINGE)
    x, y, w = scale * x, scale * y, scale * w
    out_frame[0, 0], out_frame[1, 0], out_frame[2, 0] = x, y, w
    out_frame[0, 1], out_frame[1, 1], out_frame[2, 1] = zy * w - zz * y, zz * x - zx * w, zx * y - zy * x
    out_frame[0, 2], out_frame[1, 2], out_frame[2, 2] = zx, zy, zz


@kernel
def direction_and_length(start, end):
    """(x, y, z, length): unit direction from ``start`` (3,) to ``end`` (3,) and their distance in metres.

    The direction is zero where the points coincide.
    """
    x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / length if length > 0.0 else 1.0
    return x * scale, y * scale, z * scale, length


@kernel
def offset_along_axis(start, end, axes, column):
    """Offset of ``end`` from ``start``, both (3,), along one column of ``axes`` (3, 3)."""
    return (
        axes[0, column] * (end[0] - start[0])
        + axes[1, column] * (end[1] - start[1])
        + axes[2, column] * (end[2] - start[2])
    )


@kernel
def write_relative_quaternion(out_channel, column, parent, rotation, scratch):
    """Write the quaternion (x, y, z, w) of parent^T @ rotation into four channels from ``column`` on."""
    rotation_tuples.write_rotation(
        rotation_tuples.compose(
            rotation_tuples.inverse_rotation(rotation_tuples.rotation_from_matrix(parent)),
            rotation_tuples.rotation_from_matrix(rotation),
        ),
        scratch,
    )
    write_quaternion(out_channel, column, scratch)


@kernel
def write_quaternion(out_channel, column, matrix):
    """Write a rotation (3, 3) as unit quaternion (x, y, z, w) into four channels from ``column`` on.

    It is found by its largest component (Shepperd 1978).
    """
    trace = matrix[0, 0] + matrix[1, 1] + matrix[2, 2]
    i = 3
    largest = trace
    for axis in range(2, -1, -1):
        if matrix[axis, axis] >= largest:
            i, largest = axis, matrix[axis, axis]
    quaternion = out_channel[column : column + 4]
    if i == 3:
        quaternion[0] = matrix[2, 1] - matrix[1, 2]
        quaternion[1] = matrix[0, 2] - matrix[2, 0]
        quaternion[2] = matrix[1, 0] - matrix[0, 1]
        quaternion[3] = 1.0 + trace
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        quaternion[i] = 1.0 - trace + 2.0 * matrix[i, i]
        quaternion[j] = matrix[j, i] + matrix[i, j]
        quaternion[k] = matrix[k, i] + matrix[i, k]
        quaternion[3] = matrix[k, j] - matrix[j, k]
    size = 0.0
    for component in range(4):
        size += quaternion[component] * quaternion[component]
    scale = 1.0 / math.sqrt(size)
    for component in range(4):
        quaternion[component] *= scale
