"""A front kick with the rear leg: weight to the front, knee up, snap with the hip behind it, knee back, foot down."""

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
from .targets import FRAME_RATE, AirLeg, ArmTargets, Targets, frame_times

DURATION = 6.0
LIFT, CHAMBER, HIT, BACK, LAND = 2.06, 2.36, 2.56, 2.84, 3.26
"""Toe-off, knee highest, leg longest, knee bent again, foot down."""
LANDED = (REAR[0] + 0.035, REAR[1] - 0.022)
"""Nobody comes down exactly where the foot left."""
BOUNCE = {0.0: 1.0, 1.3: 0.9, 1.7: 0.0, 4.0: 0.0, 4.6: 0.9, 5.6: 0.8}


def front_kick(frame_rate: float = FRAME_RATE) -> Targets:
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
        (foot_path(0, times, [_front_foot()]), foot_path(1, times, _rear_foot())),
        splay=(5.0, 5.0),
        air={1: _kick(times)},
    )


PLACE = {
    0.0: (0.0, -0.02),
    0.9: (-0.015, -0.03),
    1.55: (-0.03, -0.035),
    LIFT - 0.06: (0.145, 0.055),
    CHAMBER: (0.175, 0.085),
    HIT: (0.225, 0.085),
    HIT + 0.14: (0.215, 0.085),
    BACK + 0.15: (0.165, 0.075),
    LAND: (0.05, 0.01),
    LAND + 0.35: (-0.012, -0.046),
    4.4: (0.018, -0.030),
    5.3: (0.006, -0.040),
}
LEVEL = {
    1.35: 0.0,
    1.78: -0.045,
    LIFT: -0.006,
    CHAMBER: 0.034,
    HIT: 0.052,
    BACK: 0.040,
    LAND - 0.12: 0.0,
    LAND + 0.2: -0.042,
    4.15: 0.006,
    4.5: 0.0,
}
"""Down before up: the knees give, then the standing leg lengthens under the kick."""


def _pelvis(times: FloatArray, beat: FloatArray) -> FloatArray:
    place = curve(times, PLACE, soft=0.06)
    place += rocking(times, 41)
    return np.column_stack([place, HEIGHT + curve(times, LEVEL, soft=0.05) + 0.030 * (beat - 0.5)])


def _pelvis_turn(times: FloatArray, beat: FloatArray) -> FloatArray:
    yaw = {0.0: -33.0, 1.4: -34.0, 1.75: -40.0, LIFT: -22.0, CHAMBER: 2.0, HIT: 20.0, BACK: 8.0, LAND: -26.0}
    yaw |= {LAND + 0.35: -36.0, 4.5: -30.0}
    pitch = {0.0: 5.0, 1.5: 6.0, 1.8: 9.0, LIFT + 0.05: 2.0, CHAMBER: -10.0, HIT: -20.0, BACK: -9.0, LAND: 5.0}
    pitch |= {LAND + 0.25: 9.0, 4.3: 5.0}
    roll = {1.5: 0.0, 1.8: 2.0, LIFT: 4.0, CHAMBER: -5.0, HIT: -8.0, BACK: -3.0, LAND: 2.0, 4.0: 0.0}
    keyed = [curve(times, keys, soft=0.04) for keys in (yaw, pitch, roll)]
    return np.stack(keyed, axis=1) + np.stack([1.2 * drift(times, 43), 0.8 * beat, 0 * beat], axis=1)


def _chest(times: FloatArray, beat: FloatArray) -> FloatArray:
    """Twists against the hip, curls over the rising knee, leans away from the blow."""
    yaw = {0.0: -8.0, 1.5: -8.0, 1.8: -3.0, LIFT: -14.0, CHAMBER: -18.0, HIT + 0.03: -30.0, BACK + 0.05: -16.0}
    yaw |= {LAND: 2.0, LAND + 0.4: -11.0, 4.6: -8.0}
    pitch = {0.0: 9.0, 1.55: 9.0, 1.85: 14.0, CHAMBER + 0.03: 15.0, HIT + 0.02: 8.0, BACK + 0.06: 16.0}
    pitch |= {LAND + 0.08: 8.0, LAND + 0.3: 13.0, 4.5: 9.0}
    roll = {1.6: 0.0, LIFT: -3.0, CHAMBER: 4.0, HIT + 0.03: 8.0, BACK: 4.0, LAND + 0.1: -2.0, 4.1: 0.0}
    keyed = [curve(times, keys, soft=0.04, delay=0.02) for keys in (yaw, pitch, roll)]
    alive = [0.8 * drift(times, 44), 1.2 * (beat - 0.5) - 1.5 * breath(times, 2.3), 0.6 * drift(times, 45)]
    return np.stack(keyed, axis=1) + np.stack(alive, axis=1)


