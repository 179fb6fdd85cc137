"""Beats of a sound: its onsets, found by spectral flux."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

FLUX_WINDOW_SECONDS, FLUX_HOP_SECONDS = 0.024, 0.005
FLUX_BLOCK_FRAMES = 4096
"""Frames whose spectra are computed at once."""
LOCAL_SECONDS = 0.5
"""Seconds on either side whose mean flux a beat surpasses."""
LEAST_APART_SECONDS = 0.12
FLUX_FACTOR, LEAST_FLUX_PART = 2.0, 0.08
"""Flux of a beat in means of what is around it, and in parts of the strongest one."""


def beats_of(samples: FloatArray, rate: float) -> FloatArray:
    """(B,) seconds of beats in mono ``samples`` (N,) of ``rate`` Hz, ascending."""
    hop, window = max(round(FLUX_HOP_SECONDS * rate), 1), max(round(FLUX_WINDOW_SECONDS * rate), 2)
    padded = np.concatenate([np.zeros(window), samples])  # what sounds at once sets in at 0
    flux = _flux(padded, hop, window)
    if not flux.size or flux.max() <= 0.0:
        return np.empty(0)
    around = round(LOCAL_SECONDS / FLUX_HOP_SECONDS)
    sums = np.concatenate([[0.0], np.cumsum(flux)])
    first = np.maximum(np.arange(len(flux)) - around, 0)
    last = np.minimum(np.arange(len(flux)) + around + 1, len(flux))
    mean = (sums[last] - sums[first]) / (last - first)
    strong = np.flatnonzero((flux > FLUX_FACTOR * mean) & (flux > LEAST_FLUX_PART * flux.max()))
    apart = round(LEAST_APART_SECONDS / FLUX_HOP_SECONDS)
    found, near_another = [], np.zeros(len(flux), dtype=bool)
    for place in strong[np.argsort(-flux[strong], kind="stable")].tolist():
        if not near_another[place]:
            found.append(place)
            near_another[max(place - apart + 1, 0) : place + apart] = True
    # The spectrum grows most where a sound that sets in comes to the middle of the window.
    return np.sort(np.maximum(((np.array(found) - 0.5) * hop - window / 2) / rate, 0.0))


def _flux(samples: FloatArray, hop: int, window: int) -> FloatArray:
    """(F,) increase of all magnitudes of the spectrum from one frame to the next."""
    frames = np.lib.stride_tricks.sliding_window_view(samples, window)[::hop]
    taper, before, found = np.hanning(window), np.zeros(window // 2 + 1), []
    for begin in range(0, len(frames), FLUX_BLOCK_FRAMES):
        spectra = np.abs(np.fft.rfft(frames[begin : begin + FLUX_BLOCK_FRAMES] * taper, axis=1))
        growth = np.diff(spectra, axis=0, prepend=before[None])
        found.append(np.maximum(growth, 0.0).sum(axis=1))
        before = spectra[-1]
    return np.concatenate(found) if found else np.empty(0)
