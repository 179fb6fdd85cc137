"""Positions of heels, balls and tips of feet, for their contacts: captures have an ankle and a ball, seldom a heel."""

import numpy as np
from numpy.typing import NDArray

from studio.core.normalized.landmarks import Landmarks
from studio.core.normalized.measure import HEEL_LENGTH_FRACTION, USUAL_ANKLE

FloatArray = NDArray[np.float64]

FLAT_FOOT_HEIGHT = 0.03
"""Metres above their own usual lows that ankle and ball of a flat foot may be."""


def sole_points(marks: Landmarks, leg_length: float, first_frame: int) -> FloatArray:
    """(F, 2, 3, 3) metres: heel, ball and tip of the toes of left and right foot.

    The heel is fixed to the foot at its position on the ground under a flat foot; frames before ``first_frame`` are not
    used to find it. On a foot that never is flat it is at the ankle.
    """
    layout, points = marks.layout, marks.points
    soles = np.empty((len(points), 2, 3, 3))
    for side in (0, 1):
        ankles, balls, tips = (points[:, layout.ankle_point(side) + step] for step in range(3))
        flat = _near_its_low(ankles[first_frame:]) & _near_its_low(balls[first_frame:])
        turns = marks.rotations[:, layout.foot_segment(side)]
        backward = HEEL_LENGTH_FRACTION * (ankles - balls)[first_frame:][flat]
        backward[:, 2] = -2.0 * USUAL_ANKLE * leg_length
        in_foot = np.einsum("fji,fj->fi", turns[first_frame:][flat], backward)
        heels = ankles + turns @ (np.median(in_foot, axis=0) if len(in_foot) else np.zeros(3))
        soles[:, side] = np.stack([heels, balls, tips], axis=1)
    return soles


def _near_its_low(track: FloatArray) -> NDArray[np.bool_]:
    return np.asarray(track[:, 2] < np.percentile(track[:, 2], 5) + FLAT_FOOT_HEIGHT)
