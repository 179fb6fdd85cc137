"""Smoothing of solved frames at acceleration peaks (METHOD (36) to (38)).

Every frame is solved from its own pose alone, so a limb that changes sides, or a level that is dropped, may jump
between two frames. Frames without a peak beyond those of the motion and its moving targets are unchanged. Elsewhere the
displacements by the constraints are averaged over the frames around, level by level from the highest, each on the final
poses of the levels above. Then the level is solved again; if that has peaks the average is kept; and if the levels
above are violated, it is dropped for them: strict priorities come before smoothness.
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
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.runs import runs_of
from studio.core.solver.smoothing.limb_coordinates import LimbCoordinates
from studio.core.solver.smoothing.root_reach import RootReach
from studio.core.solver.standing.blends import LOOK_AHEAD, hann_window
from studio.core.solver.standing.stand import GroundedMotion

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Run = Callable[[int, records.SmoothingRun], None]


class Ramp(NamedTuple):
    """Linear ramp of a weight from 0 to 1."""

    begin: FloatArray
    whole: FloatArray

    def share_of(self, values: FloatArray) -> FloatArray:
        """Position of ``values`` on the ramp: 0 at its beginning, 1 at its end."""
        return np.asarray((values - self.begin) / (self.whole - self.begin))


class SmoothedPose(NamedTuple):
    """Unknowns of a clip: ``states`` (F, N, 3) of the search, and ``charts`` (F, 16, 3) of the limbs' coordinates."""

    states: FloatArray
    charts: FloatArray


class SolvedArrays(NamedTuple):
    """Arrays written by a solve, frames first: positions, rotations, residuals (F, C), and the cleared unsolved poses,
    if any.
    """

    positions: FloatArray
    rotations: FloatArray
    residuals: FloatArray
    cleared_positions: FloatArray
    cleared_rotations: FloatArray

    def copy_from(self, other: "SolvedArrays") -> None:
        """Copy the values of another solve."""
        for mine, theirs in zip(self, other, strict=True):
            mine[:] = theirs

    def in_frames(self, frames: slice) -> "SolvedArrays":
        """Copy for some frames."""
        return SolvedArrays(*(each[frames] for each in self))


class LevelNumbers(NamedTuple):
    """Counts for a level: solved levels above it, and self-collision constraints not above it."""

    solved: int
    clears: int


SMOOTHING_RANGE = Ramp(np.array([ADDED_PEAK, ADDED_PEAK, TOTAL_PEAK]), np.array([1.8, 1.8, 2.6]))
"""Fractions of the allowed peak over which the smoothing of root, joints and limbs fades in."""
DROPPING_RANGE = Ramp(3.5 * SMOOTHING_RANGE.begin, 3.5 * SMOOTHING_RANGE.whole)
"""Fractions of the allowed peak over which a level is dropped for those above it, since even its average pops.

A level that is merely sharper than a calm source is kept: dropped, its residual was up to 0.8 m for seconds.
"""
SMOOTHING_WIDTHS = 0.06, 0.2, 0.35, 0.12
"""Seconds on either side of successive averages, each used where the one before did not suffice; full within that
distance of a peak, and fading over as much again.
"""
DROPPING_ROUNDS = 4
"""Rounds of dropping a level where it violates those above it, with growing margins."""
SMOOTHING_MARGIN = 0.35
"""Seconds on either side of a peak in which a level stays averaged, or is dropped, completely; it fades over as much
again.
"""
VIOLATION_RANGE = Ramp(np.array(0.93 * SMOOTHING_VIOLATION), np.array(1.07 * SMOOTHING_VIOLATION))
"""Priority violation of a smoothed level, in metres, over which it is dropped."""
SMOOTHING_REACH = 0.6
"""Seconds on either side of a solved peak in which frames may be smoothed; it fades over as much again."""
SMOOTHING_HORIZON = 2.0 * SMOOTHING_REACH + 0.25
"""Seconds on either side of a frame that affect its smoothing."""
LEG_BONES = BodyPart.LEFT_THIGH, BodyPart.RIGHT_THIGH, BodyPart.LEFT_SHANK, BodyPart.RIGHT_SHANK
"""Segments whose peaks allow root and trunk as much where a leg has a constraint: a kick swings the pelvis."""


