"""Axes of the segments of a body from its joint centres and markers; in a T-pose they equal the world axes.

They are x forward, y left, z up. All arrays are over frames, in world axes and metres, without gaps.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.hand_end import SHORTEST_HAND_METRES
from studio.core.markers.functional import cluster_axes
from studio.core.markers.joint_centres import thorax_frame
from studio.core.markers.measures import frame_of, has_pelvis, pelvis_frame
from studio.core.markers.roles import SIDE_WORDS
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]
Tracks = Mapping[str, FloatArray]

WORLD_UP: FloatArray = np.array([0.0, 0.0, 1.0])
_STEADY = 0.25
"""Weight of the wrist's axis against the bend of the elbow (as a sine) in finding the plane of an arm."""


@dataclass(frozen=True)
class Trunk:
    """Axes (F, 3, 3) of pelvis and thorax, middle of the hips (F, 3) and base of the neck (F, 3)."""

    pelvis: FloatArray
    thorax: FloatArray
    hips: FloatArray
    neck: FloatArray


def upright_axes(axes: FloatArray) -> FloatArray:
    """Axes (F, 3, 3) with the same heading and z up."""
    left = axes[..., 1] - axes[..., 1] @ WORLD_UP[:, None] * WORLD_UP
    left = np.where(np.linalg.norm(left, axis=-1, keepdims=True) > 1e-6, left, [0.0, 1.0, 0.0])
    return frame_of(left, np.cross(left, WORLD_UP))


def find_trunk(tracks: Tracks, joints: Tracks, stature: float, radius: float) -> Trunk:
    """Pelvis and thorax; if one of them has no markers, it is upright below or above the other."""
    legs, arms = "left_hip" in joints, "left_shoulder" in joints
    trunk = 0.3 * stature
    pelvis = _pelvis(tracks, joints) if legs or has_pelvis(tracks) else None
    thorax = _thorax(tracks, joints, radius) if arms else None
    if pelvis is None and thorax is not None:
        pelvis = upright_axes(thorax)
    elif thorax is None and pelvis is not None:
        thorax = upright_axes(pelvis)
    assert pelvis is not None
    assert thorax is not None
    neck = _neck(tracks, joints) if arms else None
    if legs:
        hips = 0.5 * (joints["left_hip"] + joints["right_hip"])
    elif has_pelvis(tracks):
        front = 0.5 * (tracks["left_front_hip"] + tracks["right_front_hip"])
        hips = front + pelvis @ np.array([-0.06, 0.0, -0.09])
    else:
        assert neck is not None
        hips = neck - trunk * thorax[..., 2]
    if neck is None:
        neck = hips + trunk * thorax[..., 2]
    return Trunk(_levelled(pelvis, neck - hips), _levelled(thorax, neck - hips), hips, neck)


HEAD_MARKERS = tuple(f"{side}_{end}_head" for end in ("front", "back") for side in SIDE_WORDS)
"""Roles of the four markers of the head."""


def head_axes(tracks: Tracks, thorax: FloatArray) -> FloatArray | None:
    """Axes (F, 3, 3) of the head, upright on average relative to the thorax; None with fewer than three head markers.

    Three markers do not show the front; the head is then taken to face on average in the direction of the chest.
    """
    names = [name for name in HEAD_MARKERS if name in tracks]
    if len(names) < 3:
        return None
    if len(names) == 3:
        turns = cluster_axes(np.stack([tracks[name] for name in names], axis=1))[1]
        return np.asarray(turns @ mean_rotation(np.swapaxes(turns, -1, -2) @ thorax))
    front_left, front_right, back_left, back_right = (tracks[name] for name in names)
    left = front_left + back_left - front_right - back_right
    axes = frame_of(left, front_left + front_right - back_left - back_right)
    return _levelled(axes, thorax[..., 2])


