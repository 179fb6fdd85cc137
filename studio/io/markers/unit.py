"""Unit of a marker trial: the stated one if the markers then have human size, else one with which they do."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.capture import Guess
from studio.core.markers.marker_map import MarkerMap, role_markers, role_middles, seen_labels
from studio.core.markers.trial import TRIAL_UNIT_METRES, Trial
from studio.io.guessing import Scale, choose_unit
from studio.io.markers.maps import find_map

_UNITS = {"m": "m", "me": "m", "met": "m", "mete": "m", "meter": "m", "metre": "m", "meters": "m", "metres": "m"}
_UNITS |= {"mm": "mm", "mill": "mm", "millimeter": "mm", "millimetre": "mm", "millimeters": "mm", "millimetres": "mm"}
_UNITS |= {"cm": "cm", "cent": "cm", "centimeter": "cm", "centimetre": "cm", "centimeters": "cm", "centimetres": "cm"}
_UNITS |= {"in": "inch", "inch": "inch", "inches": "inch"}
_OVER_SKIN = 1.06
"""Length of the path over the markers of hip, knee and ankle, relative to that between the joints."""
_LEG_OF_ARM = 1.5
_SIZES = (0.5, 3.5)
"""Metres between the two markers of a person that are farthest apart."""
_LOOKED_AT = 32


def unit_by_spelling(said: str) -> str | None:
    """Unit of length that a file spells ``said``, by its name in the studio; None if it is unknown."""
    return _UNITS.get(said.lower().rstrip("."))


def with_plausible_unit(
    trial: Trial, marker_map: MarkerMap | None, subject: str, unit: str | None
) -> tuple[Trial, MarkerMap, list[Guess]]:
    """Trial in the user's ``unit``, or in a unit with which its legs are plausible; its marker map; and the guesses.

    The map is proposed by measure if ``marker_map`` is None, so other units are tried if it finds no legs with the
    stated unit.
    """
    if unit is not None and unit in TRIAL_UNIT_METRES:
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
    scale, guess = choose_unit(leg, Scale(trial.unit, trial.metres))
    if guess is None or scale.unit not in TRIAL_UNIT_METRES:
        return trial, found, []
    trial = replace(trial, unit=scale.unit)
    return trial, marker_map or find_map(trial, subject), [guess]


def _leg(trial: Trial, marker_map: MarkerMap, subject: str) -> float | None:
    """Median length of a leg in units of the file, by the markers near its joints or by an arm; None without either."""
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
    """Units with which the trial's cloud of markers is as large as a person; empty if it is so with the stated unit."""
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
    return [unit for unit, metres in TRIAL_UNIT_METRES.items() if _SIZES[0] < size * metres < _SIZES[1]]