_NO_ROTATIONS, _NO_RESIDUALS, _NO_POSE = (
    np.empty((0, 16, 3, 3)),
    np.empty((0, 0)),
    HigherLevelPoses(np.empty((0, 0, 3)), np.empty((0, 0, 3, 3)), np.empty((0, 0, 3)), np.empty(0)),
)


@dataclass(eq=False)
class SolveNotes:
    """Notes of ``kernels.solve_clip.solve_frames`` on F frames, and its input to pose some of them again.

    ``joints`` (N,) of the search, ``limbs`` (4,) with constraints, ``states`` (F, N, 3) of the search, ``sharp``
    (F, N + 1) the acceleration peaks and ``peaks`` (N + 1,) those of the unsolved motion
    (``kernels.time.acceleration_peaks``); ``changes`` (F,) priority violations of the smoothing.
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
        standing: GroundedMotion,
        frames: int,
        joints: NDArray[np.void],
        limbs: IntArray,
        held: int,
    ) -> "SolveNotes":
        """Notes for some ``frames`` with ``joints`` (N,) and ``limbs`` (C, 2) of the constraints' ends, -1 none; the
        first ``held`` levels are contacts.
        """
        named = set(limbs.ravel().tolist())
        named_limbs = np.array([0 in named, 1 in named, 2 in named, 3 in named], dtype=np.int64)
        layout, rate = standing.morphology.layout, standing.motion.frame_rate
        peaks, states = (
            own_peaks(standing, joints["segment"], 2 in named or 3 in named),
            np.empty((frames, len(joints), 3)),
        )
        return SolveNotes(
            layout, rate, joints, named_limbs, states, peaks, np.zeros((frames, len(peaks))), np.zeros(frames), held
        )

    def easing(
        self,
        frames: IntArray,
        rotation_matrices: FloatArray,
        rank: LevelNumbers,
        meets: bool,
        holds: bool,
        misses: FloatArray,
        above: HigherLevelPoses,
    ) -> records.SmoothingRun:
        """Record for ``kernels.time.smoothed_frames``."""
        noted = self.limbs, self.peaks[-1:], np.array([self.rate]), self.sharp, self.changes
        eased = np.array([(rank.solved, meets, self.held, holds, rank.clears)], dtype=SMOOTHED_LEVEL)
        return records.SmoothingRun(frames, self.states, rotation_matrices, eased, misses, above, *noted)

    def in_frames(self, frames: slice) -> "SolveNotes":
        """Notes of some frames."""
        arrays = {name: getattr(self, name)[frames].copy() for name in ("states", "sharp", "changes")}
        return replace(self, **arrays)

    @property
    def noting(self) -> records.SmoothingRun:
        """Record for a first solve of all frames."""
        return self.easing(
            np.arange(len(self.states)), _NO_ROTATIONS, LevelNumbers(0, 0), False, False, _NO_RESIDUALS, _NO_POSE
        )

    def exceeds_peaks(self, allowed: FloatArray) -> bool:
        """True if any peak exceeds the ``allowed`` one, (N + 1,) or (F, N + 1), rad/s2."""
        return bool((self.ratios(self.sharp, allowed) > SMOOTHING_RANGE.begin).any())

    def ratios(self, sharp: FloatArray, allowed: FloatArray) -> FloatArray:
        """Greatest peaks (F, 3) of root, other joints of the search, and limbs, beside their ``allowed`` ones."""
        each, is_root = sharp / allowed, self.joints["segment"] == ROOT_TRANSLATION
        root, others = (each[:, :-1][:, mask].max(axis=1, initial=0.0) for mask in (is_root, ~is_root))
        return np.stack([root, others, each[:, -1]], axis=1)

    def peaks_of(self, states: FloatArray, rotation_matrices: FloatArray) -> FloatArray:
        """Peaks (F, N + 1) in rad/s2 of the joints of the search, and of limbs with these rotations (F, 16, 3, 3)."""
        sharp = np.zeros((len(rotation_matrices), len(self.peaks)))
        write_smoothed_peaks(self.joints, states, self.limbs, rotation_matrices, self.rate, sharp)
        return sharp


def own_peaks(standing: GroundedMotion, searched: IntArray, legs_asked: bool) -> FloatArray:
    """Peaks (N + 1,) of the unsolved motion as in ``SolveNotes.peaks_of``, for a search of segments ``searched`` (N,).

    Legs count where they have a constraint; root and searched joints are then allowed at least the legs' peaks.
    """
    layout, all_peaks = standing.morphology.layout, standing.peak_angular_accelerations
    peaks = all_peaks if legs_asked else all_peaks[: layout.thigh_segment(0)]
    leg = max(QUIET_PEAK, *(peaks[layout.segment_of_part(part)] for part in LEG_BONES)) if legs_asked else QUIET_PEAK
    most, is_root = peaks.max(initial=QUIET_PEAK), searched == ROOT_TRANSLATION
    joints = np.maximum(all_peaks[np.where(is_root, 0, searched)], leg)
    joints[is_root] = min(max(leg, standing.root_peak), most)
    return np.append(joints, most)


@dataclass(frozen=True, eq=False)
class SolvedLevel:
    """A level solved with those above it: notes and arrays of its solve, the constraints ``above`` it (C,), its numbers
    ``rank``, frames with active constraints (``acts``, and ``own`` of this level) (F,), and allowed peaks (F, N + 1)
    in rad/s2.
    """

    solve: SolveNotes
    solved: SolvedArrays
    above: NDArray[np.bool_]
    rank: LevelNumbers
    acts: NDArray[np.bool_]
    own: NDArray[np.bool_]
    allowed: FloatArray

    def in_frames(self, frames: slice) -> "SolvedLevel":
        """Copy for some frames."""
        solved = self.solved.in_frames(frames)
        solve, acts, own = self.solve.in_frames(frames), self.acts[frames], self.own[frames]
        return replace(self, solve=solve, solved=solved, acts=acts, own=own, allowed=self.allowed[frames])

    @property
    def near_peaks(self) -> FloatArray:
        """Closeness (F,) to peaks of the level's solve: 1 near them, fading to 0."""
        return _spread_peaks(
            _excess(self.solve.ratios(self.solve.sharp, self.allowed)), self.solve.rate, SMOOTHING_REACH
        )

    @property
    def within_activity(self) -> FloatArray:
        """Weights (F,): 1 where constraints of this level or above are active, fading over the frames at the ends."""
        return _mean(minimum_filter1d(self.acts.astype(np.float64), 3, mode="nearest"), 1)


