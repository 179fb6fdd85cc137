"""Detection of markers labelled with the wrong side of the body throughout a take.

The left side is found without the labels of sides: from the front of the body and its up direction.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.feet import TOE_ROLES
from studio.core.markers.joint_centres import joint_centres
from studio.core.markers.marker_map import MarkerMap, role_markers, role_middles, stored_centres
from studio.core.markers.measures import find_measures
from studio.core.markers.roles import SIDE_WORDS
from studio.core.markers.trial import Trial
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]
Tracks = Mapping[str, FloatArray]

_FRONT_AND_BACK = (
    ("front_hip", "back_hip"),
    ("collar", "neck_back"),
    ("breastbone", "back"),
    ("toe", "heel"),
    ("front_head", "back_head"),
)
_HIGH, _LOW = ("neck_back", "shoulder", "front_hip", "hip"), ("ankle", "heel", "toe", "knee", "front_hip")
_GIRDLES = ("front_hip", "back_hip", "hip", "shoulder", "front_head", "back_head")
"""Places that are sorted by where they lie on the body alone."""
_LINKS = (
    ("hip", ("knee", "inner_knee", "thigh")),
    ("knee", ("ankle", "inner_ankle", "shank")),
    ("thigh", ("shank",)),
    ("shank", ("heel",)),
    ("ankle", ("heel",)),
    ("heel", TOE_ROLES),
    ("ankle", TOE_ROLES),
    ("shoulder", ("elbow", "inner_elbow", "upper_arm")),
    ("elbow", ("wrist", "outer_wrist", "forearm")),
    ("wrist", ("hand",)),
)
"""Joints, and the places that stay as far from them as they are, the surest first; from the trunk outwards."""
_MOST_FRAMES = 600
_SHORTER, _CLEARLY_SHORTER, _STEADIER = 0.98, 0.94, 0.8
"""Parts of its length, and of its spread, below which a link to the other side is the better one: by its length alone,
or by both."""
_RIGID, _FOLDED, _FARTHER = 0.1, 0.6, 1.5
"""Part of its length by which a link of a bone changes at most, and below which the other side's is none: in folded
limbs knees and elbows lie beside the other side's ankles and wrists. Length in that of the bone before it beyond which
it is no bone."""
_BEFORE = {"knee": "hip", "elbow": "shoulder"}
"""Joint at the other end of the bone before a limb's middle."""


def exchanged_places(trial: Trial, marker_map: MarkerMap, subject: str = "") -> tuple[str, ...]:
    """Roles without their side (``knee``) whose left and right markers are exchanged most of the time."""
    frames = np.unique(np.linspace(0, trial.frame_count - 1, _MOST_FRAMES).astype(int))
    few = replace(trial, points=trial.points[frames], residuals=trial.residuals[frames])
    markers, centres = role_markers(few, marker_map, subject), stored_centres(few, marker_map, subject)
    leftward = _leftward(role_middles(markers) | centres)
    found: list[str] = []

    def exchange(name: str) -> None:
        found.append(name)
        for tracks in (markers, centres):
            left, right = (tracks.pop(f"{side}_{name}", None) for side in SIDE_WORDS)
            tracks |= {
                f"{side}_{name}": own for side, own in zip(SIDE_WORDS, (right, left), strict=True) if own is not None
            }

    for name in _GIRDLES:
        if _is_mirrored(role_middles(markers) | centres, name, leftward):
            exchange(name)
    for joint, names in _LINKS:
        tracks = role_middles(markers)
        measures = find_measures(few.measures, few.metres, tracks, centres)
        joints = tracks | joint_centres(markers, measures) | centres
        for name in names:
            ends = role_middles(markers) | centres
            along = joint in found or names[0] in found
            if _is_mirrored(ends, name, leftward) and (along or _is_crossed(joints, joint, ends, name)):
                exchange(name)
    return tuple(found)


