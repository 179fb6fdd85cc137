"""Where what was solved jolts it is eased in time: less exact for a moment, but smooth (METHOD (36) to (38)).

Every frame is solved from its own pose alone; a limb that changes sides, or a level that is given up, may so jump
between two frames. What nowhere jolts beyond what the motion itself and its moving wishes bring is left as it is.
Elsewhere what constraints have changed is averaged over the frames around, level by level from the highest: each is
solved with what those above it have become. Then it is met again; where that jolts it is left as the average has it;
and where those above cannot be held so either, it is left for them altogether.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d, maximum_filter1d, minimum_filter1d

from studio.core.canonical import BodyLayout
from studio.core.kernels.joints import ROOT
from studio.core.kernels.jolts import ADDED, WHOLE, note_eased_jolts
from studio.core.metrics import QUIET
from studio.core.solver.limb_charts import LimbCharts
from studio.core.solver.root_leash import RootLeash

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Pose = tuple[FloatArray, FloatArray]
EasingArrays = tuple[object, ...]
Run = Callable[[int, EasingArrays], None]

EASED = np.array([[ADDED, ADDED, WHOLE], [1.8, 1.8, 2.6]])
"""Parts of the allowed peak at which what root and joints add, and what limbs turn with in all, begins to be eased, and
is."""
LEFT = np.array([[5.0, 1.6, 2.4], [6.0, 2.2, 2.9]])
"""The same at which a level is left altogether for those above it: a root that starts at once is the lesser evil."""
WIDTHS = 0.06, 0.12, 0.2, 0.35, 0.12
"""Seconds on either side over which one averaging after another goes, each where the one before did not suffice."""
AROUND = 0.2
"""Seconds on either side of a jolt that are averaged wholly, at most; as many again fade."""
MENDED, FALLING = 0.1, 0.35
"""The same where a level is left as averaged, and where that does not suffice or it is left for those above it."""
PULLED = 0.15
"""Seconds on either side over which planted feet pull the root."""
LOST = 1e-4, 4e-4
"""Metres that those above a level may lose by its easing for it to be left for them, beginning and wholly."""
SEEN = 0.8
"""Seconds on either side of what jolts when solved in which anything may be eased; in as many again that ends."""
LOOKED = 2.0 * SEEN + 0.25
"""Seconds beside a frame that have to do with whether it is eased."""
BESIDE = 0.1
"""Seconds beside where nothing acts in which nothing is eased, and again in which that begins."""


_NO_TURNS, _NO_MISSES, _NO_POSE = (
    np.empty((0, 16, 3, 3)),
    np.empty((0, 0)),
    (np.empty((0, 0, 3)), np.empty((0, 0, 3, 3))),
)


def reach_of(levels: int) -> float:
    """Seconds on either side of a frame that may have to do with how it is eased."""
    averaging = sum(width + 2.0 * min(width, AROUND) for width in WIDTHS)
    return 2.0 * SEEN + levels * (averaging + 2.0 * 5.0 * FALLING)


@dataclass(eq=False)
class Solve:
    """What ``kernels.adapt.solve_frames`` notes of a stretch of F frames, and is given to pose some of them anew.

    ``joints`` (N, 5) of the search, ``limbs`` (4,) that constraints are about, ``carriers`` of every segment that
    counts as source (legs only where constraints are about them), ``states`` (F, N, 3) of the search, and as in
    ``kernels.jolts`` the peak of the ``source`` (1,) as far as it is known and the ``sharp`` jolts (F, 3).
    """

    layout: BodyLayout
    rate: float
    joints: IntArray
    limbs: IntArray
    carriers: IntArray
    states: FloatArray
    source: FloatArray
    sharp: FloatArray
    held: int

    @staticmethod
    def of(layout: BodyLayout, rate: float, frames: int, joints: IntArray, limbs: IntArray, held: int) -> "Solve":
        """``limbs`` (C, 2) of the constraints' ends, -1 none; the first ``held`` levels are contacts'."""
        named = set(limbs.ravel().tolist())
        wished = np.array([0 in named, 1 in named, 2 in named, 3 in named], dtype=np.int64)
        carriers, states = _carriers(layout, 2 in named or 3 in named), np.empty((frames, len(joints), 3))
        return Solve(layout, rate, joints, wished, carriers, states, np.array([QUIET]), np.zeros((frames, 3)), held)

    def easing(
        self, frames: IntArray, turns: FloatArray, level: int, meets: bool, misses: FloatArray, kept: Pose
    ) -> EasingArrays:
        """As ``kernels.easing`` takes it."""
        noted = self.limbs, self.carriers, self.source, np.array([self.rate]), self.sharp
        return frames, self.states, turns, np.array([level, meets, self.held]), misses, kept, *noted

    @property
    def noting(self) -> EasingArrays:
        """For a first run over all frames."""
        return self.easing(np.arange(len(self.states)), _NO_TURNS, 0, False, _NO_MISSES, _NO_POSE)

    @property
    def jolts(self) -> bool:
        """Whether any frame has to be looked at closer."""
        return bool(np.count_nonzero(self.sharp > EASED[0] * self.source))

    def jolts_of(self, states: FloatArray, turns: FloatArray) -> FloatArray:
        """(F, 3) of the root, of other joints of the search by their states, and of turns (F, 16, 3, 3) of the limbs.

        As ``kernels.jolts`` has them, radians a second squared.
        """
        sharp = np.zeros((len(turns), 3))
        note_eased_jolts(self.joints, states, self.limbs, turns, self.rate, sharp)
        return sharp


@cache
def _carriers(layout: BodyLayout, with_legs: bool) -> IntArray:
    carriers = np.array(layout.parent_segments())
    return carriers if with_legs else carriers[: layout.spine_count + 10]


@dataclass(frozen=True, eq=False)
class Level:
    """A level of priority with those above it: what is noted of their solve, where they act (F,), and what peak of
    angular acceleration they are allowed (F,), radians a second squared.
    """

    solve: Solve
    acts: NDArray[np.bool_]
    allowed: FloatArray

    @property
    def room(self) -> FloatArray:
        """(F,) how far it may be eased, from 0 to 1: near jolts of what is solved, and where it acts."""
        rate, sharp = self.solve.rate, self.solve.sharp / self.allowed[:, None]
        beside = max(round(BESIDE * rate), 1)
        acting = minimum_filter1d(self.acts.astype(np.float64), 2 * beside + 1, mode="nearest")
        return _mean(acting, beside) * _around(_excess(sharp, EASED), rate, SEEN)


class Easing:
    """Eases level after level, each with what those above it have become."""

    def __init__(
        self,
        levels: Sequence[Level],
        solve: Run,
        pose: Run,
        motion: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
        misses: FloatArray,
        limits: NDArray[np.void],
        leash: RootLeash,
        room: FloatArray,
    ) -> None:
        """``solve`` all frames of ``motion`` (unsolved and solved positions and rotations) with the constraints down to
        a level, and ``pose`` some anew; both note their ``misses`` (C, F). Down to the last all is solved already.
        ``limits`` of ``kernels.joint_limits``; ``room`` (F,) of the last level, which some of the clip may have.
        """
        self._levels, self._solve, self._pose, self._motion, self._misses = levels, solve, pose, motion, misses
        self._leash, self._room, self._last = leash, np.zeros(len(room)), room
        self._charts = LimbCharts(levels[0].solve.layout, motion[1], limits, levels[-1].solve.limbs)
        unsolved = self._charts.values(self._charts.turns_of(motion[1]))
        self._eased: Pose = np.zeros_like(levels[0].solve.states), unsolved
        self._moved: Pose = np.zeros_like(self._eased[0]), np.zeros_like(unsolved)
        self._touched, self._jolts = np.zeros(len(unsolved)), np.zeros((len(unsolved), 3))

    def ease(self) -> None:
        """Ease all levels but those of contacts."""
        kept = self._motion[0].copy(), self._motion[1].copy()
        noted = *self._motion[2:], self._misses
        whole = [each.copy() for each in noted]
        for number, level in enumerate(self._levels):
            if number < len(self._levels) - 1:
                self._solve(number, level.solve.noting)
                self._room = level.room
            else:
                self._room = self._last
                for each, before in zip(noted, whole, strict=True):
                    each[:] = before
            if number >= level.solve.held:
                self._ease_level(number, kept)
            else:
                self._eased = self._solved(number)
            kept = self._motion[2].copy(), self._motion[3].copy()

    def _ease_level(self, number: int, kept: Pose) -> None:
        """``kept`` is what those above the level have become."""
        level, misses, solved = self._levels[number], self._misses.copy(), self._solved(number)
        room, rate = self._room, level.solve.rate
        smooth = self._smoothed(level, solved)
        ways = [(smooth, True, MENDED, EASED), (smooth, False, FALLING, EASED), (smooth, False, FALLING, LEFT)]
        if number > 0:
            left = _blend(solved[0], self._eased[0], room), _blend(solved[1], self._eased[1], room)
            ways += 3 * [(left, False, FALLING, LEFT)]
        now, bump = solved, np.sign(self._touched * room)
        for goal, meets, around, parts in ways:
            frames = np.flatnonzero(bump > 0.0)
            if not len(frames):
                break
            level.solve.states[:] = _blend(now[0], goal[0], bump)
            turns = self._charts.turns(_blend(now[1], goal[1], bump))
            level.solve.sharp[:] = 0.0
            self._pose(number, level.solve.easing(frames, turns, number, meets, misses, kept))
            now = self._solved(number, now[1])
            lost = (level.solve.sharp[:, 0] - LOST[0]) / (LOST[1] - LOST[0])
            bump = np.maximum(self._bump(level, now, around, parts), _around(lost, rate, FALLING)) * (room > 0.0)
        self._jolts = level.solve.jolts_of(now[0], self._charts.turns(now[1]))
        self._eased, self._moved = now, (now[0] - solved[0], now[1] - solved[1])

    def _solved(self, number: int, beside: FloatArray | None = None) -> Pose:
        """States and charted limbs as they are."""
        turns = self._charts.turns_of(self._motion[3])
        return self._levels[number].solve.states.copy(), self._charts.values(turns, beside)

    def _smoothed(self, level: Level, solved: Pose) -> Pose:
        """What a level has changed, averaged in time where it jolts."""
        states, values = (now + (self._room * moved.T).T for now, moved in zip(solved, self._moved, strict=True))
        for seconds in WIDTHS:
            width = max(round(seconds * level.solve.rate), 1)
            bump = self._room * self._bump(level, (states, values), min(seconds, AROUND))
            if not bump.any():
                break
            self._touched = np.maximum(self._touched, bump)
            states, values = _blend(states, _mean(states, width), bump), _blend(values, _mean(values, width), bump)
            values = self._charts.within(values)
        joints = level.solve.joints
        back = self._leash.pulled(states, joints, round(PULLED * level.solve.rate)) * (self._room > 0.0)[:, None]
        self._touched = np.maximum(self._touched, back.any(axis=1))
        states[:, joints[:, 0] == ROOT] += back[:, None]
        return states, values

    def _bump(self, level: Level, poses: Pose, around: float, parts: FloatArray = EASED) -> FloatArray:
        """(F,) how far frames of ``poses`` are to be eased, from 0 to 1, for their jolts.

        ``around`` seconds on either side of a jolt are eased wholly, and as many again fade; ``parts`` of what is
        allowed (2, 3), where that begins and where it is whole. What those above have become is no fault of a level.
        """
        allowed = np.maximum(level.allowed[:, None], self._jolts / parts[0])
        sharp = level.solve.jolts_of(poses[0], self._charts.turns(poses[1])) / allowed
        return _around(_excess(sharp, parts), level.solve.rate, around)


def _excess(sharp: FloatArray, parts: FloatArray) -> FloatArray:
    """(F,) where jolts (F, 3), in parts of what is allowed, are between both ``parts`` (2, 3): from 0 on, to 1."""
    return np.asarray(((sharp - parts[0]) / (parts[1] - parts[0])).max(axis=1))


def _around(share: FloatArray, rate: float, seconds: float) -> FloatArray:
    """(F,) the greatest ``share`` (F,) within some seconds, from 0 to 1, faded over as many."""
    near = max(round(seconds * rate), 1)
    return _mean(maximum_filter1d(np.clip(share, 0.0, 1.0), 2 * near + 1, mode="constant"), near)


def _blend(first: FloatArray, second: FloatArray, share: FloatArray) -> FloatArray:
    """From ``first`` to ``second`` (F, ...), by ``share`` (F,)."""
    return np.asarray(first + share.reshape(-1, *[1] * (second.ndim - 1)) * (second - first))


def _mean(values: FloatArray, width: int) -> FloatArray:
    """Means of ``values`` (F, ...) over ``width`` frames on either side, by Hann's window."""
    window = np.hanning(2 * width + 3)[1:-1]
    return np.asarray(convolve1d(values, window / window.sum(), axis=0, mode="nearest"))
