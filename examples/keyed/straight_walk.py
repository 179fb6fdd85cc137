"""A walk straight ahead: eight steps from a stand to a stand."""

import numpy as np

from .curves import breath, curve, drift
from .feet import foot_path
from .gait import Step, Walk, swinging_arm
from .performer import STANDING
from .targets import FRAME_RATE, Targets, frame_times

FIRST, STEP_TIME, SWING = 0.3, 0.55, 0.43
"""Seconds: the first foot leaves the ground, then every other one; how long each is in the air."""
STEP = 0.62
STEPS = 8
DURATION = FIRST + STEPS * STEP_TIME + 0.4
WALK = Walk(
    ((0.0, 0.09, 7.0), (0.0, -0.09, -7.0)),
    [
        Step(
            k % 2,
            FIRST + k * STEP_TIME,
            FIRST + k * STEP_TIME + SWING,
            (STEP * (k + 0.75 if k < STEPS - 1 else k - 0.25), (0.08, -0.08)[k % 2]),
            (5.0, -5.0)[k % 2],
            -8.0 if k == STEPS - 1 else -17.0,
        )
        for k in range(STEPS)
    ],
)


def straight_walk(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    stride, support, place = WALK.stride(times), WALK.support(times), WALK.carried(times)
    ahead = curve(times, {0.0: 0.02, FIRST + 0.2: 0.05, DURATION - 0.8: 0.045, DURATION - 0.1: 0.02}, soft=0.1)
    height = STANDING - 0.036 + 0.025 * WALK.rise(times) + 0.0015 * drift(times, 109)
    lean = curve(times, {0.0: 2.0, FIRST + 0.2: 4.5, DURATION - 0.9: 3.0, DURATION - 0.5: 0.5, DURATION: 2.0}, soft=0.1)
    still = np.zeros_like(times)
    return Targets(
        times,
        np.column_stack([place[:, 0] + ahead, place[:, 1] + 0.005 * drift(times, 101), height]),
        np.column_stack([place[:, 2] - 5.5 * stride, lean, 4.5 * support]),
        np.column_stack(
            [
                11.0 * WALK.stride(times, delay=0.04) + 1.2 * drift(times, 102, 4.3),
                1.0 - 1.6 * breath(times) + 0.7 * drift(times, 103, 3.9),
                -5.5 * WALK.support(times, delay=0.05) + 0.9 * drift(times, 104),
            ]
        ),
        np.column_stack([1.5 * drift(times, 105, 3.1), 4.0 + 1.2 * drift(times, 106), still]),
        (swinging_arm(WALK, times, 0), swinging_arm(WALK, times, 1)),
        (foot_path(0, times, WALK.plants(0)), foot_path(1, times, WALK.plants(1))),
    )
