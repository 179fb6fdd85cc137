"""Flight height: without it the head of a short body that turns over in the air would be below the ground (METHOD
5).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.captures.contacts import ContactInterval, contact_mask
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

LEAST_FLIGHT_FRACTION = 0.25
"""Least fraction of its greatest rise that a flight is taken to have at a penetration: near its ends the flight would
rise without bound.
"""


def flight_heights(
    contacts: Sequence[ContactInterval], body: AnyMorphology, floor: float, positions: FloatArray
) -> FloatArray:
    """Heights (F,) in metres by which flights of a body are raised so that trunk and head clear the floor.

    They are zero during contacts, and begin and end with zero velocity. ``positions`` (F, P, 3); ``floor`` is the
    floor's height.
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
