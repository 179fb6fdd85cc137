"""Detection of markers of one side that carry each other's name throughout a take: front and back, heel and toe, knee
and ankle, thumb and little finger.

The front is found from the parts that agree on it: trunk, pelvis, head, the long part of each foot, and bending knees.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.feet import TOE_ROLES
from studio.core.markers.joint_centres import joint_centres
from studio.core.markers.marker_map import MarkerMap, role_markers, role_middles
from studio.core.markers.measures import find_measures
from studio.core.markers.roles import SIDE_WORDS
from studio.core.markers.sides import high_and_low, middle_of
from studio.core.markers.trial import Trial
from studio.core.rotations import normalized

FloatArray = NDArray[np.float64]
Tracks = Mapping[str, FloatArray]

FRONT_AND_BACK_PAIRS = (("front_hip", "back_hip"), ("front_head", "back_head"))
"""Roles in front and behind that each have a left and a right marker."""
FRONT_AND_BACK_TRUNK_ROLES = (("collar", "neck_back"), ("breastbone", "back"))
"""Roles in front and behind in the middle of the trunk."""
WRIST_ROLES = ("wrist", "outer_wrist")
BONES_AND_BEYOND = (
    ("front_hip", "knee", "ankle"),
    ("ankle", "knee", "thigh"),
    ("heel", "ankle", "shank"),
    ("wrist", "elbow", "shoulder"),
    ("shoulder", "elbow", "wrist"),
)
"""Role at one end of a bone, role at its other end, and a role beyond that."""
EXCHANGEABLE = frozenset(
    frozenset(pair)
    for pair in (
        *FRONT_AND_BACK_PAIRS,
        *FRONT_AND_BACK_TRUNK_ROLES,
        WRIST_ROLES,
        *((chain[1], chain[2]) for chain in BONES_AND_BEYOND),
        *(("heel", toe) for toe in TOE_ROLES),
        *(("ankle", sole) for sole in ("heel", *TOE_ROLES)),
    )
)
"""Pairs of roles whose exchange is detected."""
_MOST_FRAMES = 600
_OPPOSITE = -0.3
"""Cosine to the front of all other places below which front and back are exchanged."""
_AGREED = 0.5
"""Length of the mean of directions to the front, each of length one, from which they agree."""
_APART = 0.02
"""Metres along the body's front within which two places are not told apart."""
_FARTHER, _UNSTEADY = 1.25, 0.002
"""Times by which the end of a bone lies farther from its root than what should be beyond it, and metres by which that
distance changes more, where their names are exchanged."""
_FOLDED = float(np.cos(np.radians(20.0)))
"""Cosine of the angle between two bones at a joint to which none folds all the time."""
_BENT, _THUMB_BACK, _THUMB_BEHIND = 0.3, -0.4, -0.6
"""Sine of an elbow's bend that shows its plane; cosines to the side to which it bends, or to the front where it hangs
straight, below which no forearm turns its thumb."""


