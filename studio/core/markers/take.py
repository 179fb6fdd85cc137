"""Marker take: a trial, its marker map and its cleaning steps, from which a body is solved."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.markers.cleaning import USUAL_STEPS, Step, StepReport, cleaned_trial
from studio.core.markers.joint_centres import joint_centres, with_hips_of_thighs
from studio.core.markers.marker_map import MarkerMap, role_markers, role_middles, seen_labels, stored_centres
from studio.core.markers.measures import Measures, find_measures, pelvis_frame
from studio.core.markers.roles import SIDE_WORDS
from studio.core.markers.trial import MARKER_KIND, VIRTUAL_KIND, Trial, seen_mask

FloatArray = NDArray[np.float64]

_CARRIERS = (
    ("left_front_hip", "right_front_hip", "left_back_hip"),
    ("left_front_hip", "right_front_hip", "right_back_hip"),
    ("left_hip", "right_hip"),
    ("left_shoulder", "right_shoulder"),
)
"""Places without which nothing is known of the body in a frame, the best first."""


@dataclass(frozen=True, eq=False)
class MarkerTake:
    """Recorded trial, unchanged, with the user's marker map and cleaning steps, from which a body is computed."""

    trial: Trial
    marker_map: MarkerMap
    steps: tuple[Step, ...] = USUAL_STEPS
    subject: str = ""
    """Prefix of the labels that are read, for a trial with several subjects."""

    def with_map(self, marker_map: MarkerMap) -> "MarkerTake":
        """Copy with another marker map."""
        return replace(self, marker_map=marker_map)

    def with_steps(self, steps: tuple[Step, ...]) -> "MarkerTake":
        """Copy with other cleaning steps."""
        return replace(self, steps=steps)


@dataclass(frozen=True)
class TrackedBody:
    """Joint centres (F, 3) and positions by role, without gaps, in metres and file axes.

    The frames are those from 0 to the last one with a body.
    """

    joints: Mapping[str, FloatArray]
    tracks: Mapping[str, FloatArray]
    measures: Measures
    first_frame: int
    """First frame in which the body is seen; before it, the body stands still."""
    reports: tuple[StepReport, ...]
    unseen: int
    """Number of frames after that in which some position was neither seen nor filled by a cleaning step."""
    stored: Mapping[str, FloatArray]
    """Joint centres that a model left in the trial; with gaps."""
    seen: Mapping[str, NDArray[np.bool_]]
    """Mask (F,) of the frames in which each joint or role is seen and not held constant."""


def track_body(take: MarkerTake) -> TrackedBody:
    """Tracked body of a take: points cleaned, joint centres found, remaining gaps closed.

    Raises StudioError if there is no body.
    """
    trial, reports = cleaned_trial(take.trial.with_labels(mapped_labels(take)), take.steps)
    markers = role_markers(trial, take.marker_map, take.subject)
    stored = stored_centres(trial, take.marker_map, take.subject)
    tracks = role_middles(markers)
    seen, carrier = _seen(tracks | stored)
    if not seen.any():
        raise StudioError(f"'{trial.name}' has no frame in which its body is seen. Choose other markers for it.")
    first, end = int(np.argmax(seen)), len(seen) - int(np.argmax(seen[::-1]))
    open_frames = ~np.all([seen_mask(track) for track in tracks.values()], axis=0) if tracks else ~seen
    axes = _carrier_axes(tracks | stored, carrier)
    filled = {role: _closed_cluster(own[:end], axes[0][:end], axes[1][:end]) for role, own in markers.items()}
    measures = find_measures(trial.measures, trial.metres, tracks, stored)
    recorded = {role: own[:end] for role, own in markers.items()}
    if not any(f"{side}_hip" in stored for side in SIDE_WORDS):
        measures = with_hips_of_thighs(recorded, measures)
    given = {joint: own[:end] for joint, own in stored.items()}
    shown = joint_centres(recorded, measures) | given
    computed = joint_centres(filled, measures)
    origin, turns = axes[0][:end], axes[1][:end]
    joints = computed | {
        joint: _closed(own, origin, turns)
        if joint not in computed
        else computed[joint] + _closed(own - computed[joint], np.zeros_like(origin), turns)
        for joint, own in given.items()
    }
    return TrackedBody(
        joints=_whole_pairs(joints),
        tracks=role_middles(filled),
        measures=measures,
        first_frame=first,
        reports=reports,
        unseen=int(open_frames[first:end].sum()),
        stored=given,
        seen={role: seen_mask(track[:end]) for role, track in tracks.items()}
        | {joint: seen_mask(track) for joint, track in shown.items()},
    )


