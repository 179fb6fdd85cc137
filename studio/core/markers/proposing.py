"""Proposal of a marker map for an unknown set: by the words in its labels, then by the positions of the markers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.feet import TOE_ROLES
from studio.core.markers.label_words import initials_of, side_and_part, with_english_sides
from studio.core.markers.marker_map import MarkerMap, seen_labels
from studio.core.markers.roles import ROLES_BY_ID, SIDE_WORDS
from studio.core.markers.subjects import shared_beginning
from studio.core.markers.told_centres import label_without_side, measured_centre_labels, pelvis_width
from studio.core.markers.trial import Trial, seen_mask
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]

PROPOSED_MAP_NAME = "proposed from marker names and positions"
"""Name of the proposed maps of unknown marker sets."""
_ACROSS = 0.7
"""Cosine of the angle from straight across the body within which two markers are on either side of a joint."""
_ALONG = 0.5
"""Cosine of the angle from straight along an arm beyond which they are not."""
_WELL_SEEN = 0.8
"""Fraction of the markers of the best frame that a frame must show."""
_MOST_FRAMES = 600
"""Frames that are enough to know where markers lie on a body."""
_LOW = 0.1
"""Parts of the pelvis' width over the lowest marker of a standing foot within which another lies beside the sole."""
_ON_THE_FOOT = 1.0
"""Parts of the pelvis' width from the ankle within which a heel is."""
_HALF_FOOT = 0.27
"""Parts of the pelvis' width from the fifth metatarsal to the middle of the foot, at most."""


@dataclass(frozen=True)
class _Marker:
    """Marker with its label and positions."""

    label: str
    track: FloatArray
    """(F, 3) metres, file axes; NaN where not seen."""


_Found = dict[tuple[str, str], list[_Marker]]
"""Markers by side and part."""


def propose_map(trial: Trial, subject: str = "") -> MarkerMap:
    """Marker map proposed by words in the labels, and refined by the positions of the markers.

    Positions show pairs on both sides of a joint, and clusters on pelvis and feet.
    """
    found = _by_words(trial, subject)
    _name_single_feet(found)
    centres, found = _apart_from_centres(found)
    _sort_pelvis(found)
    leftward = _leftward(found)
    forward = np.cross(leftward, _upward(found))
    for side, outward in zip(SIDE_WORDS, (leftward, -leftward), strict=True):
        for joint in ("knee", "ankle"):
            _sort_pair(found, side, joint, outward)
        _sort_elbows(found, side, outward)
        for role, marker in zip(
            ("wrist", "outer_wrist"), _sorted(found.pop((side, "wrists"), []), forward), strict=False
        ):
            found.setdefault((side, role), []).append(marker)
        _sort_foot(found, side, outward)
    _sort_foot_clusters(found, forward)
    markers: dict[str, tuple[str, ...]] = {}
    for (side, part), own in found.items():
        role = f"{side}_{part}" if side else part
        limit = None if part in ("thigh", "shank", "hand") else 1
        markers[role] = tuple(marker.label for marker in own[:limit])
    sacrum = markers.pop("sacrum", ())
    for side in SIDE_WORDS:
        if behind := markers.pop(f"{side}_sacrum", sacrum):
            markers.setdefault(f"{side}_back_hip", behind)
    return MarkerMap(PROPOSED_MAP_NAME, {r: m for r, m in markers.items() if r in ROLES_BY_ID}, centres)


def _by_words(trial: Trial, subject: str) -> _Found:
    """Markers whose labels name their positions, in frames spread over the trial."""
    labels = seen_labels(trial, subject)
    if not labels:
        return {}
    points = trial.points[:, [trial.labels.index(label) for label in labels]]
    seen = seen_mask(points)
    well_seen = np.flatnonzero(seen.sum(axis=1) >= _WELL_SEEN * seen.sum(axis=1).max())
    spread = well_seen[np.linspace(0, len(well_seen) - 1, _MOST_FRAMES).astype(int)]
    frames = np.union1d(spread, seen.argmax(axis=0))
    beginning = shared_beginning(list(labels.values()))
    sided = with_english_sides([label.removeprefix(beginning) for label in labels.values()])
    found: _Found = {}
    open_markers: dict[str, _Marker] = {}
    for index, bare in enumerate(labels.values()):
        own, marker = sided[bare.removeprefix(beginning)], _Marker(bare, trial.metres * points[frames, index])
        said = side_and_part(own)
        if said is not None:
            found.setdefault(said, []).append(marker)
        else:
            open_markers[own] = marker
    for own, marker in open_markers.items():
        side, parts = initials_of(own)
        if part := next((each for each in parts if (side, each) not in found), None):
            found[side, part] = [marker]
    return found


