"""From a posed capture to channels: the other way round than ``kernels.body.realize``, and in its order (METHOD 2)."""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.algebra import turns
from studio.core.kernels.algebra.rotation import multiply, multiply_by_transposed
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.records import Array, Pose

TINY = 1e-12
"""Length below which what is left of a hinge across its limb has no direction."""


class ActorSizes(NamedTuple):
    """Of the actor of a capture, what a motion without a body leaves out."""

    rests: Array
    """(3, 3, 3) the rest of neck and clavicles in the thorax."""
    hips: Array
    """(2, 3) metres in the pelvis."""
    limbs: Array
    """(4,) metres, lengths of arms and legs."""
    ankle_height: float
    leg: float
    neck: float
    """Metres."""


class EncodeScratch(NamedTuple):
    """Scratch: rotations (3, 3)."""

    carriers: Array
    """(2, 3, 3) the thorax carried along by each clavicle, in which arms lie."""
    limb_frame: Array
    turn: Array
    local: Array


@kernel
def align_segments(joint_rotations, joints, alignments, out_rotations):
    """R_canonical = R_joint A (METHOD 2): ``joint_rotations`` (F, J, 3, 3), ``joints`` (S,) that move the segments,
    ``alignments`` (S, 3, 3), out (F, S, 3, 3).
    """
    for frame in range(out_rotations.shape[0]):
        for segment in range(out_rotations.shape[1]):
            joint = joint_rotations[frame, joints[segment]]
            multiply(joint, alignments[segment], out_rotations[frame, segment])


@allocating_kernel
def encode_frames(points, rotations, yaw, actor, out_channels):
    """Channels (F, 93 + 4 (K - 1)) of a body in motion (METHOD 2), each frame by itself: ``continue_turns`` follows.

    ``points`` (F, K + 23, 3) and ``rotations`` (F, K + 18, 3, 3) canonical, in the motion's space; ``yaw`` (F,) the
    low-passed heading; ``actor`` what they leave out.
    """
    scratch = EncodeScratch(np.empty((2, 3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)))
    for frame in range(out_channels.shape[0]):
        pose, channels = Pose(points[frame], rotations[frame]), out_channels[frame]
        channels[at.YAW] = yaw[frame]
        encode_trunk(pose, actor, scratch, channels)
        for limb in range(4):
            encode_limb(limb, pose, actor.limbs[limb], scratch, channels)


@kernel
def continue_turns(turn_columns, channels):
    """Quaternions at ``turn_columns`` and twists of limbs made to go on from the frame before, in place.

    A quaternion takes the sign that lies nearer to it, a twist the whole turns.
    """
    for frame in range(1, channels.shape[0]):
        before, now = channels[frame - 1], channels[frame]
        for column in turn_columns:
            dot = 0.0
            for part in range(4):
                dot += now[column + part] * before[column + part]
            if dot < 0.0:
                for part in range(4):
                    now[column + part] = -now[column + part]
        for column in range(at.LIMB_TWIST, at.LIMB_TWIST + 8):
            beyond = now[column] - before[column] + math.pi
            now[column] -= 2.0 * math.pi * math.floor(beyond / (2.0 * math.pi))


@kernel
def encode_trunk(pose, actor, scratch, out):
    """Root, spine, neck, head, clavicles and what strays of one frame (METHOD 3.1 to 3.3, backwards), whose heading is
    known; the carriers of both arms into ``scratch``.
    """
    points, rotations = pose
    spine_count = rotations.shape[0] - 18
    pelvis, thorax, neck = rotations[0], rotations[spine_count - 1], spine_count
    place_hips(points[0], pelvis, actor, out)
    turn, local = scratch.turn, scratch.local
    c, s = math.cos(out[at.YAW]), math.sin(out[at.YAW])
    for column in range(3):
        turn[0, column] = c * pelvis[0, column] + s * pelvis[1, column]
        turn[1, column] = c * pelvis[1, column] - s * pelvis[0, column]
        turn[2, column] = pelvis[2, column]
    put_turn(out, at.PELVIS, turn)
    for segment in range(1, spine_count):
        put_between(out, at.SPINE + 4 * (segment - 1), pelvis, rotations[segment], local)
    multiply_by_transposed(rotations[neck], actor.rests[0], turn)
    put_between(out, at.NECK, thorax, turn, local)
    put_between(out, at.HEAD, turn, rotations[neck + 1], local)
    for side in range(2):
        carrier = scratch.carriers[side]
        multiply_by_transposed(rotations[spine_count + 2 + 4 * side], actor.rests[1 + side], carrier)
        put_between(out, at.CLAVICLE + 4 * side, thorax, carrier, local)
        for axis in range(3):
            hip = along(points[0], points[spine_count + 13 + 5 * side], pelvis, axis)
            out[at.HIP_PLAY + 3 * side + axis] = (hip - actor.hips[side, axis]) / actor.leg
    for axis in range(3):
        head = along(points[neck], points[neck + 1], rotations[neck], axis)
        out[at.HEAD_PLAY + axis] = head / actor.neck - (1.0 if axis == 2 else 0.0)


