"""Channels of a whole motion at once, array by array."""

import numpy as np

from studio.core.body.morphology import Morphology
from studio.core.kernels import channel_columns as channel
from studio.core.normalized.encode import BODY_FORWARD
from studio.core.normalized.normalize import smoothed_heading
from studio.core.rotations import frame_along, from_matrix, normalized, shortest_arc, sign_continuous

FloatArray = np.ndarray


def channels_of(body: Morphology, points: FloatArray, rotations: FloatArray, frame_rate: float) -> FloatArray:
    layout = body.layout
    thorax, neck, head = layout.spine_count - 1, layout.neck_base, layout.head_joint
    channels = np.zeros((len(points), channel.SPINE + 4 * (layout.spine_count - 1)))
    pelvis = rotations[:, 0]
    ankle = np.array([0.0, 0.0, body.ankle_height.mean()])
    hips = points[:, 0] + pelvis @ body.hip_offset.mean(axis=0)
    channels[:, channel.HIPS : channel.HIPS + 3] = (hips - ankle) / body.leg_length
    yaw = smoothed_heading(pelvis, frame_rate)
    channels[:, channel.YAW] = yaw
    put = _QuaternionWriter(channels)
    put(channel.PELVIS, _about_z(-yaw) @ pelvis)
    carrier = rotations[:, neck] @ frame_along(body.neck_rest, BODY_FORWARD).T
    put(channel.NECK, _local(rotations[:, thorax], carrier))
    put(channel.HEAD, _local(carrier, rotations[:, head]))
    for segment in range(1, layout.spine_count):
        put(channel.SPINE + 4 * (segment - 1), _local(pelvis, rotations[:, segment]))
    for side in range(2):
        arm, leg = layout.spine_count + 2 + 4 * side, layout.spine_count + 10 + 4 * side
        carrier = rotations[:, arm] @ frame_along(body.clavicle_rest[side], BODY_FORWARD).T
        put(channel.CLAVICLE + 4 * side, _local(rotations[:, thorax], carrier))
        put(channel.HAND + 4 * side, _local(rotations[:, arm + 2], rotations[:, arm + 3]))
        put(channel.FOOT + 4 * side, _local(pelvis, rotations[:, leg + 2]))
        put(channel.TOE + 4 * side, _local(rotations[:, leg + 2], rotations[:, leg + 3]))
        _encode_limb(channels, put, side, carrier, points, rotations, layout.collar_point(side) + 1, arm + 1)
        _encode_limb(channels, put, 2 + side, pelvis, points, rotations, layout.hip_point(side), leg)
        hip = _apply_inverse(pelvis, points[:, layout.hip_point(side)] - points[:, 0])
        play = channel.HIP_SHIFT + 3 * side
        channels[:, play : play + 3] = (hip - body.hip_offset[side]) / body.leg_length
    stray = _apply_inverse(rotations[:, neck], points[:, head] - points[:, neck]) / body.neck
    channels[:, channel.HEAD_SHIFT : channel.HEAD_SHIFT + 3] = stray - [0.0, 0.0, 1.0]
    return channels


def _encode_limb(
    channels: FloatArray,
    put: "_QuaternionWriter",
    limb: int,
    carrier: FloatArray,
    points: FloatArray,
    rotations: FloatArray,
    root: int,
    upper: int,
) -> None:
    """Frame, reach, bend and twists of one limb (METHOD 2, "limb encoding")."""
    to_middle, to_end = points[:, root + 1] - points[:, root], points[:, root + 2] - points[:, root]
    lengths = [np.linalg.norm(bone, axis=1, keepdims=True) for bone in (to_middle, to_end - to_middle)]
    total = float(np.median(lengths[0]) + np.median(lengths[1]))
    u, z, f = to_middle / lengths[0], normalized(to_end), (to_end - to_middle) / lengths[1]
    hinge = rotations[:, upper, :, 0]
    x = np.einsum("fij,fj->fi", shortest_arc(u, z), hinge)
    x = normalized(x - np.sum(x * z, axis=1, keepdims=True) * z)
    frame = np.stack([x, np.cross(z, x), z], axis=2)
    put(channel.LIMB_FRAME + 4 * limb, _local(carrier, frame))
    middle = _apply_inverse(frame, to_middle)
    channels[:, channel.LIMB_SLACK + limb] = 1.0 - np.linalg.norm(to_end, axis=1) / total
    channels[:, channel.LIMB_OFF_PLANE + limb] = middle[:, 0] / total
    channels[:, channel.LIMB_BEND + limb] = np.where(middle[:, 1] < 0.0, -1.0, 1.0)
    for bone, direction in enumerate((u, f)):
        untwisted = shortest_arc(z, direction) @ frame
        rest = _local(untwisted, rotations[:, upper + bone])
        twist = np.unwrap(np.arctan2(rest[:, 1, 0] - rest[:, 0, 1], rest[:, 0, 0] + rest[:, 1, 1]))
        channels[:, channel.LIMB_TWIST + 2 * limb + bone] = twist


class _QuaternionWriter:
    """Writes rotations (F, 3, 3) as quaternions continuous in time into four columns."""

    def __init__(self, channels: FloatArray) -> None:
        self.channels = channels

    def __call__(self, column: int, matrices: FloatArray) -> None:
        self.channels[:, column : column + 4] = sign_continuous(from_matrix(matrices))


def _about_z(angles: FloatArray) -> FloatArray:
    turns = np.zeros((len(angles), 3, 3))
    turns[:, 0, 0] = turns[:, 1, 1] = np.cos(angles)
    turns[:, 1, 0] = np.sin(angles)
    turns[:, 0, 1] = -turns[:, 1, 0]
    turns[:, 2, 2] = 1.0
    return turns


def _local(carrier: FloatArray, rotations: FloatArray) -> FloatArray:
    return np.asarray(np.swapaxes(carrier, -1, -2) @ rotations)


def _apply_inverse(rotations: FloatArray, vectors: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("fji,fj->fi", rotations, vectors))
