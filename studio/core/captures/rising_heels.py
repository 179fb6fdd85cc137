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


def rising_heels(
    heels: Sequence[tuple[int, int]], toe: NDArray[np.bool_], ankle: FloatArray, leg_length: float
) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which a heel rises or sinks while the ball stands, ``toe`` (F,).

    ``heels`` are the spans (first, last) of heel contacts, ``ankle`` (F, 3) is in metres, Z up. Noise of the ankle is
    not taken as a rise.
    """
    heights, noise = ankle[:, 2], noise_deviation(ankle, toe)
    rising = np.zeros(len(heights), dtype=np.bool_)
    stances = spans_of(toe)
    begins, ends = (np.array([stance[edge] for stance in stances], dtype=int) for edge in (0, 1))
    for first, last in heels:
        low = np.quantile(heights[first : last + 1], FLAT_SOLE_FRACTION)
        for stance, past in stances[np.searchsorted(ends, first) : np.searchsorted(begins, last, "right")]:
            above = heights[stance : past + 1] - low  # they go on to rise after the contact
            for begin, end in runs_of(above > max(HEEL_RISE_BEGIN * leg_length, noise)):
                own = slice(max(stance + begin, first), min(stance + end, last + 1))
                rising[own] |= above[begin:end].max() > max(HEEL_RISE_LEAST * leg_length, 2.0 * noise)
    return rising
