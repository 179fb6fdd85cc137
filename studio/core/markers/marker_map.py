"""Marker map: the markers of a set at each role, a position on the body."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.feet import TOE_ROLES, feet_axes
from studio.core.markers.roles import JOINTS, ROLES_BY_ID, SIDE_WORDS
from studio.core.markers.trial import MARKER_KIND, VIRTUAL_KIND, Trial, label_without_subject

FloatArray = NDArray[np.float64]
Tracks = Mapping[str, FloatArray]
"""Positions (F, 3) by role in metres; NaN in frames in which they are not seen."""

_LEG = ("knee", "ankle")
_ARM = ("shoulder", "elbow", "wrist")


@dataclass(frozen=True)
class MarkerMap:
    """Labels (without subject) of the markers of each role; the mean of its markers is the position of the role."""

    name: str
    markers: Mapping[str, tuple[str, ...]]
    centres: Mapping[str, str] = field(default_factory=dict)
    """Labels of points that are joint centres, by joint (``left_knee``), as a model leaves them in a file. They are
    used if the markers do not give that joint, and to find the measures of the subject.
    """

    def __post_init__(self) -> None:
        for given, known in ((self.markers, tuple(ROLES_BY_ID)), (self.centres, JOINTS)):
            unknown = [place for place in given if place not in known]
            if unknown:
                raise StudioError(f"'{unknown[0]}' is not a body location. Body locations are {', '.join(known)}.")
        ordered = {role: tuple(self.markers[role]) for role in ROLES_BY_ID if self.markers.get(role)}
        object.__setattr__(self, "markers", MappingProxyType(ordered))
        object.__setattr__(self, "centres", MappingProxyType(dict(self.centres)))

    def __reduce__(self) -> tuple[type["MarkerMap"], tuple[str, dict[str, tuple[str, ...]], dict[str, str]]]:
        """Pickle of the map for another process; its read-only mappings cannot be pickled themselves."""
        return MarkerMap, (self.name, dict(self.markers), dict(self.centres))

    @property
    def labels(self) -> frozenset[str]:
        """Labels of all markers in the map."""
        return frozenset(label for labels in self.markers.values() for label in labels)

    def with_role(self, role: str, labels: Iterable[str]) -> "MarkerMap":
        """Copy in which ``role`` has the markers ``labels``, which may be none."""
        return replace(self, markers={**self.markers, role: tuple(labels)})

    def restricted_to(self, labels: Iterable[str]) -> "MarkerMap":
        """Copy with only those markers that are among ``labels``."""
        there = set(labels)
        kept = {role: tuple(label for label in own if label in there) for role, own in self.markers.items()}
        centres = {joint: label for joint, label in self.centres.items() if label in there}
        return replace(self, markers=kept, centres=centres)

    def has_legs(self) -> bool:
        """True if both legs can be tracked: pelvis or hips, knees, ankles."""
        hips = self._has("front_hip") and ("left_back_hip" in self.markers or "right_back_hip" in self.markers)
        knees = self._has("knee") or (self._has_cluster("thigh") and self._has_cluster("shank"))
        toes = all(any(f"{side}_{toe}" in self.markers for toe in TOE_ROLES) for side in SIDE_WORDS)
        ankles = self._has("ankle") or (self._has("heel") and toes)
        return ((hips or self._has("hip")) and knees and ankles) or self._has_centres("hip", *_LEG)

    def has_arms(self) -> bool:
        """True if both arms can be tracked: shoulders, elbows, wrists."""
        return all(self._has(part) for part in _ARM) or self._has_centres(*_ARM)

    def missing_positions(self) -> tuple[str, ...]:
        """Names of the positions that are missing to track at least half a body."""
        if self.has_legs() or self.has_arms():
            return ()
        needed = [f"{side}_{part}" for part in ("front_hip", "back_hip", *_LEG) for side in SIDE_WORDS]
        return tuple(ROLES_BY_ID[role].words.lower() for role in needed if role not in self.markers)

    def _has_cluster(self, part: str) -> bool:
        """True if three markers move with the bone of ``part``, and so show its rotation."""
        return all(len(self.markers.get(f"{side}_{part}", ())) >= 3 for side in SIDE_WORDS)

    def _has_centres(self, *joints: str) -> bool:
        return all(f"{side}_{joint}" in self.centres for side in SIDE_WORDS for joint in joints)

    def _has(self, part: str) -> bool:
        return all(f"{side}_{part}" in self.markers for side in SIDE_WORDS)


def seen_labels(trial: Trial, subject: str = "", kinds: tuple[str, ...] = (MARKER_KIND,)) -> dict[str, str]:
    """Labels without subject of the points that are seen in some frame, by label; only those of ``subject`` if it is
    given.
    """
    found: dict[str, str] = {}
    for label, kind, ever in zip(trial.labels, trial.kinds, trial.ever_seen, strict=True):
        if kind in kinds and ever and (not subject or label.startswith(f"{subject}:")):
            found.setdefault(label_without_subject(label), label)
    return {label: bare for bare, label in found.items()}


def role_markers(trial: Trial, marker_map: MarkerMap, subject: str = "") -> dict[str, FloatArray]:
    """Markers (F, n, 3) of each role in metres and the file's axes; NaN where not seen."""
    by_bare = _by_bare(trial, subject)
    return {
        role: trial.metres * np.stack([trial.track(by_bare[bare]) for bare in labels], axis=1)
        for role, labels in marker_map.restricted_to(by_bare).markers.items()
    }


def role_middles(markers: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Mean (F, 3) of the markers of each role, with the toes moved to the long axis of each foot.

    NaN in frames in which one of them is not seen.
    """
    tracks = {role: np.asarray(own.mean(axis=1)) for role, own in markers.items()}
    return tracks | feet_axes(tracks)


def stored_centres(trial: Trial, marker_map: MarkerMap, subject: str = "") -> dict[str, FloatArray]:
    """Joint centres (F, 3), by joint, that are stored as points of the trial, in metres and the file's axes."""
    by_bare = _by_bare(trial, subject)
    centres = marker_map.restricted_to(by_bare).centres
    return {joint: trial.metres * trial.track(by_bare[bare]) for joint, bare in centres.items()}


def _by_bare(trial: Trial, subject: str) -> dict[str, str]:
    return {bare: label for label, bare in seen_labels(trial, subject, kinds=(MARKER_KIND, VIRTUAL_KIND)).items()}
