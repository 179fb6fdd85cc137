"""Unit of a marker trial: that of the file if its markers then have human size, else one in which they do."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.capture import Guess
from studio.core.markers.marker_map import MarkerMap, role_markers, role_middles, seen_labels
from studio.core.markers.trial import METRES, Trial
from studio.io.guessing import Scale, find_unit
from studio.io.markers.maps import find_map

_UNITS = {"m": "m", "me": "m", "met": "m", "mete": "m", "meter": "m", "metre": "m", "meters": "m", "metres": "m"}
_UNITS |= {"mm": "mm", "mill": "mm", "millimeter": "mm", "millimetre": "mm", "millimeters": "mm", "millimetres": "mm"}
_UNITS |= {"cm": "cm", "cent": "cm", "centimeter": "cm", "centimetre": "cm", "centimeters": "cm", "centimetres": "cm"}
_UNITS |= {"in": "inch", "inch": "inch", "inches": "inch"}
_OVER_SKIN = 1.06
"""The way over the markers of hip, knee and ankle, in lengths of the leg between the joints."""
_LEG_OF_ARM = 1.5
_SIZES = (0.5, 3.5)
"""Metres between the two markers of a person that are farthest apart."""
_LOOKED_AT = 32


def named_unit(said: str) -> str | None:
    """Name here of the unit of length ``said`` by a file; None if it is unknown."""
    return _UNITS.get(said.lower().rstrip("."))


def in_believable_unit(
    trial: Trial, marker_map: MarkerMap | None, subject: str, unit: str | None
) -> tuple[Trial, MarkerMap, list[Guess]]:
    """Trial in the user's ``unit``, or in one in which its legs are plausible; and its map, proposed if there is none.

    A map is proposed by measure, so other units are tried if none has legs in that of the file.
    """
    if unit is not None and unit in METRES:
        trial = replace(trial, unit=unit)
    found = marker_map or find_map(trial, subject)
    if unit is not None:
        return trial, found, []
    leg = _leg(trial, found, subject)
    if leg is None and marker_map is None:
        for other in _units_of_size(trial, subject):
            found_there = find_map(replace(trial, unit=other), subject)
            if (leg := _leg(trial, found_there, subject)) is not None:
                found = found_there
                break
    scale, guess = find_unit(leg, Scale(trial.unit, trial.metres))
    if guess is None or scale.unit not in METRES:
        return trial, found, []
    trial = replace(trial, unit=scale.unit)
    return trial, marker_map or find_map(trial, subject), [guess]


def _leg(trial: Trial, marker_map: MarkerMap, subject: str) -> float | None:
    """Median length of a leg in units of the file, by markers near its joints, or by an arm's; None without either."""
    places = role_middles(role_markers(trial, marker_map, subject))
    lengths = []
    for chain, factor in ((("front_hip", "knee", "ankle"), 1.0), (("shoulder", "elbow", "wrist"), _LEG_OF_ARM)):
        for side in ("left", "right"):
            joints = [places.get(f"{side}_{name}") for name in chain]
            if any(joint is None or not np.isfinite(joint).any() for joint in joints):
                continue
            near, middle, far = joints
            bones = np.linalg.norm(middle - near, axis=1) + np.linalg.norm(far - middle, axis=1)  # type: ignore[operator]
            if np.isfinite(bones).any():
                lengths.append(factor * float(np.nanmedian(bones)) / trial.metres / _OVER_SKIN)
        if lengths:
            return float(np.mean(lengths))
    return None


def _units_of_size(trial: Trial, subject: str) -> list[str]:
    """Units in which the trial's cloud of markers is as large as a person, if it is not in that of the file."""
    places = [trial.labels.index(label) for label in seen_labels(trial, subject)]
    frames = np.unique(np.linspace(0, trial.frame_count - 1, _LOOKED_AT).astype(int))
    points = trial.points[frames][:, places]
    seen: NDArray[np.bool_] = np.isfinite(points).all(axis=2) & points.any(axis=2)
    sizes = [
        float(np.linalg.norm(np.ptp(own[there], axis=0)))
        for own, there in zip(points, seen, strict=True)
        if there.any()
    ]
    size = float(np.median(sizes)) if sizes else 0.0
    if _SIZES[0] < size * trial.metres < _SIZES[1]:
        return []
    return [unit for unit, metres in METRES.items() if _SIZES[0] < size * metres < _SIZES[1]]
