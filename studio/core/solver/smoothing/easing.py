"""Where what was solved jolts it is eased in time: less exact for a moment, but smooth (METHOD (36) to (38)).

Every frame is solved from its own pose alone; a limb that changes sides, or a level that is given up, may so jump
between two frames. What nowhere jolts beyond what the motion itself and its moving targets bring is left as it is.
Elsewhere what constraints have changed is averaged over the frames around, level by level from the highest: each is
solved with what those above it have become. Then it is met again; where that jolts it is left as the average has it;
and where those above cannot be held so either, it is left for them altogether: priorities are strict before all is
smooth.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d, maximum_filter1d, minimum_filter1d

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.kernels import records
from studio.core.kernels.records import SMOOTHED_LEVEL, HigherLevelPoses
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.kernels.time.acceleration_peaks import ADDED_PEAK, TOTAL_PEAK, write_smoothed_peaks
from studio.core.kernels.time.smoothed_frames import SMOOTHING_VIOLATION
from studio.core.quality.metrics import QUIET
from studio.core.runs import runs_of
from studio.core.solver.smoothing.limb_charts import LimbCharts
from studio.core.solver.smoothing.root_reach import RootReach
from studio.core.solver.standing.blends import LOOK_AHEAD, hann_window
from studio.core.solver.standing.stand import Standing

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Run = Callable[[int, records.SmoothingRun], None]


class Ramp(NamedTuple):
    """Where something begins to be done, and where it is done wholly."""

    begins: FloatArray
    whole: FloatArray

    def share_of(self, values: FloatArray) -> FloatArray:
        """How far ``values`` are on it: from 0 on, to 1."""
        return np.asarray((values - self.begins) / (self.whole - self.begins))


class Posed(NamedTuple):
    """The unknowns of a clip: ``states`` (F, N, 3) of the search, and ``charts`` (F, 16, 3) of the limbs."""

    states: FloatArray
    charts: FloatArray


class Solved(NamedTuple):
    """All that a solve writes, frames first: places, turns, by how much each task is missed (F, C), and the pose that
    was cleared before, where anything is.
    """

    positions: FloatArray
    rotations: FloatArray
    misses: FloatArray
    cleared_positions: FloatArray
    cleared_rotations: FloatArray

    def put(self, other: "Solved") -> None:
        """Write another's values over these."""
        for mine, theirs in zip(self, other, strict=True):
            mine[:] = theirs

    def within(self, frames: slice) -> "Solved":
        """Those of some frames."""
        return Solved(*(each[frames] for each in self))


class Rank(NamedTuple):
    """Of a level: how many levels stand above it that are solved, and how many that keep clear do not."""

    solved: int
    clears: int


EASED = Ramp(np.array([ADDED_PEAK, ADDED_PEAK, TOTAL_PEAK]), np.array([1.8, 1.8, 2.6]))
"""Parts of the allowed peak at which what root and joints add, and what limbs turn with in all, is eased."""
DROPPED = Ramp(3.5 * EASED.begins, 3.5 * EASED.whole)
"""Parts of the allowed peak at which a level is dropped in favour of those above it, since even its average pops.

A level that is merely sharper than a calm source is kept: dropped, it missed its target for seconds by up to 0.8 m.
"""
WIDTHS = 0.06, 0.2, 0.35, 0.12
"""Seconds on either side over which one averaging after another goes, each where the one before did not suffice: so far
beside a jolt wholly, and fading as far again.
"""
BACK = 4
"""Times that a level is left for those above it where it changes them, ever further around."""
AROUND = 0.35
"""Seconds on either side of a jolt in which a level is left wholly as averaged, or for those above it; in as many again
that fades.
"""
CHANGED = Ramp(np.array(0.93 * SMOOTHING_VIOLATION), np.array(1.07 * SMOOTHING_VIOLATION))
"""Metres by which a level's easing may change those above it for it to be left for them."""
SEEN = 0.6
"""Seconds on either side of what jolts when solved in which anything may be eased; in as many again that ends."""
LOOKED = 2.0 * SEEN + 0.25
"""Seconds beside a frame that have to do with whether it is eased."""
LEGS = BodyPart.LEFT_THIGH, BodyPart.RIGHT_THIGH, BodyPart.LEFT_SHANK, BodyPart.RIGHT_SHANK
"""Segments as sharply as which root and trunk may move where a leg has a constraint: who kicks swings the pelvis."""


