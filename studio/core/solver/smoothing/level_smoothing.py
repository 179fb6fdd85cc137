"""Smoothing of solved frames at acceleration peaks (METHOD (36) to (38)).

Every frame is solved from its own pose alone, so a limb that changes sides, or a level that is dropped, may jump
between two frames. Frames without a peak beyond those of the motion and its moving targets are unchanged. Elsewhere the
displacements caused by the constraints are averaged over neighbouring frames, level by level from the highest, each on
the final poses of the levels above. Then the level is solved again; if that has peaks, the average is kept; if the
average has peaks or violates the levels above, the level is dropped: strict priorities come before smoothness.
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
from studio.core.kernels.time.acceleration_peaks import ADDED_PEAK_FRACTION, TOTAL_PEAK_FRACTION, write_smoothed_peaks
from studio.core.kernels.time.smoothed_frames import SMOOTHING_VIOLATION
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.runs import runs_of
from studio.core.solver.grounding.contact_blending import LOWERING_LEAD_SECONDS, hann_window
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.smoothing.limb_coordinates import LimbCoordinates
from studio.core.solver.smoothing.smoothed_root_reach import RootReach

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
FramePoser = Callable[[int, records.SmoothingRun], None]
"""Function that poses frames again with the constraints down to a level."""


class Ramp(NamedTuple):
    """Linear ramp of a weight from 0 to 1."""

    begin: FloatArray
    """Value at which the weight is 0."""
    whole: FloatArray
    """Value at which the weight is 1."""

    def share_of(self, values: FloatArray) -> FloatArray:
        """Position of ``values`` on the ramp, not clipped: 0 at its beginning, 1 at its end."""
        return np.asarray((values - self.begin) / (self.whole - self.begin))


class SmoothedPose(NamedTuple):
    """Degrees of freedom of all frames of a clip."""

    states: FloatArray
    """(F, N, 3) states of the search."""
    charts: FloatArray
    """(F, 16, n) coordinates of the limbs' joints (``LimbCoordinates``)."""


class SolvedArrays(NamedTuple):
    """Arrays written by a solve, frames first."""

    positions: FloatArray
    """(F, P, 3) metres."""
    rotations: FloatArray
    """(F, S, 3, 3) in the world."""
    residuals: FloatArray
    """(F, C) metres or radians."""
    cleared_positions: FloatArray
    """(F, P, 3) unsolved poses with arms pushed out of the body; empty without self-collision constraints."""
    cleared_rotations: FloatArray
    """(F, S, 3, 3) unsolved poses with arms pushed out of the body; empty without self-collision constraints."""

    def copy_from(self, other: "SolvedArrays") -> None:
        """Copy the values of ``other`` into these arrays."""
        for mine, theirs in zip(self, other, strict=True):
            mine[:] = theirs

    def in_frames(self, frames: slice) -> "SolvedArrays":
        """Views of the frames of a slice."""
        return SolvedArrays(*(each[frames] for each in self))


class LevelNumbers(NamedTuple):
    """Position of a level among the others."""

    solved: int
    """Number of solved task levels above it."""
    clears: int
    """Number of self-collision constraints without a higher priority."""


SMOOTHING_RANGE = Ramp(
    np.array([ADDED_PEAK_FRACTION, ADDED_PEAK_FRACTION, TOTAL_PEAK_FRACTION]), np.array([1.8, 1.8, 2.6])
)
"""Peaks of root, joints and limbs, as fractions of the allowed peak, over which smoothing fades in."""
DROPPING_RANGE = Ramp(3.5 * SMOOTHING_RANGE.begin, 3.5 * SMOOTHING_RANGE.whole)
"""Peaks of root, joints and limbs, as fractions of the allowed peak, over which a level is dropped, since even its
average pops.

A level that is merely sharper than a calm source is kept: dropped, its residual was up to 0.8 m for seconds.
"""
SMOOTHING_WIDTH_SECONDS = 0.06, 0.2, 0.35, 0.12
"""Seconds on either side of successive averages, each used where the one before did not suffice: fully within that
distance of a peak, fading over as much again.
"""
DROPPING_ROUNDS = 4
"""Rounds of dropping a level where it violates those above it, over growing ranges of frames."""
SMOOTHING_MARGIN_SECONDS = 0.35
"""Seconds on either side of a peak within which a level stays averaged, or is dropped, completely; it fades over as
much again.
"""
VIOLATION_RANGE = Ramp(np.array(0.93 * SMOOTHING_VIOLATION), np.array(1.07 * SMOOTHING_VIOLATION))
"""Priority violation of a smoothed level, in metres or radians, over which it is dropped."""
SMOOTHING_REACH_SECONDS = 0.6
"""Seconds on either side of a peak of a solved level within which frames may be smoothed; the weight fades over as much
again.
"""
SMOOTHING_HORIZON_SECONDS = 2.0 * SMOOTHING_REACH_SECONDS + 0.25
"""Seconds on either side of a frame that affect its smoothing."""
LEG_BONES = BodyPart.LEFT_THIGH, BodyPart.RIGHT_THIGH, BodyPart.LEFT_SHANK, BodyPart.RIGHT_SHANK
"""Segments whose peaks are also allowed for root and trunk if a leg has a constraint: a kick swings the pelvis."""


