"""Heels that leave the ground while the ball still stands: a heel contact ends as its heel begins to rise."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import noise_deviation, spans_of
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

FLAT_SOLE_FRACTION = 0.3
"""Quantile of the ankle's heights in a heel contact that is the height over the flat sole."""
HEEL_RISE_BEGIN, HEEL_RISE_LEAST = 0.004, 0.012
"""Heights above that of the flat sole, as fractions of the leg length: at which a heel begins to rise, and which it
must reach in the same rise.
"""
FLOOR_DRIFT_SPEED = 0.012
"""Greatest speed in metres per second with which the floor of a capture rises or sinks."""


def rising_heels(
    heels: Sequence[tuple[int, int]],
    toe: NDArray[np.bool_],
    ankle: FloatArray,
    ball: FloatArray,
    leg_length: float,
    frame_rate: float,
) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a heel rises or sinks while the ball stands, ``toe`` (F,).

    ``heels`` are the spans (first, last) of heel contacts; ``ankle`` and ``ball`` (F, 3), metres, Z up, are joints of
    the foot. A rising heel rises above its height in the contact, and either relative to the ball or faster than the
    floor of a capture drifts, since drift lifts both. Noise of the ankle is not taken as a rise.
    """
    floor = _floor_under(np.where(toe, ankle[:, 2], np.inf), FLOOR_DRIFT_SPEED / frame_rate)
    heights = np.stack([ankle[:, 2], ankle[:, 2] - ball[:, 2], ankle[:, 2] - floor])
    noise = max(noise_deviation(ankle, toe), noise_deviation(ankle - ball, toe))
    rising = np.zeros(len(ankle), dtype=np.bool_)
    stances = spans_of(toe)
    begins, ends = (np.array([stance[edge] for stance in stances], dtype=int) for edge in (0, 1))
    for first, last in heels:
        flat = toe[first : last + 1]
        if not flat.any():
            continue
        lows = np.quantile(heights[:, first : last + 1][:, flat], FLAT_SOLE_FRACTION, axis=1)
        for stance, past in stances[np.searchsorted(ends, first) : np.searchsorted(begins, last, "right")]:
            over_low, over_ball, over_floor = heights[:, stance : past + 1] - lows[:, None]
            above = np.minimum(over_low, np.maximum(over_ball, over_floor))  # they go on to rise after the contact
            for begin, end in runs_of(above > max(HEEL_RISE_BEGIN * leg_length, noise)):
                own = slice(max(stance + begin, first), min(stance + end, last + 1))
                rising[own] |= above[begin:end].max() > max(HEEL_RISE_LEAST * leg_length, 2.0 * noise)
    return rising


def _floor_under(heights: FloatArray, drift: float) -> FloatArray:
    """Highest floor (F,) below the ``heights`` (F,) that rises and sinks by no more than ``drift`` a frame."""
    ramp = drift * np.arange(len(heights))
    before = np.minimum.accumulate(heights - ramp) + ramp
    after = np.minimum.accumulate((heights + ramp)[::-1])[::-1] - ramp
    return np.asarray(np.minimum(before, after))
