"""Flight height: the head of a short body that turns over in the air would be below the ground (METHOD 5)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.captures.contacts import ContactInterval, contact_mask
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

LEAST_FLIGHT_FRACTION = 0.25
"""Least height of a flight, relative to its greatest, at which a penetration raises it."""


def flight_heights(
    contacts: Sequence[ContactInterval], body: AnyMorphology, floor: float, positions: FloatArray
) -> FloatArray:
    """Heights (F,) in metres to add to flights of a body, ``positions`` (F, P, 3), so that trunk and head clear the
    floor.

    They are zero during contacts, and begin and end with zero velocity.
    """
    lacking = np.maximum(floor - positions[:, : body.layout.head_end + 1, 2].min(axis=1), 0.0)
    lifted = np.zeros(len(positions))
    if not lacking.any():
        return lifted
    spans = [(each.first, each.last) for each in contacts if each.first < len(positions)]
    for first, past in runs_of(~contact_mask(spans, len(positions))):
        lack, fraction = lacking[first:past], (np.arange(past - first) + 1.0) / (past - first + 1.0)
        leap = (4.0 * fraction * (1.0 - fraction)) ** 2
        lifted[first:past] = leap * (lack / np.maximum(leap, LEAST_FLIGHT_FRACTION)).max()
    return lifted
