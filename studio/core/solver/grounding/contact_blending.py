"""Blending between contacts and free motion: smooth weights and averages over time (METHOD 5)."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from studio.core.kernels.limbs.legs import smooth_lowering
from studio.core.kernels.support.gap_interpolation import interpolate_gaps, release_weights
from studio.core.kernels.support.swing_foot_clearance import SWING_FADE_SECONDS

FloatArray = NDArray[np.float64]

RELEASE_SECONDS, SLOW_RELEASE_SECONDS = 0.2, 0.3
"""Seconds of release and return of contacts. The first for a foot or knee that comes to rest or starts, for a weight
that passes to the next support, and for a hand that leaves the body; the second, slower, for a hand on the ground or
the seat.
"""
DISPLACEMENT_RETURN_SECONDS = 0.4
"""Seconds in which a body displaced with its contacts returns to the motion's own position."""
LOWERING_LEAD_SECONDS = SWING_FADE_SECONDS
"""Seconds before and after a necessary root lowering over which the root is lowered."""
ROOT_AVERAGE_SECONDS = 0.1
"""Seconds on either side over which the root's displacements, and the weights of the feet that it follows, are
averaged.
"""


def smoothstep_array(t: FloatArray) -> FloatArray:
    """Quintic smoothstep of an array of values in [0, 1], equation (6) of METHOD."""
    return np.asarray(t * t * t * (t * (6.0 * t - 15.0) + 10.0))


@cache
def hann_window(half: int) -> FloatArray:
    """Weights (2 * half + 1,) of a Hann window, which add up to 1."""
    window = np.hanning(2 * half + 3)[1:-1]
    return np.asarray(window / window.sum())


def hann_average(values: FloatArray, reach: float, frame_rate: float) -> FloatArray:
    """``values`` (F, N) averaged over ``reach`` seconds on either side by a Hann window."""
    half = max(1, round(reach * frame_rate))
    return np.asarray(convolve1d(values, hann_window(half), axis=0, mode="nearest"))


def release_weight(planted: NDArray[np.bool_], frame_rate: float, after: float = SWING_FADE_SECONDS) -> FloatArray:
    """Weight (F,) that is 0 in ``planted`` frames, rising smoothly to 1 within ``after`` seconds of the nearest one."""
    free = np.empty(len(planted))
    release_weights(planted, after * frame_rate, free)
    return free


def interpolated_corrections(corrections: FloatArray, known: NDArray[np.bool_], frame_rate: float) -> FloatArray:
    """Corrections (F, 3), given where ``known`` (F,), interpolated between, or fading over
    ``DISPLACEMENT_RETURN_SECONDS``.

    A point released from a contact then keeps the motion's own speed: one that stayed at rest would have less time for
    its path.
    """
    filled = corrections.copy()
    if not known.any():
        return filled
    interpolate_gaps(
        filled, known | (_frames_to_nearest(known) >= max(round(DISPLACEMENT_RETURN_SECONDS * frame_rate), 1))
    )
    return filled


def _frames_to_nearest(known: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Distance (F,) in frames to the nearest ``known`` (F,) frame."""
    frames, stands = np.arange(len(known)), np.flatnonzero(known)
    after = np.searchsorted(stands, frames)
    behind, ahead = stands[np.maximum(after - 1, 0)], stands[np.minimum(after, len(stands) - 1)]
    return np.asarray(np.minimum(np.abs(frames - behind), np.abs(ahead - frames)))


def smooth_drops(drops: FloatArray, frame_rate: float) -> FloatArray:
    """Smooth upper envelope (F,) of the root lowerings ``drops`` (F,): their moving maximum, averaged over the same
    support.

    The paper's plain minimum of three heights has acceleration peaks 3 to 27 times the source's.
    """
    if not (drops > 0.0).any():
        return np.zeros(len(drops))
    peaks, smooth = np.empty_like(drops), np.empty_like(drops)
    smooth_lowering(drops, hann_window(max(1, round(LOWERING_LEAD_SECONDS * frame_rate))), peaks, smooth)
    return smooth


def smooth_penetrations(heights: FloatArray, margin: float | FloatArray) -> FloatArray:
    """Corrections (F,) in metres that keep ``heights`` (F,) above 0, smoothly (METHOD (7)).

    They are twice continuously differentiable, and 0 for heights of ``margin`` metres or more.
    """
    fraction = np.clip(heights / margin, -1.0, 1.0)
    return np.asarray(margin * (1.0 - fraction) ** 3 * (3.0 + fraction) / 16.0 + np.maximum(-heights - margin, 0.0))
