"""Markers that jump: for a frame, or from a frame on, they are where no body can have moved them."""

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import MARKER_KIND, Trial

FloatArray = NDArray[np.float64]

JUMP_DISTANCE, JUMP_ACCELERATION = 0.04, 200.0
"""Metres by which a step may lie off all between the one before and the one after it, and metres a second squared."""


def marker_jumps(trial: Trial) -> dict[str, tuple[NDArray[np.bool_], float]]:
    """Label of each marker that jumps: (F,) true for frames into which it jumps, and the greatest jump in metres.

    A body that accelerates or strikes takes steps between those before and after; a jump is off both. Without one of
    these frames it only has to differ from the other.
    """
    allowed = max(JUMP_DISTANCE, JUMP_ACCELERATION / trial.frame_rate**2)
    found = {}
    for place in (place for place, kind in enumerate(trial.kinds) if kind == MARKER_KIND):
        steps = trial.metres * np.diff(trial.points[:, place], axis=0)
        far = _off_their_neighbours(steps) > allowed
        if far.any():
            found[trial.labels[place]] = np.append(False, far), float(np.linalg.norm(steps[far], axis=1).max())
    return found


def _off_their_neighbours(steps: FloatArray) -> FloatArray:
    """(N,) distance of each step (N, 3) from the line between the one before and the one after; NaN without any."""
    before, after = np.full((2, *steps.shape), np.nan)
    before[1:], after[:-1] = steps[:-1], steps[1:]
    before, after = np.where(np.isnan(before), after, before), np.where(np.isnan(after), before, after)
    way = after - before
    along = np.sum((steps - before) * way, axis=1) / np.maximum(np.sum(way**2, axis=1), 1e-18)
    nearest = before + np.clip(along, 0.0, 1.0)[:, None] * way
    return np.asarray(np.linalg.norm(steps - nearest, axis=1))
