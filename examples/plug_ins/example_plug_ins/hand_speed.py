"""A measure for plots and reports: how fast the faster hand moves."""

from typing import Any

import numpy as np

from studio import api

HANDS = tuple(api.BodyPoint(api.BodyPart(f"{side}_hand")) for side in ("left", "right"))


def hand_speed(adapted: Any) -> np.ndarray:
    """Speed (F,) of the faster hand, metres a second."""
    from studio.core.solver.adapt import body_point_positions

    if adapted.frame_count < 2:
        return np.zeros(adapted.frame_count)
    speeds = [np.gradient(body_point_positions(hand, adapted), axis=0) * adapted.frame_rate for hand in HANDS]
    return np.linalg.norm(speeds, axis=2).max(axis=0)


MEASURE = api.MotionMeasure("Hand speed", "m/s", hand_speed)
