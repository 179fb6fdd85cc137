"""Bodies that fly high enough: who turns over in the air on short legs would have its head in the ground (METHOD 4)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnyMorphology
from studio.core.captures.contacts import ContactInterval, contact_mask
from studio.core.runs import runs_of

FloatArray = NDArray[np.float64]

EARLIEST = 0.25
"""Part of its greatest height that a leap has at least where it is made higher for what lacks at that moment."""


def leaps(contacts: Sequence[ContactInterval], body: AnyMorphology, floor: float, positions: FloatArray) -> FloatArray:
    """(F,) metres by which a body, ``positions`` (F, P, 3), leaps higher, so that trunk and head are above the floor.

    Only while nothing stands, and as much higher as is lacking there: a leap begins and ends as slowly as the motion.
    """
    lacking = np.maximum(floor - positions[:, : body.layout.head_end + 1, 2].min(axis=1), 0.0)
    lifted = np.zeros(len(positions))
    if not lacking.any():
        return lifted
    spans = [(each.first, each.last) for each in contacts if each.first < len(positions)]
    for first, past in runs_of(~contact_mask(spans, len(positions))):
        lack, share = lacking[first:past], (np.arange(past - first) + 1.0) / (past - first + 1.0)
        leap = (4.0 * share * (1.0 - share)) ** 2
        lifted[first:past] = leap * (lack / np.maximum(leap, EARLIEST)).max()
    return lifted
