"""Report of every constraint in every frame, and of feet, knees and balance, as arrays for plots.

The blocker of a constraint is found by counterfactuals: the frame is solved without each other constraint of the same
or a higher priority, without contacts, without joint limits, or without smoothing, and the motion is posed without the
self-contacts that act after the solver. The blocker is the one whose absence removes most of the residual. If no single
one helps, they are removed one after the other; if even that does not help, the blocker is the reach of the body.
Sampled frames stand for the frames around them. Manual corrections above the constraints, and followed characters that
moved on when they were solved in turn, are blockers where they add most to the residual.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.curves.activation import LEAST_FULL_ACTIVATION
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.quality.metrics import body_heights, knee_speeds, mass_margins, skate_distances
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion
from studio.core.solver.grounding.support_polygon import standing_mask
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.solved_window import ALL_LIMITS, SolvedWindow, SolverLimits, targets_of
from studio.core.solver.task_assembly.contact_release import constraint_activations, contact_release
from studio.core.solver.task_assembly.measured_residuals import full_residuals
from studio.core.solver.task_assembly.tracks import Tracks

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]

BLOCKED_BY_NOTHING, BLOCKED_BY_CONTACTS, BLOCKED_BY_LIMITS, BLOCKED_BY_REACH, BLOCKED_BY_SMOOTHING = -1, -2, -3, -4, -5
BLOCKED_BY_TOUCHES, BLOCKED_BY_CLEARANCE, BLOCKED_BY_TOLERANCE = -6, -7, -8
BLOCKED_BY_CORRECTIONS, BLOCKED_BY_FOLLOWED, BLOCKED_BY_GROUND = -9, -10, -11
"""Blockers of a constraint other than the index of another one: none (met, or inactive), contacts with the ground,
joint limits, the reach of body and chain, smoothing in time, hands that touch, arms that stay out of the body, the
solver's own tolerance, manual corrections above it, characters who follow this one in turn, and the ground over its
target.
"""
MET_TOLERANCE_BY_UNIT = {"m": PRIORITY_TOLERANCE, "rad": float(np.radians(0.1))}
"""Greatest residual of a constraint that counts as met, by unit."""
SAMPLE_SECONDS = 0.2
"""Seconds between sampled frames: a third of the cost of all frames, with another blocker in 5 % of them."""
RELEVANT_FRACTION = 0.05
"""Least fraction of a residual that the absence of a blocker removes."""


@dataclass(frozen=True, eq=False)
class QualityReport:
    """Report of C constraints over F frames.

    ``residuals`` (C, F) are in metres or radians, NaN where inactive. ``misses`` (C, F) are measured on the poses, at
    full activation, active or not (``measured_residuals.full_residuals``). ``winners`` (C, F) is the blocker of each
    constraint: the index of a constraint, or one of the ``BLOCKED_BY_*`` constants. ``slides`` and ``heights`` (9, F),
    metres, have a row for each ``ContactPoint``, NaN without contact. ``lowest`` (F,) and ``skates`` (2, F), metres,
    are the height of the lowest point of the body and the travel of each foot along the ground, with or without contact
    (``quality.metrics``). ``knee_speeds`` (2, F) are in rad/s. ``mass_margins`` (F,) are metres from the centre of mass
    to the edge of the support polygon, negative outside, NaN in flight.
    """

    residuals: FloatArray
    misses: FloatArray
    winners: IntArray
    slides: FloatArray
    heights: FloatArray
    lowest: FloatArray
    skates: FloatArray
    knee_speeds: FloatArray
    mass_margins: FloatArray


def report_of(standing: GroundedMotion, request: AdaptRequest, adapted: AdaptedMotion) -> QualityReport:
    """Report of ``adapted``, the solution of ``request`` on its grounded motion, in any range of frames."""
    window = _window_of(adapted)
    stands = standing_mask(standing.contacts, request.motion.frame_count)[:, window]
    slides, heights = contact_tracks(adapted, standing.contacts, request.ground)
    misses, blockers = _misses_and_blockers(standing, request, adapted)
    return QualityReport(
        adapted.residuals,
        misses,
        blockers,
        slides,
        heights,
        body_heights(adapted, request.ground),
        skate_distances(adapted, request.ground),
        knee_speeds(adapted),
        mass_margins(adapted, stands),
    )


def _misses_and_blockers(
    standing: GroundedMotion, request: AdaptRequest, adapted: AdaptedMotion
) -> tuple[FloatArray, IntArray]:
    """Residuals (C, F) measured on the poses of ``adapted``, and their blockers (C, F).

    Of the solver, the corrections above it and the characters that moved on, the one that adds most is the blocker.
    """
    problem = _Problem(standing, request.constraints, request.tracks)
    if not request.final_tracks and not any(each.above for each in request.corrections):
        misses = problem.misses(adapted)
        return misses, _BlockerSearch(problem, adapted, misses, request.eased).winners()
    window = _window_of(adapted)
    first, last = window.start, window.stop - 1
    solved = solve_constraints(standing, request.constraints, first, last, request.tracks, eased=request.eased)
    solved_misses, corrected = problem.misses(solved), problem.misses(adapted)
    misses = replace(problem, tracks={**request.tracks, **request.final_tracks}).misses(adapted)
    blockers = _BlockerSearch(problem, solved, solved_misses, request.eased).winners()
    limits = np.array([MET_TOLERANCE_BY_UNIT[each.unit] for each in request.constraints]).reshape(-1, 1)
    added = np.nan_to_num(np.stack([solved_misses, corrected - solved_misses, misses - corrected]))
    added[0, blockers == BLOCKED_BY_NOTHING] = -np.inf  # the solver met it
    full = fully_active(request.constraints, request.motion.times[window])
    most = np.where(full & (misses > limits), added.argmax(axis=0), 0)
    blockers = np.choose(most, [blockers, BLOCKED_BY_CORRECTIONS, BLOCKED_BY_FOLLOWED])
    return misses, np.where(full & (misses <= limits), BLOCKED_BY_NOTHING, blockers)


def blocking_constraints(
    standing: GroundedMotion,
    constraints: Sequence[Constraint],
    tracks: Tracks,
    adapted: AdaptedMotion,
    eased: bool = False,
) -> IntArray:
    """Index of the constraint, or ``BLOCKED_BY_*`` constant, that keeps each of C constraints from its
    target, (C, F).
    """
    problem = _Problem(standing, constraints, tracks)
    return _BlockerSearch(problem, adapted, problem.misses(adapted), eased).winners()


def fully_active(constraints: Sequence[Constraint], times: FloatArray) -> Mask:
    """Mask (C, F) of the frames in which the activation of a constraint is 1, with or without contacts."""
    active = [each.activation.at(times) >= LEAST_FULL_ACTIVATION for each in constraints]
    return np.array(active, dtype=np.bool_).reshape(-1, len(times))


def sampled_frames(state: Mask, apart: int) -> tuple[IntArray, IntArray]:
    """Sampled frames (n,), at most ``apart`` frames from each other, and the index (F,) of the sample for each frame.

    All frames of a sample have the same ``state`` (S, F).
    """
    changes = np.flatnonzero((state[:, 1:] != state[:, :-1]).any(axis=0)) + 1
    runs = np.split(np.arange(state.shape[1]), changes)
    parts = [part for run in runs for part in np.array_split(run, math.ceil(len(run) / max(apart, 1)))]
    return np.array([part[len(part) // 2] for part in parts]), np.repeat(range(len(parts)), list(map(len, parts)))


def _window_of(adapted: AdaptedMotion) -> slice:
    return slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)


@dataclass(frozen=True, eq=False)
class _Problem:
    """Constraints, C in number, on a grounded motion, with the tracks that they follow."""

    standing: GroundedMotion
    constraints: Sequence[Constraint]
    tracks: Tracks

    @cached_property
    def activations(self) -> FloatArray:
        """Activations (C, F) in the whole motion."""
        return constraint_activations(self.constraints, self.standing)

    def misses(self, adapted: AdaptedMotion) -> FloatArray:
        """Residuals (C, F) measured on poses, at full activation."""
        targets = targets_of(self.standing, self.constraints, _window_of(adapted), self.tracks)
        return full_residuals(self.constraints, targets, adapted)

    def solved_residuals(self, rows: IntArray, frames: IntArray, bound: SolverLimits = ALL_LIMITS) -> FloatArray:
        """Residuals (A, m) of the constraints ``rows`` (A,) in ``frames`` (m,), solved without the others and without
        smoothing.
        """
        constraints, window = [self.constraints[row] for row in rows], slice(int(frames[0]), int(frames[-1]) + 1)
        solved = SolvedWindow(self.standing, constraints, self.activations[rows], self.tracks, bound, window)
        solved.solve(frames - window.start)
        return solved.residuals[:, frames - window.start]


class _BlockerSearch:
    """Search for the blockers of C constraints in n frames: the best candidate so far, and its gain."""

    def __init__(self, problem: _Problem, adapted: AdaptedMotion, misses: FloatArray, eased: bool) -> None:
        """Start a search with ``misses`` (C, F), measured on the poses of ``adapted``; ``eased`` if it was smoothed."""
        window, constraints = _window_of(adapted), problem.constraints
        self._problem, self._window, self._eased = problem, window, eased
        self._ranks = np.array([each.priority for each in constraints], dtype=np.int64)
        self._limits = np.array([MET_TOLERANCE_BY_UNIT[each.unit] for each in constraints]).reshape(-1, 1)
        self._full = fully_active(constraints, problem.standing.motion.times[window])
        self._residuals, self._misses = adapted.residuals, np.where(self._full, misses, adapted.residuals)
        missed = np.where(self._full, ~(misses <= self._limits), adapted.residuals > self._limits)
        self._found = np.where(missed, BLOCKED_BY_TOLERANCE, BLOCKED_BY_NOTHING)
        relevant = np.minimum(self._limits, self._misses - self._limits)
        self._best = np.where(missed, np.maximum(relevant, RELEVANT_FRACTION * self._misses), np.inf)
        self._frames = np.arange(window.start, window.stop)

    def winners(self) -> IntArray:
        """Blockers (C, F), as in ``QualityReport.winners``."""
        every, always = np.arange(len(self._ranks)), np.ones(len(self._frames), dtype=np.bool_)
        self._weigh_posing()
        if self._eased:
            self._weigh(BLOCKED_BY_SMOOTHING, every, every, always)
        sample_of = self._sample()
        acting, always = np.isfinite(self._residuals), always[: len(self._frames)]
        self._weigh(BLOCKED_BY_CONTACTS, every, every, always, SolverLimits(uses_contacts=False))
        self._weigh(BLOCKED_BY_LIMITS, every, every, always, SolverLimits(uses_joint_limits=False))
        self._weigh(BLOCKED_BY_GROUND, every, every, always, SolverLimits(uses_ground=False))
        for row in every.tolist():
            others = every[every != row]
            self._weigh(row, others, others[self._ranks[others] >= self._ranks[row]], acting[row])
        for row in every.tolist():
            self._weigh_together(row)
        found = self._found[:, sample_of]
        found[self._waiting()] = BLOCKED_BY_CONTACTS
        return found

    def _waiting(self) -> Mask:
        """Mask (C, F) of the frames in which the contacts of a limb move it although it has constraints."""
        problem, standing = self._problem, self._problem.standing
        target = [each.activation.at(standing.motion.times[self._window]) for each in problem.constraints]
        released = contact_release(problem.constraints, standing, self._window)
        return np.asarray((np.reshape(target, released.shape) > 0.0) & (released < 1.0))

    def _sample(self) -> IntArray:
        """Reduce the search to sampled frames, and return the index (F,) of the sample for each frame."""
        state = np.concatenate([np.isfinite(self._residuals), self._found])
        kept, sample_of = sampled_frames(state, round(SAMPLE_SECONDS * self._problem.standing.motion.frame_rate))
        self._frames = self._frames[kept]
        self._residuals, self._misses = self._residuals[:, kept], self._misses[:, kept]
        self._found, self._best = self._found[:, kept], self._best[:, kept]
        return sample_of

    def _weigh_posing(self) -> None:
        """Note, as blockers, the steps that pose arms after the solver, if the poses miss more than the solver left.

        Of several steps it is the one whose absence alone helps most.
        """
        standing, apart = self._problem.standing, self._misses - self._residuals
        absent = _posed_without(standing)
        if absent and (apart > self._best).any():
            alone = np.array([self._gain_of(without) for without in absent.values()])
            names = np.array(list(absent))[alone.argmax(axis=0)]
            whole = self._gain_of(replace(standing, arms=None, self_contact=None))
            self._note(names, np.arange(len(self._found)), np.arange(len(self._frames)), whole)

    def _gain_of(self, standing: GroundedMotion) -> FloatArray:
        """Decrease (C, F) of the residuals of fully active constraints on another grounded motion."""
        problem, first, last = self._problem, self._window.start, self._window.stop - 1
        posed = solve_constraints(standing, problem.constraints, first, last, problem.tracks, eased=self._eased)
        return np.where(self._full, self._misses - problem.misses(posed), 0.0)

    def _weigh(self, name: int, asked: IntArray, rows: IntArray, acts: Mask, bound: SolverLimits = ALL_LIMITS) -> None:
        """Note ``name`` as blocker in the frames ``acts`` (n,) if solving only the constraints ``asked`` helps most so
        far.
        """
        numbers = np.flatnonzero(acts & (self._found[rows] != BLOCKED_BY_NOTHING).any(axis=0))
        if len(numbers):
            left = self._problem.solved_residuals(asked, self._frames[numbers], bound)[np.isin(asked, rows)]
            self._note(name, rows, numbers, self._residuals[np.ix_(rows, numbers)] - left)

    def _note(self, name: int | IntArray, rows: IntArray, numbers: IntArray, gain: FloatArray) -> None:
        """Note ``name`` where its ``gain`` (R, m) is the best so far, for constraints ``rows`` (R,) in frames
        ``numbers`` (m,).
        """
        here = np.ix_(rows, numbers)
        better = gain > self._best[here]
        self._found[here] = np.where(better, name, self._found[here])
        self._best[here] = np.where(better, gain, self._best[here])

    def _weigh_together(self, row: int) -> None:
        """Note, if no absence helps alone, the first that helps when removed together with the ones before it.

        The order is constraints, contacts, limits. If a free body misses the target as well, the blocker is its reach.
        """
        for name, bound in (
            (None, ALL_LIMITS),
            (BLOCKED_BY_CONTACTS, SolverLimits(uses_contacts=False)),
            (BLOCKED_BY_LIMITS, SolverLimits(uses_contacts=False, uses_joint_limits=False)),
        ):
            numbers = np.flatnonzero(self._found[row] == BLOCKED_BY_TOLERANCE)
            if not len(numbers):
                return
            left = self._problem.solved_residuals(np.array([row]), self._frames[numbers], bound)[0]
            helped = numbers[self._residuals[row, numbers] - left > self._best[row, numbers]]
            if name is None:
                self._name_highest(row, helped)
            else:
                self._found[row, helped] = name
        unexplained = self._found[row, numbers] == BLOCKED_BY_TOLERANCE
        self._found[row, numbers[unexplained & (left > self._limits[row])]] = BLOCKED_BY_REACH

    def _name_highest(self, row: int, numbers: IntArray) -> None:
        """Note, as blocker of the constraint ``row``, the other acting constraint with the highest priority in frames
        ``numbers`` (m,).
        """
        for other in reversed(np.argsort(self._ranks, kind="stable").tolist()):
            if other != row:
                self._found[row, numbers[np.isfinite(self._residuals[other, numbers])]] = other


def _posed_without(standing: GroundedMotion) -> dict[int, GroundedMotion]:
    """Grounded motions, each without one step that poses arms after the solver, by the blocker that the step is."""
    absent, contact = dict[int, GroundedMotion](), standing.self_contact
    if standing.arms is not None:
        absent[BLOCKED_BY_CONTACTS] = replace(standing, arms=None)
    if contact is not None and contact.has_contacts:
        absent[BLOCKED_BY_TOUCHES] = replace(standing, self_contact=contact.without_touches)
    if contact is not None and contact.clearances is not None:
        absent[BLOCKED_BY_CLEARANCE] = replace(standing, self_contact=replace(contact, clearances=None))
    return absent