def with_sides_exchanged(marker_map: MarkerMap, names: tuple[str, ...]) -> MarkerMap:
    """Map with left and right markers and centres exchanged for the roles ``names`` (without their side)."""
    other = {f"{one}_{name}": f"{two}_{name}" for one, two in (SIDE_WORDS, SIDE_WORDS[::-1]) for name in names}
    markers = {other.get(role, role): labels for role, labels in marker_map.markers.items()}
    centres = {other.get(joint, joint): label for joint, label in marker_map.centres.items()}
    return replace(marker_map, markers=markers, centres=centres)


def _leftward(tracks: Tracks) -> FloatArray:
    """Directions (F, 3) to the left of the body, perpendicular to its front and up directions."""
    forward = [
        normalized(front - back)
        for one, other in _FRONT_AND_BACK
        if (front := middle_of(tracks, one)) is not None and (back := middle_of(tracks, other)) is not None
    ]
    high, low = high_and_low(tracks)
    if not forward or high is None or low is None:
        return np.full((1, 3), np.nan)
    return normalized(np.cross(high - low, np.nansum(forward, axis=0)))


def high_and_low(tracks: Tracks) -> tuple[FloatArray | None, FloatArray | None]:
    """Positions (F, 3) in the middle of the body, one high and one low on it; None for one without markers."""
    high, low = (
        next((each for name in names if (each := middle_of(tracks, name)) is not None), None) for names in (_HIGH, _LOW)
    )
    return high, low


def middle_of(tracks: Tracks, name: str) -> FloatArray | None:
    """Mean of left and right markers, which does not depend on their order."""
    if name in tracks:
        return tracks[name]
    pair = [tracks[f"{side}_{name}"] for side in SIDE_WORDS if f"{side}_{name}" in tracks]
    return np.asarray(0.5 * (pair[0] + pair[1])) if len(pair) == 2 else None


def _is_mirrored(tracks: Tracks, name: str, leftward: FloatArray) -> bool:
    """True if the left marker is to the right of the right one most of the time."""
    if any(f"{side}_{name}" not in tracks for side in SIDE_WORDS):
        return False
    apart = np.sum((tracks[f"left_{name}"] - tracks[f"right_{name}"]) * leftward, axis=-1)
    known = apart[np.isfinite(apart)]
    return bool(len(known)) and float(np.median(known)) < 0.0


def _is_crossed(joints: Tracks, joint: str, ends: Tracks, name: str) -> bool:
    """True if the bones from joints to ends would be shorter and more constant with left and right ends exchanged."""
    if any(f"{side}_{joint}" not in joints for side in SIDE_WORDS):
        return False
    own, across = (
        [
            np.linalg.norm(joints[f"{one}_{joint}"] - ends[f"{two}_{name}"], axis=-1)
            for one, two in zip(SIDE_WORDS, order, strict=True)
        ]
        for order in (SIDE_WORDS, SIDE_WORDS[::-1])
    )
    seen = np.isfinite(np.sum([*own, *across], axis=0))
    if not seen.any():
        return False
    lengths = [float(np.median(np.concatenate([each[seen] for each in links]))) for links in (own, across)]
    spreads = [float(np.sum([np.std(each[seen]) for each in links])) for links in (own, across)]
    folded = joint not in ("hip", "shoulder") and lengths[1] < _FOLDED * lengths[0]
    before = [f"{side}_{_BEFORE.get(joint)}" for side in SIDE_WORDS]
    if folded and all(name in joints for name in before):
        bones = [joints[f"{side}_{joint}"] - joints[name] for side, name in zip(SIDE_WORDS, before, strict=True)]
        folded = lengths[0] < _FARTHER * float(np.nanmedian(np.linalg.norm(bones, axis=-1)))
    if folded and spreads[0] < _RIGID * lengths[0]:
        return False
    steadier = spreads[1] < _STEADIER * spreads[0]
    return lengths[1] < (_SHORTER if steadier else _CLEARLY_SHORTER) * lengths[0]
