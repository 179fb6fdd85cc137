"""Beats of a sound: its onsets, found by spectral flux."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

FLUX_WINDOW_SECONDS, FLUX_HOP_SECONDS = 0.024, 0.005
"""Length of a window of the spectrum, and step from one window to the next, both in seconds."""
FLUX_BLOCK_FRAMES = 4096
"""Frames whose spectra are computed at once."""
FLUX_MEAN_SECONDS = 0.5
"""Seconds on either side of an onset over which the mean flux is taken that a beat must exceed."""
LEAST_BEAT_SPACING_SECONDS = 0.12
"""Shortest time in seconds between two beats."""
FLUX_FACTOR, LEAST_FLUX_FRACTION = 2.0, 0.08
"""Least flux of a beat: this factor times the mean flux around it, and this fraction of the strongest flux."""


def beats_of(samples: FloatArray, rate: float) -> FloatArray:
    """Times (B,) in seconds of the beats of a mono sound ``samples`` (N,) with ``rate`` samples per second,
    ascending.
    """
    hop, window = max(round(FLUX_HOP_SECONDS * rate), 1), max(round(FLUX_WINDOW_SECONDS * rate), 2)
    padded = np.concatenate([np.zeros(window), samples])  # what sounds at once sets in at 0
    flux = _flux(padded, hop, window)
    if not flux.size or flux.max() <= 0.0:
        return np.empty(0)
    around = round(FLUX_MEAN_SECONDS / FLUX_HOP_SECONDS)
    sums = np.concatenate([[0.0], np.cumsum(flux)])
    first = np.maximum(np.arange(len(flux)) - around, 0)
    last = np.minimum(np.arange(len(flux)) + around + 1, len(flux))
    mean = (sums[last] - sums[first]) / (last - first)
    strong = np.flatnonzero((flux > FLUX_FACTOR * mean) & (flux > LEAST_FLUX_FRACTION * flux.max()))
    apart = round(LEAST_BEAT_SPACING_SECONDS / FLUX_HOP_SECONDS)
    found, near_another = [], np.zeros(len(flux), dtype=bool)
    for place in strong[np.argsort(-flux[strong], kind="stable")].tolist():
        if not near_another[place]:
            found.append(place)
            near_another[max(place - apart + 1, 0) : place + apart] = True
    # The spectrum grows most where a sound that sets in comes to the middle of the window.
    return np.sort(np.maximum(((np.array(found) - 0.5) * hop - window / 2) / rate, 0.0))


def _flux(samples: FloatArray, hop: int, window: int) -> FloatArray:
    """Spectral flux (F,): sum of the increases of all magnitudes from the previous spectrum to that of each frame."""
    frames = np.lib.stride_tricks.sliding_window_view(samples, window)[::hop]
    taper, before, found = np.hanning(window), np.zeros(window // 2 + 1), []
    for begin in range(0, len(frames), FLUX_BLOCK_FRAMES):
        spectra = np.abs(np.fft.rfft(frames[begin : begin + FLUX_BLOCK_FRAMES] * taper, axis=1))
        growth = np.diff(spectra, axis=0, prepend=before[None])
        found.append(np.maximum(growth, 0.0).sum(axis=1))
        before = spectra[-1]
    return np.concatenate(found) if found else np.empty(0)
