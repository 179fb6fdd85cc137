"""A dance on the spot: steps to either side, hips and chest against each other, hands that meet before and above."""

import numpy as np

from .curves import FloatArray, breath, curve, drift
from .feet import Plant, foot_path
from .performer import OUTWARD, STANDING
from .targets import FRAME_RATE, ArmTargets, Targets, frame_times

BEAT = 0.56
FIRST, BARS = 0.4, 3
"""Seconds before the first step, and rounds of four beats: left, together, right, together."""
DURATION = FIRST + 4 * BARS * BEAT + 0.8
ASIDE, WIDE = 0.30, 0.11
"""Metres of a step to the side, and of each foot from the middle of both."""


def dance(frame_rate: float = FRAME_RATE) -> Targets:
    """The targets of the clip."""
    times = frame_times(DURATION, frame_rate)
    beats = FIRST + BEAT * np.arange(4 * BARS)
    going = curve(times, {FIRST - 0.2: 0.0, FIRST + 0.3: 1.0, DURATION - 0.9: 1.0, DURATION - 0.4: 0.0}, soft=0.08)
    phase = np.pi * (times - FIRST) / BEAT
    sway, bounce = going * np.sin(phase), going * (0.5 - 0.5 * np.cos(2.0 * phase))
    middle = curve(times, {beat + 0.62 * BEAT: _middle(k) for k, beat in enumerate(beats)} | {FIRST: 0.0}, soft=0.09)
    alive = [0.8 * np.column_stack([drift(times, seed + k, 3.0) for k in range(3)]) for seed in (191, 194, 197)]
    return Targets(
        times,
        np.column_stack([0.02 + 0.01 * sway, middle + 0.006 * drift(times, 200), STANDING - 0.045 + 0.022 * bounce]),
        np.column_stack([9.0 * sway, 3.0 + 2.0 * bounce, 4.0 * sway]) + alive[0],
        np.column_stack([-16.0 * sway, 1.0 - 1.2 * breath(times), -6.0 * sway]) + alive[1],
        np.column_stack([4.0 * sway, 5.0 - 2.0 * bounce, 3.0 * sway]) + alive[2],
        (_arm(times, 0, sway), _arm(times, 1, sway)),
        (foot_path(0, times, _plants(0, beats)), foot_path(1, times, _plants(1, beats))),
        splay=(9.0, 9.0),
    )


def _middle(beat: int) -> float:
    """Metres to the left of the middle of both feet after a step."""
    return (0.5 * ASIDE, ASIDE, 0.5 * ASIDE, 0.0)[beat % 4]


def _plants(side: int, beats: FloatArray) -> list[Plant]:
    """Left, right to it, right, left to it."""
    out, place = OUTWARD[side], 0.0
    stands = [Plant(-1e3, 1e3, (0.0, WIDE * out), 8.0 * out)]
    for k, beat in enumerate(beats):
        if (0, 1, 1, 0)[k % 4] == side:
            place = ASIDE - place
            last = stands.pop()
            stands += [
                Plant(last.start, beat + 0.06, last.place, last.yaw, 12.0, 0.14, 16.0, 0.18, clearance=0.05),
                Plant(beat + 0.46 * BEAT + 0.1, 1e3, (0.0, WIDE * out + place), 8.0 * out, 12.0, 0.14, 16.0, 0.18,
                      clearance=0.05),
            ]  # fmt: skip
    return stands


def _arm(times: FloatArray, side: int, sway: FloatArray) -> ArmTargets:
    """Hands meet before the chest, open to the sides, meet above the head, and come down."""
    out, begin = OUTWARD[side], FIRST + 0.2
    hangs, before, wide = (0.06, 0.08 * out, -0.53), (0.34, -0.145 * out, -0.16), (0.16, 0.40 * out, 0.02)
    above = (0.20, -0.14 * out, 0.44)
    keys = {
        begin: hangs, begin + 0.8: before, begin + 2.0: before, begin + 2.8: wide, begin + 3.4: wide,
        begin + 4.2: above, begin + 5.0: above, begin + 5.9: wide, DURATION - 0.2: hangs,
    }  # fmt: skip
    raised = curve(times, {begin: 0.0, begin + 0.8: 0.5, begin + 2.6: 1.0, begin + 5.8: 1.0, DURATION - 0.2: 0.0})
    wander = 0.006 * np.column_stack([drift(times, 201 + 3 * side + k) for k in range(3)])
    return ArmTargets(
        curve(times, keys, soft=0.07) + wander + np.outer(sway, [0.02 * out, 0.0, 0.01]),
        np.array([-0.8, 0.6 * out, -0.2]) + raised[:, None] * [0.5, 0.3 * out, -0.5],
        upright=0.7 * (1 - raised),
        pronation=30.0 - 10.0 * raised,
        flexion=10.0 + 8.0 * sway,
        shrug=2.0,
    )