def leg_axes(
    joints: Tracks, tracks: Tracks, side: str, pelvis: FloatArray, thigh: float
) -> tuple[FloatArray, FloatArray]:
    """Axes (F, 3, 3) of thigh and shank: z from the distal joint to the proximal one, y the axis about which the knee
    bends.

    The shank begins at the end of a thigh of the length ``thigh``.
    """
    hip, knee, ankle = (joints[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle"))
    out = 1.0 if side == "left" else -1.0
    hinges: list[FloatArray] = []
    for joint, centre, usual in (("knee", knee, pelvis[..., 1]), ("ankle", ankle, None)):
        marker = tracks.get(f"{side}_{joint}")
        beside = None if marker is None else out * (marker - centre)
        usual = hinges[0] if usual is None else usual
        hinges.append(usual if beside is None or np.linalg.norm(beside, axis=-1).min() < 0.01 else beside)
    upper = _along_z(hip - knee, hinges[0])
    return upper, _along_z(hip - thigh * upper[..., 2] - ankle, hinges[1])


def arm_axes(
    joints: Tracks, tracks: Tracks, side: str, thorax: FloatArray, shoulder: FloatArray, length: float
) -> tuple[FloatArray, FloatArray]:
    """Axes (F, 3, 3) of upper arm and forearm: y along the bone to the left, z up if the palm is down and the elbow
    bends forward.

    The arm begins at the body's ``shoulder`` (F, 3), and the forearm at the end of an upper arm of the given
    ``length``. A forearm whose wrist has no two markers bends about the axis of its elbow and does not twist.
    """
    elbow, wrist = (joints[f"{side}_{joint}"] for joint in ("elbow", "wrist"))
    out = 1.0 if side == "left" else -1.0
    upper = out * (elbow - shoulder)
    lower = out * (wrist - shoulder) - length * normalized(upper)
    thumb, little = tracks.get(f"{side}_wrist"), tracks.get(f"{side}_outer_wrist")
    across = None if thumb is None or little is None else thumb - little
    along, bend = normalized(upper), normalized(wrist - elbow)
    forward = bend - np.sum(bend * along, axis=-1, keepdims=True) * along
    bent = np.linalg.norm(forward, axis=-1, keepdims=True)
    steady = _STEADY * np.clip(1.0 - bent / _STEADY, 0.0, 1.0) ** 2
    arm = frame_of(upper, forward + steady * normalized(thorax[..., 0] if across is None else across))
    return arm, frame_of(lower, np.cross(lower, arm[..., 2]) if across is None else across)


def hand_axes(joints: Tracks, tracks: Tracks, side: str, forearm: FloatArray) -> FloatArray:
    """Axes (F, 3, 3) of a hand: y along it to the left, x to the side of the thumb.

    They are those of the forearm if no marker is beyond the wrist.
    """
    wrist = joints[f"{side}_wrist"]
    reach = tracks.get(f"{side}_hand", wrist) - wrist
    if np.median(np.linalg.norm(reach, axis=-1)) < SHORTEST_HAND_METRES:
        return forearm
    return frame_of((1.0 if side == "left" else -1.0) * reach, forearm[..., 0])


def foot_axes(joints: Tracks, tracks: Tracks, side: str, shank: FloatArray, shown: NDArray[np.bool_]) -> FloatArray:
    """Axes (F, 3, 3) of a foot: x forward along it, level where the foot is lowest among the frames ``shown`` (F,).

    A foot without markers is perpendicular to the shank.
    """
    toe = tracks.get(f"{side}_toe")
    if toe is None:
        return shank
    heel = tracks.get(f"{side}_heel", joints[f"{side}_ankle"])
    x = normalized(toe - heel)
    y = normalized(shank[..., 1] - np.sum(shank[..., 1] * x, axis=-1, keepdims=True) * x)
    axes = np.stack([x, y, np.cross(x, y)], axis=-1)
    heights = toe[:, 2] + heel[:, 2]
    standing = shown & (heights <= np.percentile(heights[shown], 20))
    return axes @ _pitch(-np.median(np.arcsin(np.clip(x[standing, 2], -1.0, 1.0))))


def _pelvis(tracks: Tracks, joints: Tracks) -> FloatArray:
    if has_pelvis(tracks):
        return pelvis_frame(tracks)[1]
    left = joints["left_hip"] - joints["right_hip"]
    above = _middle(joints, "shoulder") if "left_shoulder" in joints else None
    up = np.broadcast_to(WORLD_UP, left.shape) if above is None else above - _middle(joints, "hip")
    return frame_of(left, np.cross(left, up))


def _thorax(tracks: Tracks, joints: Tracks, radius: float) -> FloatArray:
    own = thorax_frame(tracks, radius)
    if own is not None:
        return own[1]
    left = joints["left_shoulder"] - joints["right_shoulder"]
    middle = _middle(joints, "shoulder")
    below = _middle(joints, "hip") if "left_hip" in joints else middle - WORLD_UP
    return frame_of(left, np.cross(left, middle - below))


def _neck(tracks: Tracks, joints: Tracks) -> FloatArray:
    if "neck_back" in tracks and "collar" in tracks:
        return 0.5 * (tracks["neck_back"] + tracks["collar"])
    return _middle(joints, "shoulder")


def _levelled(axes: FloatArray, up: FloatArray) -> FloatArray:
    """Axes pitched by one constant angle, so that ``up`` (F, 3) leans neither forward nor back on average."""
    local = np.einsum("fji,fj->fi", axes, normalized(up))
    return axes @ _pitch(-float(np.median(np.arctan2(local[:, 0], local[:, 2]))))


def _pitch(angle: float) -> FloatArray:
    """Rotation such that ``axes @ _pitch(angle)`` has its x axis raised by ``angle`` radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


def _along_z(bone: FloatArray, left: FloatArray) -> FloatArray:
    """Axes with z along ``bone`` and y as near to ``left`` as possible."""
    z = normalized(bone)
    y = normalized(left - np.sum(left * z, axis=-1, keepdims=True) * z)
    return np.stack([np.cross(y, z), y, z], axis=-1)


def mean_rotation(rotations: FloatArray) -> FloatArray:
    """Rotation (3, 3) nearest to the mean of rotations (F, 3, 3)."""
    u, _, v = np.linalg.svd(rotations.mean(axis=0))
    return np.asarray(u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v)


def _middle(joints: Tracks, joint: str) -> FloatArray:
    return np.asarray(0.5 * (joints[f"left_{joint}"] + joints[f"right_{joint}"]))
