"""A cartwheel to the left: a step aside, hand, hand, foot, foot on one line, and upright again."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import OUTWARD, STANDING
from .targets import FRAME_RATE, AirLeg, ArmTargets, Targets, frame_times

DURATION = 4.6
FACING = -90.0
"""It goes ahead of where the capture looks, left side first."""
STEP, LUNGE = 0.55, 0.95
RIGHT_UP, LEFT_UP, RIGHT_LANDS, LEFT_LANDS = 1.18, 1.46, 2.28, 2.68
HANDS = ((1.12, 1.36, 1.98), (1.46, 1.72, 2.30))
"""Left hand and right one: place on the ground, begin and end."""
MIDDLE, UPRIGHT = 1.85, 3.15
"""Upside down, and on both feet."""
PALM = 0.055
FAR, NEAR = 2.17, 2.72
"""Places at which the right foot comes down, and the left one beyond it."""


def cartwheel(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    air = breath(times, 3.1)
    roll = curve(times, ROLL, soft=0.05)
    lean = curve(times, LEAN, soft=0.05)
    facing = FACING + 0.7 * drift(times, 82)
    return Targets(
        times,
        _pelvis(times),
        np.column_stack([facing, 0.4 * drift(times, 84), roll + 0.4 * drift(times, 85)]),
        np.column_stack([0.8 * drift(times, 86), 2.0 + 0.8 * drift(times, 81) - 1.4 * air, lean]),
        np.column_stack([facing + 1.6 * drift(times, 87, 3.3), _nod(times) + 0.9 * drift(times, 88), roll + lean]),
        (_arm(times, 0), _arm(times, 1)),
        (foot_path(0, times, _left_foot()), foot_path(1, times, _right_foot())),
        splay=(14.0, 14.0),
        air={0: _leg(times, LEFT_LEG, LEFT_UP, LEFT_LANDS), 1: _leg(times, RIGHT_LEG, RIGHT_UP, RIGHT_LANDS)},
    )


def _nod(times: FloatArray) -> FloatArray:
    """It looks for the floor between its hands."""
    return 3.0 + curve(times, {0.9: 0.0, 1.4: 8.0, 2.3: 8.0, 2.9: 0.0})


ROLL = {
    0.0: 0.0, STEP: 2.0, LUNGE: -10.0, 1.16: -40.0, 1.36: -82.0, 1.6: -130.0, MIDDLE: -180.0, 2.1: -230.0,
    RIGHT_LANDS: -268.0, 2.48: -306.0, LEFT_LANDS: -336.0, 2.95: -356.0, UPRIGHT: -361.0, 3.6: -360.0,
}  # fmt: skip
LEAN = {0.0: 0.0, STEP: 3.0, 1.16: -10.0, 1.6: -4.0, MIDDLE: 0.0, 2.1: 5.0, 2.48: 10.0, UPRIGHT: 0.0}
ALONG = {
    0.0: 0.0, 0.35: -0.09, STEP: -0.10, LUNGE: 0.24, 1.16: 0.46, 1.36: 0.70, 1.6: 1.04, MIDDLE: 1.29, 2.1: 1.60,
    RIGHT_LANDS: 1.88, 2.48: 2.12, LEFT_LANDS: 2.32, UPRIGHT: 2.44, 3.8: 2.45,
}  # fmt: skip


def _pelvis(times: FloatArray) -> FloatArray:
    """As high as legs and arms let it."""
    high = {0.0: STANDING - 0.035, LUNGE: STANDING, 1.36: 1.1, MIDDLE: 1.4, 2.2: 1.2, LEFT_LANDS: STANDING}
    high |= {2.95: STANDING - 0.07, 3.4: STANDING - 0.035}
    aside = 0.004 * drift(times, 83)
    return np.column_stack([curve(times, ALONG, soft=0.05), aside, curve(times, high, soft=0.05)])


def _arm(times: FloatArray, side: int) -> ArmTargets:
    """Up and apart as spokes of a wheel, then down at the side."""
    out, (place, down, off) = OUTWARD[side], HANDS[side]
    keys = {
        0.0: (0.03, 0.075 * out, -0.51), 0.12: (0.03, 0.075 * out, -0.51), 0.42: (0.38, 0.16 * out, -0.10),
        0.75: (0.17, 0.22 * out, 0.46), 2.3: (0.17, 0.22 * out, 0.46), 2.6: (0.12, 0.30 * out, 0.42),
        3.0: (0.36, 0.26 * out, 0.22), 3.4: (0.36, 0.16 * out, -0.14), 3.85: (0.03, 0.075 * out, -0.51),
    }  # fmt: skip
    holding = curve(times, {down - 0.36: 0.0, down: 1.0, off: 1.0, off + 0.36: 0.0}, soft=0.02)
    stands = curve(times, {down - 0.3: 0.0, down: 1.0, off: 1.0, off + 0.3: 0.0}, soft=0.02)
    raised = curve(times, {0.25: 0.0, 0.7: 1.0, 3.0: 1.0, 3.7: 0.0})
    return ArmTargets(
        curve(times, keys, soft=0.05) + 0.006 * np.column_stack([drift(times, 90 + 3 * side + k) for k in range(3)]),
        raised[:, None] * [0.5, 1.0 * out, 0.3] + (1.0 - raised)[:, None] * [-1.0, 0.25 * out, -0.2],
        held=np.tile([place, 0.0, PALM], (len(times), 1)),
        holding=holding,
        carries=True,
        pronation=12.0,
        flexion=8.0 - 84.0 * stands,
        shrug=6.0 * raised + 1.5 * breath(times, 3.1),
    )


def _left_foot() -> list[Plant]:
    return [
        Plant(-1e3, STEP, (0.17, 0.0), FACING + 24.0, push=26.0, roll=0.25),
        Plant(LUNGE - 0.08, LEFT_UP, (0.50, 0.0), FACING + 55.0, strike=-6.0, push=50.0, roll=0.4, clearance=0.06),
        Plant(LEFT_LANDS, 1e3, (NEAR, 0.0), FACING + 24.0, strike=30.0, landing=0.25, clearance=0.3),
    ]


def _right_foot() -> list[Plant]:
    return [
        Plant(-1e3, RIGHT_UP, (-0.17, 0.0), FACING - 20.0, push=46.0, roll=0.4),
        Plant(RIGHT_LANDS, 1e3, (FAR, 0.0), FACING - 24.0, strike=34.0, landing=0.25, clearance=0.3),
    ]


LEFT_LEG = {LEFT_UP: 30.0, 1.66: 40.0, MIDDLE: 52.0, 2.1: 54.0, 2.45: 46.0, LEFT_LANDS: 34.0}
RIGHT_LEG = {RIGHT_UP: 40.0, 1.4: 56.0, MIDDLE: 54.0, 2.1: 44.0, RIGHT_LANDS: 32.0}
"""Degrees that the thighs are spread aside."""


def _leg(times: FloatArray, spread: dict[float, float], off: float, down: float) -> AirLeg:
    share = curve(times, {off + 0.05: 0.0, off + 0.3: 1.0, down - 0.3: 1.0, down - 0.05: 0.0}, soft=0.02)
    knee = curve(times, {off: 18.0, off + 0.24: 10.0, down - 0.24: 11.0, down: 24.0})
    foot = curve(times, {off: 36.0, off + 0.2: 48.0, down - 0.16: 46.0, down: 30.0})
    return AirLeg(share, curve(times, spread, soft=0.04), knee, foot, -8.0 * share, 84.0 * np.ones_like(times))
