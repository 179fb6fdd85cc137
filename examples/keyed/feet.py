"""Feet that stand, roll and swing: where each ankle is and how foot and toes are turned.

Pitch is in degrees, above zero with the heel up and below zero with the toes up. A planted foot with its heel up
turns about the ball while the toes lie flat; with its toes up it turns about the heel.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.interpolate import BPoly
from scipy.spatial.transform import Rotation

from .curves import FloatArray, Keys, curve
from .performer import BODY

_SWING_ENDS = 1e-3


@dataclass(frozen=True)
class Plant:
    """One stand of a foot from ``start`` to ``end`` seconds, its ankle above ``place`` while the sole is flat.

    It lands with pitch ``strike`` and is flat after ``landing`` seconds; for the last ``roll`` seconds the heel
    rises to ``push``. ``heel`` and ``pivot`` are keys of further pitch and of turning on the ball, in degrees.
    ``clearance`` lifts the swing that leads here, ``around`` bows it aside in the world, all in metres.
    """

    start: float
    end: float
    place: tuple[float, float]
    yaw: float = 0.0
    strike: float = -18.0
    landing: float = 0.19
    push: float = 44.0
    roll: float = 0.40
    heel: Keys = field(default_factory=dict)
    pivot: Keys = field(default_factory=dict)
    clearance: float = 0.044
    around: tuple[float, float] = (0.0, 0.0)

    def pose(self, side: int, times: FloatArray) -> FloatArray:
        """Ankle x, y, z in metres, pitch and yaw in degrees (F, 5); smooth a little beyond both ends."""
        landing = _ease(np.clip(1 - (times - self.start) / self.landing, 0, 1))
        rolling = np.maximum(1 + (times - self.end) / self.roll, 0)
        pitch = self.strike * landing + self.push * rolling**3
        yaw = np.full(len(times), self.yaw)
        if self.heel:
            pitch += curve(times, self.heel)
        if self.pivot:
            yaw += curve(times, self.pivot)
        flat = Rotation.from_euler("z", self.yaw, degrees=True)
        turned = Rotation.from_euler("ZY", np.stack([yaw, pitch], axis=1), degrees=True)
        ankle = np.array([*self.place, BODY.ankle_height[side]])
        heel = np.array([-BODY.heel_length[side], 0.0, -BODY.ankle_height[side]])
        about = np.where(pitch[:, None] >= 0, BODY.foot[side], heel)
        ankles = ankle + flat.apply(about) - turned.apply(about)
        return np.column_stack([ankles, pitch, yaw])


@dataclass(frozen=True)
class FootPath:
    """One foot over all frames: ``ankle`` (F, 3), ``pitch``, ``yaw``, ``toe`` (F,) degrees, ``planted`` (F,)."""

    ankle: FloatArray
    pitch: FloatArray
    yaw: FloatArray
    toe: FloatArray
    """Pitch of the toes against the foot: below zero bent up."""
    planted: FloatArray


def foot_path(side: int, times: FloatArray, plants: Sequence[Plant]) -> FootPath:
    """The path of a foot through its stands, with swings between that leave and land at the stands' own speed."""
    pose, toe, planted = np.empty((len(times), 5)), np.zeros(len(times)), np.zeros(len(times), dtype=bool)
    for k, plant in enumerate(plants):
        here = (times >= (plant.start if k else -np.inf)) & (
            times <= (plant.end if plant is not plants[-1] else np.inf)
        )
        pose[here] = plant.pose(side, times[here])
        toe[here] = -np.maximum(pose[here, 3], 0)
        planted |= here
    for left, right in pairwise(plants):
        air = (times > left.end) & (times < right.start)
        share = (times[air] - left.end) / (right.start - left.end)
        pose[air] = _swing(side, left, right, times[air])
        pose[air, :3] += np.outer((4 * share * (1 - share)) ** 3, [*right.around, right.clearance])
        toe[air] = -np.maximum(pose[air, 3], 0) * (1 - 0.45 * (4 * share * (1 - share)) ** 3)
    return FootPath(pose[:, :3], pose[:, 3], pose[:, 4], toe, planted)


def _swing(side: int, left: Plant, right: Plant, times: FloatArray) -> FloatArray:
    """Quintics (F, 5) from one stand's place, speed and acceleration to those of the next."""
    ends = [_derivatives(side, plant, moment) for plant, moment in ((left, left.end), (right, right.start))]
    return np.asarray(BPoly.from_derivatives([left.end, right.start], ends)(times))


def _derivatives(side: int, plant: Plant, moment: float) -> FloatArray:
    before, at, after = plant.pose(side, moment + _SWING_ENDS * np.array([-1.0, 0.0, 1.0]))
    speed, acceleration = (after - before) / (2 * _SWING_ENDS), (after - 2 * at + before) / _SWING_ENDS**2
    return np.stack([at, speed, acceleration])


def _ease(share: FloatArray) -> FloatArray:
    return share**3 * (6 * share**2 - 15 * share + 10)
