"""End point of a hand. Some files have hand ends of zero length, or far away at the tip of a sword."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.skeleton import Skeleton

FloatArray = NDArray[np.float64]

SHORTEST_HAND = 0.01
"""Distance in metres from the wrist within which an end belongs to a bone without length."""
LONGEST_HAND, USUAL_HAND = 1.0, 0.4
"""Fraction of the forearm: 0.1 to 0.75 in captures of people, from wrist to knuckles or finger tips."""


def hand_reach(skeleton: Skeleton, wrist: int, positions: FloatArray) -> FloatArray:
    """(F, 3) metres from a wrist to the mean of its child joints, for joints at ``positions`` (F, J, 3)."""
    ends = skeleton.children[wrist] or (wrist,)
    return np.asarray(positions[:, list(ends)].mean(axis=1) - positions[:, wrist])


def has_hand_length(reach: FloatArray, forearm: FloatArray) -> NDArray[np.bool_]:
    """(F,) true if a hand of the offset ``reach`` (F, 3) has a plausible length for a forearm (F, 3)."""
    lengths = np.linalg.norm(reach, axis=1)
    return np.asarray((lengths >= SHORTEST_HAND) & (lengths <= LONGEST_HAND * np.linalg.norm(forearm, axis=1)))
