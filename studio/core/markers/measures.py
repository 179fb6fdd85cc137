"""Measures of the subject of a marker trial: bone widths and positions of the hip joints in the pelvis."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import seen_mask
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]
Tracks = Mapping[str, FloatArray]

USUAL_MARKER_RADIUS_METRES = 0.007
"""Distance in metres from the middle of a marker to the skin, if the file does not state it."""
_THETA, _BETA = 0.5, 0.314
_PUT_ON_EXACTLY = 1e-3
"""Radians within which a wand is where it should be."""
_STORED = {
    "knee": ("KNEEWIDTH", 0.5, 0.118),
    "ankle": ("ANKLEWIDTH", 0.5, 0.078),
    "shoulder": ("SHOULDEROFFSET", 1.0, 0.05),
    "elbow": ("ELBOWWIDTH", 0.5, 0.09),
    "wrist": ("WRISTWIDTH", 0.5, 0.0),
}
"""By joint: the measure's name in a file, its share, and its usual part of the leg."""


@dataclass(frozen=True)
class SideMeasures:
    """Measures of one side in metres: distance of each joint centre from its marker (half the bone and the marker's
    radius).
    """

    hip: FloatArray
    """Hip joint (3,) in the axes of the pelvis, from the middle between its front markers."""
    knee: float
    ankle: float
    shoulder: float
    elbow: float
    wrist: float
    """Distance of the wrist from the bar that carries its two markers; 0 if they stick to the skin."""
    thigh_turn: float = 0.0
    """Angle in radians about the bone from the wand on the thigh to the plane of the knee."""
    shank_turn: float = 0.0


@dataclass(frozen=True)
class Measures:
    """Measures of left and right side, and the radius of the markers; ``words`` describes their source."""

    sides: tuple[SideMeasures, SideMeasures]
    radius: float
    words: str


def hip_in_pelvis(leg: float, mean_leg: float, inter_asis: float, trochanter: float, radius: float) -> FloatArray:
    """Left hip joint (3,) in the axes of the pelvis, in metres (Davis 1991, as in Plug-in-Gait).

    ``trochanter`` is the distance from the front of the pelvis back to the trochanter, by default 0.1288 leg - 48.56
    mm.
    """
    c = 0.115 * mean_leg - 0.0153
    back = (trochanter or 0.1288 * leg - 0.04856) + radius
    return np.array(
        [
            c * np.cos(_THETA) * np.sin(_BETA) - back * np.cos(_BETA),
            0.5 * inter_asis - c * np.sin(_THETA),
            -c * np.cos(_THETA) * np.cos(_BETA) - back * np.sin(_BETA),
        ]
    )


def find_measures(stored: Mapping[str, float], metres: float, tracks: Tracks, centres: Tracks) -> Measures:
    """Measures stored in the file, else those of the joint centres that it stores, else regressed from the markers.

    ``stored`` are the file's measures (``LKNEEWIDTH``), in units of ``metres``. ``tracks`` are by role; ``centres`` are
    the joints (``left_knee``) that a model has left in the file.
    """

    def length(key: str) -> float:
        value = stored.get(key, 0.0) * metres
        return value if 0.0 < value < 3.0 else 0.0

    legs = [length(f"{letter}LEGLENGTH") or _leg_of(tracks, side) for letter, side in (("L", "left"), ("R", "right"))]
    radius = _radius(stored, metres, tracks, centres, length("LKNEEWIDTH"))
    inter_asis = length("INTERASISDISTANCE") or _inter_asis(tracks, legs)
    known = "LKNEEWIDTH" in stored
    sides = []
    for index, (letter, side) in enumerate((("L", "left"), ("R", "right"))):
        trochanter = length(f"{letter}ASISTROCANTERDISTANCE")
        hip = hip_in_pelvis(legs[index], sum(legs) / 2, inter_asis, trochanter, radius) * (1.0, 1 - 2 * index, 1.0)
        offsets = {}
        for joint, (key, share, usual) in _STORED.items():
            beside = share * (length(letter + key) or usual * legs[index])
            offsets[joint] = beside + radius if beside else 0.0
            if not known:
                offsets[joint] = _beside(tracks, centres, f"{side}_{joint}", offsets[joint])
        offsets["thigh_turn"] = wand_turn(tracks, centres, side, "hip", "knee", "thigh")
        offsets["shank_turn"] = wand_turn(tracks, centres, side, "knee", "ankle", "shank")
        sides.append(SideMeasures(hip=hip if known else _stored_hip(tracks, centres, side, hip), **offsets))
    words = "stored in the file" if known else "read off the joint centres in the file" if centres else "usual ones"
    return Measures((sides[0], sides[1]), radius, words)


