"""Something is taken from a shelf on the right, brought to the chest, and put down low on the left."""

import numpy as np

from .curves import FloatArray, Keys, breath, curve, drift, spring
from .feet import Plant, foot_path
from .performer import STANDING
from .targets import ArmTargets, Targets, frame_times

DURATION = 8.4
HIGH, LOW = (0.72, -0.42, 1.35), (0.50, 0.38, 0.80)
"""Places of the thing on the shelf, and as it is put down."""
GRASP, CARRY, PLACE, RELEASE, REST = 1.95, 2.45, 4.85, 5.15, 6.5
"""Hand at the thing, off with it, down with it, hand off it, hand back at the side."""


def reach_grasp() -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION)
    return Targets(
        times,
        _pelvis(times),
        _turn(times, PELVIS, 0.09, 1),
        _turn(times, CHEST, 0.08, 4) - np.outer(breath(times), [0.0, 1.2, 0.0]),
        _turn(times, HEAD, 0.06, 7),
        (_left_arm(times), _right_arm(times)),
        (foot_path(0, times, [_left_foot()]), foot_path(1, times, [_right_foot()])),
    )


SHIFT = {
    0.0: (0.030, -0.012, 0.0),
    0.55: (0.030, -0.016, 0.0),
    1.0: (0.012, 0.034, -0.015),
    1.55: (0.075, -0.030, -0.012),
    GRASP: (0.105, -0.062, 0.004),
    CARRY - 0.1: (0.100, -0.058, 0.0),
    3.15: (0.024, -0.010, -0.008),
    3.7: (0.026, -0.014, 0.0),
    4.1: (0.014, -0.030, -0.012),
    PLACE: (0.050, 0.048, -0.085),
    RELEASE + 0.05: (0.050, 0.046, -0.080),
    5.9: (0.022, 0.002, -0.006),
    6.6: (0.030, -0.016, 0.0),
    7.5: (0.028, 0.006, 0.0),
}
"""Pelvis forward, left and up: away from the shelf first, then towards it."""
PELVIS = {
    0.0: (2.0, 1.0, 0.5),
    0.6: (2.0, 1.0, 0.5),
    1.0: (7.0, 2.0, -2.5),
    GRASP - 0.1: (-17.0, 10.0, 4.0),
    CARRY: (-15.0, 9.0, 3.0),
    3.2: (-2.0, 2.0, 1.0),
    4.0: (-3.0, 2.0, 1.5),
    PLACE - 0.05: (15.0, 17.0, -3.0),
    RELEASE: (14.0, 16.0, -3.0),
    6.0: (2.0, 2.0, 0.0),
    6.8: (1.0, 1.0, 0.5),
}
CHEST = {
    0.0: (0.0, 2.0, -0.5),
    0.7: (0.0, 2.0, -0.5),
    1.08: (7.0, 4.0, -2.0),
    GRASP: (-14.0, 9.0, 6.0),
    CARRY: (-13.0, 8.0, 5.0),
    3.25: (3.0, 4.0, 0.0),
    3.9: (2.0, 3.0, 0.0),
    4.2: (-2.0, 3.0, 1.0),
    PLACE: (17.0, 23.0, -4.0),
    RELEASE + 0.05: (16.0, 22.0, -4.0),
    6.05: (2.0, 4.0, 0.0),
    6.7: (-1.0, 2.0, -0.5),
    7.4: (0.0, 2.5, -0.5),
}
HEAD = {
    0.0: (6.0, 4.0, 0.0),
    0.35: (5.0, 4.0, 0.0),
    0.72: (-29.0, -1.0, 2.0),
    1.2: (-30.0, 1.0, 2.0),
    GRASP: (-27.0, 5.0, 5.0),
    CARRY: (-25.0, 6.0, 4.0),
    3.1: (-3.0, 24.0, 0.0),
    3.6: (-2.0, 25.0, -2.0),
    4.0: (32.0, 24.0, -3.0),
    PLACE: (35.0, 40.0, -3.0),
    RELEASE + 0.1: (34.0, 39.0, -3.0),
    5.75: (26.0, 20.0, -1.0),
    6.4: (2.0, 3.0, 0.0),
    8.4: (0.0, 3.0, 0.0),
}
"""The eyes are there first, for each thing that the hand does."""


def _pelvis(times: FloatArray) -> FloatArray:
    shift = curve(times, SHIFT, soft=0.09)
    sway = np.stack([0.006 * drift(times, 31), 0.008 * drift(times, 32, 3.3), 0.002 * drift(times, 33)], axis=1)
    return shift + sway + [0.0, 0.0, STANDING - 0.013]


def _turn(times: FloatArray, keys: Keys, soft: float, seed: int) -> FloatArray:
    alive = np.stack([drift(times, seed + k, 3.0) for k in range(3)], axis=1)
    return curve(times, keys, soft) + 1.1 * alive


HANGING = (0.06, -0.066, -0.541)
"""The right wrist at rest, from its shoulder; the left is its mirror image and a little lower."""