def _head(times: FloatArray) -> FloatArray:
    yaw = curve(times, {0.0: -4.0, 1.7: -2.0, HIT: 2.0, LAND: -2.0, 4.4: -4.0}, soft=0.06)
    pitch = curve(times, {0.0: 8.0, 1.75: 12.0, CHAMBER: 6.0, HIT + 0.04: 0.0, BACK: 7.0, LAND + 0.25: 12.0, 4.4: 8.0})
    roll = curve(times, {1.7: 0.0, HIT: 4.0, LAND: -1.0, 4.2: 0.0})
    alive = np.stack([1.2 * drift(times, 46), 0.8 * drift(times, 47), 0.8 * drift(times, 48)], axis=1)
    return np.stack([yaw, pitch, roll], axis=1) + alive


def _left_arm(times: FloatArray, beat: FloatArray) -> ArmTargets:
    """The front hand closes before the face."""
    keys = {1.5: (0, 0, 0), 1.85: (-0.03, 0.0, -0.05), CHAMBER: (-0.05, 0.0, 0.03), HIT + 0.03: (-0.04, -0.05, 0.05)}
    keys |= {
        BACK + 0.1: (-0.03, -0.02, 0.01),
        LAND + 0.15: (0.02, 0.02, -0.06),
        LAND + 0.6: (0, 0, 0.01),
        4.6: (0, 0, 0),
    }
    return ArmTargets(
        moved(times, guarding(times, LEFT_GUARD, beat, 50), keys, soft=0.05),
        LEFT_ELBOW,
        pronation=18.0,
        flexion=6 + 4 * drift(times, 51),
        shrug=3.0 + 1.5 * breath(times, 2.3),
    )


def _right_arm(times: FloatArray, beat: FloatArray) -> ArmTargets:
    """Throws back and down against the leg, and floats up again after it."""
    keys = {1.45: (0, 0, 0), 1.85: (0.02, 0.0, 0.02), CHAMBER - 0.05: (-0.06, -0.10, -0.10)}
    keys |= {HIT + 0.02: (-0.27, -0.27, -0.37), HIT + 0.14: (-0.29, -0.28, -0.37), BACK + 0.16: (-0.08, -0.16, -0.20)}
    keys |= {LAND + 0.1: (0.0, -0.04, -0.08), LAND + 0.5: (0.01, 0.0, 0.01), 4.6: (0, 0, 0)}
    throw = curve(times, {CHAMBER: 0.0, HIT + 0.08: 1.0, BACK + 0.25: 0.0}, soft=0.05)
    return ArmTargets(
        moved(times, guarding(times, RIGHT_GUARD, beat, 60), keys, soft=0.045),
        RIGHT_ELBOW + throw[:, None] * [-0.6, -0.5, 0.6],
        pronation=15 + 40 * curve(times, {CHAMBER: 0.0, BACK: 1.0, LAND + 0.5: 0.0}),
        flexion=6 + 10 * throw + 3 * drift(times, 61),
        shrug=3.0,
    )


def _front_foot() -> Plant:
    """Swivels outward on its ball so that the hip can come round."""
    heel = {1.75: 0.0, LIFT: 4.0, CHAMBER: 7.0, HIT: 9.0, BACK: 6.0, LAND: 3.0, LAND + 0.35: 0.0}
    pivot = {LIFT - 0.1: 0.0, CHAMBER + 0.05: 36.0, HIT: 46.0, BACK: 42.0, LAND - 0.05: 12.0, LAND + 0.25: 0.0}
    return Plant(-1e3, 1e3, FRONT, FRONT_YAW, heel=heel, pivot=pivot)


def _rear_foot() -> list[Plant]:
    heel = {1.4: REAR_HEEL, 1.75: REAR_HEEL - 4}
    back = {LAND + 0.1: 12.0, LAND + 0.35: 5.0, 4.3: REAR_HEEL}
    return [
        Plant(-1e3, LIFT, REAR, REAR_YAW, heel=heel, push=38.0, roll=0.34),
        Plant(LAND, 1e3, LANDED, REAR_YAW + 6.0, strike=22.0, landing=0.22, heel=back, clearance=0.10),
    ]


def _kick(times: FloatArray) -> AirLeg:
    share = curve(times, {LIFT + 0.07: 0.0, CHAMBER - 0.04: 1.0, BACK: 1.0, LAND - 0.06: 0.0}, soft=0.03)
    thigh = {LIFT: -5.0, CHAMBER: 97.0, HIT - 0.04: 101.0, HIT + 0.04: 97.0, BACK: 86.0, LAND - 0.12: 14.0}
    knee = {LIFT: 60.0, CHAMBER - 0.04: 122.0, CHAMBER + 0.03: 122.0, HIT: 13.0, HIT + 0.05: 16.0, BACK: 108.0}
    knee |= {LAND - 0.12: 80.0}
    foot = {LIFT: 30.0, CHAMBER: 20.0, HIT - 0.03: 42.0, HIT + 0.06: 40.0, BACK: 18.0, LAND - 0.1: 25.0}
    toe = {LIFT: -10.0, CHAMBER: -5.0, HIT - 0.05: -38.0, HIT + 0.06: -38.0, BACK: -5.0, LAND - 0.1: -32.0}
    outward = {LIFT: 0.0, CHAMBER: 6.0, HIT: 12.0, BACK: 10.0, LAND: 0.0}
    quick = [curve(times, keys, soft=0.022) for keys in (thigh, knee, foot, toe, outward)]
    return AirLeg(share, *quick)
