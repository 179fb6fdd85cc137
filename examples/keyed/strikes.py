"""Strikes from guard, one a clip: each limb, high and low, from standing or with a step in, quick or slow."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .curves import FloatArray, Keys, breath, curve, drift
from .feet import FootPath, Plant, foot_path
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
from .performer import OUTWARD
from .targets import AirLeg, ArmTargets, Targets, frame_times

HIT, AFTER = 1.6, 1.7
"""Seconds before and after the hit."""
GUARDS, ELBOWS = (LEFT_GUARD, RIGHT_GUARD), (LEFT_ELBOW, RIGHT_ELBOW)
QUIET = {HIT - 0.9: 0.8, HIT - 0.5: 0.0, HIT + 0.8: 0.0, HIT + 1.3: 0.7}
"""Strength of the bounce."""


@dataclass(frozen=True)
class Punch:
    """``side`` 0 is the jab of the front hand, 1 the cross; ``wrist`` is where it hits, in metres.

    ``step`` metres of the front foot ahead, ``sink`` of the pelvis. The body takes
    ``pace`` times as long; the fist does not.
    """

    side: int
    wrist: tuple[float, float, float]
    step: float = 0.0
    sink: float = 0.0
    pace: float = 1.0
    seed: int = 0

    def targets(self) -> Targets:
        """Keys of the clip."""
        times = frame_times(HIT + AFTER)
        beat = bounce(times, QUIET)
        return Targets(
            times,
            self._pelvis(times, beat),
            self._turn(times, PELVIS_OF_PUNCH[self.side], 0.0) + _alive(times, beat, self.seed),
            self._turn(times, CHEST_OF_PUNCH[self.side], 0.02) + _breathing(times, beat, self.seed),
            _head(times, self.seed, 20.0 * self.sink),
            (self._arm(0, times, beat), self._arm(1, times, beat)),
            (self._front_foot(times), self._rear_foot(times)),
            splay=(4.0, 4.0),
        )

    def _keys(self, keys: Keys) -> Keys:
        return at_hit(keys, self.pace)

    def _pelvis(self, times: FloatArray, beat: FloatArray) -> FloatArray:
        ahead = (0.045, 0.02)[self.side] if self.step else (0.05, 0.085)[self.side]
        place = curve(times, self._keys({-0.4: (0, -0.02), -0.2: (-0.03, -0.03), 0.05: (ahead, 0.01), 0.7: (0, -0.02)}))
        place[:, 0] += self.step * curve(times, self._keys({-0.34: 0.0, -0.02: 0.8, 0.25: 0.85, 0.65: 1.0}))
        level = curve(times, self._keys({-0.45: 0.0, -0.2: -0.02, 0.0: -0.014, 0.2: -0.014, 0.7: 0.0}), soft=0.03)
        level -= self.sink * curve(times, self._keys({-0.4: 0.0, -0.04: 1.0, 0.12: 1.0, 0.6: 0.0}), soft=0.05)
        swayed = place + rocking(times, 70 + self.seed)
        return np.column_stack([swayed, HEIGHT + level + 0.030 * (beat - 0.5)])

    def _turn(self, times: FloatArray, keyed: tuple[Keys, Keys, Keys], delay: float) -> FloatArray:
        turns = [curve(times, self._keys(keys), soft=0.025, delay=delay) for keys in keyed]
        turns[1] += 60.0 * self.sink * curve(times, self._keys({-0.35: 0.0, 0.0: 1.0, 0.12: 1.0, 0.6: 0.0}))
        return np.stack(turns, axis=1)

    def _arm(self, side: int, times: FloatArray, beat: FloatArray) -> ArmTargets:
        wrist = guarding(times, GUARDS[side], beat, 80 + 7 * self.seed + side)
        if side != self.side:
            out = 0.06 * OUTWARD[side]
            cover = {-0.4: (0, 0, 0), -0.1: (-0.02, out, 0.07), 0.1: (-0.035, out, 0.06), 0.7: (0, 0, 0)}
            return ArmTargets(
                moved(times, wrist, self._keys(cover)), ELBOWS[side], pronation=18.0, flexion=6.0, shrug=3.0
            )
        hold = at_hit({-0.22: 0.0, -0.12: 0.14, 0.0: 1.0, 0.045: 1.0, 0.18: 0.55, 0.42: 0.0}, 1.0)
        holding, turned = curve(times, hold, soft=0.02), curve(times, hold, soft=0.02, delay=0.02)
        load = {-0.45: (0, 0, 0), -0.22: (-0.025, 0.0, -0.02), 0.0: (0, 0, 0), 0.3: (0.02, 0, -0.06), 0.75: (0, 0, 0)}
        thrust = curve(times, self._keys({-0.15: 0.0, 0.0: 1.0, 0.06: 1.0, 0.3: 0.0}), soft=0.02)
        return ArmTargets(
            moved(times, wrist, self._keys(load)),
            ELBOWS[side],
            held=np.tile(self.wrist, (len(times), 1)),
            holding=holding,
            pronation=16 + 64 * turned,
            flexion=6 - 4 * holding,
            shrug=3 + 5 * thrust,
            thrust=15 * thrust,
        )

    def _front_foot(self, times: FloatArray) -> FootPath:
        x, y = FRONT
        if not self.step:
            return foot_path(0, times, [Plant(-1e3, 1e3, FRONT, FRONT_YAW)])
        left, landed = HIT - 0.30 * self.pace, HIT - 0.05 * self.pace
        first = Plant(-1e3, left, FRONT, FRONT_YAW, push=14.0, roll=0.14)
        ahead = Plant(landed, 1e3, (x + self.step, y), FRONT_YAW, strike=-6.0, landing=0.10, clearance=0.02)
        return foot_path(0, times, [first, ahead])

    def _rear_foot(self, times: FloatArray) -> FootPath:
        x, y = REAR
        up = {-0.4: REAR_HEEL, -0.1: (14.0, 28.0)[self.side], 0.1: (14.0, 32.0)[self.side], 0.5: 12.0, 1.0: REAR_HEEL}
        swivel = {-0.2: 0.0, 0.0: (4.0, 42.0)[self.side], 0.1: (4.0, 45.0)[self.side], 0.45: 10.0, 0.6: 0.0}
        turned = {"heel": self._keys(up), "pivot": self._keys(swivel)}
        if not self.step:
            return foot_path(1, times, [Plant(-1e3, 1e3, REAR, REAR_YAW, **turned)])
        left, landed = HIT + 0.62 * self.pace, HIT + 0.62 * self.pace + 0.26
        back = Plant(landed, 1e3, (x + self.step, y), REAR_YAW, strike=8.0, landing=0.14, heel={0.0: REAR_HEEL})
        return foot_path(1, times, [Plant(-1e3, left, REAR, REAR_YAW, push=10.0, roll=0.12, **turned), back])


@dataclass(frozen=True)
class Kick:
    """A front kick: ``side`` 0 with the leg in front, 1 with that behind; ``thigh`` degrees above hanging down."""

    side: int
    thigh: float
    pace: float = 1.0
    seed: int = 0

    def targets(self) -> Targets:
        """Keys of the clip."""
        times = frame_times(HIT + AFTER)
        beat = bounce(times, QUIET)
        return Targets(
            times,
            self._pelvis(times, beat),
            self._turn(times, PELVIS_OF_KICK[self.side]) + self._lean(times) + _alive(times, beat, self.seed),
            self._turn(times, CHEST_OF_KICK[self.side]) + _breathing(times, beat, self.seed),
            _head(times, self.seed, 0.0),
            (self._arm(0, times, beat), self._arm(1, times, beat)),
            (self._foot(0, times), self._foot(1, times)),
            splay=(5.0, 5.0),
            air={self.side: self._leg(times)},
        )

    def _keys(self, keys: Keys) -> Keys:
        return at_hit(keys, self.pace)

    def _pelvis(self, times: FloatArray, beat: FloatArray) -> FloatArray:
        place = curve(times, self._keys(PLACE_OF_KICK[self.side]), soft=0.06) + rocking(times, 90 + self.seed)
        rise = {
            -1.05: 0.0,
            -0.74: -0.04,
            -0.5: -0.006,
            -0.2: 0.034,
            0.0: 0.05,
            0.28: 0.04,
            0.6: 0.0,
            0.9: -0.04,
            1.5: 0,
        }
        return np.column_stack([place, HEIGHT + curve(times, self._keys(rise), soft=0.05) + 0.030 * (beat - 0.5)])

    def _turn(self, times: FloatArray, keyed: tuple[Keys, Keys, Keys]) -> FloatArray:
        return np.stack([curve(times, self._keys(keys), soft=0.04) for keys in keyed], axis=1)

    def _lean(self, times: FloatArray) -> FloatArray:
        """Lean of the pelvis away from the blow: the higher, the farther."""
        back = curve(times, self._keys({-0.5: 0.0, -0.2: 0.5, 0.0: 1.0, 0.28: 0.45, 0.6: 0.0}), soft=0.04)
        return np.outer(back, [0.0, -0.2 * self.thigh, 0.0])

    def _leg(self, times: FloatArray) -> AirLeg:
        most = self.thigh
        share = {-0.43: 0.0, -0.24: 1.0, 0.28: 1.0, 0.62: 0.0}
        thigh = {-0.5: -5.0, -0.2: most, -0.04: most + 4, 0.04: most, 0.28: 0.88 * most, 0.58: 14.0}
        knee = {-0.5: 60.0, -0.24: 122.0, -0.17: 122.0, 0.0: 13.0, 0.05: 16.0, 0.28: 108.0, 0.58: 80.0}
        foot = {-0.5: 30.0, -0.2: 20.0, -0.03: 42.0, 0.06: 40.0, 0.28: 18.0, 0.6: 25.0}
        toe = {-0.5: -10.0, -0.2: -5.0, -0.05: -38.0, 0.06: -38.0, 0.28: -5.0, 0.6: -32.0}
        outward = {-0.5: 0.0, -0.2: OPENED[self.side] / 2, 0.0: OPENED[self.side], 0.28: OPENED[self.side] - 2, 0.7: 0}
        return AirLeg(
            *(curve(times, self._keys(keys), soft=0.022) for keys in (share, thigh, knee, foot, toe, outward))
        )

    def _arm(self, side: int, times: FloatArray, beat: FloatArray) -> ArmTargets:
        """That of the leg throws back and down against it; the other closes before the face."""
        wrist = guarding(times, GUARDS[side], beat, 100 + 7 * self.seed + side)
        if side != self.side:
            cover = {-0.7: (0, 0, 0), -0.2: (0.0, 0, 0.0), 0.03: (0.03, 0.0, -0.02), 0.4: (0.02, 0, 0), 1.2: (0, 0, 0)}
            return ArmTargets(moved(times, wrist, self._keys(cover), 0.05), ELBOWS[side], pronation=18.0, flexion=6.0)
        out = OUTWARD[side]
        keys = {-1.1: (0, 0, 0), -0.7: (0.02, 0, 0.02), -0.25: (-0.06, 0.1 * out, -0.1)}
        keys |= {0.02: (-0.27, 0.27 * out, -0.37), 0.14: (-0.29, 0.28 * out, -0.37), 0.45: (-0.08, 0.16 * out, -0.2)}
        keys |= {0.8: (0.0, 0.04 * out, -0.08), 1.2: (0, 0, 0)}
        throw = curve(times, self._keys({-0.2: 0.0, 0.08: 1.0, 0.53: 0.0}), soft=0.05)
        return ArmTargets(
            moved(times, wrist, self._keys(keys), soft=0.045),
            ELBOWS[side] + throw[:, None] * [-0.6, 0.5 * out, 0.6],
            pronation=15 + 40 * throw,
            flexion=6 + 10 * throw,
            shrug=3.0,
        )

    def _foot(self, side: int, times: FloatArray) -> FootPath:
        place, yaw, heel = ((FRONT, FRONT_YAW, 0.0), (REAR, REAR_YAW, REAR_HEEL))[side]
        if side != self.side:
            up = {-0.8: heel, -0.5: 4.0, -0.2: 7.0, 0.0: 9.0, 0.28: 6.0, 0.7: 3.0, 1.0: heel}
            pivot = {-0.6: 0.0, -0.15: 0.8 * PIVOT[side], 0.0: PIVOT[side], 0.28: 0.9 * PIVOT[side], 0.95: 0.0}
            return foot_path(side, times, [Plant(-1e3, 1e3, place, yaw, heel=self._keys(up), pivot=self._keys(pivot))])
        left, landed = HIT - 0.5 * self.pace, HIT + 0.7 * self.pace
        near = place[0] + 0.03, place[1] - 0.02
        down = {"heel": {0.0: heel}} if heel else {}
        return foot_path(
            side,
            times,
            [
                Plant(-1e3, left, place, yaw, push=38.0, roll=0.34, **down),
                Plant(landed, 1e3, near, yaw + 4.0, strike=22.0, landing=0.22, clearance=0.10, **down),
            ],
        )


def at_hit(keys: Keys, pace: float) -> Keys:
    """Keys in seconds about the hit as keys of the clip, ``pace`` times as far apart."""
    return {HIT + pace * moment: value for moment, value in keys.items()}


def _alive(times: FloatArray, beat: FloatArray, seed: int) -> FloatArray:
    return np.stack([1.2 * drift(times, 120 + seed), 0.8 * beat, 0 * beat], axis=1)


def _breathing(times: FloatArray, beat: FloatArray, seed: int) -> FloatArray:
    sway = 0.8 * drift(times, 130 + seed), 1.2 * (beat - 0.5) - 1.5 * breath(times, 2.4), 0.6 * drift(times, 140 + seed)
    return np.stack(sway, axis=1)


def _head(times: FloatArray, seed: int, down: float) -> FloatArray:
    """Eyes ahead, chin down with the hit."""
    pitch = curve(times, at_hit({-0.6: 9.0, 0.05: 13.0 + down, 0.6: 9.0}, 1.0), soft=0.05)
    wander = [1.2 * drift(times, 150 + seed), 0.8 * drift(times, 160 + seed), 0.8 * drift(times, 170 + seed)]
    return np.stack([wander[0] - 3.0, wander[1] + pitch, wander[2]], axis=1)


PELVIS_OF_PUNCH: tuple[tuple[Keys, Keys, Keys], ...] = (
    (
        {-0.4: -33.0, -0.2: -28.0, 0.0: -46.0, 0.08: -47.0, 0.5: -34.0, 0.9: -33.0},
        {-0.4: 5.0, 0.0: 8.0, 0.6: 5.0},
        {-0.4: 0.0, 0.0: 2.0, 0.6: 0.0},
    ),
    (
        {-0.5: -33.0, -0.3: -44.0, -0.2: -43.0, -0.08: 12.0, 0.06: 18.0, 0.34: -12.0, 0.75: -36.0, 1.2: -33.0},
        {-0.5: 5.0, -0.3: 3.0, 0.0: 9.0, 0.5: 6.0, 0.9: 5.0},
        {-0.6: 0.0, -0.3: 4.0, -0.1: -3.0, 0.15: -4.0, 0.6: 0.0},
    ),
)
"""Yaw, pitch and roll in degrees, of jab and cross."""
CHEST_OF_PUNCH: tuple[tuple[Keys, Keys, Keys], ...] = (
    (
        {-0.4: -9.0, -0.2: -4.0, 0.0: -26.0, 0.07: -27.0, 0.4: -10.0, 0.9: -9.0},
        {-0.4: 9.0, 0.0: 10.0, 0.6: 9.0},
        {-0.3: 0.0, 0.0: 4.0, 0.5: 0.0},
    ),
    (
        {-0.5: -9.0, -0.32: -17.0, -0.2: -19.0, -0.04: 17.0, 0.07: 22.0, 0.33: 0.0, 0.7: -12.0, 1.2: -8.0},
        {-0.5: 9.0, -0.3: 10.0, -0.07: 8.0, 0.05: 13.0, 0.5: 11.0, 1.0: 9.0},
        {-0.6: 0.0, -0.3: 5.0, 0.03: -6.0, 0.4: -1.0, 1.0: 0.0},
    ),
)
PLACE_OF_KICK: tuple[Mapping[float, tuple[float, float]], ...] = (
    {
        -1.1: (0.0, -0.02),
        -0.8: (0.02, -0.02),
        -0.52: (-0.13, -0.09),
        -0.2: (-0.17, -0.125),
        0.0: (-0.13, -0.125),
        0.14: (-0.135, -0.125),
        0.4: (-0.15, -0.11),
        0.7: (-0.06, -0.04),
        1.05: (0.01, -0.02),
        1.5: (0.0, -0.02),
    },
    {
        -1.1: (-0.01, -0.03),
        -0.8: (-0.03, -0.035),
        -0.56: (0.145, 0.055),
        -0.2: (0.175, 0.085),
        0.0: (0.225, 0.085),
        0.14: (0.215, 0.085),
        0.43: (0.165, 0.075),
        0.7: (0.05, 0.01),
        1.05: (-0.012, -0.046),
        1.5: (0.01, -0.03),
    },
)
"""Over the leg that stays, and into the kick."""
PELVIS_OF_KICK: tuple[tuple[Keys, Keys, Keys], ...] = (
    (
        {-1.1: -33.0, -0.7: -30.0, -0.5: -26.0, -0.2: -18.0, 0.0: -26.0, 0.28: -20.0, 0.7: -30.0, 1.2: -33.0},
        {-1.0: 5.0, -0.75: 8.0, -0.45: 4.0, -0.2: 2.0, 0.0: 0.0, 0.6: 5.0, 1.5: 5.0},
        {-0.8: 0.0, -0.5: -3.0, -0.2: 5.0, 0.0: 7.0, 0.28: 3.0, 0.7: 0.0},
    ),
    (
        {-1.1: -33.0, -0.8: -40.0, -0.5: -22.0, -0.2: 2.0, 0.0: 20.0, 0.28: 8.0, 0.7: -26.0, 1.05: -36.0, 1.6: -31.0},
        {-1.0: 5.0, -0.75: 9.0, -0.45: 4.0, -0.2: 2.0, 0.0: 0.0, 0.6: 5.0, 1.5: 5.0},
        {-1.0: 0.0, -0.75: 2.0, -0.5: 4.0, -0.2: -5.0, 0.0: -8.0, 0.28: -3.0, 0.7: 2.0, 1.4: 0.0},
    ),
)
"""Yaw, pitch without the lean of the kick, and roll, with the leg in front and with that behind."""
CHEST_OF_KICK: tuple[tuple[Keys, Keys, Keys], ...] = (
    (
        {-1.1: -8.0, -0.5: -4.0, -0.2: 2.0, 0.03: 16.0, 0.33: 6.0, 0.8: -8.0},
        {-1.0: 9.0, -0.75: 13.0, -0.2: 13.0, 0.05: 9.0, 0.35: 13.0, 0.8: 9.0},
        {-0.9: 0.0, -0.5: 3.0, -0.2: -4.0, 0.03: -7.0, 0.3: -3.0, 0.9: 0.0},
    ),
    (
        {-1.1: -8.0, -0.75: -3.0, -0.5: -14.0, -0.2: -18.0, 0.03: -30.0, 0.33: -16.0, 0.7: 2.0, 1.1: -11.0, 1.6: -8.0},
        {-1.0: 9.0, -0.75: 13.0, -0.2: 13.0, 0.05: 9.0, 0.35: 13.0, 0.8: 9.0},
        {-0.9: 0.0, -0.5: -3.0, -0.2: 4.0, 0.03: 8.0, 0.3: 4.0, 0.8: -2.0, 1.5: 0.0},
    ),
)
OPENED, PIVOT = (24.0, 12.0), (46.0, -26.0)
"""Degrees: of the thigh at the hit by kicking side; of the foot that stays, in front and behind."""

STRIKES: Mapping[str, Punch | Kick] = {
    "jab_high": Punch(0, (0.80, 0.0, 1.46), seed=1),
    "jab_low_step": Punch(0, (0.98, -0.02, 1.08), step=0.24, sink=0.10, pace=1.15, seed=2),
    "cross_high_step": Punch(1, (1.08, 0.02, 1.48), step=0.22, pace=1.1, seed=3),
    "cross_low": Punch(1, (0.86, 0.02, 1.10), sink=0.10, pace=1.35, seed=4),
    "front_leg_low": Kick(0, 66.0, pace=0.9, seed=5),
    "front_leg_high": Kick(0, 100.0, seed=6),
    "rear_leg_low": Kick(1, 68.0, pace=0.9, seed=7),
    "rear_leg_high": Kick(1, 106.0, pace=1.1, seed=8),
    "jab_middle": Punch(0, (0.82, 0.0, 1.27), pace=0.95, seed=9),
    "jab_far_step": Punch(0, (1.09, -0.02, 1.36), step=0.36, sink=0.04, pace=1.25, seed=10),
    "cross_above": Punch(1, (0.78, 0.0, 1.66), pace=0.95, seed=11),
    "cross_middle_step": Punch(1, (1.02, 0.02, 1.27), step=0.18, sink=0.04, pace=1.15, seed=12),
    "front_leg_middle": Kick(0, 84.0, pace=0.95, seed=13),
    "rear_leg_middle": Kick(1, 88.0, seed=15),
}
"""By name; half of them are performed by each actor."""
SECOND_ACTOR = (
    *("jab_low_step", "cross_high_step", "front_leg_low", "rear_leg_high"),
    *("jab_middle", "cross_middle_step", "rear_leg_middle"),
)
"""Those of the small actor; the others are of the one of ``performer``."""