_NO_ROTATIONS, _NO_RESIDUALS, _NO_POSE = (
    np.empty((0, 16, 3, 3)),
    np.empty((0, 0)),
    HigherLevelPoses(np.empty((0, 0, 3)), np.empty((0, 0, 3, 3)), np.empty((0, 0, 3)), np.empty(0)),
)


@dataclass(eq=False)
class SolveNotes:
    """Notes that a solve makes on F frames, and from which some frames can be posed again."""

    layout: BodyLayout
    rate: float
    """Frames a second."""
    joints: NDArray[np.void]
    """(N,) joints of the search."""
    limbs: IntArray
    """(4,) 1 for a limb with constraints."""
    states: FloatArray
    """(F, N, 3) states of the search."""
    peaks: FloatArray
    """(N + 1,) acceleration peaks of the unsolved motion, rad/s2, in the columns of
    ``kernels.time.acceleration_peaks``.
    """
    sharp: FloatArray
    """(F, N + 1) acceleration peaks of the solve, rad/s2."""
    changes: FloatArray
    """(F,) priority violations of the smoothing, metres or radians."""
    held: int
    """Number of levels that are contacts."""

    @staticmethod
    def of(
        standing: GroundedMotion,
        frames: int,
        joints: NDArray[np.void],
        limbs: IntArray,
        held: int,
    ) -> "SolveNotes":
        """Empty notes for a number of ``frames``, with ``joints`` (N,) of the search.

        ``limbs`` (C, 2) are the limbs of the constraints' ends, -1 for none; the first ``held`` levels are contacts.
        """
        named = set(limbs.ravel().tolist())
        named_limbs = np.array([0 in named, 1 in named, 2 in named, 3 in named], dtype=np.int64)
        layout, rate = standing.morphology.layout, standing.motion.frame_rate
        peaks, states = (
            unsolved_peaks(standing, joints["segment"], 2 in named or 3 in named),
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
        """``SmoothingRun`` that poses ``frames`` (n,) from smoothed states and limb rotations (F, 16, 3, 3).

        With ``meets`` the level is solved again, with ``holds`` frames that violate higher levels return to these;
        ``misses`` (C + Q, F) are the residuals so far.
        """
        noted = self.limbs, self.peaks[-1:], np.array([self.rate]), self.sharp, self.changes
        eased = np.array([(rank.solved, meets, self.held, holds, rank.clears)], dtype=SMOOTHED_LEVEL)
        return records.SmoothingRun(frames, self.states, rotation_matrices, eased, misses, above, *noted)

    def in_frames(self, frames: slice) -> "SolveNotes":
        """Copy for the frames of a slice."""
        arrays = {name: getattr(self, name)[frames].copy() for name in ("states", "sharp", "changes")}
        return replace(self, **arrays)

    @property
    def noting(self) -> records.SmoothingRun:
        """``SmoothingRun`` for a first solve of all frames."""
        return self.easing(
            np.arange(len(self.states)), _NO_ROTATIONS, LevelNumbers(0, 0), False, False, _NO_RESIDUALS, _NO_POSE
        )

    def exceeds_peaks(self, allowed: FloatArray) -> bool:
        """True if any peak of the solve exceeds the ``allowed`` one, (N + 1,) or (F, N + 1), rad/s2, by more than the
        tolerance.
        """
        return bool((self.ratios(self.sharp, allowed) > SMOOTHING_RANGE.begin).any())

    def ratios(self, sharp: FloatArray, allowed: FloatArray) -> FloatArray:
        """Greatest ratios (F, 3) of peak accelerations ``sharp`` (F, N + 1), rad/s2, to the ``allowed`` ones: of the
        root, of the other joints of the search, and of the limbs.
        """
        each, is_root = sharp / allowed, self.joints["segment"] == ROOT_TRANSLATION
        root, others = (each[:, :-1][:, mask].max(axis=1, initial=0.0) for mask in (is_root, ~is_root))
        return np.stack([root, others, each[:, -1]], axis=1)

    def peaks_of(self, states: FloatArray, rotation_matrices: FloatArray) -> FloatArray:
        """Acceleration peaks (F, N + 1) in rad/s2 of poses with these states, and joint rotations (F, 16, 3, 3) of the
        limbs.
        """
        sharp = np.zeros((len(rotation_matrices), len(self.peaks)))
        write_smoothed_peaks(self.joints, states, self.limbs, rotation_matrices, self.rate, sharp)
        return sharp


def unsolved_peaks(standing: GroundedMotion, searched: IntArray, legs_asked: bool) -> FloatArray:
    """Acceleration peaks (N + 1,) in rad/s2 of the unsolved motion, for a search of segments ``searched`` (N,).

    Legs count if they have a constraint (``legs_asked``); root and searched joints are then allowed at least the legs'
    peaks.
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
    """Solution of a level together with all levels above it."""

    solve: SolveNotes
    """Notes of the solve."""
    solved: SolvedArrays
    """Results of the solve."""
    above: NDArray[np.bool_]
    """(C,) True for constraints of a higher level."""
    rank: LevelNumbers
    acts: NDArray[np.bool_]
    """(F,) True where a constraint of this level or above is active."""
    own: NDArray[np.bool_]
    """(F,) True where a constraint of this level is active."""
    allowed: FloatArray
    """(F, N + 1) allowed acceleration peaks, rad/s2."""

    def in_frames(self, frames: slice) -> "SolvedLevel":
        """Copy for the frames of a slice."""
        solved = self.solved.in_frames(frames)
        solve, acts, own = self.solve.in_frames(frames), self.acts[frames], self.own[frames]
        return replace(self, solve=solve, solved=solved, acts=acts, own=own, allowed=self.allowed[frames])

    @property
    def near_peaks(self) -> FloatArray:
        """Weights (F,): 1 near acceleration peaks of the level's solve, fading to 0."""
        return _spread_peaks(
            _excess(self.solve.ratios(self.solve.sharp, self.allowed)), self.solve.rate, SMOOTHING_REACH_SECONDS
        )

    @property
    def within_activity(self) -> FloatArray:
        """Weights (F,): 1 where constraints of this level or above are active, fading over the frames at the ends of
        activity.
        """
        return _mean(minimum_filter1d(self.acts.astype(np.float64), 3, mode="nearest"), 1)


class LevelSmoother:
    """Smoother of one priority level after the other, each on the final poses of the levels above."""

    def __init__(
        self,
        levels: Sequence[SolvedLevel],
        pose: FramePoser,
        solved: SolvedArrays,
        charts: LimbCoordinates,
        root_reach: RootReach,
        rooms: FloatArray,
    ) -> None:
        """Prepare ``levels``; ``pose`` poses frames again, into ``solved``.

        ``charts`` converts joint rotations of limbs, ``root_reach`` bounds the root; ``rooms`` (L, F) are the smoothing
        weights of all levels.
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
        """Average level ``number`` at peaks and solve it again; keep the average where that has peaks, or drop the
        level.
        """
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
        """Pose with level ``number`` dropped where ``posed`` has peaks or violates the levels above."""
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
        """Weight (F,) by which level ``number`` is smoothed in each frame.

        It is positive where the pose ``now`` has acceleration peaks over ``limits``, or where the level violates those
        above.
        """
        changed = self._spread(
            number, VIOLATION_RANGE.share_of(self._levels[number].solve.changes), SMOOTHING_MARGIN_SECONDS
        )
        peaks = self._bump(number, now, SMOOTHING_MARGIN_SECONDS, limits)
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
        """Pose with the frames of positive ``fraction`` (F,) posed again at that fraction from ``first`` to
        ``second``.
        """
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
        """Maximum (F,) of ``fraction`` within some ``seconds``, fading over as many, in each run of smoothed frames by
        itself.
        """
        spread = np.zeros(len(fraction))
        if (fraction > 0.0).any():
            for first, past in self._runs[number]:
                spread[first:past] = _spread_peaks(fraction[first:past], self._levels[number].solve.rate, seconds)
        return spread

    def _posed_limbs(self, beside: FloatArray | None = None) -> FloatArray:
        """Coordinates (F, 16, n) of the limbs' joints in the poses solved last; signs follow the coordinates
        ``beside``.
        """
        return self._charts.coordinates(self._charts.joint_rotations(self._solved.rotations), beside)

    def _smoothed(self, number: int, solved: SmoothedPose) -> SmoothedPose:
        """Pose of level ``number`` with displacements averaged in time at acceleration peaks."""
        level, margin = self._levels[number], self._rooms[number]
        states, values = solved.states + self._moved.states, solved.charts + self._moved.charts
        for moved in self._moved:
            self._touched = np.maximum(self._touched, moved.reshape(len(moved), -1).any(axis=1))
        for seconds in SMOOTHING_WIDTH_SECONDS:
            width = max(round(seconds * level.solve.rate), 1)
            bump = margin * self._bump(number, SmoothedPose(states, values), seconds)
            if not bump.any():
                break
            self._touched = np.maximum(self._touched, bump)
            states, values = _blend(states, _mean(states, width), bump), _blend(values, _mean(values, width), bump)
            values = self._charts.clamped_to_limits(values)
        joints = level.solve.joints
        back = (
            self._root_reach.root_correction(states, joints, round(LOWERING_LEAD_SECONDS * level.solve.rate))
            * (margin > 0.0)[:, None]
        )
        self._touched = np.maximum(self._touched, back.any(axis=1))
        states[:, joints["segment"] == ROOT_TRANSLATION] += back[:, None]
        return SmoothedPose(states, values)

    def _bump(self, number: int, poses: SmoothedPose, around: float, limits: Ramp = SMOOTHING_RANGE) -> FloatArray:
        """Smoothing weight (F,) from 0 to 1 of each frame, for acceleration peaks of ``poses``.

        Frames within ``around`` seconds of a peak have full weight, which fades over as many again. Peaks of the levels
        above do not count.
        """
        level = self._levels[number]
        begin = np.append(np.full(len(level.solve.joints), ADDED_PEAK_FRACTION), TOTAL_PEAK_FRACTION)
        allowed = np.maximum(level.allowed, self._jolts / begin)
        sharp = level.solve.peaks_of(poses.states, self._charts.rotations(poses.charts))
        return self._spread(number, _excess(level.solve.ratios(sharp, allowed), limits), around)


def _excess(sharp: FloatArray, limits: Ramp = SMOOTHING_RANGE) -> FloatArray:
    """Position (F,) on the ramp ``limits`` of the greatest of the peak ratios ``sharp`` (F, 3)."""
    return np.asarray(limits.share_of(sharp).max(axis=1))


def _spread_peaks(fraction: FloatArray, rate: float, seconds: float) -> FloatArray:
    """Maximum (F,) of ``fraction`` (F,), clipped to [0, 1], within some ``seconds``, fading over as many."""
    near = max(round(seconds * rate), 1)
    return _mean(maximum_filter1d(np.clip(fraction, 0.0, 1.0), 2 * near + 1, mode="constant"), near)


def _blend(first: FloatArray, second: FloatArray, fraction: FloatArray) -> FloatArray:
    """Values at ``fraction`` (F,) from ``first`` to ``second``, both (F, ...)."""
    return np.asarray(first + fraction.reshape(-1, *[1] * (second.ndim - 1)) * (second - first))


def _mean(values: FloatArray, width: int) -> FloatArray:
    """Means of ``values`` (F, ...) over ``width`` frames on either side, by a Hann window."""
    return np.asarray(convolve1d(values, hann_window(width), axis=0, mode="nearest"))
