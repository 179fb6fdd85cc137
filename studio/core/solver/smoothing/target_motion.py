"""Angular accelerations of bones caused by moving targets and changing activations (METHOD (36))."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from studio.core.body.morphology import Morphology
from studio.core.solver.task_assembly.kinds.known import KIND_BY_CODE
from studio.core.solver.task_assembly.target_trajectory import UnsolvedTask
from studio.core.solver.task_assembly.task_rows import TaskRecords

FloatArray = NDArray[np.float64]

TARGET_PEAK_SPREAD_SECONDS = 0.1
"""Seconds around a frame within which a target's acceleration may show in the joints."""


def target_accelerations(
    rows: TaskRecords,
    first: int,
    activations: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
    body: Morphology,
    rate: float,
) -> FloatArray:
    """Angular accelerations (2, C, F) in rad/s2 caused by the targets from row ``first`` on: by their motion, by their
    activation.

    The first is (a + v^2 / l) / l over a lever of l metres, with v and a of the target trajectory; the second is the
    second derivative of the activation (C, F) times the angle of the displacement, at most one radian.
    """
    brings = np.zeros((2, *activations.shape))
    for c in (first + np.flatnonzero((activations[first:] > 0.0).any(axis=1))).tolist():
        course = KIND_BY_CODE[int(rows.tasks["kind"][c])].trajectory
        path, lever = course(UnsolvedTask(c, rows, positions, rotations, body))
        edges = np.pad(np.abs(np.diff(activations[c], 2)), 1, mode="edge") * rate**2
        angles = np.minimum(np.linalg.norm(path, axis=1) / lever, 1.0)
        sharp = np.stack([_sharp(path, lever, rate), edges * angles])
        acts = maximum_filter1d(activations[c] > 0.0, 3)
        brings[:, c] = maximum_filter1d(
            np.where(acts, sharp, 0.0), 2 * round(TARGET_PEAK_SPREAD_SECONDS * rate) + 1, mode="nearest"
        )
    return brings


def _sharp(path: FloatArray, lever: float, rate: float) -> FloatArray:
    """Angular acceleration (F,) in rad/s2 of a bone of length ``lever`` whose end moves along ``path`` (F, n)."""
    speed = np.linalg.norm(np.gradient(path, axis=0), axis=1) * rate
    push = np.linalg.norm(np.diff(path, 2, axis=0), axis=1) * rate**2
    return np.asarray((np.pad(push, 1, mode="edge") + speed**2 / lever) / lever)
