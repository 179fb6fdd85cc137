"""A marker map proposed for a set that nobody knows: by the words in its labels, then by where the markers are."""

import re
from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.marker_map import MarkerMap, seen_labels
from studio.core.markers.roles import ROLE, SIDES
from studio.core.markers.told_centres import told_centres
from studio.core.markers.trial import Trial, whole

FloatArray = NDArray[np.float64]

_WORDS: tuple[tuple[str, str], ...] = (
    ("back_hip", r"psis?|bwt|ips|waist.?back|back.?waist|hip.?back"),
    ("front_hip", r"asis?|fwt|ias|waist.?front|front.?waist|hip.?front"),
    ("sacrum", r"v?\.?sacr?(um|al)?|s1"),
    ("pelvis", r"pv\d*|pelv(is)?\d*|waist\d*"),
    ("inner_knee", r"fme|mknee?|knee?.?(m|med|medial|in|inner|int)"),
    ("knee", r"knee?|fle|lk|knee?.?(l|lat|lateral|out|outer|ext)"),
    ("inner_ankle", r"tam|mank(le)?|mm|ank(le)?.?(m|med|medial|in|inner|int)"),
    ("ankle", r"ank(le)?|fal|lm|mall?(eolus)?|ank(le)?.?(l|lat|lateral|out|outer|ext)"),
    ("heel", r"hee?l?|heel.?back|calc(aneus)?|fcc|ca"),
    ("toe", r"toe|toe.?tip|fm[125]|mt2|met|foo\d*|toe.?(in|out)?"),
    ("foot", r"ft\d*|foot\d*"),
    ("thigh", r"bar.?1|thi(gh)?\d*|th\d*|femur\d*|uleg\d*"),
    ("shank", r"bar.?2|sha(nk)?\d*|shi?n\d*|tib(ia)?\d*|ttc|fax|sk\d*|lleg\d*"),
    ("hip", r"hip|gt|ftc|troch(anter)?"),
    ("shoulder", r"sho(ulder)?|should|saj|acr(omion)?|shoulder.?top|sho.?top"),
    ("inner_elbow", r"elb(ow)?.?(m|med|medial|in|inner|int)|hme"),
    ("elbow", r"elb(ow)?|hle|elb(ow)?.?(l|lat|lateral|out|outer|ext)"),
    ("wrist", r"wra|wrist?.?(a|in|inner|thumb|rad(ius)?)|rsp|rhe"),
    ("outer_wrist", r"wrb|wrist?.?(b|out|outer|uln(a)?)|usp|uhe"),
    ("wrists", r"wri(st)?\d*"),
    ("hand", r"fin(ger)?|hm[235]|hand\d*|knu(ckle)?|hand.?(in|out)"),
    ("upper_arm", r"upa|uarm\d*|upper.?arm\d*|arm\d*"),
    ("forearm", r"fra|frm|farm\d*|fore.?arm\d*"),
    ("front_head", r"fhd|hdf|front.?head|head.?front"),
    ("back_head", r"bhd|hdb|back.?head|head.?back"),
)
_MIDDLE_WORDS: tuple[tuple[str, str], ...] = (
    ("neck_back", r"cv?7|spine.?top|neck"),
    ("back", r"tv?(8|9|10|12)|spine.?(mid|thoracic\d*)"),
    ("collar", r"clav(icle)?|ij|sjn|cl|notch|jug(ular)?|collar"),
    ("breastbone", r"strn|stern(um)?|px|sxs|xip(h|hoid)?|chest"),
    ("sacrum", r"v?\.?sacr?(um|al)?|s1"),
)
_ACROSS = 0.7
"""Cosine of the angle from straight across the body within which two markers are on either side of a joint."""
_NUMBERED = re.compile(r"[_ ]\d+$")


@dataclass(frozen=True)
class _Marker:
    label: str
    place: FloatArray
    """(3,) metres, its median over frames in which most markers are seen."""


def propose_map(trial: Trial, subject: str = "") -> MarkerMap:
    """What the labels say, sorted out by geometry: pairs on both sides of a joint, clusters on pelvis and feet."""
    found = _by_words(trial, subject)
    centres = _take_centres(found, trial, subject)
    markers: dict[str, tuple[str, ...]] = {}
    outward = _leftward(found)
    for side in SIDES:
        sign = 1.0 if side == "left" else -1.0
        for joint in ("knee", "ankle", "elbow"):
            _sort_pair(found, side, joint, sign * outward)
        pair = found.pop((side, "wrists"), [])
        for role, marker in zip(("wrist", "outer_wrist"), pair, strict=False):
            found.setdefault((side, role), []).append(marker)
    _sort_pelvis(found, outward)
    _sort_feet(found)
    for (side, part), own in found.items():
        role = f"{side}_{part}" if side else part
        limit = None if part in ("thigh", "shank") else 1
        markers[role] = tuple(marker.label for marker in own[:limit])
    sacrum = markers.pop("sacrum", ())
    for side in SIDES:
        if behind := markers.pop(f"{side}_sacrum", sacrum):
            markers.setdefault(f"{side}_back_hip", behind)
    return MarkerMap("proposed by names and places", {r: m for r, m in markers.items() if r in ROLE}, centres)


def _take_centres(found: dict[tuple[str, str], list[_Marker]], trial: Trial, subject: str) -> dict[str, str]:
    """Joint centres by joint, taken out of what was ``found`` where markers of their joint remain."""
    written = {bare: label for label, bare in seen_labels(trial, subject).items()}
    labels = {place: [marker.label for marker in own] for place, own in found.items()}
    tracks = {bare: trial.metres * trial.track(written[bare]) for own in labels.values() for bare in own}
    told = told_centres(labels, tracks)
    names = {joint.partition("_")[2] for joint in told}
    left = {place: [each for each in own if each.label not in told.values()] for place, own in found.items()}
    if not all(left.get((side, name)) or name == "hip" for side in SIDES for name in names):
        return {}
    found.clear()
    found |= {place: own for place, own in left.items() if own}
    return told