def centre_errors(take: MarkerTake) -> dict[str, float]:
    """Greatest distances in metres, by joint, between the computed joint centre and the one that a model left in the
    trial.

    They are computed from the trial as recorded, without cleaning.
    """
    markers = role_markers(take.trial, take.marker_map, take.subject)
    stored = stored_centres(take.trial, take.marker_map, take.subject)
    tracks = role_middles(markers)
    joints = joint_centres(markers, find_measures(take.trial.measures, take.trial.metres, tracks, stored))
    errors = {}
    for joint in stored.keys() & joints.keys():
        off = np.linalg.norm(joints[joint] - stored[joint], axis=1)
        if np.isfinite(off).any():
            errors[joint] = float(np.nanmax(off))
    return dict(sorted(errors.items()))


def mapped_labels(take: MarkerTake) -> tuple[str, ...]:
    """Labels, with subject, of the points in the map."""
    named = take.marker_map.labels | set(take.marker_map.centres.values())
    there = seen_labels(take.trial, take.subject, (MARKER_KIND, VIRTUAL_KIND))
    return tuple(label for label, bare in there.items() if bare in named)


def _seen(tracks: Mapping[str, FloatArray]) -> tuple[NDArray[np.bool_], tuple[str, ...]]:
    """Mask of the frames in which the reference segment of the body is seen, and the roles of this segment."""
    best: tuple[NDArray[np.bool_], tuple[str, ...]] = (np.zeros(1, dtype=bool), ())
    for roles in _CARRIERS:
        if all(role in tracks for role in roles):
            seen = np.all([seen_mask(tracks[role]) for role in roles], axis=0)
            if seen.any():
                return np.asarray(seen), roles
    return best


def _carrier_axes(tracks: Mapping[str, FloatArray], roles: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
    """Origin (F, 3) and axes (F, 3, 3) of the reference segment of the body, held where it is not seen."""
    held = {role: _held(tracks[role]) for role in roles}
    if "left_front_hip" in roles:
        return pelvis_frame(held)
    left, right = (held[role] for role in roles)
    return 0.5 * (left + right), np.tile(np.eye(3), (len(left), 1, 1))


def _whole_pairs(joints: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Joints of the limbs whose joints are all known on both sides; half a limb would have no bones."""
    whole: dict[str, FloatArray] = {}
    for limb in (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")):
        names = [f"{side}_{joint}" for side in ("left", "right") for joint in limb]
        if all(name in joints for name in names):
            whole |= {name: joints[name] for name in names}
    return whole


def _closed_cluster(markers: FloatArray, origin: FloatArray, axes: FloatArray) -> FloatArray:
    closed = [_closed(markers[:, index], origin, axes) for index in range(markers.shape[1])]
    return np.stack(closed, axis=1)


def _closed(track: FloatArray, origin: FloatArray, axes: FloatArray) -> FloatArray:
    """Track (F, 3) without gaps, interpolated linearly in the axes of the pelvis, and constant at both ends."""
    if seen_mask(track).all():
        return track
    local = np.einsum("fji,fj->fi", axes, track - origin)
    return np.asarray(origin + np.einsum("fij,fj->fi", axes, _held(local)))


def _held(track: FloatArray) -> FloatArray:
    seen = np.flatnonzero(seen_mask(track))
    if len(seen) in (0, len(track)):
        return track
    frames = np.arange(len(track))
    return np.stack([np.interp(frames, seen, track[seen, axis]) for axis in range(3)], axis=1)
