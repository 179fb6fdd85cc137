"""Walking: steps in time and place, and how pelvis, chest and arms go with them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from .curves import FloatArray, breath, curve, drift, spring
from .feet import Plant
from .performer import OUTWARD
from .targets import ArmTargets


@dataclass(frozen=True)
class Step:
    """A foot (0 left, 1 right) leaves the ground at ``lift`` and lands at ``land`` with its ankle over ``place``."""

    side: int
    lift: float
    land: float
    place: tuple[float, float]
    yaw: float = 0.0
    strike: float = -18.0
    around: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Walk:
    """Steps from a stance ``start``: places and yaws of the left and right foot."""

    start: tuple[tuple[float, float, float], tuple[float, float, float]]
    steps: Sequence[Step]

    def plants(self, side: int) -> list[Plant]:
        """The stands of one foot between its steps."""
        x, y, yaw = self.start[side]
        stands = [Plant(-1e3, 1e3, (x, y), yaw)]
        for step in (step for step in self.steps if step.side == side):
            stands[-1] = replace(stands[-1], end=step.lift)
            stands.append(Plant(step.land, 1e3, step.place, step.yaw, step.strike, around=step.around))
        return stands

    def carried(self, times: FloatArray, over_stance: float = 0.30) -> FloatArray:
        """Place of the weight, x, y and heading in degrees (F, 3): between both feet, then towards the standing one.

        ``over_stance`` is how far it goes from the middle of the track to the foot that stands alone.
        """
        feet = [np.array(foot, dtype=np.float64) for foot in self.start]
        moments, states = [self.steps[0].lift - 0.9], [np.mean(feet, axis=0)]
        for k, step in enumerate(self.steps):
            stance, before = feet[1 - step.side], feet[step.side].copy()
            feet[step.side] = np.array([*step.place, step.yaw])
            middle = 0.5 * (before + feet[step.side])
            moments.append(0.53 * step.lift + 0.47 * step.land)
            states.append(0.5 * (1 + over_stance) * stance + 0.5 * (1 - over_stance) * middle)
            leaves = self.steps[k + 1].lift if k + 1 < len(self.steps) else step.land + 0.5
            moments.append(step.land + 0.1 * (leaves - step.land))
            states.append(np.mean(feet, axis=0))
        spline = CubicSpline(moments, states, bc_type="clamped")
        return np.asarray(spline(np.clip(times, moments[0], moments[-1])))

    def stride(self, times: FloatArray, delay: float = 0.0) -> FloatArray:
        """1 when the left foot has just landed in front, -1 when the right has, 0 while standing (F,)."""
        keys = {self.steps[0].lift - 0.25: 0.0, self.steps[-1].land + 0.35: 0.0}
        keys |= {step.land + 0.02: 1.0 - 2.0 * step.side for step in self.steps[:-1]}
        return curve(times, keys, soft=0.09, delay=delay)

    def support(self, times: FloatArray, delay: float = 0.0) -> FloatArray:
        """1 while only the left foot stands, -1 while only the right does (F,)."""
        keys = {self.steps[0].lift - 0.5: 0.0, self.steps[-1].land + 0.3: 0.0}
        keys |= {step.lift + 0.35 * (step.land - step.lift): 2.0 * step.side - 1.0 for step in self.steps}
        return curve(times, keys, soft=0.07, delay=delay)

    def rise(self, times: FloatArray) -> FloatArray:
        """1 when passing over the standing foot, 0 with both feet down: twice a stride (F,)."""
        keys = {self.steps[0].lift - 0.5: 0.6, self.steps[-1].land + 0.6: 0.6}
        for step in self.steps:
            keys[step.lift + 0.45 * (step.land - step.lift)] = 1.0
            keys[step.land + 0.05] = 0.0 if step is not self.steps[-1] else 0.3
        return curve(times, keys, soft=0.06)


def swinging_arm(walk: Walk, times: FloatArray, side: int, apart: float | FloatArray = 0.0) -> ArmTargets:
    """The arm of ``side``: it hangs and swings against the leg; the elbow drags and the hand behind it.

    ``apart`` holds it further from the body, in metres.
    """
    sign, outward = (-0.88, 1.0)[side], OUTWARD[side]
    swing = spring(times, sign * walk.stride(times, delay=0.03), 1.9, 0.75)
    late = sign * walk.stride(times, delay=0.17)
    angle = np.radians(2 + 21 * swing + 1.2 * drift(times, 5 + side))
    length = 0.567 * (0.964 - 0.020 * (late + 0.5 * swing))
    aside = outward * (0.076 + apart - 0.030 * np.maximum(swing, 0) + 0.012 * np.maximum(-swing, 0))
    wrist = np.stack([length * np.sin(angle), aside, -length * np.cos(angle)], axis=1)
    return ArmTargets(
        wrist,
        np.array([-1.0, 0.45 * outward, 0.0]),
        upright=0.7,
        pronation=28 + 9 * swing,
        flexion=11 + 13 * (late - swing),
        deviation=2.0 + 3.0 * late,
        shrug=1.5 * breath(times),
    )
