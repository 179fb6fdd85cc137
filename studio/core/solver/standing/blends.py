"""How what stands passes into what does not: shares and moves that ease, or are averaged, over seconds (METHOD 4)."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from studio.core.kernels.limbs.legs import smooth_lowering
from studio.core.kernels.support.gap_interpolation import interpolate_gaps, release_weights
from studio.core.kernels.support.swing_foot_clearance import SWING_FADE

FloatArray = NDArray[np.float64]

LET_GO, SLOWLY_LET_GO = 0.2, 0.3
"""Seconds in which a foot or knee comes to rest on the ground, or starts from it, and to each side over which the
weight passes from who carries to who carries next, and in which a hand lets go of the body; and a hand or the seat.
"""
GOES_ALONG = 0.4
"""Seconds in which what is displaced comes back to the motion's own: what has left the ground, and a body that leans
with it.
"""
LOOK_AHEAD = SWING_FADE
"""Seconds over which the root comes down before it must, and stays down after."""
AVERAGED = 0.1
"""Seconds to each side over which the root's moves are averaged, and which foot it goes along with."""


def smoothstep(t: FloatArray) -> FloatArray:
    """(6) of METHOD."""
    return np.asarray(t * t * t * (t * (6.0 * t - 15.0) + 10.0))


@cache
def hann_window(half: int) -> FloatArray:
    """(2 * half + 1,) weights of an average that is smooth to its second derivative; they add up to 1."""
    window = np.hanning(2 * half + 3)[1:-1]
    return np.asarray(window / window.sum())


def averaged(values: FloatArray, reach: float, frame_rate: float) -> FloatArray:
    """``values`` (F, N) averaged over ``reach`` seconds to each side (Hann): smooth to the second derivative."""
    half = max(1, round(reach * frame_rate))
    return np.asarray(convolve1d(values, hann_window(half), axis=0, mode="nearest"))


def freedom(planted: NDArray[np.bool_], frame_rate: float, after: float = SWING_FADE) -> FloatArray:
    """(F,) 0 while a foot stands, eased to 1 within ``after`` seconds of the nearest frame that does."""
    free = np.empty(len(planted))
    release_weights(planted, after * frame_rate, free)
    return free


def eased(corrections: FloatArray, known: NDArray[np.bool_], frame_rate: float) -> FloatArray:
    """Corrections (F, 3) where ``known`` (F,), eased from one to the next or, over ``GOES_ALONG`` seconds, to nothing.

    What is let go has the motion's own speed from there on: a hand that kept its rest would have less time for its way.
    """
    filled = corrections.copy()
    interpolate_gaps(filled, known | (_frames_to_nearest(known) >= max(round(GOES_ALONG * frame_rate), 1)))
    return filled


def _frames_to_nearest(known: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(F,) how many frames away the nearest one is that is ``known`` (F,)."""
    frames, stands = np.arange(len(known)), np.flatnonzero(known)
    after = np.searchsorted(stands, frames)
    behind, ahead = stands[np.maximum(after - 1, 0)], stands[np.minimum(after, len(stands) - 1)]
    return np.asarray(np.minimum(np.abs(frames - behind), np.abs(ahead - frames)))


def smooth_drops(drops: FloatArray, frame_rate: float) -> FloatArray:
    """At least ``drops`` (F,) everywhere, and smooth: their moving maximum, averaged over the same support.

    The paper's plain minimum of three heights jolts the root (accelerations 3 to 27 times the source's).
    """
    if not (drops > 0.0).any():
        return np.zeros(len(drops))
    peaks, smooth = np.empty_like(drops), np.empty_like(drops)
    smooth_lowering(drops, hann_window(max(1, round(LOOK_AHEAD * frame_rate))), peaks, smooth)
    return smooth


def lacking(heights: FloatArray, room: float) -> FloatArray:
    """(F,) by how much to raise what is at ``heights`` (F,) so that it keeps above 0: METHOD (7)."""
    share = np.clip(heights / room, -1.0, 1.0)
    return np.asarray(room * (1.0 - share) ** 3 * (3.0 + share) / 16.0 + np.maximum(-heights - room, 0.0))
