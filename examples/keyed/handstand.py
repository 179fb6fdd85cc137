"""A handstand: a lunge, hands down, one leg swings up and the other follows, a hold, and back on the feet."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import OUTWARD, STANDING
from .targets import AirLeg, ArmTargets, Targets, frame_times

DURATION = 7.2
STEP, LUNGE = 0.75, 1.25
DOWN, SWING, PUSH, UP = 1.85, 1.70, 2.10, 2.75
"""Hands down, the rear foot off, the front foot off, legs above the hands."""
LEAVE, FIRST, OFF, SECOND, STOOD = 4.15, 5.05, 5.10, 5.45, 6.2
"""Legs begin to come back, the front foot lands, hands off, the rear foot lands, upright again."""
HANDS, WIDE = 1.16, 0.21
"""Places of the hands: ahead of where the feet began, and aside."""
PALM = 0.055
"""Height of a wrist over its palm."""
FRONT, BACK = (0.52, 0.09), (0.02, -0.09)


def handstand() -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION)
    sway = curve(times, {UP: 0.0, UP + 0.3: 1.0, LEAVE - 0.2: 1.0, LEAVE: 0.0})
    pitch = curve(times, PITCH, soft=0.06) + (0.4 + 1.1 * sway) * drift(times, 71)
    chest = curve(times, CHEST, soft=0.06, delay=0.03) - 1.3 * breath(times, 3.2)
    head = curve(times, HEAD, soft=0.07, delay=0.04) + 0.9 * drift(times, 74)
    return Targets(
        times,
        _pelvis(times, sway),
        np.column_stack([0.7 * drift(times, 75), pitch, 0.5 * drift(times, 76)]),
        np.column_stack([0.8 * drift(times, 77), chest, 0.5 * drift(times, 78)]),
        np.column_stack([1.6 * drift(times, 79, 3.3), head, 0.6 * drift(times, 80)]),
        (_arm(times, 0), _arm(times, 1)),
        (foot_path(0, times, _front_foot()), foot_path(1, times, _rear_foot())),
        splay=(8.0, 8.0),
        air={0: _leg(times, FRONT_LEG, PUSH, FIRST), 1: _leg(times, REAR_LEG, SWING, SECOND)},
    )


AHEAD = {
    0.0: 0.02, STEP - 0.2: 0.02, STEP + 0.1: 0.07, LUNGE: 0.34, DOWN: 0.60, PUSH: 0.82, PUSH + 0.3: 1.04, UP: 1.13,
    LEAVE: 1.13, LEAVE + 0.35: 1.03, 4.85: 0.83, OFF: 0.68, SECOND: 0.52, STOOD: 0.38, 6.8: 0.38,
}  # fmt: skip
PITCH = {
    0.0: 2.0, STEP: 3.0, LUNGE: 24.0, DOWN: 92.0, PUSH: 126.0, PUSH + 0.3: 158.0, UP: 180.0, LEAVE: 180.0,
    LEAVE + 0.35: 158.0, 4.85: 118.0, OFF: 86.0, SECOND: 48.0, STOOD: 3.0, 6.8: 2.0,
}  # fmt: skip
CHEST = {
    0.0: 2.0, 0.6: -4.0, LUNGE: 6.0, DOWN: 26.0, PUSH: 24.0, UP: -4.0, LEAVE: -4.0, 4.85: 26.0, OFF: 30.0, SECOND: 18.0,
    STOOD: 2.0,
}  # fmt: skip
HEAD = {
    0.0: 2.0, LUNGE: 22.0, DOWN: 92.0, PUSH: 118.0, UP: 148.0, LEAVE: 148.0, 4.85: 116.0, OFF: 92.0, SECOND: 50.0,
    STOOD: 4.0, 6.8: 1.0,
}  # fmt: skip
"""In the world: it looks at the floor between the hands."""


def _pelvis(times: FloatArray, sway: FloatArray) -> FloatArray:
    """As high as legs and arms let it: it sinks to what they reach."""
    level = {0.0: STANDING - 0.012, LUNGE: STANDING, DOWN: 1.05, PUSH: 1.25, UP: 1.4, LEAVE: 1.4, 4.85: 1.25, OFF: 1.0}
    level |= {SECOND: STANDING - 0.06, STOOD: STANDING - 0.012}
    ahead = curve(times, AHEAD, soft=0.06) + 0.008 * sway * drift(times, 72)
    aside = 0.006 * drift(times, 73) + curve(times, {STEP - 0.2: 0.0, STEP + 0.1: -0.02, LUNGE: 0.0})
    return np.column_stack([ahead, aside, curve(times, level, soft=0.05)])


def _arm(times: FloatArray, side: int) -> ArmTargets:
    """Hangs, rises beside the head, stands on its palm, and comes down again."""
    out = OUTWARD[side]
    keys = {
        0.0: (0.03, 0.075 * out, -0.51), 0.2: (0.03, 0.075 * out, -0.51), 0.5: (0.34, 0.14 * out, -0.18),
        0.8: (0.16, 0.04 * out, 0.50), OFF: (0.16, 0.04 * out, 0.50), OFF + 0.3: (0.40, 0.12 * out, 0.18),
        STOOD - 0.15: (0.26, 0.10 * out, -0.36), STOOD + 0.3: (0.03, 0.075 * out, -0.51),
    }  # fmt: skip
    holding = curve(times, {DOWN - 0.34: 0.0, DOWN: 1.0, OFF: 1.0, OFF + 0.34: 0.0}, soft=0.02)
    stands = curve(times, {DOWN - 0.3: 0.0, DOWN: 1.0, OFF: 1.0, OFF + 0.3: 0.0}, soft=0.02)
    raised = curve(times, {0.3: 0.0, 0.8: 1.0, OFF + 0.3: 1.0, STOOD: 0.0})
    return ArmTargets(
        curve(times, keys, soft=0.05) + 0.006 * np.column_stack([drift(times, 97 + 3 * side + k) for k in range(3)]),
        raised[:, None] * [0.5, 1.0 * out, 0.3] + (1.0 - raised)[:, None] * [-1.0, 0.25 * out, -0.2],
        held=np.tile([HANDS, WIDE * out, PALM], (len(times), 1)),
        holding=holding,
        carries=True,
        pronation=12.0,
        flexion=8.0 - 86.0 * stands,
        shrug=6.0 * raised + 1.5 * breath(times, 3.2),
    )


def _front_foot() -> list[Plant]:
    return [
        Plant(-1e3, STEP, (0.0, 0.09), 4.0, push=30.0, roll=0.3),
        Plant(LUNGE - 0.08, PUSH, FRONT, 6.0, strike=-10.0, push=52.0, roll=0.45, clearance=0.07),
        Plant(FIRST, 1e3, (0.42, 0.09), 4.0, strike=34.0, landing=0.3, clearance=0.3),
    ]


def _rear_foot() -> list[Plant]:
    return [
        Plant(-1e3, SWING, BACK, -6.0, push=58.0, roll=0.7),
        Plant(SECOND, 1e3, (0.33, -0.09), -4.0, strike=30.0, landing=0.3, clearance=0.3),
    ]


FRONT_LEG = {
    "thigh": {PUSH: 62.0, PUSH + 0.25: 34.0, UP - 0.1: 4.0, UP + 0.2: -2.0, LEAVE: -2.0, LEAVE + 0.4: 34.0, 4.85: 70.0,
              FIRST: 76.0},
    "knee": {PUSH: 30.0, PUSH + 0.25: 16.0, UP: 10.0, LEAVE: 10.0, LEAVE + 0.4: 12.0, FIRST: 40.0},
    "foot": {PUSH: 40.0, UP: 52.0, LEAVE: 52.0, FIRST - 0.1: 28.0, FIRST: 24.0},
}  # fmt: skip
REAR_LEG = {
    "thigh": {SWING: -4.0, DOWN: -14.0, PUSH: -38.0, PUSH + 0.3: -22.0, UP + 0.1: -2.0, LEAVE: -2.0, LEAVE + 0.4: -18.0,
              4.85: 8.0, OFF: 40.0, SECOND - 0.15: 50.0, SECOND: 42.0},
    "knee": {SWING: 28.0, DOWN: 14.0, PUSH: 11.0, UP: 10.0, LEAVE: 10.0, LEAVE + 0.5: 14.0, OFF: 70.0,
             SECOND - 0.15: 90.0, SECOND: 34.0},
    "foot": {SWING: 40.0, PUSH: 48.0, UP: 52.0, LEAVE: 52.0, OFF - 0.2: 30.0, OFF + 0.08: -55.0,
             SECOND - 0.1: -40.0, SECOND: 0.0},
}  # fmt: skip
"""Degrees: thighs raised forward against the pelvis, knees bent, feet pointed."""


def _leg(times: FloatArray, keys: dict[str, dict[float, float]], off: float, down: float) -> AirLeg:
    share = curve(times, {off + 0.05: 0.0, off + 0.36: 1.0, down - 0.34: 1.0, down - 0.05: 0.0}, soft=0.02)
    thigh, knee, foot = (curve(times, keys[part], soft=0.05) for part in ("thigh", "knee", "foot"))
    return AirLeg(share, thigh, knee, foot, -8.0 * share, 3.0 * share)
