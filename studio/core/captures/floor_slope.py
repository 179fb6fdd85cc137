"""Slope of the floor of a capture, from the lowest positions of the soles: calibrations are off by a degree or two."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import HEIGHT_MARGIN, STILL_SPEED, point_speeds
from studio.core.runs import runs_of
from studio.core.windows import sliding_minimum

FloatArray = NDArray[np.float64]

STEEPEST_FLOOR = 0.07
"""Greatest rise over run (4 degrees) of a floor: steeper ground is stairs or a ramp, and no badly calibrated level
floor.
"""
SLOPE_DEVIATION = 0.02
"""Standard deviation of the rise over run of floors in captures."""
SOLE_HEIGHT_DEVIATION = 0.015
"""Standard deviation in metres of the heights at which a sole comes to stand."""
STEP_STANCE_SECONDS = 0.3
"""Seconds that a sole stands in a step: a shorter stance has less weight, a longer one has no more. The swing to the
next step takes longer than this.
"""
SLOPE_FITS = 5
"""Number of fits of the slope, each with less weight on positions far off the previous fit."""


@dataclass(frozen=True, eq=False)
class FloorSlope:
    """Floor that rises by ``gradient`` (2,) along X and Y and has the capture's own height at ``level``."""

    gradient: FloatArray
    level: float

    def rise(self, points: FloatArray) -> FloatArray:
        """Heights in metres of the floor at ``points`` (..., 3) relative to the capture's own height of the floor."""
        return np.asarray(points[..., :2] @ self.gradient - self.level)

    def levelled(self, points: FloatArray) -> FloatArray:
        """``points`` (..., 3) with heights measured from the floor."""
        heights = points[..., 2] - self.rise(points)
        return np.concatenate([points[..., :2], heights[..., None]], axis=-1)


def find_floor_slope(soles: FloatArray, upright: NDArray[np.bool_], frame_rate: float) -> FloorSlope:
    """Slope of the floor by the lowest positions of ``soles`` (F, 2, 3, 3), as in ``detect_contacts``.

    ``upright`` (F, 2) masks the legs that stand upright. A level floor is the prior: soles that stay at one position
    show no slope.
    """
    reach = round(STEP_STANCE_SECONDS * frame_rate)
    points = [(side, end) for side in range(2) for end in range(2)]
    steps, weights, kinds = [], [], []
    for kind, (side, end) in enumerate(points):
        track = soles[:, side, end]
        low = track[:, 2] < sliding_minimum(track[:, 2], reach) + HEIGHT_MARGIN
        stands = low & upright[:, side] & (point_speeds(track, low, frame_rate) < STILL_SPEED)
        for first, past in runs_of(stands):
            steps.append(track[first:past].mean(axis=0))
            weights.append(min((past - first) / (STEP_STANCE_SECONDS * frame_rate), 1.0))
            kinds.append(kind)
    if not steps:
        return FloorSlope(np.zeros(2), 0.0)
    places = np.array(steps)
    gradient = _gradient(places, np.array(weights), np.eye(len(points))[kinds])
    if np.linalg.norm(gradient) > STEEPEST_FLOOR:
        gradient = np.zeros(2)
    return FloorSlope(gradient, float(np.quantile(places[:, :2] @ gradient, 0.05)))


def _gradient(positions: FloatArray, weights: FloatArray, kinds: FloatArray) -> FloatArray:
    """Rise over run (2,) of ``positions`` (N, 3), in a robust fit with ``weights`` (N,).

    Heels and balls may differ in height: each row of ``kinds`` (N, K) has one 1, at the kind of its position. Outliers
    far off the floor, as of a heel that never came down, weigh little.
    """
    columns = np.concatenate([positions[:, :2] - positions[:, :2].mean(axis=0), kinds], axis=1)
    doubt = np.diag([*2 * [(SOLE_HEIGHT_DEVIATION / SLOPE_DEVIATION) ** 2], *kinds.shape[1] * [1e-9]])
    trusted = weights
    for _ in range(SLOPE_FITS):
        weighed = columns.T * trusted
        fit = np.linalg.solve(weighed @ columns + doubt, weighed @ positions[:, 2])
        trusted = weights / (1.0 + ((positions[:, 2] - columns @ fit) / SOLE_HEIGHT_DEVIATION) ** 2)
    return np.asarray(fit[:2])
