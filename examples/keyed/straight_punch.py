"""A jab that is not meant, then a right cross from the ground up: foot, hip, chest, shoulder, fist."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .guard import (
    FRONT,
    FRONT_YAW,
    HEIGHT,
    LEFT_ELBOW,
    LEFT_GUARD,
    REAR,
    REAR_HEEL,
    REAR_YAW,
    RIGHT_ELBOW,
    RIGHT_GUARD,
    bounce,
    guarding,
    moved,
    rocking,
)
from .targets import FRAME_RATE, ArmTargets, Targets, frame_times

DURATION = 5.8
STEP = 0.13
"""Metres that the stance begins behind the place it strikes from."""
TARGET = (0.86, 0.03, 1.37)
"""The wrist where the fist hits."""
HIT = 3.0
"""The moment of the hit; the chain behind it starts earlier, part by part."""
HIP, CHEST, SHOULDER = HIT - 0.11, HIT - 0.07, HIT - 0.03
BOUNCE = {0.0: 0.9, 0.35: 0.4, 1.0: 0.5, 1.3: 1.0, 1.7: 0.5, 2.2: 0.6, 2.5: 0.0, 3.7: 0.0, 4.3: 1.0, 5.3: 0.8}


def straight_punch(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    beat = bounce(times, BOUNCE)
    return Targets(
        times,
        _pelvis(times, beat),
        _pelvis_turn(times, beat),
        _chest(times, beat),
        _head(times),
        (_left_arm(times, beat), _right_arm(times, beat)),
        (foot_path(0, times, _front_foot()), foot_path(1, times, _rear_foot())),
        splay=(4.0, 4.0),
    )


PLACE = {
    0.0: (-STEP, -0.02),
    0.42: (-STEP - 0.022, -0.035),
    0.78: (-0.03, -0.01),
    1.02: (0.008, -0.012),
    1.3: (0.0, -0.02),
    1.62: (-0.015, -0.02),
    1.82: (0.025, 0.0),
    2.2: (-0.01, -0.015),
    2.62: (-0.055, -0.045),
    HIP - 0.16: (-0.05, -0.042),
    HIP + 0.04: (0.055, 0.0),
    HIT + 0.1: (0.085, 0.012),
    HIT + 0.35: (0.04, 0.0),
    4.1: (-0.01, -0.025),
    4.9: (0.0, -0.01),
    5.8: (-0.012, -0.02),
}
"""Forward and left: a step in, back on the rear leg before the cross, over the front knee with it."""
LEVEL = {
    0.3: 0.0,
    0.46: -0.014,
    0.7: 0.008,
    1.0: -0.008,
    1.2: 0.0,
    1.55: 0.0,
    1.68: -0.012,
    1.9: 0.0,
    2.3: 0.0,
    2.68: -0.034,
    HIP: -0.012,
    HIT + 0.08: -0.020,
    3.5: -0.012,
    4.2: 0.0,
}


def _pelvis(times: FloatArray, beat: FloatArray) -> FloatArray:
    place = curve(times, PLACE, soft=0.035)
    place += rocking(times, 1)
    return np.column_stack([place, HEIGHT + curve(times, LEVEL, soft=0.03) + 0.030 * (beat - 0.5)])


def _pelvis_turn(times: FloatArray, beat: FloatArray) -> FloatArray:
    yaw = {0.0: -34.0, 1.6: -33.0, 1.82: -38.0, 2.15: -33.0, 2.66: -45.0, HIP - 0.15: -44.0, HIP + 0.03: 12.0}
    yaw |= {HIT + 0.06: 18.0, HIT + 0.34: -12.0, 3.75: -36.0, 4.3: -33.0}
    roll = {2.3: 0.0, 2.66: 4.0, HIP: -3.0, HIT + 0.15: -4.0, 3.6: 0.0}
    pitch = {0.0: 5.0, 2.4: 5.0, 2.66: 3.0, HIT: 9.0, 3.3: 7.0, 3.9: 5.0}
    keyed = [curve(times, keys, soft=0.025) for keys in (yaw, pitch, roll)]
    return np.stack(keyed, axis=1) + np.stack([1.2 * drift(times, 3), 0.8 * beat, 0 * beat], axis=1)


def _chest(times: FloatArray, beat: FloatArray) -> FloatArray:
    yaw = {0.0: -9.0, 1.62: -9.0, 1.76: -20.0, 2.0: -9.0, 2.68: -17.0, CHEST - 0.14: -19.0, CHEST + 0.03: 17.0}
    yaw |= {HIT + 0.07: 22.0, HIT + 0.33: 0.0, 3.7: -12.0, 4.2: -8.0}
    pitch = {0.0: 9.0, 2.4: 9.0, 2.68: 10.0, CHEST: 8.0, HIT + 0.05: 13.0, 3.5: 11.0, 4.1: 9.0}
    roll = {2.4: 0.0, 2.7: 5.0, HIT + 0.03: -6.0, 3.4: -1.0, 4.0: 0.0}
    keyed = [curve(times, keys, soft=0.025) for keys in (yaw, pitch, roll)]
    alive = [0.8 * drift(times, 4), 1.2 * (beat - 0.5) - 1.5 * breath(times, 2.4), 0.6 * drift(times, 5)]
    return np.stack(keyed, axis=1) + np.stack(alive, axis=1)


def _head(times: FloatArray) -> FloatArray:
    """Eyes on the target throughout; chin down behind the shoulder with the hit."""
    yaw = curve(times, {0.0: -4.0, 1.7: -3.0, 2.6: -5.0, HIT: 4.0, 3.5: -1.0, 4.2: -4.0}, soft=0.05)
    pitch = curve(times, {0.0: 9.0, 1.8: 11.0, 2.5: 10.0, HIT + 0.05: 15.0, 3.6: 11.0, 4.6: 8.0}, soft=0.05)
    roll = curve(times, {2.4: 0.0, 2.7: 2.0, HIT + 0.05: -6.0, 3.6: 0.0}, soft=0.05)
    alive = np.stack([1.2 * drift(times, 6), 0.8 * drift(times, 7), 0.8 * drift(times, 8)], axis=1)
    return np.stack([yaw, pitch, roll], axis=1) + alive


def _left_arm(times: FloatArray, beat: FloatArray) -> ArmTargets:
    """Jabs half the way, then comes back to the chin while the right goes."""
    feint = {1.60: (0, 0, 0), 1.68: (-0.02, 0.01, -0.015), 1.80: (0.17, 0.05, 0.06), 1.85: (0.165, 0.05, 0.055)}
    feint |= {
        2.1: (0, 0, 0),
        2.6: (0.0, 0.0, 0.0),
        HIT - 0.13: (-0.01, 0.05, 0.08),
        HIT + 0.05: (-0.06, -0.11, 0.03),
        3.3: (-0.05, -0.07, 0.01),
    }
    feint |= {3.8: (0.01, 0.0, 0.0), 4.3: (0, 0, 0)}
    jab = curve(times, {1.64: 0.0, 1.80: 1.0, 1.86: 1.0, 2.1: 0.0}, soft=0.02)
    return ArmTargets(
        moved(times, guarding(times, LEFT_GUARD, beat, 20), feint, soft=0.02),
        LEFT_ELBOW,
        pronation=18 + 45 * jab,
        flexion=6 + 4 * drift(times, 9),
        shrug=3 + 5 * jab,
        thrust=10 * jab,
    )


def _right_arm(times: FloatArray, beat: FloatArray) -> ArmTargets:
    """Draws in by a hand's breadth, then drives straight to the target and snaps back with a loose return."""
    load = {
        2.45: (0, 0, 0),
        2.74: (-0.035, -0.02, -0.03),
        HIT - 0.12: (-0.01, -0.05, -0.05),
        HIT: (0, 0, 0),
        3.28: (0.02, -0.06, -0.06),
        3.5: (-0.02, -0.055, -0.03),
        3.75: (0, 0, 0),
    }
    hold = {SHOULDER - 0.17: 0.0, SHOULDER - 0.08: 0.14, HIT: 1.0, HIT + 0.045: 1.0, HIT + 0.16: 0.55, HIT + 0.36: 0.0}
    holding = curve(times, hold, soft=0.014)
    thrust = curve(times, {SHOULDER - 0.12: 0.0, SHOULDER + 0.03: 1.0, HIT + 0.06: 1.0, HIT + 0.3: 0.0}, soft=0.02)
    return ArmTargets(
        moved(times, guarding(times, RIGHT_GUARD, beat, 30), load),
        RIGHT_ELBOW,
        held=np.tile(TARGET, (len(times), 1)),
        holding=holding,
        pronation=15 + 65 * curve(times, hold, soft=0.02, delay=0.02),
        flexion=6 - 4 * holding + 3 * drift(times, 10),
        shrug=3 + 8 * thrust,
        thrust=16 * thrust,
    )