def _apart_from_centres(found: _Found) -> tuple[dict[str, str], _Found]:
    """Labels of joint centres by joint, and the remaining markers.

    A joint centre is recognised by its label, or by measure if markers of its joint remain or a whole leg of centres is
    there.
    """
    named = {(s, part.removesuffix(" centre")): own for (s, part), own in found.items() if part.endswith(" centre")}
    told = measured_centre_labels(*_labelled(found))
    names = {joint.partition("_")[2] for joint in told}
    left = {place: [marker for marker in own if marker.label not in told.values()] for place, own in found.items()}
    if not (
        names >= {"hip", "knee", "ankle"} or all(left.get((s, n)) or n == "hip" for s in SIDE_WORDS for n in names)
    ):
        told, left = {}, found
    centres = told | {f"{side}_{joint}": own[0].label for (side, joint), own in named.items()}
    return centres, {place: own for place, own in left.items() if own}


def _leftward(found: _Found) -> FloatArray:
    """Directions (F, 3) from right to left: along the pelvis, the hips or the shoulders, else between all markers."""
    for part in ("front_hip", "hip", "shoulder"):
        pair = [found[side, part][0].track for side in SIDE_WORDS if (side, part) in found]
        if len(pair) == 2:
            return normalized(pair[0] - pair[1])
    sides = [
        [marker.track for (own, _), many in found.items() if own == side for marker in many] for side in SIDE_WORDS
    ]
    if not all(sides):
        return np.zeros(3)
    return normalized(_mean(sides[0]) - _mean(sides[1]))


def _mean(tracks: list[FloatArray]) -> FloatArray:
    """Mean (F, 3) of the tracks that are seen; NaN if none is."""
    seen = np.array([seen_mask(track) for track in tracks])[..., None]
    count = seen.sum(axis=0)
    return np.asarray(np.where(seen, tracks, 0.0).sum(axis=0) / np.where(count, count, np.nan))


def _average(values: FloatArray) -> float:
    """Mean of the values that are not NaN; 0 if there are none."""
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else 0.0


def _along(vectors: FloatArray, directions: FloatArray) -> float:
    """Mean component of vectors (F, 3) along unit directions (F, 3)."""
    return _average(np.sum(vectors * directions, axis=-1))


def _sorted(markers: list[_Marker], directions: FloatArray) -> list[_Marker]:
    """Markers in the order of their position along directions (F, 3), the farthest first."""
    return sorted(markers, key=lambda marker: -_along(marker.track - markers[0].track, directions))


def _sort_pair(found: _Found, side: str, joint: str, outward: FloatArray) -> None:
    """Sort two markers at one joint into the outer and the inner one, if they are on either side of it."""
    own = found.get((side, joint), [])
    if len(own) < 2 or (side, f"inner_{joint}") in found:
        return
    outer, *_, inner = _sorted(own, outward)
    if _along(normalized(outer.track - inner.track), outward) > _ACROSS:
        found[side, f"inner_{joint}"], found[side, joint] = [inner], [outer]


def _sort_elbows(found: _Found, side: str, outward: FloatArray) -> None:
    """Sort two markers at an elbow: the one farther from the body, perpendicular to the arm, is the outer one."""
    own, ends = found.get((side, "elbow"), []), found.get((side, "shoulder"), []) + found.get((side, "wrists"), [])
    if len(own) < 2 or (side, "inner_elbow") in found or not ends:
        return
    one, other = own[:2]
    between = normalized(one.track - other.track)
    arms = [normalized(end.track - 0.5 * (one.track + other.track)) for end in ends]
    if max(abs(_along(between, arm)) for arm in arms) < _ALONG:
        out = _along(one.track - other.track, outward) >= 0.0
        found[side, "elbow"], found[side, "inner_elbow"] = ([one], [other]) if out else ([other], [one])


