"""Poses of the fingers of both hands, in axes that all skeletons share."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FingerPoses:
    """Fingers of both hands in N frames."""

    rotations: FloatArray
    """(N, 2, 5, 3, 4) captured rotation of each finger joint from a straight finger, relative to the joint before, in
    the axes of the hand."""
    captured: FloatArray
    """(N,) fraction, from 0 to 1, of ``rotations`` in the pose; the rest is the character's own hand."""
    grips: FloatArray
    """(N,) grip that is asked for, from -1 (open) to 1 (fists)."""
    asked: FloatArray
    """(N,) fraction, from 0 to 1, of that grip in the pose."""

    @property
    def is_at_rest(self) -> bool:
        """True if no finger ever moves."""
        return not (self.captured.any() or self.asked.any())