def _front_foot() -> list[Plant]:
    """A short step in, toes first off and heel last down."""
    x, y = FRONT
    return [
        Plant(-1e3, 0.56, (x - STEP, y), FRONT_YAW, push=16.0, roll=0.16),
        Plant(0.76, 1e3, FRONT, FRONT_YAW, strike=-5.0, landing=0.12, heel=FRONT_HEEL, clearance=0.016),
    ]


def _rear_foot() -> list[Plant]:
    """Follows the step; then swivels on its ball ahead of the hip, heel out and up."""
    x, y = REAR
    return [
        Plant(-1e3, 0.80, (x - STEP, y), REAR_YAW, heel={0.0: REAR_HEEL}, push=16.0, roll=0.14),
        Plant(1.0, 1e3, REAR, REAR_YAW, strike=6.0, landing=0.16, heel=SWIVEL_HEEL, pivot=SWIVEL, clearance=0.016),
    ]


FRONT_HEEL = {1.6: 0.0, 1.75: 2.0, 2.1: 0.0}
SWIVEL_HEEL = {
    1.7: REAR_HEEL,
    2.0: REAR_HEEL + 3,
    2.3: REAR_HEEL,
    2.68: 3.0,
    HIP - 0.14: 5.0,
    HIP + 0.04: 30.0,
    HIT + 0.1: 34.0,
    3.45: 16.0,
    3.85: REAR_HEEL - 3,
    4.4: REAR_HEEL,
}
SWIVEL = {2.68: 0.0, HIP - 0.17: 0.0, HIP + 0.02: 42.0, HIT + 0.1: 47.0, 3.4: 20.0, 3.8: -2.0, 4.2: 0.0}
