"""Poses of the fingers of both hands, in axes common to all skeletons."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FingerPoses:
    """Finger poses of both hands in N frames: captured rotations blended with requested grips."""

    rotations: FloatArray
    """Captured rotations (N, 2, 5, 3, 4) of each finger joint from a straight finger, relative to the previous joint,
    in the axes of the hand.
    """
    captured: FloatArray
    """Weights (N,) from 0 to 1 of ``rotations`` in the pose; the rest is the character's own hand."""
    grips: FloatArray
    """Requested grips (N,), from -1 (open) to 1 (fists)."""
    asked: FloatArray
    """Weights (N,) from 0 to 1 of ``grips`` in the pose."""

    @property
    def is_at_rest(self) -> bool:
        """True if no finger moves in any frame."""
        return not (self.captured.any() or self.asked.any())
