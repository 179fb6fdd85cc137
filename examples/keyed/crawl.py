"""A crawl on hands and knees: one hand and the knee across from it, then the other two."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import BODY, OUTWARD
from .solve import euler
from .targets import FRAME_RATE, AirLeg, ArmTargets, Targets, frame_times

DURATION = 6.4
FIRST, STEP_TIME, SWING = 0.6, 0.62, 0.36
"""Seconds: the first knee leaves, then every other one; how long each is in the air."""
STEPS = 8
STRIDE = 0.36
KNEE, ANKLE, PALM = 0.06, 0.075, 0.055
"""Heights of knees, ankles and wrists that are on the ground."""
PITCH, CHEST = 70.0, 5.0
HANDS_AHEAD = 0.53
"""Metres by which hands are ahead of knees."""


def crawl(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    steps = [FIRST + k * STEP_TIME for k in range(STEPS)]
    hips_ahead = _hips(times, steps)
    knees, airs = zip(*(_steps(times, steps[side::2]) for side in (0, 1)), strict=True)
    thigh = float(BODY.leg[0, 0])
    angles = [np.arcsin(np.clip((knee - hips_ahead) / thigh, -0.9, 0.9)) for knee in knees]
    stands = [1.0 - air + 1e-3 for air in airs]
    high = KNEE + thigh * sum(s * np.cos(a) for s, a in zip(stands, angles, strict=True)) / sum(stands)
    sway = airs[1] - airs[0]
    turn = np.column_stack([3.0 * sway, PITCH + 0.8 * drift(times, 181), 2.5 * sway + 0.5 * drift(times, 182)])
    hips = np.column_stack([hips_ahead, 0.012 * sway + 0.005 * drift(times, 183), high])
    root = hips - euler(turn).apply(BODY.hip_offset.mean(axis=0))
    chest = np.column_stack([-4.0 * sway + 0.8 * drift(times, 184), CHEST - breath(times), -2.0 * sway])
    return Targets(
        times,
        root,
        turn,
        chest,
        np.column_stack([2.5 * drift(times, 185, 3.3), 38.0 + 2.0 * drift(times, 186), 0.8 * drift(times, 187)]),
        (_arm(times, 0, steps[1::2]), _arm(times, 1, steps[0::2])),
        (foot_path(0, times, [Plant(-1e3, 1e3, (0.0, 0.1))]), foot_path(1, times, [Plant(-1e3, 1e3, (0.0, -0.1))])),
        air={side: _leg(turn[:, 1], np.degrees(angles[side]), airs[side]) for side in (0, 1)},
    )


def _hips(times: FloatArray, steps: list[float]) -> FloatArray:
    """Metres ahead (F,): the middle of both knees, evenly."""
    begin, end = steps[0], steps[-1] + SWING
    way, early = 0.5 * STRIDE * (len(steps) - 1), 0.5 * STRIDE * 0.9 / STEP_TIME - 0.06
    keys = {begin - 0.1: 0.0, begin + 0.9: early, end - 0.9: way - early, end + 0.1: way}
    return curve(times, keys, soft=0.15)


def _steps(times: FloatArray, steps: list[float]) -> tuple[FloatArray, FloatArray]:
    """Metres ahead (F,) of a knee or hand that steps, and how far it is in the air, from 0 to 1."""
    ahead, air, place = {}, {}, 0.0
    for step in steps:
        further = place + (0.5 * STRIDE if step == steps[0] and step < FIRST + 0.5 * STEP_TIME else STRIDE)
        if step > FIRST + (STEPS - 1.5) * STEP_TIME:
            further = place + 0.5 * STRIDE
        ahead |= {step: place, step + SWING: further}
        air |= {step: 0.0, step + 0.5 * SWING: 1.0, step + SWING: 0.0}
        place = further
    return curve(times, ahead, soft=0.015), curve(times, air, soft=0.015)


def _leg(pitch: FloatArray, angle: FloatArray, air: FloatArray) -> AirLeg:
    """Thigh at ``angle`` degrees (F,) ahead of straight down; the shank lies behind it with its instep down."""
    down = np.degrees(np.arcsin((ANKLE - KNEE) / BODY.leg[0, 1]))
    one = np.ones_like(angle)
    return AirLeg(one, pitch + angle, 90.0 + down + angle + 8.0 * air, 72.0 - 6.0 * air, -6.0 * one, 2.0 + 9.0 * air)


def _arm(times: FloatArray, side: int, steps: list[float]) -> ArmTargets:
    out = OUTWARD[side]
    ahead, air = _steps(times, steps)
    held = np.column_stack([ahead + HANDS_AHEAD, out * (0.19 + 0.01 * air), PALM + 0.06 * air])
    one = np.ones_like(times)
    return ArmTargets(
        np.tile([0.2, 0.0, -0.5], (len(times), 1)),
        np.array([-0.3, 0.6 * out, -1.0]),
        held=held,
        holding=one,
        pronation=70.0,
        flexion=-72.0 + 34.0 * air,
        shrug=3.0 + 1.5 * breath(times),
    )
