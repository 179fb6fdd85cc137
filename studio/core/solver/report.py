"""Report of every constraint in every frame, and of feet, knees and balance: arrays for plots.

The blocker of a constraint is found by counterfactuals: the frame is solved without each other constraint of the same
or a higher priority, without contacts, without joint limits, or without smoothing. The one whose absence removes most
of the residual is named; if none helps, the reach of the body is. Sampled frames stand for the frames around them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.quality.contact_tracks import contact_tracks
from studio.core.quality.metrics import centre_of_mass, knee_speeds
from studio.core.solver.asking.measured_residuals import full_residuals
from studio.core.solver.asking.releasing import constraint_activations, contact_release
from studio.core.solver.asking.tracks import Tracks
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.solved_window import BOUND, Bound, SolvedWindow, targets_of
from studio.core.solver.standing.stand import Standing
from studio.core.solver.standing.support import outlines, standing_points, support_margins

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Mask = NDArray[np.bool_]

BLOCKED_BY_NOTHING, BLOCKED_BY_CONTACTS, BLOCKED_BY_LIMITS, BLOCKED_BY_REACH, BLOCKED_BY_SMOOTHING = -1, -2, -3, -4, -5
"""Blockers of a constraint other than the row of another one: none (met, or inactive), contacts, joint limits, the
reach of body and chain, smoothing in time.
"""
MET_BY_UNIT = {"m": PRIORITY_TOLERANCE, "rad": float(np.radians(0.1))}
"""Greatest residual of a constraint that counts as met, by unit."""
SAMPLE_SECONDS = 0.2
"""Seconds between samples: a third of the cost of all frames, 5 % of which then get another blocker."""
RELEVANT_FRACTION = 0.05
"""Fraction of a residual that an absence has to remove to be relevant."""


@dataclass(frozen=True, eq=False)
class Report:
    """Report of C constraints over F frames.

    ``residuals`` (C, F) metres or radians, NaN where inactive; ``misses`` (C, F) the same measured on the poses, at
    full activation, active or not (``measured_residuals.full_residuals``); ``winners`` (C, F) the blocker of each
    constraint: the row of a constraint, or one of the constants above; ``slides`` and ``heights`` (9, F) metres, a row
    a ``ContactPoint``, NaN without contact; ``knee_speeds`` (2, F) rad/s; ``mass_margins`` (F,) metres from the centre
    of mass to the edge of the support polygon, negative outside, NaN in flight.
    """

    residuals: FloatArray
    misses: FloatArray
    winners: IntArray
    slides: FloatArray
    heights: FloatArray
    knee_speeds: FloatArray
    mass_margins: FloatArray


def report_of(standing: Standing, request: AdaptRequest, adapted: AdaptedMotion) -> Report:
    """Report of ``adapted``, the answer to ``request`` on its grounded motion, in any window."""
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    stands = standing_points(standing.contacts, request.motion.frame_count)[:, window]
    areas = outlines(adapted.positions[:], adapted.rotations[:], stands, adapted.morphology)
    slides, heights = contact_tracks(adapted, standing.contacts, request.ground)
    return Report(
        adapted.residuals,
        full_residuals(request.constraints, targets_of(standing, request.constraints, window, request.tracks), adapted),
        winners(standing, request.constraints, request.tracks, adapted, request.eased),
        slides,
        heights,
        knee_speeds(adapted),
        support_margins(areas, centre_of_mass(adapted)[:, :2]),
    )


def winners(
    standing: Standing, constraints: Sequence[Constraint], tracks: Tracks, adapted: AdaptedMotion, eased: bool = False
) -> IntArray:
    """Blockers (C, F) of each constraint; see ``Report``."""
    if not constraints:
        return np.empty(adapted.residuals.shape, dtype=np.int64)
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    activations = constraint_activations(constraints, standing)
    limits = np.array([[MET_BY_UNIT[each.unit]] for each in constraints])
    frames, sample_of = samples(adapted.residuals, limits, round(SAMPLE_SECONDS * standing.motion.frame_rate))
    search = _BlockerSearch(
        standing, constraints, activations, tracks, window.start + frames, adapted.residuals[:, frames], limits
    )
    found = search.winners(eased)[:, sample_of]
    target = np.array([each.activation.at(standing.motion.times[window]) for each in constraints])
    free = contact_release(constraints, standing, window)
    found[(target > 0.0) & (free < 1.0)] = BLOCKED_BY_CONTACTS  # what is about a limb gives way to that limb's contacts
    return found


def samples(residuals: FloatArray, limits: FloatArray, apart: int) -> tuple[IntArray, IntArray]:
    """Sampled frames (n,), at most ``apart`` frames from each other, and the index (F,) of the sample for each frame.

    A sample has the same active and missed constraints as its frames: of ``residuals`` (C, F), NaN where inactive,
    beyond ``limits`` (C, 1).
    """
    state = np.concatenate([np.isfinite(residuals), residuals > limits])
    changes = np.flatnonzero((state[:, 1:] != state[:, :-1]).any(axis=0)) + 1
    runs = np.split(np.arange(residuals.shape[1]), changes)
    parts = [part for run in runs for part in np.array_split(run, math.ceil(len(run) / max(apart, 1)))]
    return np.array([part[len(part) // 2] for part in parts]), np.repeat(range(len(parts)), list(map(len, parts)))


class _BlockerSearch:
    """Search for the blockers of C constraints in n frames: the best candidate so far, and its gain."""

    def __init__(
        self,
        standing: Standing,
        constraints: Sequence[Constraint],
        activations: FloatArray,
        tracks: Tracks,
        frames: IntArray,
        residuals: FloatArray,
        limits: FloatArray,
    ) -> None:
        """``activations`` (C, F) of the whole motion, ``frames`` (n,) of it, their ``residuals`` (C, n)."""
        self._standing, self._constraints, self._activations, self._tracks = standing, constraints, activations, tracks
        self._frames, self._residuals = frames, residuals
        self._missed = residuals > limits
        self._found = np.where(self._missed, BLOCKED_BY_REACH, BLOCKED_BY_NOTHING)
        self._best = np.maximum(limits, RELEVANT_FRACTION * np.nan_to_num(residuals))

    def winners(self, eased: bool) -> IntArray:
        """Blockers (C, n) as in ``Report.winners``; ``eased`` if the motion was smoothed."""
        ranks, acting = np.array([each.priority for each in self._constraints]), np.isfinite(self._residuals)
        everybody, always = np.arange(len(ranks)), np.ones(len(self._frames), dtype=np.bool_)
        if eased:
            self._weigh(BLOCKED_BY_SMOOTHING, everybody, everybody, always)
        self._weigh(BLOCKED_BY_CONTACTS, everybody, everybody, always, Bound(by_contacts=False))
        self._weigh(BLOCKED_BY_LIMITS, everybody, everybody, always, Bound(by_limits=False))
        for row in everybody.tolist():
            others = everybody[everybody != row]
            self._weigh(row, others, others[ranks[others] >= ranks[row]], acting[row])
        highest_first = np.argsort(ranks, kind="stable")
        for row in np.flatnonzero((self._found == BLOCKED_BY_REACH).any(axis=1)).tolist():
            self._weigh_together(row, highest_first[(ranks[highest_first] <= ranks[row]) & (highest_first != row)])
        return self._found

    def _weigh(self, name: int, asked: IntArray, rows: IntArray, acts: Mask, bound: Bound = BOUND) -> None:
        """Note ``name`` where what it leaves out ``acts`` (n,), and those ``asked`` alone miss less of ``rows`` than in
        any answer so far.
        """
        numbers = np.flatnonzero(acts & self._missed[rows].any(axis=0))
        if len(numbers):
            left = self._residuals_at(asked, numbers, bound)[np.isin(asked, rows)]
            here = np.ix_(rows, numbers)
            gain = self._residuals[here] - left
            better = self._missed[here] & (gain > self._best[here])
            self._found[here] = np.where(better, name, self._found[here])
            self._best[here] = np.where(better, gain, self._best[here])

    def _weigh_together(self, row: int, above: IntArray) -> None:
        """Where several stand in the way of one, and none of them alone, the first of them is named."""
        helped = self._found[row] == BLOCKED_BY_REACH
        alone = self._residuals_at(np.array([row]), np.flatnonzero(helped), BOUND)[0]
        helped[helped] = self._residuals[row, helped] - alone > self._best[row, helped]
        for other in above:
            here = helped & np.isfinite(self._residuals[other])
            self._found[row, here] = other
            helped &= ~here

    def _residuals_at(self, asked: IntArray, numbers: IntArray, bound: Bound) -> FloatArray:
        """(A, m) what those ``asked`` (A,) are missed by in some of the frames (m,), each solved by itself."""
        frames, constraints = self._frames[numbers], [self._constraints[row] for row in asked]
        window = slice(int(frames[0]), int(frames[-1]) + 1)
        solved = SolvedWindow(self._standing, constraints, self._activations[asked], self._tracks, bound, window)
        solved.solve(frames - window.start)
        return solved.residuals[:, frames - window.start]