_NO_TURNS, _NO_MISSES, _NO_POSE = (
    np.empty((0, 16, 3, 3)),
    np.empty((0, 0)),
    HigherLevelPoses(np.empty((0, 0, 3)), np.empty((0, 0, 3, 3)), np.empty((0, 0, 3)), np.empty(0)),
)


@dataclass(eq=False)
class Solve:
    """What ``kernels.solve_clip.solve_frames`` notes of F frames, and is given to pose some of them anew.

    ``joints`` (N,) of the search, ``limbs`` (4,) that constraints are about, ``states`` (F, N, 3) of the search, and as
    in ``kernels.time.acceleration_peaks`` the ``sharp`` peaks (F, 3) and the ``peaks`` (3,) of the unsolved motion;
    ``changes`` (F,) is by how much easing changes what stands above.
    """

    layout: BodyLayout
    rate: float
    joints: NDArray[np.void]
    limbs: IntArray
    states: FloatArray
    peaks: FloatArray
    sharp: FloatArray
    changes: FloatArray
    held: int

    @staticmethod
    def of(
        standing: Standing,
        frames: int,
        joints: NDArray[np.void],
        moved: NDArray[np.bool_],
        limbs: IntArray,
        held: int,
    ) -> "Solve":
        """Of some ``frames``; which ``joints`` (N,) may be ``moved`` (N,); ``limbs`` (C, 2) of the constraints' ends,
        -1 none; the first ``held`` levels are contacts'.
        """
        named = set(limbs.ravel().tolist())
        named_limbs = np.array([0 in named, 1 in named, 2 in named, 3 in named], dtype=np.int64)
        layout, rate = standing.morphology.layout, standing.motion.frame_rate
        peaks, states = (
            own_peaks(standing, joints["segment"][moved], 2 in named or 3 in named),
            np.empty((frames, len(joints), 3)),
        )
        return Solve(layout, rate, joints, named_limbs, states, peaks, np.zeros((frames, 3)), np.zeros(frames), held)

    def easing(
        self,
        frames: IntArray,
        turns: FloatArray,
        rank: Rank,
        meets: bool,
        holds: bool,
        misses: FloatArray,
        above: HigherLevelPoses,
    ) -> records.SmoothingRun:
        """As ``kernels.time.smoothed_frames`` takes it."""
        noted = self.limbs, self.peaks[2:], np.array([self.rate]), self.sharp, self.changes
        eased = np.array([(rank.solved, meets, self.held, holds, rank.clears)], dtype=SMOOTHED_LEVEL)
        return records.SmoothingRun(frames, self.states, turns, eased, misses, above, *noted)

    def within(self, frames: slice) -> "Solve":
        """What it noted of some frames."""
        arrays = {name: getattr(self, name)[frames].copy() for name in ("states", "sharp", "changes")}
        return replace(self, **arrays)

    @property
    def noting(self) -> records.SmoothingRun:
        """For a first run over all frames."""
        return self.easing(np.arange(len(self.states)), _NO_TURNS, Rank(0, 0), False, False, _NO_MISSES, _NO_POSE)

    def jolts(self, allowed: FloatArray) -> bool:
        """Whether anything turns more sharply than what is ``allowed``, (3,) or (F, 3), radians a second squared."""
        return bool((self.sharp > EASED.begins * allowed).any())

    def jolts_of(self, states: FloatArray, turns: FloatArray) -> FloatArray:
        """(F, 3) of the root, of other joints of the search by their states, and of turns (F, 16, 3, 3) of the limbs.

        As ``kernels.time.acceleration_peaks`` has them, radians a second squared.
        """
        sharp = np.zeros((len(turns), 3))
        write_smoothed_peaks(self.joints, states, self.limbs, turns, self.rate, sharp)
        return sharp


def own_peaks(standing: Standing, searched: IntArray, legs_asked: bool) -> FloatArray:
    """(3,) what ``Solve.jolts_of`` tells at most of the unsolved motion, of a search that turns
    segments ``searched`` (n,).

    Legs count where a constraint is about them; root and searched joints then have at least what legs have.
    """
    layout = standing.morphology.layout
    peaks = standing.peaks if legs_asked else standing.peaks[: layout.spine_count + 10]
    joints = peaks[searched[(searched != ROOT_TRANSLATION) & (searched < len(peaks))]]
    leg = max(QUIET, *(peaks[layout.segment(part)] for part in LEGS)) if legs_asked else QUIET
    most = peaks.max(initial=QUIET)
    return np.array([min(max(leg, standing.root_peak), most), joints.max(initial=leg), most])


