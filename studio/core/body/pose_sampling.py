"""Sampling of poses between frames."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.rotations import slerp

FloatArray = NDArray[np.float64]

_SAME = 1e-6
"""A part of a frame within which a moment is that frame itself."""


def poses_at(poses: PoseSequence, frames: FloatArray) -> PoseSequence:
    """Poses at ``frames`` (N,), which need not be whole; clamped at both ends.

    Whole frames are returned unchanged; between two, joints are interpolated linearly and spherically.
    """
    last = poses.frame_count - 1
    within = np.clip(frames, 0.0, float(last))
    nearest = np.rint(within)
    within = np.where(np.abs(within - nearest) < _SAME, nearest, within)
    before = np.floor(within).astype(np.int64)
    share = within - before
    between = np.flatnonzero(share > 0.0)
    rotations, translations = poses.local_rotations[before], poses.local_translations[before]
    if len(between):
        low, part = before[between], share[between, None]
        rotations[between] = slerp(poses.local_rotations[low], poses.local_rotations[low + 1], part)
        here, there = poses.local_translations[low], poses.local_translations[low + 1]
        translations[between] = here + part[..., None] * (there - here)
    return PoseSequence(rotations, translations)
