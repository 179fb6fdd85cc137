"""Detection of markers that jump, for one frame or from a frame on, to where no body can have moved them."""

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import MARKER_KIND, Trial

FloatArray = NDArray[np.float64]

JUMP_DISTANCE, JUMP_ACCELERATION = 0.04, 200.0
"""Jump: metres by which a step is outside the range of the steps before and after it, and metres per second squared."""


def marker_jumps(trial: Trial) -> dict[str, tuple[NDArray[np.bool_], float]]:
    """Jumping markers by label: mask (F,) of the frames into which each jumps, and its greatest jump in metres.

    The steps of a body that accelerates or strikes lie between those before and after; a jump is outside of both. At
    the ends it is only compared with the one neighbour.
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
    """Distances (N,) of steps (N, 3) from the line between the previous and the next step; NaN if both are missing."""
    before, after = np.full((2, *steps.shape), np.nan)
    before[1:], after[:-1] = steps[:-1], steps[1:]
    before, after = np.where(np.isnan(before), after, before), np.where(np.isnan(after), before, after)
    way = after - before
    along = np.sum((steps - before) * way, axis=1) / np.maximum(np.sum(way**2, axis=1), 1e-18)
    nearest = before + np.clip(along, 0.0, 1.0)[:, None] * way
    return np.asarray(np.linalg.norm(steps - nearest, axis=1))
