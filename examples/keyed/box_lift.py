"""A box is lifted off the floor with both hands, carried before the belly, and put down again."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import OUTWARD, STANDING
from .targets import FRAME_RATE, ArmTargets, Targets, frame_times

DURATION = 7.4
GRASP, LIFT, HIGH, LOWER, DOWN, RELEASE = 1.9, 2.2, 3.3, 4.3, 5.4, 5.6
"""Hands at the box, off with it, box before the belly, down with it, on the floor, hands off it."""
HALF_WIDTH = 0.19
"""Metres from the middle of the box to a wrist beside it."""
HEIGHT = {0.0: 0.30, LIFT: 0.30, HIGH: 0.98, LOWER: 0.97, DOWN: 0.30}
AHEAD = {0.0: 0.50, LIFT: 0.50, 0.5 * (LIFT + HIGH): 0.46, HIGH: 0.38, LOWER: 0.38, DOWN: 0.50}
SQUAT = {0.5: 0.0, GRASP - 0.1: 1.0, LIFT: 1.0, HIGH: 0.0, LOWER: 0.0, DOWN: 1.0, RELEASE: 1.0, 6.9: 0.0}


def box_lift(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    squat, burden = curve(times, SQUAT, soft=0.09), curve(times, {GRASP: 0.0, HIGH: 1.0, LOWER: 1.0, DOWN: 0.0})
    pelvis = np.column_stack(
        [
            0.025 - 0.13 * squat - 0.03 * burden + 0.005 * drift(times, 121),
            0.006 * drift(times, 122, 3.3),
            STANDING - 0.014 - 0.34 * squat + 0.002 * drift(times, 123),
        ]
    )
    alive = [0.8 * np.column_stack([drift(times, seed + k, 3.0) for k in range(3)]) for seed in (124, 127, 130)]
    still = np.zeros_like(times)
    return Targets(
        times,
        pelvis,
        np.column_stack([still, 2.0 + 38.0 * squat - 3.0 * burden, still]) + alive[0],
        np.column_stack([still, 2.0 + 26.0 * squat - 5.0 * burden - 1.2 * breath(times), still]) + alive[1],
        np.column_stack([still, 6.0 + 42.0 * squat + 14.0 * burden, still]) + alive[2],
        (_arm(times, 0), _arm(times, 1)),
        (
            foot_path(0, times, [Plant(-1e3, 1e3, (0.02, 0.15), 14.0)]),
            foot_path(1, times, [Plant(-1e3, 1e3, (-0.02, -0.15), -16.0)]),
        ),
        splay=(14.0, 14.0),
    )


def _arm(times: FloatArray, side: int) -> ArmTargets:
    out = OUTWARD[side]
    apart = curve(times, {GRASP - 0.25: 0.07, GRASP: 0.0, RELEASE: 0.0, RELEASE + 0.3: 0.08}, soft=0.03)
    box = np.column_stack(
        [curve(times, AHEAD, soft=0.06), out * (HALF_WIDTH + apart), curve(times, HEIGHT, soft=0.06)],
    )
    holding = curve(times, {0.9: 0.0, GRASP - 0.1: 1.0, RELEASE: 1.0, 6.5: 0.0}, soft=0.06)
    hangs = np.tile([0.05, 0.07 * out, -0.54], (len(times), 1))
    return ArmTargets(
        hangs + 0.004 * np.column_stack([drift(times, 133 + 3 * side + k) for k in range(3)]),
        np.array([-1.0, 0.5 * out, 0.0]),
        upright=0.75 * (1 - holding),
        held=box,
        holding=holding,
        pronation=30.0 - 18.0 * holding,
        flexion=10.0 - 6.0 * holding,
        deviation=2.0 + 4.0 * holding,
        shrug=1.5 * breath(times),
    )
