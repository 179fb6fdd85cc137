"""How good an adapted motion is, in millimetres and in ratios to its source."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.contacts import ContactInterval
from studio.core.ground import Ground
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]

QUIET = 20.0
"""Radians a second squared: a source peak below it counts as this, or a still source would divide by nothing."""


@dataclass(frozen=True)
class FootQuality:
    """Worst values over all contacts of a motion, in metres."""

    slide: float
    """Greatest horizontal distance of a standing ankle or toe joint from where its contact began."""
    rise: float
    """Greatest height of a standing heel or ball above the ground."""
    penetration: float
    """Greatest depth of either below it."""


def foot_quality(adapted: AdaptedMotion, contacts: Sequence[ContactInterval], ground: Ground) -> FootQuality:
    """Slide, float and penetration of the soles during ``contacts`` (frames counted in the whole motion)."""
    body, layout = adapted.morphology, adapted.morphology.layout
    slide = rise = depth = 0.0
    for contact in contacts:
        first = max(contact.first - adapted.first_frame, 0)
        stop = min(contact.last + 1 - adapted.first_frame, adapted.frame_count)
        if stop <= first:
            continue
        side, span = contact.point.side, slice(first, stop)
        foot = adapted.rotations[span, layout.spine_count + 12 + 4 * side]
        ankle, toe = adapted.positions[span, layout.ankle(side)], adapted.positions[span, layout.toe(side)]
        joint = ankle if contact.point.is_heel else toe
        slide = max(slide, float(np.linalg.norm(joint[:, :2] - joint[0, :2], axis=1).max()))
        if contact.point.is_heel:
            heel = np.array([-body.heel_length[side], 0.0, -body.ankle_height[side]])
            sole = ankle + foot @ heel
        else:
            sole = toe - np.array([0.0, 0.0, body.ankle_height[side] + body.foot[side, 2]])
        height = sole[:, 2] - ground.height_at(sole)
        rise, depth = max(rise, float(height.max())), max(depth, float(-height.min()))
    return FootQuality(slide, rise, depth)


def angular_acceleration(rotations: FloatArray, frame_rate: float) -> FloatArray:
    """Magnitude (F - 2, ...) in rad/s^2 of the angular acceleration of rotations (F, ..., 3, 3)."""
    turns = np.swapaxes(rotations[:-1], -1, -2) @ rotations[1:]
    velocity = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec().reshape(turns.shape[:-1])
    return np.asarray(np.linalg.norm(np.diff(velocity, axis=0), axis=-1) * frame_rate**2)


def acceleration_ratio(adapted: AdaptedMotion, source: AdaptedMotion) -> float:
    """Worst peak angular acceleration of a thigh or shank, beside the same segment's peak in the source.

    About 1 is as smooth as the capture; a popping knee shows as 5 and more. 1 for fewer than three frames.
    """
    worst = 0.0
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    for side in range(2):
        for bone in range(2):
            peaks = []
            for motion, frames in ((adapted, slice(None)), (source, window)):
                segment = motion.morphology.layout.spine_count + 10 + 4 * side + bone
                if len(motion.rotations[frames]) < 3:
                    return 1.0
                peaks.append(angular_acceleration(motion.rotations[frames, segment], motion.frame_rate).max())
            worst = max(worst, peaks[0] / max(peaks[1], QUIET))
    return float(worst)
