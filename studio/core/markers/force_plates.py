"""Forces on force plates, in the axes of the plates, from their analog channels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import ForcePlate, Trial
from studio.core.rotations import normalized
from studio.core.runs import runs_in

FloatArray = NDArray[np.float64]

_SMALLEST, _LEVEL = 0.02, 0.02
"""Square metres of a plate, and metres between the heights of its corners: others are not described, or no floor."""
_FEET_ARE_OFF = 0.15
"""Metres from where the feet seem to stand to where they do: markers lie beside a foot, and soles are thick."""
_LEAST = 20.0
"""Newtons below which a plate counts as empty: its centre of pressure is noise."""
_STEP, _EMPTY, _LOADED = 100.0, 0.1, 0.02
"""Newtons of the greatest force on a plate that shows a step, and parts of it below which the plate is empty, and above
whose median it is loaded.
"""
_BREAK, _SHORTEST = 0.05, 0.1
"""Seconds without load that do not end a step, and seconds that a step takes at least."""


@dataclass(frozen=True, eq=False)
class PlateLoad:
    """Step on a force plate that is loaded from frame ``first`` to ``last``, both included, and unloaded before and
    after.
    """

    first: int
    last: int
    corners: FloatArray
    """Corners (4, 2) of the plate in metres, along X and Y of the world."""


def plate_force(trial: Trial, plate: ForcePlate) -> FloatArray:
    """Forces (N, 3) in the units of the channels, along x and y of the plate and perpendicular to it.

    Plates of types 1 and 2 give the force itself, type 3 has eight sensors (x12, x34, y14, y23, z1 to z4), and type 4
    needs its calibration.
    """
    raw = _calibrated(trial, plate)
    if plate.kind == 3:
        x, y = raw[:, 0] + raw[:, 1], raw[:, 2] + raw[:, 3]
        return np.stack([x, y, raw[:, 4:8].sum(axis=1)], axis=1)
    return np.asarray(raw[:, :3])


def plate_reactions(trial: Trial, plate: ForcePlate) -> tuple[FloatArray, FloatArray]:
    """Centres of pressure (N, 3), in file units and axes, and ground reaction forces (N, 3); NaN for an unloaded plate.

    The plate's x runs from corner 2 to corner 1, its y from corner 4 to corner 1 (C3D user guide). With the sensors h
    below the surface the centre of pressure is x = -(My + h Fx) / Fz, y = (Mx - h Fy) / Fz. Type 1 gives it directly,
    type 3 by the loads of its four corners, which are ``origin`` away from the middle. Files disagree about the sign of
    the force; here the ground pushes up.
    """
    corners, force, raw = plate.corners, plate_force(trial, plate), _calibrated(trial, plate)
    sides = np.stack([corners[0] - corners[1], corners[0] - corners[3]])
    half = 0.5 * np.linalg.norm(sides, axis=1)
    if not half.all():
        return np.full_like(force, np.nan), np.full_like(force, np.nan)
    x, y = normalized(sides)
    axes = np.stack([x, y, np.cross(x, y)])
    across = np.where(np.abs(force[:, 2:]) >= _LEAST, force[:, 2:], np.nan)
    height = abs(float(plate.origin[2]))
    if plate.kind == 1:
        centre = raw[:, 3:5]
    elif plate.kind == 3:
        z1, z2, z3, z4 = raw[:, 4:8].T
        centre = np.abs(plate.origin[:2]) * np.stack([z1 - z2 - z3 + z4, z1 + z2 - z3 - z4], axis=1) / across
    else:
        centre = np.stack([-raw[:, 4] - height * force[:, 0], raw[:, 3] - height * force[:, 1]], axis=1) / across
    places = corners.mean(axis=0) + np.clip(centre, -half, half) @ axes[:2]
    up = axes[2] * np.sign(axes[2][np.argmax(np.abs(axes[2]))])
    pushed = force @ axes
    pushed *= np.sign(np.sum(pushed @ up))
    seen = np.isfinite(across)
    places *= trial.metres_of_plates / trial.metres
    return np.where(seen, places, np.nan), np.where(seen, pushed, np.nan)


def plates_height(trial: Trial, turn: FloatArray, near: float) -> float | None:
    """Height in metres of the level force plates in world axes; ``turn`` (3, 3) rotates points (N, 3) to these.

    Of plates at several heights the one nearest to ``near`` is taken; None if no level plate is within reach of it.
    """
    heights = []
    for plate in trial.plates:
        corners = trial.metres_of_plates * plate.corners @ turn
        sides = corners[1] - corners[0], corners[3] - corners[0]
        top = float(corners[:, 2].mean())
        level = float(np.ptp(corners[:, 2])) < _LEVEL
        if level and np.linalg.norm(np.cross(*sides)) > _SMALLEST and abs(top - near) < _FEET_ARE_OFF:
            heights.append(top)
    return min(heights, key=lambda height: abs(height - near), default=None)


def plate_loads(trial: Trial, turn: FloatArray) -> tuple[PlateLoad, ...]:
    """Steps on all plates of a trial; ``turn`` (3, 3) rotates points (N, 3) to world axes.

    Amplifiers drift, so the force on an empty plate is subtracted. A plate that is never empty shows no step.
    """
    samples_a_frame, found = trial.analog.rate / trial.frame_rate, []
    for plate in trial.plates if len(trial.analog.samples) else ():
        if not plate.channels:
            continue
        corners = (trial.metres_of_plates * plate.corners @ turn)[:, :2]
        if abs(np.linalg.det([corners[1] - corners[0], corners[3] - corners[0]])) < _SMALLEST:
            continue
        force = plate_force(trial, plate)[:, 2]
        greatest = np.abs(force).max(initial=0.0)
        empty = np.abs(force) < _EMPTY * greatest
        if greatest < _STEP or not empty.any():
            continue
        loaded = np.abs(force - np.median(force[empty])) > _LOADED * greatest
        for run in runs_in(slice(0, len(loaded)), loaded, round(_BREAK * trial.analog.rate)):
            if run.stop - run.start >= _SHORTEST * trial.analog.rate:
                first, past = (round(sample / samples_a_frame) for sample in (run.start, run.stop))
                found.append(PlateLoad(first, past - 1, corners))
    return tuple(found)


def sample_times(trial: Trial) -> FloatArray:
    """Times (N,) in seconds of the analog samples, from frame 0 of the trial."""
    return np.arange(len(trial.analog.samples)) / trial.analog.rate


def _calibrated(trial: Trial, plate: ForcePlate) -> FloatArray:
    raw = trial.analog.samples[:, list(plate.channels)]
    if plate.kind == 4 and plate.calibration is not None:
        raw = raw @ plate.calibration.T
    return np.asarray(raw)