class LevelSmoother:
    """Smooths level after level, each on the final poses of the levels above."""

    def __init__(
        self,
        levels: Sequence[SolvedLevel],
        pose: Run,
        solved: SolvedArrays,
        charts: LimbCoordinates,
        root_reach: RootReach,
        rooms: FloatArray,
    ) -> None:
        """``pose`` poses frames again with the constraints down to a level, into ``solved``; ``rooms`` (L, F) are the
        smoothing weights of all levels.
        """
        self._levels, self._pose, self._solved, self._rooms = levels, pose, solved, rooms
        self._charts, self._root_reach = charts, root_reach
        self._runs = [runs_of(margin > 0.0) for margin in rooms]
        frames, joints, _ = levels[0].solve.states.shape
        values = charts.unsolved_coordinates
        self._eased = SmoothedPose(np.zeros((frames, joints, 3)), values)
        self._moved = SmoothedPose(np.zeros((frames, joints, 3)), np.zeros_like(values))
        self._told = levels[0].solved.residuals
        self._touched, self._jolts = np.zeros(frames), np.zeros((frames, joints + 1))
        first = levels[0].solved
        self._kept = HigherLevelPoses(
            first.positions.copy(), first.rotations.copy(), self._eased.states, np.zeros(frames)
        )

    def smooth_levels(self) -> None:
        """Smooth all levels but those of contacts."""
        now = self._solved
        for number, level in enumerate(self._levels):
            if number > 0 and not level.own.any():
                continue
            self._told = np.where(level.above, self._told, level.solved.residuals)
            now.copy_from(level.solved)
            if number >= level.solve.held:
                self._ease_level(number)
            else:
                self._eased = SmoothedPose(level.solve.states.copy(), self._posed_limbs())
            self._told = np.where(level.above, self._told, now.residuals)
            states, back = self._eased.states.copy(), np.zeros(len(now.positions))
            self._kept = HigherLevelPoses(now.positions.copy(), now.rotations.copy(), states, back)

    def _ease_level(self, number: int) -> None:
        """Solve a level again from its average; where that has peaks keep the average, or drop the level."""
        level, margin = self._levels[number], self._rooms[number]
        solved = SmoothedPose(level.solve.states.copy(), self._posed_limbs())
        smooth = self._smoothed(number, solved)
        now, bump = solved, np.sign(self._touched * margin)
        for meets in (True, False):
            now = self._posed_anew(number, now, smooth, bump, meets)
            bump = self._to_ease(number, now)
        if number > 0:
            now = self._left(number, now)
        self._jolts = level.solve.peaks_of(now.states, self._charts.rotations(now.charts))
        self._eased, self._moved = now, SmoothedPose(now.states - solved.states, now.charts - solved.charts)

    def _left(self, number: int, posed: SmoothedPose) -> SmoothedPose:
        """Drop the level where the pose has peaks or violates the levels above."""
        now, back = posed, np.zeros(len(posed.states))
        for last in [False] * (DROPPING_ROUNDS - 1) + [True]:
            bump = self._to_ease(number, now, DROPPING_RANGE)
            if not bump.any():
                break
            back = np.maximum(back, bump)
            self._kept.return_fractions[:] = np.round(back, 9)
            now = self._posed_anew(number, posed, self._eased, self._kept.return_fractions, False, last)
        return now

    def _to_ease(self, number: int, now: SmoothedPose, limits: Ramp = SMOOTHING_RANGE) -> FloatArray:
        """Weight (F,) by which level ``number`` is smoothed in each frame: where the pose ``now`` has peaks of
        acceleration over ``limits``, or where lower levels violate its priority.
        """
        changed = self._spread(number, VIOLATION_RANGE.share_of(self._levels[number].solve.changes), SMOOTHING_MARGIN)
        peaks = self._bump(number, now, SMOOTHING_MARGIN, limits)
        return np.asarray(np.maximum(peaks, changed) * (self._rooms[number] > 0.0))

    def _posed_anew(
        self,
        number: int,
        first: SmoothedPose,
        second: SmoothedPose,
        fraction: FloatArray,
        meets: bool,
        holds: bool = False,
    ) -> SmoothedPose:
        """Pose the frames with a ``fraction`` (F,) between two poses again."""
        level, frames = self._levels[number], np.flatnonzero(fraction > 0.0)
        level.solve.changes[:] = 0.0
        if not len(frames):
            return first
        level.solve.states[:] = _blend(first.states, second.states, fraction)
        rotation_matrices = self._charts.rotations(_blend(first.charts, second.charts, fraction))
        told = np.ascontiguousarray(self._told.T)  # kernels are compiled for no other
        self._pose(number, level.solve.easing(frames, rotation_matrices, level.rank, meets, holds, told, self._kept))
        return SmoothedPose(level.solve.states.copy(), self._posed_limbs(first.charts))

    def _spread(self, number: int, fraction: FloatArray, seconds: float) -> FloatArray:
        """``_spread_peaks`` within each run of smoothed frames, which lower levels must not connect."""
        spread = np.zeros(len(fraction))
        if (fraction > 0.0).any():
            for first, past in self._runs[number]:
                spread[first:past] = _spread_peaks(fraction[first:past], self._levels[number].solve.rate, seconds)
        return spread

    def _posed_limbs(self, beside: FloatArray | None = None) -> FloatArray:
        """Coordinates of the limbs as solved last, on the branches of the coordinates ``beside``."""
        return self._charts.coordinates(self._charts.joint_rotations(self._solved.rotations), beside)

    def _smoothed(self, number: int, solved: SmoothedPose) -> SmoothedPose:
        """Displacement of a level, averaged in time at peaks."""
        level, margin = self._levels[number], self._rooms[number]
        states, values = solved.states + self._moved.states, solved.charts + self._moved.charts
        for moved in self._moved:
            self._touched = np.maximum(self._touched, moved.reshape(len(moved), -1).any(axis=1))
        for seconds in SMOOTHING_WIDTHS:
            width = max(round(seconds * level.solve.rate), 1)
            bump = margin * self._bump(number, SmoothedPose(states, values), seconds)
            if not bump.any():
                break
            self._touched = np.maximum(self._touched, bump)
            states, values = _blend(states, _mean(states, width), bump), _blend(values, _mean(values, width), bump)
            values = self._charts.clamped_to_limits(values)
        joints = level.solve.joints
        back = (
            self._root_reach.root_correction(states, joints, round(LOOK_AHEAD * level.solve.rate))
            * (margin > 0.0)[:, None]
        )
        self._touched = np.maximum(self._touched, back.any(axis=1))
        states[:, joints["segment"] == ROOT_TRANSLATION] += back[:, None]
        return SmoothedPose(states, values)

    def _bump(self, number: int, poses: SmoothedPose, around: float, limits: Ramp = SMOOTHING_RANGE) -> FloatArray:
        """Smoothing weight (F,) from 0 to 1 of each frame for its peaks.

        Frames within ``around`` seconds of a peak have full weight, which fades over as many again. Peaks of the levels
        above do not count.
        """
        level = self._levels[number]
        begin = np.append(np.full(len(level.solve.joints), ADDED_PEAK), TOTAL_PEAK)
        allowed = np.maximum(level.allowed, self._jolts / begin)
        sharp = level.solve.peaks_of(poses.states, self._charts.rotations(poses.charts))
        return self._spread(number, _excess(level.solve.ratios(sharp, allowed), limits), around)


def _excess(sharp: FloatArray, limits: Ramp = SMOOTHING_RANGE) -> FloatArray:
    """Position (F,) on ``limits`` of the greatest peak (F, 3), in fractions of the allowed one."""
    return np.asarray(limits.share_of(sharp).max(axis=1))


def _spread_peaks(fraction: FloatArray, rate: float, seconds: float) -> FloatArray:
    """Maximum (F,) of ``fraction`` (F,) within some seconds, from 0 to 1, fading over as many."""
    near = max(round(seconds * rate), 1)
    return _mean(maximum_filter1d(np.clip(fraction, 0.0, 1.0), 2 * near + 1, mode="constant"), near)


def _blend(first: FloatArray, second: FloatArray, fraction: FloatArray) -> FloatArray:
    """Blend from ``first`` to ``second`` (F, ...), by ``fraction`` (F,)."""
    return np.asarray(first + fraction.reshape(-1, *[1] * (second.ndim - 1)) * (second - first))


def _mean(values: FloatArray, width: int) -> FloatArray:
    """Means of ``values`` (F, ...) over ``width`` frames on either side, by a Hann window."""
    return np.asarray(convolve1d(values, hann_window(width), axis=0, mode="nearest"))