def exchanged_ends(trial: Trial, marker_map: MarkerMap, subject: str = "") -> dict[str, str]:
    """Map from each role to the role whose markers it should have, for roles that carry each other's name most of the
    time.
    """
    frames = np.unique(np.linspace(0, trial.frame_count - 1, _MOST_FRAMES).astype(int))
    few = replace(trial, points=trial.points[frames], residuals=trial.residuals[frames])
    markers = role_markers(few, marker_map, subject)
    tracks = {role: np.asarray(own.mean(axis=1)) for role, own in markers.items()}
    place = {role: role for role in tracks}

    def exchange(roles: Mapping[str, str]) -> None:
        place.update({role: place[other] for role, other in roles.items()})
        tracks.update({role: tracks[other] for role, other in roles.items()})

    high, low = high_and_low(tracks)
    if high is not None and low is not None:
        up = normalized(high - low)
        for side in SIDE_WORDS:
            foot = [role for name in ("ankle", "heel", *TOE_ROLES) if (role := f"{side}_{name}") in tracks]
            over = [_along(tracks[role] - tracks[foot[0]], up) for role in foot]
            if foot[:1] == [f"{side}_ankle"] and max(over) > _APART:
                highest = foot[int(np.argmax(over))]
                exchange({foot[0]: highest, highest: foot[0]})
        fronts = _fronts(tracks)
        for front, back in FRONT_AND_BACK_PAIRS:
            exchange(_sorted_quadrants(tracks, front, back, _agreed(fronts, front), up))
        for front, back in FRONT_AND_BACK_TRUNK_ROLES:
            forward = _agreed(fronts, front)
            if forward is not None and front in fronts and _cosine(fronts[front], forward) < _OPPOSITE:
                exchange({front: back, back: front})
        forward = _agreed(fronts, "")
        for side in SIDE_WORDS:
            toe = next((f"{side}_{name}" for name in TOE_ROLES if f"{side}_{name}" in tracks), "")
            heel = f"{side}_heel"
            if (
                forward is not None
                and toe
                and heel in tracks
                and _cosine(tracks[toe] - tracks[heel], forward) < _OPPOSITE
            ):
                exchange({toe: heel, heel: toe})
    return {role: other for role, other in place.items() if role != other}


def exchanged_on_limbs(trial: Trial, marker_map: MarkerMap, subject: str = "") -> dict[str, str]:
    """Map as in ``exchanged_ends`` for the end of a bone and the role beyond it, and for the two sides of a wrist."""
    tracks = {role: np.asarray(own.mean(axis=1)) for role, own in role_markers(trial, marker_map, subject).items()}
    found: dict[str, str] = {}
    for side, (root, end, beyond) in product(SIDE_WORDS, BONES_AND_BEYOND):
        roles = [f"{side}_{name}" for name in (root, end, beyond)]
        places = [tracks[role] for role in roles if role in tracks]
        if not found.keys() & roles and len(places) == 3 and _is_beyond(*places):
            found |= {roles[1]: roles[2], roles[2]: roles[1]}
    markers = role_markers(trial, with_roles(marker_map, found), subject)
    tracks = role_middles(markers)
    joints = joint_centres(markers, find_measures(trial.measures, trial.metres, tracks, {}))
    forward = _agreed(_fronts(tracks), "")
    for side in SIDE_WORDS:
        thumb, little = (f"{side}_{name}" for name in WRIST_ROLES)
        if not {thumb, little} <= tracks.keys() or found.keys() & {thumb, little}:
            continue
        if _is_turned_back(tracks[thumb] - tracks[little], joints, side, forward):
            found |= {thumb: little, little: thumb}
    return found


def with_roles(marker_map: MarkerMap, roles: Mapping[str, str]) -> MarkerMap:
    """Marker map in which each key of ``roles`` has the markers of the role that is its value."""
    moved = {role: marker_map.markers[other] for role, other in roles.items() if other in marker_map.markers}
    return replace(marker_map, markers={**marker_map.markers, **moved})


def _fronts(tracks: Tracks) -> dict[str, FloatArray]:
    """Directions (F, 3) to the front by the role in front; each uses the markers of its own pair only."""
    found: dict[str, FloatArray] = {}
    for front, back in (*FRONT_AND_BACK_PAIRS, *FRONT_AND_BACK_TRUNK_ROLES):
        before, behind = middle_of(tracks, front), middle_of(tracks, back)
        if before is not None and behind is not None:
            found[front] = normalized(before - behind)
    feet, knees = [], []
    for side in SIDE_WORDS:
        knee, ankle = (tracks.get(f"{side}_{name}") for name in ("knee", "ankle"))
        if ankle is None:
            continue
        ends = [tracks[role] - ankle for name in ("heel", *TOE_ROLES) if (role := f"{side}_{name}") in tracks]
        if ends:
            feet.append(max(ends, key=lambda end: _median(np.linalg.norm(end, axis=-1))))
        pelvis = [each for name in ("front_hip", "back_hip") if (each := middle_of(tracks, name)) is not None]
        if knee is not None and len(pelvis) == 2:
            thigh, leg = knee - ankle, normalized(np.mean(pelvis, axis=0) - ankle)
            knees.append(thigh - np.sum(thigh * leg, axis=-1, keepdims=True) * leg)
    for name, own in (("feet", feet), ("knees", knees)):
        if len(own) == 2:
            found[name] = normalized(own[0] + own[1])
    return found


