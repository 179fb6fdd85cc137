"""Something is picked up from the floor with the right hand, the left on the way to the knee, and looked at."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import OUTWARD, STANDING
from .targets import FRAME_RATE, ArmTargets, Targets, frame_times

DURATION = 6.2
TOUCH, OFF = 2.2, 2.7
"""Fingers on the floor, and off it."""
PLACE = (0.46, -0.17, 0.17)
"""The wrist over the fingers on the floor."""
BEND = {0.6: 0.0, TOUCH - 0.05: 1.0, OFF: 1.0, 4.1: 0.0}


def floor_reach(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    bend = curve(times, BEND, soft=0.09)
    looks = curve(times, {3.6: 0.0, 4.4: 1.0, 5.2: 1.0, 5.9: 0.0}, soft=0.08)
    alive = [0.8 * np.column_stack([drift(times, seed + k, 3.0) for k in range(3)]) for seed in (141, 144, 147)]
    still = np.zeros_like(times)
    return Targets(
        times,
        np.column_stack(
            [
                0.03 - 0.07 * bend + 0.005 * drift(times, 150),
                -0.03 * bend + 0.006 * drift(times, 151, 3.3),
                STANDING - 0.013 - 0.27 * bend,
            ]
        ),
        np.column_stack([10.0 * bend, 2.0 + 46.0 * bend, 4.0 * bend]) + alive[0],
        np.column_stack([12.0 * bend, 2.0 + 30.0 * bend - 1.2 * breath(times), 4.0 * bend]) + alive[1],
        np.column_stack([8.0 * bend - 8.0 * looks, 5.0 + 52.0 * bend + 24.0 * looks, still]) + alive[2],
        (_left_arm(times, bend), _right_arm(times, looks)),
        (
            foot_path(
                0, times, [Plant(-1e3, 1e3, (-0.05, 0.12), 10.0, heel={1.4: 0.0, TOUCH: 12.0, OFF: 12.0, 3.5: 0.0})]
            ),
            foot_path(1, times, [Plant(-1e3, 1e3, (0.06, -0.11), -12.0)]),
        ),
        splay=(10.0, 10.0),
    )


def _left_arm(times: FloatArray, bend: FloatArray) -> ArmTargets:
    """Goes back and out against the reach."""
    hangs = np.array([0.05, 0.07, -0.54]) + np.outer(bend, [0.05, 0.10, 0.05])
    return ArmTargets(
        hangs + 0.004 * np.column_stack([drift(times, 152 + k) for k in range(3)]),
        np.array([-1.0, 0.5, 0.0]),
        upright=0.75 * np.ones_like(times),
        pronation=30.0,
        flexion=12.0,
        shrug=1.5 * breath(times),
    )


def _right_arm(times: FloatArray, looks: FloatArray) -> ArmTargets:
    out = OUTWARD[1]
    wrist = np.array([0.05, 0.07 * out, -0.54]) + np.outer(looks, [0.25, 0.14, 0.30])
    holding = curve(times, {0.9: 0.0, TOUCH - 0.1: 1.0, OFF: 1.0, 3.6: 0.0}, soft=0.06)
    above = np.outer(
        curve(times, {TOUCH - 0.3: 1.0, TOUCH: 0.0, OFF: 0.0, OFF + 0.3: 1.0}, soft=0.03), [0.0, 0.0, 0.07]
    )
    return ArmTargets(
        wrist + 0.004 * np.column_stack([drift(times, 156 + k) for k in range(3)]),
        np.array([-1.0, 0.5 * out, 0.0]) + np.outer(looks, [0.3, 0.2, -0.8]),
        upright=0.75 * (1 - holding) * (1 - looks),
        held=np.array(PLACE) + above,
        holding=holding,
        pronation=30.0 - 20.0 * looks,
        flexion=10.0 + 14.0 * holding,
        shrug=1.5 * breath(times),
    )
