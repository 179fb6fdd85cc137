"""Heels that leave the ground while the ball still stands: a heel contact ends when its heel begins to rise."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import noise_deviation, spans_of
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

LYING = 0.3
"""The part of a contact's heights, from the lowest, at which the ankle is while the sole lies flat."""
RISES, RISEN = 0.004, 0.012
"""Parts of the leg's length above that at which a heel begins to rise, if it goes on to rise so far."""


def rising_heels(
    heels: Sequence[tuple[int, int]], toe: NDArray[np.bool_], ankle: FloatArray, leg_length: float
) -> NDArray[np.bool_]:
    """(F,) true where a heel rises or sinks over a ball that stands, ``toe`` (F,).

    ``heels`` are the frames (first, last) of its contacts, ``ankle`` (F, 3) metres, Z up. Noise of the ankle is no
    rise.
    """
    heights, noise = ankle[:, 2], noise_deviation(ankle, toe)
    rising = np.zeros(len(heights), dtype=np.bool_)
    stances = spans_of(toe)
    begins, ends = (np.array([stance[edge] for stance in stances], dtype=int) for edge in (0, 1))
    for first, last in heels:
        low = np.quantile(heights[first : last + 1], LYING)
        for stance, past in stances[np.searchsorted(ends, first) : np.searchsorted(begins, last, "right")]:
            above = heights[stance : past + 1] - low  # they go on to rise after the contact
            for begin, end in runs_of(above > max(RISES * leg_length, noise)):
                own = slice(max(stance + begin, first), min(stance + end, last + 1))
                rising[own] |= above[begin:end].max() > max(RISEN * leg_length, 2.0 * noise)
    return rising