def has_pelvis(tracks: Tracks) -> bool:
    """True if there are the markers for ``pelvis_frame``: both in front and one behind."""
    fronts = all(role in tracks for role in ("left_front_hip", "right_front_hip"))
    return fronts and ("left_back_hip" in tracks or "right_back_hip" in tracks)


def pelvis_frame(tracks: Tracks) -> tuple[FloatArray, FloatArray]:
    """Origin (F, 3) between the front markers, and axes (F, 3, 3): x forward, y left, z up."""
    left, right = tracks["left_front_hip"], tracks["right_front_hip"]
    origin = 0.5 * (left + right)
    backs = [tracks[role] for role in ("left_back_hip", "right_back_hip") if role in tracks]
    return origin, frame_of(left - right, origin - np.mean(backs, axis=0))


def frame_of(left: FloatArray, forward: FloatArray) -> FloatArray:
    """Axes (..., 3, 3) with y along ``left``, x as near to ``forward`` as possible, and z = x cross y."""
    y = normalized(left)
    x = normalized(forward - np.sum(forward * y, axis=-1, keepdims=True) * y)
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def known_median(values: FloatArray, usual: float) -> float:
    """Median of the known values; ``usual`` if there are none."""
    seen = values[np.isfinite(values)]
    return float(np.median(seen)) if len(seen) else usual


def _stored_hip(tracks: Tracks, centres: Tracks, side: str, usual: FloatArray) -> FloatArray:
    if f"{side}_hip" not in centres or not has_pelvis(tracks):
        return usual
    origin, pelvis = pelvis_frame(tracks)
    local = np.einsum("fji,fj->fi", pelvis, centres[f"{side}_hip"] - origin)
    seen = local[seen_mask(local)]
    return np.asarray(np.median(seen, axis=0)) if len(seen) else usual


def _beside(tracks: Tracks, centres: Tracks, role: str, usual: float) -> float:
    if role not in tracks or role not in centres:
        return usual
    return known_median(np.linalg.norm(tracks[role] - centres[role], axis=-1), usual)


def wand_turn(tracks: Tracks, centres: Tracks, side: str, above: str, joint: str, wand: str) -> float:
    """Angle in radians about the bone from the plane of a wand to a stored joint centre; 0 if it is unknown."""
    near, far = centres.get(f"{side}_{above}"), centres.get(f"{side}_{joint}")
    marker, beside = tracks.get(f"{side}_{joint}"), tracks.get(f"{side}_{wand}")
    if near is None or far is None or marker is None or beside is None:
        return 0.0
    along = normalized(marker - near)
    to_wand, to_joint = np.cross(along, beside - near), np.cross(along, near - far)
    sine = np.sum(np.cross(to_wand, to_joint) * along, axis=-1)
    turn = known_median(np.arctan2(sine, np.sum(to_wand * to_joint, axis=-1)), 0.0)
    return turn if abs(turn) > _PUT_ON_EXACTLY else 0.0


def _radius(stored: Mapping[str, float], metres: float, tracks: Tracks, centres: Tracks, knee: float) -> float:
    """Marker radius with which stored joint centres were computed.

    The marker of a knee lies half the knee's width and one radius beside its centre.
    """
    if knee:
        within = _beside(tracks, centres, "left_knee", 0.0) - 0.5 * knee
        if 0.0 < within < 0.03:
            return within
    diameter = stored.get("MARKERDIAMETER", stored.get("MARKER_DIAMETER", 0.0)) * metres
    return 0.5 * diameter if 0.004 < diameter < 0.06 else USUAL_MARKER_RADIUS_METRES


def _leg_of(tracks: Tracks, side: str) -> float:
    """Leg length from the front of the pelvis over the knee to the ankle, as measured by a tape."""
    way = [tracks.get(f"{side}_{part}") for part in ("front_hip", "knee", "ankle")]
    hip, knee, ankle = way
    if hip is None or knee is None or ankle is None:
        return 0.9
    lengths = np.linalg.norm(knee - hip, axis=-1) + np.linalg.norm(ankle - knee, axis=-1)
    return known_median(lengths, 0.9)


def _inter_asis(tracks: Tracks, legs: list[float]) -> float:
    if "left_front_hip" not in tracks or "right_front_hip" not in tracks:
        return 0.27 * sum(legs) / 2
    return known_median(np.linalg.norm(tracks["left_front_hip"] - tracks["right_front_hip"], axis=-1), 0.24)