def _sort_pelvis(found: _Found) -> None:
    """Sort the markers of the pelvis: hips in front of a sacrum are its front; four unnamed markers are its corners."""
    hips = [found.get((side, "hip"), []) for side in SIDE_WORDS]
    if all(hips) and ("", "sacrum") in found and ("left", "front_hip") not in found:
        for side in SIDE_WORDS:
            found[side, "front_hip"] = found.pop((side, "hip"))
    cluster, leftward = found.pop(("", "pelvis"), []), _leftward(found)
    if len(cluster) != 4 or not leftward.any():
        return
    forward = np.cross(leftward, _upward(found))
    middle = _mean([marker.track for marker in cluster])
    for marker in cluster:
        side = "left" if _along(marker.track - middle, leftward) > 0.0 else "right"
        end = "front_hip" if _along(marker.track - middle, forward) > 0.0 else "back_hip"
        found.setdefault((side, end), []).append(marker)


def _sort_foot(found: _Found, side: str, outward: FloatArray) -> None:
    """Sort the markers of a foot: a heel is told from a hand by the ankle near it.

    A single metatarsal is taken as the fifth; of two, the outer one is.
    """
    width = pelvis_width(*_labelled(found))
    ankles = found.get((side, "ankle"), [])
    if ankles and width:
        near = [m for m in found.get((side, "heel"), []) if _distance(m, ankles[0]) < _ON_THE_FOOT * width]
        found[side, "heel"] = near
    balls = _sorted(found.pop((side, "met"), []), outward)
    if not balls:
        return
    found.setdefault((side, "outer_toe"), balls[:1])
    if len(balls) > 1 and width:
        middle = _distance(balls[0], balls[1]) < _HALF_FOOT * width
        found.setdefault((side, "toe" if middle else "inner_toe"), balls[1:2])


def _sort_foot_clusters(found: _Found, forward: FloatArray) -> None:
    """Choose heel and toe of unnamed clusters on the feet: the two beside the sole that are farthest apart in the
    forward direction.

    Equal labels of both sides give equal choices.
    """
    feet = {side: found.pop((side, "foot"), []) for side in SIDE_WORDS}
    up, width = _upward(found), pelvis_width(*_labelled(found))
    ahead: dict[str, list[float]] = {}
    high: dict[str, list[float]] = {}
    for side, foot in feet.items():
        if not foot:
            continue
        heights = [float(np.nanpercentile(marker.track @ up, 10)) for marker in foot]
        middle = _mean([marker.track for marker in foot])
        for marker, height in zip(foot, heights, strict=True):
            name = label_without_side(marker.label, side)
            ahead.setdefault(name, []).append(_along(marker.track - middle, forward))
            high.setdefault(name, []).append(height - min(heights))
    for side, foot in feet.items():
        names = {marker.label: label_without_side(marker.label, side) for marker in foot}
        low = [marker for marker in foot if not width or np.mean(high[names[marker.label]]) < _LOW * width]
        if len(low) > 1 and not {(side, part) for part in TOE_ROLES} & found.keys():
            low.sort(key=lambda marker: float(np.mean(ahead[names[marker.label]])))
            found[side, "heel"], found[side, "toe"] = [low[0]], [low[-1]]


def _name_single_feet(found: _Found) -> None:
    """Name the single foot point on each side of a set of joints: the ankle if none is named, else the toe."""
    part = "toe" if ("left", "ankle") in found else "ankle"
    single = all(len(found.get((side, "foot"), ())) == 1 and (side, part) not in found for side in SIDE_WORDS)
    if single and ("left", "front_hip") not in found:
        for side in SIDE_WORDS:
            found[side, part] = found.pop((side, "foot"))


def _labelled(found: _Found) -> tuple[dict[tuple[str, str], list[str]], dict[str, FloatArray]]:
    """Labels by side and part, and tracks by label."""
    labels = {place: [marker.label for marker in own] for place, own in found.items()}
    return labels, {marker.label: marker.track for own in found.values() for marker in own}


def _distance(one: _Marker, other: _Marker) -> float:
    return _average(np.linalg.norm(one.track - other.track, axis=-1))


def _upward(found: _Found) -> FloatArray:
    """Axis of the file (3,) that points from shanks to pelvis or thighs; the file's Z if these are unknown."""
    low = [m.track for (_, part), many in found.items() if part in ("shank", "ankle", "toe", "foot") for m in many]
    high = [m.track for (_, part), many in found.items() if part in ("thigh", "front_hip", "shoulder") for m in many]
    if not (low and high):
        return np.array([0.0, 0.0, 1.0])
    way = np.nanmean(_mean(high) - _mean(low), axis=0)
    axis = int(np.argmax(np.abs(way)))
    return np.asarray(np.eye(3)[axis] * np.sign(way[axis]))
