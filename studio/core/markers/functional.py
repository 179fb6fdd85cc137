"""Functional joint centres: joints without a marker, found from the relative motion of two bones."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.markers.trial import seen_mask

FloatArray = NDArray[np.float64]

_TRUST_IN_PRIOR = 0.03
"""Weight of the usual place against the movement: it decides where a hinge leaves the place along its axis open."""

_STEPS = 8
_OF_A_REGRESSION, _OF_A_KNEE = 0.015, 0.008
"""Metres by which a hip that is told from the size of a body is off, as a rule, and the centre of a knee."""
_INDEPENDENT = 100
"""Frames that are worth so many measurements at most: errors of skin last."""


def cluster_axes(markers: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rigid motion of a cluster (F, n, 3) of n > 2 markers: centres (F, 3), and rotations (F, 3, 3) of its mean shape.

    The mean shape is found by aligning all frames with the first complete one (Kabsch 1976).
    """
    seen = seen_mask(markers).all(axis=1)
    if not seen.any():
        return np.full((len(markers), 3), np.nan), np.full((len(markers), 3, 3), np.nan)
    shape = markers[seen][0] - markers[seen][0].mean(axis=0)
    middles = markers.mean(axis=1)
    turns = np.full((len(markers), 3, 3), np.nan)
    for _ in range(2):
        turns[seen] = _turns(shape, markers[seen] - middles[seen, None])
        shape = np.mean(np.einsum("fji,fnj->fni", turns[seen], markers[seen] - middles[seen, None]), axis=0)
    return middles, turns


def centre_of_rotation(upper: FloatArray, lower: FloatArray, usual: FloatArray) -> FloatArray:
    """Positions (F, 3) of the joint between two clusters (F, n, 3), by symmetrical estimation (Ehrig et al. 2006).

    Least squares for a point that is fixed in both: R1 c1 + t1 = R2 c2 + t2 over all frames, with the weak prior
    ``usual`` (F, 3), the joint by the markers alone. NaN in frames in which a cluster is not seen.
    """
    (t1, r1), (t2, r2) = cluster_axes(upper), cluster_axes(lower)
    seen = seen_mask(t1) & seen_mask(t2) & seen_mask(usual)
    if not seen.any():
        return np.full_like(usual, np.nan)
    rows = np.concatenate([r1[seen], -r2[seen]], axis=2).reshape(-1, 6)
    right = (t2[seen] - t1[seen]).reshape(-1)
    prior = np.concatenate(
        [np.median(np.einsum("fji,fj->fi", r[seen], usual[seen] - t[seen]), axis=0) for r, t in ((r1, t1), (r2, t2))]
    )
    weight = _TRUST_IN_PRIOR * np.sqrt(seen.sum())
    rows = np.concatenate([rows, weight * np.eye(6)])
    centre = np.linalg.lstsq(rows, np.concatenate([right, weight * prior]), rcond=None)[0]
    return np.asarray(0.5 * (t1 + r1 @ centre[:3] + t2 + r2 @ centre[3:]))


def shift_of_centres(tracks: Sequence[FloatArray], centres: Sequence[FloatArray], direction: FloatArray) -> float:
    """Shift in metres along ``direction`` (3,) of joint centres (3,), such as hips, that keeps their distances to the
    tracks (F, 3) of the next joints most constant, all in the axes of the centres' segment.

    Maximum a posteriori estimate by Gauss-Newton, with the usual errors of centres and tracks as prior.
    """
    shift = 0.0
    for _ in range(_STEPS):
        slope, curvature = shift / _OF_A_REGRESSION**2, 1.0 / _OF_A_REGRESSION**2
        for track, centre in zip(tracks, centres, strict=True):
            apart = track[seen_mask(track)] - centre - shift * direction
            if len(apart):
                lengths = np.maximum(np.linalg.norm(apart, axis=1), 1e-6)
                change = -(apart @ direction) / lengths
                change -= change.mean()
                weight = min(len(apart), _INDEPENDENT) / len(apart) / _OF_A_KNEE**2
                slope += weight * float(change @ (lengths - lengths.mean()))
                curvature += weight * float(change @ change)
        shift -= slope / curvature
    return shift


def _turns(shape: FloatArray, targets: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) that align ``shape`` (n, 3) best with ``targets`` (F, n, 3), both about their means."""
    u, _, v = np.linalg.svd(np.einsum("ni,fnj->fij", shape, targets))
    turn = np.ones((len(targets), 3))
    turn[:, 2] = np.sign(np.linalg.det(u) * np.linalg.det(v))
    return np.asarray(np.einsum("fji,fj,fkj->fik", v, turn, u))
