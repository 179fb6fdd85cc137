"""A walk of four steps, a turn to the left about the inside foot, the way back, and a stop."""

from dataclasses import replace

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import foot_path
from .gait import Step, Walk, swinging_arm
from .performer import STANDING
from .targets import FRAME_RATE, Targets, frame_times

DURATION = 9.4
LEFT, RIGHT = 0, 1

WALK = Walk(
    ((0.0, 0.095, 9.0), (-0.02, -0.095, -11.0)),
    (
        Step(LEFT, 1.50, 1.98, (0.42, 0.085), 5.0, -14.0),
        Step(RIGHT, 2.11, 2.55, (0.98, -0.080), -6.0),
        Step(LEFT, 2.67, 3.10, (1.54, 0.085), 5.0),
        Step(RIGHT, 3.22, 3.66, (2.09, -0.090), 4.0, -17.0),
        Step(LEFT, 3.80, 4.24, (2.40, 0.110), 48.0, -13.0),
        Step(RIGHT, 4.38, 4.94, (2.475, 0.415), 118.0, -9.0, around=(0.27, -0.15)),
        Step(LEFT, 5.06, 5.56, (1.92, 0.38), 165.0, -14.0),
        Step(RIGHT, 5.69, 6.13, (1.38, 0.60), 173.0),
        Step(LEFT, 6.25, 6.69, (0.83, 0.49), 179.0, -17.0),
        Step(RIGHT, 6.84, 7.36, (0.80, 0.675), 164.0, -7.0),
    ),
)


def walk_turn(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    stride, support = WALK.stride(times), WALK.support(times)
    place = WALK.carried(times)
    apart = curve(times, {4.2: 0.0, 4.7: 0.035, 5.2: 0.0}, soft=0.08)
    pelvis_turn = np.stack([place[:, 2] - 5.5 * stride, 3 + curve(times, LEAN, soft=0.12), 4.5 * support], axis=1)
    return Targets(
        times,
        _pelvis(times, place),
        pelvis_turn,
        _chest(times, pelvis_turn),
        _head(times),
        (swinging_arm(WALK, times, LEFT, apart), swinging_arm(WALK, times, RIGHT, apart)),
        (foot_path(LEFT, times, _left_plants()), foot_path(RIGHT, times, WALK.plants(RIGHT))),
    )


LEAN = {1.0: 0.0, 1.55: 2.5, 2.2: 1.0, 3.4: 0.5, 4.1: -1.5, 5.0: 2.0, 5.8: 1.0, 6.8: -2.5, 7.5: 0.8, 8.1: 0.0}
"""Pelvis pitch: into the start, back against the stop."""
SHIFT = {
    0.0: (0.03, 0.012),
    0.75: (0.028, 0.02),
    1.15: (0.022, -0.035),
    1.5: (0.05, -0.04),
    1.9: (0.045, 0.0),
    6.6: (0.045, 0.0),
    7.5: (0.04, 0.006),
    8.0: (0.022, -0.006),
    8.6: (0.03, -0.012),
}
"""Forward and left of the middle of both feet, in the body's own heading: the weight shift before the first step."""


def _pelvis(times: FloatArray, position: FloatArray) -> FloatArray:
    shift = curve(times, SHIFT, soft=0.12)
    shift += np.stack([0.005 * drift(times, 14, 3.3), 0.007 * drift(times, 1)], axis=1)
    heading = np.radians(position[:, 2])
    forward = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    left = np.stack([-forward[:, 1], forward[:, 0]], axis=1)
    height = STANDING - 0.036 + 0.025 * WALK.rise(times) + curve(times, SINK, soft=0.08) + 0.0015 * drift(times, 9)
    return np.column_stack([position[:, :2] + shift[:, :1] * forward + shift[:, 1:] * left, height])


SINK = {
    0.0: 0.012,
    0.9: 0.013,
    1.25: 0.0,
    1.7: 0.0,
    4.0: 0.0,
    4.6: -0.012,
    5.3: 0.0,
    7.2: 0.0,
    7.6: -0.006,
    8.3: 0.013,
    8.9: 0.011,
}


def _chest(times: FloatArray, pelvis_turn: FloatArray) -> FloatArray:
    """Against the pelvis: counter-rotation, a little late, and upright; it leads into the turn."""
    yaw = 11.0 * WALK.stride(times, delay=0.04) + curve(times, CHEST_LEAD, soft=0.1) + 1.2 * drift(times, 16, 4.3)
    pitch = 1.0 - 0.4 * curve(times, LEAN, soft=0.12, delay=0.1) - 1.6 * breath(times) + 0.7 * drift(times, 15, 3.9)
    roll = -5.5 * WALK.support(times, delay=0.05) + 0.9 * drift(times, 2) + curve(times, BANK, soft=0.15)
    return np.stack([yaw, pitch, roll], axis=1)


CHEST_LEAD = {3.3: 0.0, 4.0: 13.0, 4.6: 16.0, 5.3: 5.0, 5.9: 0.0}
BANK = {3.6: 0.0, 4.4: -5.0, 5.2: -2.0, 5.8: 0.0}


def _head(times: FloatArray) -> FloatArray:
    """Steady on its own heading: it looks round first and the body follows."""
    yaw = curve(times, HEAD_YAW, soft=0.09) + 1.5 * drift(times, 17, 3.1)
    pitch = curve(times, HEAD_PITCH, soft=0.1) - 0.8 * WALK.rise(times) + 1.2 * drift(times, 3)
    roll = curve(times, {3.2: 0.0, 3.7: -5.0, 4.9: -3.0, 5.6: 0.0}, soft=0.1) + 0.5 * drift(times, 4, 3.4)
    return np.stack([yaw, pitch, roll], axis=1)


HEAD_YAW = {
    0.0: 12.0,
    0.55: 14.0,
    0.95: -2.0,
    3.15: 0.0,
    3.65: 48.0,
    4.25: 88.0,
    4.8: 142.0,
    5.3: 172.0,
    6.9: 173.0,
    7.7: 174.0,
    8.2: 158.0,
    9.4: 155.0,
}
HEAD_PITCH = {0.0: 4.0, 0.8: 1.0, 1.4: 7.0, 2.2: 3.0, 3.3: 4.0, 3.8: 9.0, 4.8: 5.0, 6.6: 6.0, 7.1: 9.0, 7.9: 3.0}


def _left_plants():
    """The inside foot of the turn swivels on its ball while the body comes round."""
    plants = WALK.plants(LEFT)
    inside = next(k for k, plant in enumerate(plants) if plant.yaw == 48.0)
    plants[inside] = replace(plants[inside], pivot={4.74: 0.0, 5.08: 40.0, 5.3: 50.0}, roll=0.45)
    return plants
