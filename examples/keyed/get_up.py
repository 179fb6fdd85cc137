"""Up from both knees: one foot forward, the weight over it, and onto both feet."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import BODY, OUTWARD, STANDING
from .targets import FRAME_RATE, ArmTargets, Targets, frame_times

DURATION = 5.2
STEP_OFF, STEPPED, PUSH, RISEN = 1.1, 1.62, 2.2, 3.1
"""The right foot leaves its toes, stands ahead, the weight is over it, and the legs are straight."""
KNEE = 0.06
"""Height of a knee that kneels."""
TOES_UP = 66.0
"""Pitch of a foot that kneels on its toes."""
KNEELING = KNEE + float(BODY.leg[0, 0]) - float(BODY.hip_offset[0, 2])


def get_up(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    lean = curve(times, {0.9: 0.0, PUSH: 1.0, 0.5 * (PUSH + RISEN): 0.7, RISEN: 0.0}, soft=0.09)
    over = curve(times, {0.9: 0.0, STEP_OFF: 1.0, STEPPED: 0.6, PUSH: 0.0}, soft=0.07)
    ahead = curve(times, {0.8: 0.0, STEPPED: 0.03, PUSH: 0.16, RISEN: 0.40}, soft=0.09)
    height = curve(times, {STEPPED: KNEELING - 0.004, PUSH: KNEELING + 0.03, RISEN: STANDING - 0.014}, soft=0.09)
    alive = [0.8 * np.column_stack([drift(times, seed + k, 3.0) for k in range(3)]) for seed in (161, 164, 167)]
    still = np.zeros_like(times)
    return Targets(
        times,
        np.column_stack([ahead + 0.004 * drift(times, 170), 0.03 * over + 0.004 * drift(times, 171), height]),
        np.column_stack([-6.0 * over, 3.0 + 16.0 * lean, -3.0 * over]) + alive[0],
        np.column_stack([still, 3.0 + 24.0 * lean - 1.2 * breath(times), 3.0 * over]) + alive[1],
        np.column_stack([still, 8.0 + 14.0 * lean, still]) + alive[2],
        (_arm(times, 0, lean), _arm(times, 1, lean)),
        (foot_path(0, times, _left_foot()), foot_path(1, times, _right_foot())),
        splay=(8.0, 8.0),
    )


def _kneeling_foot(side: int) -> tuple[float, float]:
    """Place of the ankle over a flat sole that stands on the toes of a foot behind its knee."""
    behind, pitch = float(BODY.leg[side, 1]), np.radians(TOES_UP)
    high = np.cos(pitch) * BODY.ankle_height[side] + np.sin(pitch) * BODY.foot[side, 0]
    ankle = -np.sqrt(behind**2 - (high - KNEE) ** 2)
    forward = BODY.foot[side, 0] - np.cos(pitch) * BODY.foot[side, 0] - np.sin(pitch) * BODY.ankle_height[side]
    return float(ankle - forward), 0.10 * OUTWARD[side]


def _left_foot() -> list[Plant]:
    """Pushes from its toes, then comes up beside the other."""
    return [
        Plant(-1e3, 2.6, _kneeling_foot(0), 2.0, heel={PUSH: TOES_UP, 2.6: TOES_UP - 12.0}, push=12.0, roll=0.25),
        Plant(3.08, 1e3, (0.36, 0.11), 8.0, strike=8.0, clearance=0.06),
    ]


def _right_foot() -> list[Plant]:
    return [
        Plant(-1e3, STEP_OFF, _kneeling_foot(1), -2.0, heel={0.0: TOES_UP}, push=6.0, roll=0.2),
        Plant(STEPPED, 1e3, (0.39, -0.12), -9.0, strike=4.0, clearance=0.07, around=(0.0, -0.06)),
    ]


def _arm(times: FloatArray, side: int, lean: FloatArray) -> ArmTargets:
    """Swings forward with the weight."""
    out = OUTWARD[side]
    hangs = np.array([0.05, 0.08 * out, -0.54]) + np.outer(lean, [0.24, 0.06 * out, 0.10])
    return ArmTargets(
        hangs + 0.004 * np.column_stack([drift(times, 172 + 3 * side + k) for k in range(3)]),
        np.array([-1.0, 0.5 * out, 0.0]),
        upright=0.7 * np.ones_like(times),
        pronation=30.0,
        flexion=12.0,
        shrug=1.5 * breath(times),
    )
