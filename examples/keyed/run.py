"""A run through the captured volume: it begins and ends in full stride."""

import numpy as np

from .curves import FloatArray, curve, drift
from .feet import Plant, foot_path
from .performer import OUTWARD, STANDING
from .targets import FRAME_RATE, ArmTargets, Targets, frame_times

DURATION = 3.6
STEP_TIME, STANCE = 0.36, 0.23
"""Seconds from landing to landing, and on the ground."""
SPEED = 2.9
HALFWAY = 0.10
"""Seconds from landing until the hips are over the ankle."""
FIRST = -2.0 * STEP_TIME + 0.05


def run(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    phase = np.pi * (times - FIRST - 0.5 * STANCE) / STEP_TIME
    """Half a turn a step: 0 in the middle of the left foot's stance."""
    left, bounce = np.cos(phase), np.cos(2.0 * phase)
    stride = np.cos(phase + np.pi * (0.5 * STANCE - 0.02) / STEP_TIME)
    still = np.zeros_like(times)
    return Targets(
        times,
        np.column_stack(
            [SPEED * times, 0.012 * left + 0.01 * drift(times, 111), STANDING - 0.055 - 0.035 * bounce],
        ),
        np.column_stack([-8.0 * stride + 1.0 * drift(times, 112), 8.0 - 2.0 * bounce, 3.5 * left]),
        np.column_stack([17.0 * stride, 3.0 + 1.0 * drift(times, 113), -4.0 * left]),
        np.column_stack([1.5 * drift(times, 114), 6.0 + 1.2 * drift(times, 115) + bounce, still]),
        (_arm(times, 0, stride), _arm(times, 1, -stride)),
        (foot_path(0, times, _plants(0)), foot_path(1, times, _plants(1))),
        splay=(4.0, 4.0),
    )


def _plants(side: int) -> list[Plant]:
    """Every other step, from before the clip until after it."""
    landings = np.arange(FIRST + side * STEP_TIME, DURATION + 3.0 * STEP_TIME, 2.0 * STEP_TIME)
    return [
        Plant(
            landing,
            landing + STANCE,
            (SPEED * (landing + HALFWAY), 0.045 * OUTWARD[side]),
            4.0 * OUTWARD[side],
            strike=-4.0,
            landing=0.10,
            push=48.0,
            roll=0.22,
            clearance=0.24,
        )
        for landing in landings
    ]


def _arm(times: FloatArray, side: int, stride: FloatArray) -> ArmTargets:
    """Bent by a right angle, it swings against the leg."""
    out, swing = OUTWARD[side], -stride
    wrist = np.column_stack([0.13 + 0.17 * swing, out * (0.03 - 0.05 * np.maximum(swing, 0)), -0.30 + 0.10 * swing])
    return ArmTargets(
        wrist + 0.005 * np.column_stack([drift(times, 116 + 3 * side + k) for k in range(3)]),
        np.array([-1.0, 0.45 * out, -0.35]),
        pronation=12.0,
        flexion=10.0 + 4.0 * curve(times, {0.0: 0.0, DURATION: 1.0}),
        shrug=2.0,
    )