def _agreed(fronts: Tracks, but: str) -> FloatArray | None:
    """Mean direction (F, 3) to the front, without that of the role ``but``; None if the others do not agree."""
    others = [own for name, own in fronts.items() if name != but]
    if len(others) < 2:
        return None
    seen = np.isfinite(others)
    mean = np.where(seen, others, 0.0).sum(axis=0) / np.maximum(seen.sum(axis=0), 1)
    return normalized(mean) if np.median(np.linalg.norm(mean, axis=-1)) > _AGREED else None


def _is_beyond(root: FloatArray, end: FloatArray, beyond: FloatArray) -> bool:
    """True if ``end`` (F, 3) of a bone is farther from its ``root`` than ``beyond``, which should be beyond it."""
    near, far = (np.linalg.norm(own - root, axis=-1) for own in (end, beyond))
    seen = np.isfinite(near + far)
    if not seen.any() or np.percentile(near[seen], 95) < _FARTHER * np.percentile(far[seen], 95):
        return False
    folded = _cosine(root - end, beyond - end) > _FOLDED
    return folded or bool(np.std(near[seen]) > np.std(far[seen]) + _UNSTEADY)


def _sorted_quadrants(
    tracks: Tracks, front: str, back: str, forward: FloatArray | None, up: FloatArray
) -> dict[str, str]:
    """Map from roles to the roles whose markers lie in their quadrant (left or right, front or back), if
    they differ.
    """
    roles = [f"{side}_{name}" for name in (front, back) for side in SIDE_WORDS]
    if forward is None or any(role not in tracks for role in roles):
        return {}
    points = np.stack([tracks[role] for role in roles])
    apart = points - points.mean(axis=0)
    ahead = np.array([_along(each, forward) for each in apart])
    beside = np.array([_along(each, np.cross(up, forward)) for each in apart])
    order = np.argsort(-ahead)
    if ahead[order[1]] - ahead[order[2]] < _APART:
        return {}
    there = [int(own[index]) for own in (order[:2], order[2:]) for index in np.argsort(-beside[own])]
    if any(there[other] != index for index, other in enumerate(there)):  # a head that looks over its shoulder
        return {}
    return {role: roles[other] for index, (role, other) in enumerate(zip(roles, there, strict=True)) if index != other}


def _is_turned_back(across: FloatArray, joints: Tracks, side: str, forward: FloatArray | None) -> bool:
    """True if the direction ``across`` a wrist (F, 3), to its thumb, is one that no forearm can reach."""
    shoulder, elbow, wrist = (joints.get(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist"))
    if shoulder is None or elbow is None or wrist is None:
        return False
    along = normalized(wrist - elbow)
    upper = normalized(shoulder - elbow)
    bends = upper - np.sum(upper * along, axis=-1, keepdims=True) * along
    bent = np.linalg.norm(bends, axis=-1) > _BENT
    if bent.any():
        return _cosine(across[bent], bends[bent]) < _THUMB_BACK
    return forward is not None and _cosine(across, forward) < _THUMB_BEHIND


def _along(vectors: FloatArray, directions: FloatArray) -> float:
    return _median(np.sum(vectors * directions, axis=-1))


def _cosine(vectors: FloatArray, directions: FloatArray) -> float:
    return _along(normalized(vectors), normalized(directions))


def _median(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else 0.0