@kernel
def place_hips(root, pelvis, actor, out_channel):
    """The middle of the hips above the ankles' plane, in parts of the leg's length."""
    for axis in range(3):
        place = root[axis] - (actor.ankle_height if axis == 2 else 0.0)
        for column in range(3):
            place += pelvis[axis, column] * 0.5 * (actor.hips[0, column] + actor.hips[1, column])
        out_channel[at.HIPS + axis] = place / actor.leg


@kernel
def encode_limb(limb, pose, length, scratch, out):
    """Frame, slack, bend, twists and extremity of one arm (limb 0, 1) or leg (2, 3), ``length`` metres long (METHOD 2,
    "limb encoding").
    """
    points, rotations = pose
    spine_count = rotations.shape[0] - 18
    side, is_leg = limb % 2, limb >= 2
    root = spine_count + (13 if is_leg else 4) + 5 * side
    upper = spine_count + (10 if is_leg else 3) + 4 * side
    carrier = rotations[0] if is_leg else scratch.carriers[side]
    limb_frame, arc, local = scratch.limb_frame, scratch.turn, scratch.local
    ux, uy, uz, _ = unit_between(points[root], points[root + 1])
    fx, fy, fz, _ = unit_between(points[root + 1], points[root + 2])
    zx, zy, zz, reach = unit_between(points[root], points[root + 2])
    turns.put_turn(turns.shortest(ux, uy, uz, zx, zy, zz), arc)
    frame_of_hinge(arc, rotations[upper], zx, zy, zz, limb_frame)
    put_between(out, at.LIMB_FRAME + 4 * limb, carrier, limb_frame, local)
    out[at.LIMB_SLACK + limb] = 1.0 - reach / length
    out[at.LIMB_OFF_PLANE + limb] = along(points[root], points[root + 1], limb_frame, 0) / length
    out[at.LIMB_BEND + limb] = -1.0 if along(points[root], points[root + 1], limb_frame, 1) < 0.0 else 1.0
    for bone in range(2):
        dx, dy, dz = (ux, uy, uz) if bone == 0 else (fx, fy, fz)
        straight = turns.product(turns.shortest(zx, zy, zz, dx, dy, dz), turns.turn_in(limb_frame))
        turn = turns.product(turns.inverse(straight), turns.turn_in(rotations[upper + bone]))
        out[at.LIMB_TWIST + 2 * limb + bone] = math.atan2(turn[3] - turn[1], turn[0] + turn[4])
    if is_leg:
        put_between(out, at.FOOT + 4 * side, rotations[0], rotations[upper + 2], local)
        put_between(out, at.TOE + 4 * side, rotations[upper + 2], rotations[upper + 3], local)
    else:
        put_between(out, at.HAND + 4 * side, rotations[upper + 1], rotations[upper + 2], local)


@kernel
def frame_of_hinge(arc, upper, zx, zy, zz, out_frame):
    """Limb frame (3, 3): z towards the extremity, x as near as can be to the hinge of ``upper`` carried by ``arc``."""
    x = arc[0, 0] * upper[0, 0] + arc[0, 1] * upper[1, 0] + arc[0, 2] * upper[2, 0]
    y = arc[1, 0] * upper[0, 0] + arc[1, 1] * upper[1, 0] + arc[1, 2] * upper[2, 0]
    w = arc[2, 0] * upper[0, 0] + arc[2, 1] * upper[1, 0] + arc[2, 2] * upper[2, 0]
    out_of_plane = x * zx + y * zy + w * zz
    x, y, w = x - out_of_plane * zx, y - out_of_plane * zy, w - out_of_plane * zz
    scale = 1.0 / max(math.sqrt(x * x + y * y + w * w), TINY)
    x, y, w = scale * x, scale * y, scale * w
    out_frame[0, 0], out_frame[1, 0], out_frame[2, 0] = x, y, w
    out_frame[0, 1], out_frame[1, 1], out_frame[2, 1] = zy * w - zz * y, zz * x - zx * w, zx * y - zy * x
    out_frame[0, 2], out_frame[1, 2], out_frame[2, 2] = zx, zy, zz


@kernel
def unit_between(start, end):
    """The direction (x, y, z) from one point (3,) to another, and the metres between them; zeros where they meet."""
    x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / length if length > 0.0 else 1.0
    return x * scale, y * scale, z * scale, length


@kernel
def along(start, end, axes, column):
    """How far ``end`` lies from ``start``, both (3,), along one of ``axes`` (3, 3)."""
    return (
        axes[0, column] * (end[0] - start[0])
        + axes[1, column] * (end[1] - start[1])
        + axes[2, column] * (end[2] - start[2])
    )


@kernel
def put_between(out_channel, column, carrier, rotation, scratch):
    """``put_turn`` of carrier^T rotation."""
    turns.put_turn(turns.product(turns.inverse(turns.turn_in(carrier)), turns.turn_in(rotation)), scratch)
    put_turn(out_channel, column, scratch)


@kernel
def put_turn(out_channel, column, matrix):
    """A rotation (3, 3) as unit quaternion, by its largest component (Shepperd 1978), in four columns of a frame."""
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
    for part in range(4):
        size += quaternion[part] * quaternion[part]
    scale = 1.0 / math.sqrt(size)
    for part in range(4):
        quaternion[part] *= scale