def _right_arm(times: FloatArray) -> ArmTargets:
    wrist = {
        0.0: HANGING,
        0.8: HANGING,
        1.12: (0.015, -0.085, -0.522),
        1.45: (0.20, -0.06, -0.34),
        GRASP: (0.44, 0.0, 0.0),
        CARRY: (0.42, 0.0, 0.02),
        3.15: (0.27, 0.14, -0.20),
        3.85: (0.265, 0.14, -0.205),
        PLACE: (0.40, 0.30, -0.34),
        RELEASE + 0.06: (0.38, 0.28, -0.32),
        5.65: (0.27, 0.05, -0.33),
        REST: (0.085, -0.068, -0.535),
        REST + 0.45: HANGING,
    }
    keyed = spring(times, curve(times, wrist, soft=0.06), 3.2, 0.8)
    keyed += 0.004 * np.stack([drift(times, 11), drift(times, 12), 0 * times], axis=1)
    held, holding = _held(times)
    reaching = curve(times, {1.1: 0.0, 1.75: 1.0, 5.3: 1.0, REST: 0.0}, soft=0.08)
    open_hand = curve(
        times,
        {
            1.15: 0.0,
            1.36: 16.0,
            1.75: -22.0,
            GRASP + 0.12: 4.0,
            3.2: -6.0,
            PLACE: -26.0,
            RELEASE + 0.2: -8.0,
            REST: 0.0,
        },
    )
    return ArmTargets(
        keyed,
        np.array([-0.7, -0.55, 0.0]) + reaching[:, None] * [0.3, -0.1, -1.0],
        upright=0.75 * (1 - reaching),
        held=held,
        holding=holding,
        pronation=32 - 18 * reaching,
        flexion=10 + open_hand + 1.5 * drift(times, 13),
        deviation=curve(times, {1.3: 2.0, GRASP: 6.0, 3.2: 8.0, PLACE: -14.0, RELEASE: -14.0, REST: 2.0}, soft=0.08),
        shrug=1.5 * breath(times) + 4 * curve(times, {1.3: 0.0, GRASP: 1.0, CARRY: 1.0, 3.1: 0.0}),
        thrust=8 * curve(times, {1.3: 0.0, GRASP: 1.0, CARRY: 1.0, 3.1: 0.0, 4.3: 0.0, PLACE: 1.0, 5.8: 0.0}),
    )


def _held(times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The wrist behind the thing: on the shelf until it is lifted off, then where it is put down."""
    high, low = np.array(HIGH) - [0.085, -0.035, 0.0], np.array(LOW) - [0.055, 0.06, -0.06]
    place = {
        GRASP - 0.12: high - [0.012, 0.0, -0.006],
        GRASP + 0.03: high,
        CARRY - 0.18: high,
        CARRY + 0.1: high + np.array([-0.02, 0.0, 0.06]),
        3.6: low + np.array([0.0, -0.03, 0.10]),
        PLACE - 0.22: low + np.array([0.0, -0.01, 0.035]),
        PLACE: low,
        RELEASE: low,
        RELEASE + 0.2: low + np.array([-0.05, -0.03, 0.03]),
    }
    holding = {1.15: 0.0, GRASP - 0.05: 1.0, CARRY: 1.0, 3.1: 0.0, 3.95: 0.0, 4.45: 0.35, PLACE - 0.08: 1.0}
    holding |= {RELEASE: 1.0, 5.8: 0.0}
    return curve(times, place, soft=0.04), curve(times, holding, soft=0.06)


def _left_arm(times: FloatArray) -> ArmTargets:
    """Balances: back and out against each reach, a little after it."""
    wrist = {
        0.0: (0.045, 0.062, -0.544),
        0.8: (0.045, 0.062, -0.544),
        1.15: (0.09, 0.058, -0.528),
        GRASP: (-0.10, 0.17, -0.50),
        CARRY: (-0.08, 0.15, -0.505),
        3.1: (0.09, 0.062, -0.523),
        3.8: (0.05, 0.062, -0.540),
        PLACE: (-0.17, 0.17, -0.46),
        RELEASE + 0.1: (-0.155, 0.16, -0.47),
        6.0: (0.07, 0.06, -0.53),
        6.7: (0.04, 0.062, -0.544),
    }
    followed = spring(times, curve(times, wrist, soft=0.08, delay=0.06), 1.7, 0.6)
    return ArmTargets(
        followed + 0.004 * np.stack([drift(times, 21), drift(times, 22), 0 * times], axis=1),
        np.array([-1.0, 0.5, 0.0]),
        upright=0.75,
        pronation=32.0,
        flexion=12 + 3 * drift(times, 23),
        deviation=3.0,
        shrug=1.5 * breath(times),
    )


def _left_foot() -> Plant:
    """Its heel comes off as the weight goes to the right."""
    heel = {1.25: 0.0, GRASP: 21.0, CARRY - 0.1: 20.0, 3.05: 0.0}
    return Plant(-1e3, 1e3, (0.0, 0.10), 9.0, heel=heel)


def _right_foot() -> Plant:
    """A little in front; lightened when the hand goes low on the left."""
    heel = {4.15: 0.0, PLACE: 14.0, RELEASE + 0.05: 13.0, 5.9: 0.0}
    return Plant(-1e3, 1e3, (0.05, -0.105), -12.0, heel=heel)
