"""End point of a hand. In some files the hand has zero length, or ends at the tip of a sword."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.skeleton import Skeleton

FloatArray = NDArray[np.float64]

SHORTEST_HAND_METRES = 0.01
"""Distance in metres from the wrist below which an end belongs to a bone without length."""
LONGEST_HAND_FRACTION, USUAL_HAND_FRACTION = 1.0, 0.4
"""Longest and usual length of a hand as fractions of the forearm; people have 0.1 to 0.75, from wrist to knuckles or
finger tips.
"""


def hand_reach(skeleton: Skeleton, wrist: int, positions: FloatArray) -> FloatArray:
    """Vectors (F, 3) in metres from a wrist to the mean of its child joints, for joints at ``positions`` (F, J, 3)."""
    ends = skeleton.children[wrist] or (wrist,)
    return np.asarray(positions[:, list(ends)].mean(axis=1) - positions[:, wrist])


def has_hand_length(reach: FloatArray, forearm: FloatArray) -> NDArray[np.bool_]:
    """Mask (F,) of frames in which the vector ``reach`` (F, 3) has a plausible length for the hand of ``forearm`` (F,
    3).
    """
    lengths = np.linalg.norm(reach, axis=1)
    return np.asarray(
        (lengths >= SHORTEST_HAND_METRES) & (lengths <= LONGEST_HAND_FRACTION * np.linalg.norm(forearm, axis=1))
    )
