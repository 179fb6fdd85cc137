"""How sharply targets themselves move and come and go: what joints must turn with to follow them (METHOD (36))."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from studio.core.body.morphology import Morphology
from studio.core.solver.asking.course import Unsolved
from studio.core.solver.asking.kinds.known import BY_CODE
from studio.core.solver.asking.rows import Rows

FloatArray = NDArray[np.float64]

NEAR = 0.1
"""Seconds around a frame within which what a target brings may show in the joints."""


def brought(
    rows: Rows,
    first: int,
    activations: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
    body: Morphology,
    rate: float,
) -> FloatArray:
    """(2, C, F) radians a second squared that targets, from row ``first`` on, bring by their ways and by their edges.

    (a + v^2 / l) / l over l metres, v and a of what each asks beside where the unsolved poses have what it is for; and
    what a radian has by its activation (C, F), with which joints come and go.
    """
    brings = np.zeros((2, *activations.shape))
    for c in (first + np.flatnonzero((activations[first:] > 0.0).any(axis=1))).tolist():
        course = BY_CODE[int(rows.asked["kind"][c])].course
        path, lever = course(Unsolved(c, rows, positions, rotations, body))
        edges = np.abs(np.diff(activations[c], 2)) * rate**2
        sharp = np.stack([_sharp(path, lever, rate), np.pad(edges, 1, mode="edge")])
        acts = maximum_filter1d(activations[c] > 0.0, 3)
        brings[:, c] = maximum_filter1d(np.where(acts, sharp, 0.0), 2 * round(NEAR * rate) + 1, mode="nearest")
    return brings


def _sharp(path: FloatArray, lever: float, rate: float) -> FloatArray:
    """(F,) radians a second squared that turn a bone with a lever along a path (F, n)."""
    speed = np.linalg.norm(np.gradient(path, axis=0), axis=1) * rate
    push = np.linalg.norm(np.diff(path, 2, axis=0), axis=1) * rate**2
    return np.asarray((np.pad(push, 1, mode="edge") + speed**2 / lever) / lever)
