"""Recognition, by measure, of joint centres of a model among points that are labelled knee or ankle.

Markers on the outer sides of two knees are, at the nearest, farther apart than those on the front of the pelvis (1.05
to 1.4 times in walks), joint centres are nearer (0.57 to 0.82 times).
"""

import re
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.roles import SIDE_WORDS
from studio.core.markers.trial import seen_mask

FloatArray = NDArray[np.float64]
Labels = Mapping[tuple[str, str], Sequence[str]]
"""Labels by side and part."""

INNER_PELVIS_FRACTION = 0.93
"""Fraction of the pelvis' width; two points of a joint that are nearer to each other are not markers on the outer
sides.
"""
HIP_CENTRE_LEG_FRACTION = 0.3
"""Fraction of the leg length; two hip points that are nearer are joint centres (0.20 to 0.25; trochanters 0.35 to
0.45).
"""
KEYPOINT_PARTS = {
    "hip": "hip",
    "knee": "knee",
    "ankle": "ankle",
    "shoulder": "shoulder",
    "elbow": "elbow",
    "wrist": "wrists",
}
"""Parts of labels of image keypoints, by joint."""
CENTRE_DEPTHS = {"hip": 1.0, "knee": 0.4, "ankle": 0.27}
"""Greatest distance from an outer marker to a joint's centre as a fraction of the pelvis' width; an inner marker is
farther.
"""


def measured_centre_labels(labels: Labels, tracks: Mapping[str, FloatArray]) -> dict[str, str]:
    """Label of the centre of each joint (``left_knee``) that can be recognised; ``tracks`` (F, 3), metres, are by
    label.
    """
    if _are_keypoints(labels, tracks):
        parts = [(joint, part) for joint, part in KEYPOINT_PARTS.items() if _is_alone(labels, part)]
        return {f"{side}_{joint}": labels[side, part][0] for joint, part in parts for side in SIDE_WORDS}
    width = pelvis_width(labels, tracks)
    centres: dict[str, str] = {}
    for joint in ("hip", "knee", "ankle"):
        pairs = _pairs(labels, joint)
        apart = {pair: _nearest(tracks[pair[0]], tracks[pair[1]]) for pair in pairs}
        for pair in pairs:
            wider = [other for other in pairs if apart[other] > apart[pair]]
            beside = [_nearest(tracks[pair[0]], tracks[other[0]]) for other in wider]
            deep = not wider or min(beside) < CENTRE_DEPTHS[joint] * width
            narrow = (
                apart[pair] < INNER_PELVIS_FRACTION * width if joint != "ankle" or wider else "left_knee" in centres
            )
            if narrow and deep and (wider or joint != "hip" or ("left", "front_hip") in labels):
                centres |= {f"{side}_{joint}": label for side, label in zip(SIDE_WORDS, pair, strict=True)}
    return centres


def _are_keypoints(labels: Labels, tracks: Mapping[str, FloatArray]) -> bool:
    """True if the points are joints from an image or a model: one for each joint, and hips too near each other for
    markers.
    """
    if ("left", "front_hip") in labels or not all(_is_alone(labels, part) for part in ("hip", "knee", "ankle")):
        return False
    hips, knees, ankles = ([tracks[labels[side, part][0]] for side in SIDE_WORDS] for part in ("hip", "knee", "ankle"))
    legs = [
        np.nanmedian(np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1))
        for hip, knee, ankle in zip(hips, knees, ankles, strict=True)
    ]
    return bool(_nearest(*hips) < HIP_CENTRE_LEG_FRACTION * np.mean(legs))


def _is_alone(labels: Labels, part: str) -> bool:
    """True if each side has one point of that part, and none on its inner side."""
    return all(len(labels.get((s, part), ())) == 1 and (s, f"inner_{part}") not in labels for s in SIDE_WORDS)


def pelvis_width(labels: Labels, tracks: Mapping[str, FloatArray]) -> float:
    """Distance in metres between the front markers of the pelvis, else between its sides; 0 if there are none."""
    for part in ("front_hip", "hip"):
        sides = [labels.get((side, part), ()) for side in SIDE_WORDS]
        if all(sides):
            left, right = (tracks[own[0]] for own in sides)
            return _nearest(left, right)
    return 0.0


def _pairs(labels: Labels, part: str) -> list[tuple[str, str]]:
    """Left and right labels that differ only in their side."""
    right = {label_without_side(label, "right"): label for label in labels.get(("right", part), ())}
    left = ((label_without_side(label, "left"), label) for label in labels.get(("left", part), ()))
    return [(label, right[plain]) for plain, label in left if plain in right]


def label_without_side(label: str, side: str) -> str:
    """Label without its side: ``knee`` for ``L.Knee``, whatever sign separates them."""
    return re.sub(rf"^({side}|{side[0]})|({side}|{side[0]})$", "", label.lower(), count=1).strip(" ._-")


def _nearest(one: FloatArray, other: FloatArray) -> float:
    """Distance in metres of two tracks in the twentieth of the frames in which they are nearest.

    It is 0 if they are never seen together.
    """
    seen = seen_mask(one) & seen_mask(other)
    return float(np.percentile(np.linalg.norm(one[seen] - other[seen], axis=1), 5)) if seen.any() else 0.0
