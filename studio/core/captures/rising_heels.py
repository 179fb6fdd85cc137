"""Heels that leave the ground while the ball still stands: a heel contact ends where its heel begins to rise."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.captures.contacts import spans_of

FloatArray = NDArray[np.float64]

LYING = 0.3
"""The part of a contact's heights, from the lowest, at which the ankle is while the sole lies flat."""
RISES, RISEN = 0.004, 0.012
"""Parts of the leg's length above that at which a heel begins to rise, if it goes on to rise so far."""


def rising_heels(
    heels: Sequence[tuple[int, int]], toe: NDArray[np.bool_], heights: FloatArray, leg_length: float
) -> NDArray[np.bool_]:
    """(F,) where a heel is on its way up or down over a ball that stands, ``toe`` (F,).

    ``heels`` frames (first, last) of its contacts, ``heights`` (F,) metres of the ankle.
    """
    rising = np.zeros(len(heights), dtype=np.bool_)
    for first, last in heels:
        above = heights - np.quantile(heights[first : last + 1], LYING)
        for begin, end in spans_of(toe & (above > RISES * leg_length)):  # they go on to rise after the contact
            own = slice(max(begin, first), min(end, last) + 1)
            rising[own] |= above[begin : end + 1].max() > RISEN * leg_length
    return rising
