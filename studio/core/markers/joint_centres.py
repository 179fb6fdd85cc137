"""Joint centres from markers: by the equations of Plug-in-Gait, or midway between the two sides of a joint.

All lengths are metres, all positions (F, 3) in axes that are fixed in space; NaN in frames in which a marker was not
seen.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.functional import centre_of_rotation, shift_of_centres
from studio.core.markers.marker_map import role_middles
from studio.core.markers.measures import Measures, SideMeasures, has_pelvis, pelvis_frame
from studio.core.markers.roles import SIDE_WORDS
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]
Tracks = Mapping[str, FloatArray]
"""Positions (F, 3) by role."""

_INWARD = 0.05
"""Metres from markers on the outside of a leg in to its middle."""
_TRUNK = ("neck_back", "back", "collar", "breastbone")


def joint_centres(markers: Mapping[str, FloatArray], measures: Measures) -> dict[str, FloatArray]:
    """Joint centres (F, 3) by name (``left_hip``, ``left_knee``, ..., ``right_wrist``), as far as the markers suffice.

    ``markers`` has the markers (F, n, 3) of each role; several markers of a role count as their mean.
    """
    tracks = role_middles(markers)
    joints: dict[str, FloatArray] = {}
    for index, side in enumerate(SIDE_WORDS):
        _leg(markers, tracks, measures.sides[index], side, 1 - 2 * index, joints)
        _arm(tracks, measures, index, joints)
    return joints


def with_hips_of_thighs(markers: Mapping[str, FloatArray], measures: Measures) -> Measures:
    """Measures with both hips moved forward or back in the pelvis so that the thighs have constant lengths.

    The depth of a hip is the least certain result of its regression, and the one that walking shows best; height and
    width remain those of the regression.
    """
    tracks, joints = role_middles(markers), joint_centres(markers, measures)
    if not has_pelvis(tracks) or any(f"{side}_knee" not in joints for side in SIDE_WORDS):
        return measures
    origin, pelvis = pelvis_frame(tracks)
    forward = np.array([1.0, 0.0, 0.0])
    knees = [np.einsum("fji,fj->fi", pelvis, joints[f"{side}_knee"] - origin) for side in SIDE_WORDS]
    shift = shift_of_centres(knees, [own.hip for own in measures.sides], forward)
    left, right = (replace(own, hip=own.hip + shift * forward) for own in measures.sides)
    return replace(measures, sides=(left, right))


def chord(start: FloatArray, marker: FloatArray, wand: FloatArray, offset: float, turn: float = 0.0) -> FloatArray:
    """Joint centre D at the distance ``offset`` from ``marker``, with a right angle at D between ``marker`` and
    ``start``.

    D is in the plane of the three points, on the side away from ``wand``: with e = unit(B - A), w the unit part of (W -
    A) orthogonal to e and s = offset / |AB|, D = A + |AB| c (c e - s w). A rotation by ``turn`` radians about e
    corrects a misplaced wand (Vicon's thigh and shank rotation).
    """
    bone = marker - start
    length = np.linalg.norm(bone, axis=-1, keepdims=True)
    along = normalized(bone)
    aside = wand - start
    aside = normalized(aside - np.sum(aside * along, axis=-1, keepdims=True) * along)
    aside = np.cos(turn) * aside + np.sin(turn) * np.cross(along, aside)
    sine = np.clip(offset / np.where(length > 0.0, length, np.inf), 0.0, 1.0)
    cosine = np.sqrt(1.0 - sine**2)
    return np.asarray(start + length * cosine * (cosine * along - sine * aside))


def thorax_frame(tracks: Tracks, radius: float) -> tuple[FloatArray, FloatArray] | None:
    """Origin (F, 3) under the collar's marker and axes (F, 3, 3), x forward, y left, z up; None if markers
    are missing.
    """
    if any(role not in tracks for role in _TRUNK):
        return None
    c7, t10, collar, breastbone = (tracks[role] for role in _TRUNK)
    z = normalized(0.5 * (c7 + collar) - 0.5 * (t10 + breastbone))
    y = normalized(np.cross(z, 0.5 * (collar + breastbone) - 0.5 * (c7 + t10)))
    x = np.cross(y, z)
    return collar - radius * x, np.stack([x, y, z], axis=-1)


def _leg(
    markers: Mapping[str, FloatArray],
    tracks: Tracks,
    own: SideMeasures,
    side: str,
    out: int,
    joints: dict[str, FloatArray],
) -> None:
    """Add the joint centres of one leg to ``joints``; ``out`` is 1 if the outer side is the left of the
    body, else -1.
    """
    if has_pelvis(tracks):
        origin, pelvis = pelvis_frame(tracks)
        outward = out * pelvis[..., 1]
        joints[f"{side}_hip"] = origin + pelvis @ own.hip
    elif "left_hip" in tracks and "right_hip" in tracks:
        outward = out * normalized(tracks["left_hip"] - tracks["right_hip"])
        joints[f"{side}_hip"] = tracks[f"{side}_hip"] - 0.08 * outward
    else:
        return
    for joint, above, wand, offset, turn in (
        ("knee", "hip", "thigh", own.knee, own.thigh_turn),
        ("ankle", "knee", "shank", own.ankle, own.shank_turn),
    ):
        outer, inner = tracks.get(f"{side}_{joint}"), tracks.get(f"{side}_inner_{joint}")
        if outer is None:
            found = (
                _knee_of_clusters(markers, side, outward) if joint == "knee" else _ankle_of_foot(tracks, joints, side)
            )
            if found is None:
                return
            joints[f"{side}_{joint}"] = found
            continue
        if inner is not None:
            joints[f"{side}_{joint}"] = 0.5 * (outer + inner)
            continue
        start = joints[f"{side}_{above}"]
        beside = tracks.get(f"{side}_{wand}")
        joints[f"{side}_{joint}"] = chord(start, outer, outer + outward if beside is None else beside, offset, turn)


def _knee_of_clusters(markers: Mapping[str, FloatArray], side: str, outward: FloatArray) -> FloatArray | None:
    """Centre about which thigh and shank rotate relative to each other; None without clusters.

    The prior is midway between their markers, which are on the outside.
    """
    thigh, shank = markers.get(f"{side}_thigh"), markers.get(f"{side}_shank")
    if thigh is None or shank is None or min(thigh.shape[1], shank.shape[1]) < 3:
        return None
    usual = 0.5 * (thigh.mean(axis=1) + shank.mean(axis=1)) - _INWARD * outward
    return centre_of_rotation(thigh, shank, usual)


def _ankle_of_foot(tracks: Tracks, joints: Tracks, side: str) -> FloatArray | None:
    """Ankle by proportion: above the rear part of the foot, towards the knee."""
    heel, toe, knee = tracks.get(f"{side}_heel"), tracks.get(f"{side}_toe"), joints.get(f"{side}_knee")
    if heel is None or toe is None or knee is None:
        return None
    return np.asarray(heel + 0.28 * (toe - heel) + 0.045 * normalized(knee - heel))


def _arm(tracks: Tracks, measures: Measures, index: int, joints: dict[str, FloatArray]) -> None:
    side, own, out = SIDE_WORDS[index], measures.sides[index], 1 - 2 * index
    marker = tracks.get(f"{side}_shoulder")
    if marker is None:
        return
    shoulder = _shoulder(tracks, measures, marker, own, out)
    joints[f"{side}_shoulder"] = shoulder
    outer, inner = tracks.get(f"{side}_elbow"), tracks.get(f"{side}_inner_elbow")
    wrists = [tracks[f"{side}_{name}"] for name in ("wrist", "outer_wrist") if f"{side}_{name}" in tracks]
    if outer is None or not wrists:
        return
    wrist = np.mean(wrists, axis=0)
    if inner is not None:
        elbow = 0.5 * (outer + inner)
    else:
        normal = normalized(np.cross(wrist - outer, shoulder - outer))
        elbow = chord(shoulder, outer, outer - out * normal, own.elbow)
    if own.wrist and len(wrists) == 2:
        wrist = wrist + out * own.wrist * normalized(np.cross(wrists[0] - wrists[1], elbow - wrist))
    joints |= {f"{side}_elbow": elbow, f"{side}_wrist": wrist}


def _shoulder(tracks: Tracks, measures: Measures, marker: FloatArray, own: SideMeasures, out: int) -> FloatArray:
    """Shoulder joint, found by the thorax and a wand that points up from the shoulder.

    Without a wand it is ``own.shoulder`` metres from the marker straight towards the opposite hip.
    """
    thorax = thorax_frame(tracks, measures.radius)
    if thorax is not None:
        origin, axes = thorax
        wand = marker - 0.1 * out * np.cross(normalized(marker - origin), axes[..., 0])
        return chord(origin, marker, wand, own.shoulder)
    below = [tracks[role] for role in ("left_front_hip", "right_front_hip", "left_hip", "right_hip") if role in tracks]
    if not below:
        return marker
    middle = np.mean([tracks[f"{side}_shoulder"] for side in SIDE_WORDS if f"{side}_shoulder" in tracks], axis=0)
    down = normalized(np.mean(below, axis=0) - middle)
    return marker + own.shoulder * down