def part_of(label: str) -> tuple[str, str] | None:
    """(side, part) that a label says, side empty in the middle; None where it says nothing known."""
    return _said(label.lower()) or _said(_NUMBERED.sub("", label.lower()))


def _said(plain: str) -> tuple[str, str] | None:
    for part, words in _MIDDLE_WORDS:
        if re.fullmatch(words, plain):
            return "", part
    for first in (True, False):
        for side, letter in (("left", "l"), ("right", "r")):
            names = (side, letter)
            for name in names:
                rest = plain[len(name) :] if first else plain[: -len(name)]
                fits = plain.startswith(name) if first else plain.endswith(name)
                said = _part(rest.strip(" ._-")) if fits else None
                if said is not None:
                    return side, said
    return ("", "pelvis") if _part(plain) == "pelvis" else None


def _part(word: str) -> str | None:
    return next((part for part, words in _WORDS if word and re.fullmatch(words, word)), None)


def _by_words(trial: Trial, subject: str) -> dict[tuple[str, str], list[_Marker]]:
    labels = seen_labels(trial, subject)
    if not labels:
        return {}
    points = trial.metres * trial.points[:, [trial.labels.index(label) for label in labels]]
    seen = whole(points)
    frame = int(np.argmax(seen.sum(axis=1)))
    found: dict[tuple[str, str], list[_Marker]] = defaultdict(list)
    for place, bare in enumerate(labels.values()):
        said = part_of(bare)
        if said is not None:
            near = int(np.flatnonzero(seen[:, place])[np.argmin(np.abs(np.flatnonzero(seen[:, place]) - frame))])
            found[said].append(_Marker(bare, points[near, place]))
    return dict(found)


def _leftward(found: dict[tuple[str, str], list[_Marker]]) -> FloatArray:
    """From the right markers' middle to the left ones', (3,) of length one; zero where one side has none."""
    sides = [[marker.place for (own, _), many in found.items() if own == side for marker in many] for side in SIDES]
    if not all(sides):
        return np.zeros(3)
    across = np.mean(sides[0], axis=0) - np.mean(sides[1], axis=0)
    return np.asarray(across / max(float(np.linalg.norm(across)), 1e-9))


def _sort_pair(found: dict[tuple[str, str], list[_Marker]], side: str, joint: str, outward: FloatArray) -> None:
    """Of two markers at one joint the outer one and the inner one, where they are on either side of it."""
    own = found.get((side, joint), [])
    if len(own) < 2 or (side, f"inner_{joint}") in found:
        return
    outer, *_, inner = sorted(own, key=lambda marker: -float(marker.place @ outward))
    way = outer.place - inner.place
    if way @ outward > _ACROSS * np.linalg.norm(way):
        found[side, f"inner_{joint}"], found[side, joint] = [inner], [outer]


def _sort_pelvis(found: dict[tuple[str, str], list[_Marker]], leftward: FloatArray) -> None:
    """Hips in front of a sacrum are the front of the pelvis; four unnamed markers are its corners."""
    hips = [found.get((side, "hip"), []) for side in SIDES]
    if all(hips) and ("", "sacrum") in found and ("left", "front_hip") not in found:
        for side in SIDES:
            found[side, "front_hip"] = found.pop((side, "hip"))
    cluster = found.pop(("", "pelvis"), [])
    if len(cluster) != 4 or not leftward.any():
        return
    up = _upward(found)
    forward = np.cross(leftward, up)
    middle = np.mean([marker.place for marker in cluster], axis=0)
    for marker in cluster:
        local = marker.place - middle
        side = "left" if local @ leftward > 0.0 else "right"
        end = "front_hip" if local @ forward > 0.0 else "back_hip"
        found.setdefault((side, end), []).append(marker)


def _sort_feet(found: dict[tuple[str, str], list[_Marker]]) -> None:
    """Of unnamed clusters on the feet the two that lie farthest apart along the way the body looks: heel and toe.

    The same ones on either side, where they are called alike.
    """
    forward = np.cross(_leftward(found), _upward(found))
    feet = [found.pop((side, "foot"), []) for side in SIDES]
    middles = [np.mean([marker.place for marker in foot], axis=0) for foot in feet if foot]
    if not middles:
        return
    ahead: dict[str, list[float]] = defaultdict(list)
    for foot, middle in zip([foot for foot in feet if foot], middles, strict=True):
        for marker in foot:
            ahead[marker.label[1:]].append(float((marker.place - middle) @ forward))
    for side, foot in zip(SIDES, feet, strict=True):
        if len(foot) > 1 and (side, "toe") not in found:
            foot.sort(key=lambda marker: float(np.mean(ahead[marker.label[1:]])))
            found[side, "heel"], found[side, "toe"] = [foot[0]], [foot[-1]]


def _upward(found: dict[tuple[str, str], list[_Marker]]) -> FloatArray:
    """From shanks to pelvis or thighs, (3,) of length one; the file's Z where they are not known."""
    low = [m.place for (_, part), many in found.items() if part in ("shank", "ankle", "toe", "foot") for m in many]
    high = [m.place for (_, part), many in found.items() if part in ("thigh", "front_hip", "shoulder") for m in many]
    if not (low and high):
        return np.array([0.0, 0.0, 1.0])
    way = np.mean(high, axis=0) - np.mean(low, axis=0)
    axis = int(np.argmax(np.abs(way)))
    return np.asarray(np.eye(3)[axis] * np.sign(way[axis]))