@dataclass(frozen=True, eq=False)
class Level:
    """A level of priority with those above it: what is noted of their solve and what was ``solved``, which constraints
    stand ``above`` it (C,), its ``rank``, where any ``acts`` (F,) and any of its ``own`` does, and what peaks of
    angular acceleration they are allowed (F, 3), radians a second squared.
    """

    solve: Solve
    solved: Solved
    above: NDArray[np.bool_]
    rank: Rank
    acts: NDArray[np.bool_]
    own: NDArray[np.bool_]
    allowed: FloatArray

    def within(self, frames: slice) -> "Level":
        """The same of some frames."""
        solved = self.solved.within(frames)
        solve, acts, own = self.solve.within(frames), self.acts[frames], self.own[frames]
        return replace(self, solve=solve, solved=solved, acts=acts, own=own, allowed=self.allowed[frames])

    @property
    def room(self) -> FloatArray:
        """(F,) how far it may be eased, from 0 to 1: near jolts of what is solved, where it acts but for its ends."""
        rate, sharp = self.solve.rate, self.solve.sharp / self.allowed
        acting = minimum_filter1d(self.acts.astype(np.float64), 3, mode="nearest")
        return _mean(acting, 1) * _around(_excess(sharp), rate, SEEN)


class Easing:
    """Eases level after level, each with what those above it have become."""

    def __init__(
        self,
        levels: Sequence[Level],
        pose: Run,
        solved: Solved,
        charts: LimbCharts,
        root_reach: RootReach,
        rooms: FloatArray,
    ) -> None:
        """``pose`` some frames anew with the constraints down to a level, into ``solved``, which is as
        ``Level.solved``; ``rooms`` (L, F) of all levels.
        """
        self._levels, self._pose, self._solved, self._rooms = levels, pose, solved, rooms
        self._charts, self._root_reach = charts, root_reach
        self._runs = [runs_of(room > 0.0) for room in rooms]
        frames, joints, _ = levels[0].solve.states.shape
        values = charts.unturned
        self._eased = Posed(np.zeros((frames, joints, 3)), values)
        self._moved = Posed(np.zeros((frames, joints, 3)), np.zeros_like(values))
        self._told = levels[0].solved.misses
        self._touched, self._jolts = np.zeros(frames), np.zeros((frames, 3))
        first = levels[0].solved
        self._kept = HigherLevelPoses(
            first.positions.copy(), first.rotations.copy(), self._eased.states, np.zeros(frames)
        )

    def ease(self) -> None:
        """Ease all levels but those of contacts."""
        now = self._solved
        for number, level in enumerate(self._levels):
            if number > 0 and not level.own.any():
                continue
            self._told = np.where(level.above, self._told, level.solved.misses)
            now.put(level.solved)
            if number >= level.solve.held:
                self._ease_level(number)
            else:
                self._eased = Posed(level.solve.states.copy(), self._posed_limbs())
            self._told = np.where(level.above, self._told, now.misses)
            states, back = self._eased.states.copy(), np.zeros(len(now.positions))
            self._kept = HigherLevelPoses(now.positions.copy(), now.rotations.copy(), states, back)

    def _ease_level(self, number: int) -> None:
        """Meet it again from its average; where that jolts leave it as averaged, or else for those above it."""
        level, room = self._levels[number], self._rooms[number]
        solved = Posed(level.solve.states.copy(), self._posed_limbs())
        smooth = self._smoothed(number, solved)
        now, bump = solved, np.sign(self._touched * room)
        for meets in (True, False):
            now = self._posed_anew(number, now, smooth, bump, meets)
            bump = self._to_ease(number, now)
        if number > 0:
            now = self._left(number, now)
        self._jolts = level.solve.jolts_of(now.states, self._charts.turns(now.charts))
        self._eased, self._moved = now, Posed(now.states - solved.states, now.charts - solved.charts)

    def _left(self, number: int, posed: Posed) -> Posed:
        """Drop the level where what is ``posed`` pops or changes the levels above: pose it as they have become."""
        now, back = posed, np.zeros(len(posed.states))
        for last in [False] * (BACK - 1) + [True]:
            bump = self._to_ease(number, now, DROPPED)
            if not bump.any():
                break
            back = np.maximum(back, bump)
            self._kept.return_fractions[:] = np.round(back, 9)
            now = self._posed_anew(number, posed, self._eased, self._kept.return_fractions, False, last)
        return now

    def _to_ease(self, number: int, now: Posed, limits: Ramp = EASED) -> FloatArray:
        """Share (F,) of each frame to be smoothed or dropped, for peaks over ``limits`` or changes of levels above."""
        changed = self._spread(number, CHANGED.share_of(self._levels[number].solve.changes), AROUND)
        peaks = self._bump(number, now, AROUND, limits)
        return np.asarray(np.maximum(peaks, changed) * (self._rooms[number] > 0.0))

    def _posed_anew(
        self, number: int, first: Posed, second: Posed, share: FloatArray, meets: bool, holds: bool = False
    ) -> Posed:
        """Pose between two by a ``share`` (F,) anew where there is any."""
        level, frames = self._levels[number], np.flatnonzero(share > 0.0)
        level.solve.changes[:] = 0.0
        if not len(frames):
            return first
        level.solve.states[:] = _blend(first.states, second.states, share)
        turns = self._charts.turns(_blend(first.charts, second.charts, share))
        told = np.ascontiguousarray(self._told.T)  # kernels are compiled for no other
        self._pose(number, level.solve.easing(frames, turns, level.rank, meets, holds, told, self._kept))
        return Posed(level.solve.states.copy(), self._posed_limbs(first.charts))

    def _spread(self, number: int, share: FloatArray, seconds: float) -> FloatArray:
        """``_around`` within each run of frames that has room: which there are below must not join others."""
        spread = np.zeros(len(share))
        if (share > 0.0).any():
            for first, past in self._runs[number]:
                spread[first:past] = _around(share[first:past], self._levels[number].solve.rate, seconds)
        return spread

    def _posed_limbs(self, beside: FloatArray | None = None) -> FloatArray:
        """Charted limbs as they are."""
        return self._charts.values(self._charts.turns_of(self._solved.rotations), beside)

    def _smoothed(self, number: int, solved: Posed) -> Posed:
        """What a level has changed, averaged in time where it jolts."""
        level, room = self._levels[number], self._rooms[number]
        states, values = solved.states + self._moved.states, solved.charts + self._moved.charts
        for moved in self._moved:
            self._touched = np.maximum(self._touched, moved.reshape(len(moved), -1).any(axis=1))
        for seconds in WIDTHS:
            width = max(round(seconds * level.solve.rate), 1)
            bump = room * self._bump(number, Posed(states, values), seconds)
            if not bump.any():
                break
            self._touched = np.maximum(self._touched, bump)
            states, values = _blend(states, _mean(states, width), bump), _blend(values, _mean(values, width), bump)
            values = self._charts.within(values)
        joints = level.solve.joints
        back = self._root_reach.pulled(states, joints, round(LOOK_AHEAD * level.solve.rate)) * (room > 0.0)[:, None]
        self._touched = np.maximum(self._touched, back.any(axis=1))
        states[:, joints["segment"] == ROOT_TRANSLATION] += back[:, None]
        return Posed(states, values)

    def _bump(self, number: int, poses: Posed, around: float, limits: Ramp = EASED) -> FloatArray:
        """(F,) how far frames of ``poses`` are to be eased, from 0 to 1, for their jolts.

        ``around`` seconds on either side of a jolt are eased wholly, and as many again fade. What those above have
        become is no fault of a level.
        """
        level = self._levels[number]
        allowed = np.maximum(level.allowed, self._jolts / EASED.begins)
        sharp = level.solve.jolts_of(poses.states, self._charts.turns(poses.charts)) / allowed
        return self._spread(number, _excess(sharp, limits), around)


def _excess(sharp: FloatArray, limits: Ramp = EASED) -> FloatArray:
    """Position (F,) on ``limits`` of the worst acceleration peaks (F, 3), in parts of the allowed peak."""
    return np.asarray(limits.share_of(sharp).max(axis=1))


def _around(share: FloatArray, rate: float, seconds: float) -> FloatArray:
    """(F,) the greatest ``share`` (F,) within some seconds, from 0 to 1, faded over as many."""
    near = max(round(seconds * rate), 1)
    return _mean(maximum_filter1d(np.clip(share, 0.0, 1.0), 2 * near + 1, mode="constant"), near)


def _blend(first: FloatArray, second: FloatArray, share: FloatArray) -> FloatArray:
    """From ``first`` to ``second`` (F, ...), by ``share`` (F,)."""
    return np.asarray(first + share.reshape(-1, *[1] * (second.ndim - 1)) * (second - first))


def _mean(values: FloatArray, width: int) -> FloatArray:
    """Means of ``values`` (F, ...) over ``width`` frames on either side, by Hann's window."""
    return np.asarray(convolve1d(values, hann_window(width), axis=0, mode="nearest"))
