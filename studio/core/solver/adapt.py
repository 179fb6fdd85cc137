"""Adaptation of a clip in one call: scale the motion to a body, ground it, solve its constraints."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import AnimatedMorphology
from studio.core.compact_array import PoseArray, part_of
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.runs import runs_in
from studio.core.solver.grounding.grounded_motion import GroundedMotion, grounded_motion_of
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.smoothing.level_smoothing import SMOOTHING_HORIZON_SECONDS
from studio.core.solver.solved_window import ALL_LIMITS, SolvedWindow, SolverLimits
from studio.core.solver.task_assembly.contact_release import constraint_activations
from studio.core.solver.task_assembly.lifted_ends import constrained_ends, lift_ends
from studio.core.solver.task_assembly.measured_residuals import with_residuals_remeasured
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.tracks import Tracks

FloatArray = NDArray[np.float64]


def adapt(request: AdaptRequest, first: int = 0, last: int | None = None) -> AdaptedMotion:
    """Adapted motion of ``request``, frames ``first`` to ``last`` (both included, all by default).

    Any window gives the same poses as the whole clip.
    """
    return solve_request(grounded_motion(request), request, first, last)


def grounded_motion(request: AdaptRequest, standing: GroundedMotion | None = None) -> GroundedMotion:
    """Grounded motion of ``request``, including its manual corrections below the constraints.

    ``standing`` is the grounded motion without corrections, if it is known already.
    """
    standing = standing or grounded_motion_of(request)
    if not request.corrections:
        return standing
    from studio.core.solver.correction_layer import with_corrections_below

    return with_corrections_below(standing, request.corrections)


def solve_request(
    standing: GroundedMotion, request: AdaptRequest, first: int = 0, last: int | None = None
) -> AdaptedMotion:
    """Adapted motion of ``request`` on its grounded motion ``standing``, frames ``first`` to ``last`` (both included).

    Includes the manual corrections above the constraints.
    """
    adapted = solve_constraints(standing, request.constraints, first, last, request.tracks, eased=request.eased)
    if any(each.above for each in request.corrections):
        from studio.core.solver.correction_layer import with_corrections_above

        adapted = with_corrections_above(adapted, standing, request)
    return with_residuals_remeasured(adapted, request) if request.final_tracks else adapted


def solve_constraints(
    standing: GroundedMotion,
    constraints: Sequence[Constraint],
    first: int = 0,
    last: int | None = None,
    tracks: Tracks = MappingProxyType({}),
    *,
    bound: SolverLimits = ALL_LIMITS,
    eased: bool = False,
) -> AdaptedMotion:
    """Solve ``constraints`` on a grounded motion, frames ``first`` to ``last`` (both included) (K05 section 9).

    ``tracks`` cover the whole motion for all targets outside the body; StudioError if one is missing. ``bound`` lets a
    report solve without contacts or joint limits. Every frame is solved from its own pose alone; with ``eased``, frames
    around acceleration peaks are smoothed in time (METHOD (36)). Frames without active constraints nearby are
    unchanged.
    """
    count = standing.motion.frame_count
    window = slice(first, count if last is None else min(last + 1, count))
    positions, rotations = part_of(standing.positions, window), part_of(standing.rotations, window)
    if not constraints:
        return _answer(standing, first, positions, rotations, np.empty((0, len(positions))))
    activations = constraint_activations(constraints, standing)
    acts, self_contact = np.asarray((activations > 0.0).any(axis=0)), standing.self_contact
    self_contact = self_contact if self_contact and self_contact.clearances else None
    pushed = self_contact.correction_weights(acts) if self_contact else acts
    positions, rotations = positions.copy(), rotations.copy()
    residuals, acting = np.full((len(constraints), len(positions)), np.nan), np.asarray(activations.any(axis=1))
    asked = [constraint for constraint, active in zip(constraints, acting, strict=True) if active]
    window_of = partial(SolvedWindow, standing, asked, activations[acting], tracks, bound)
    free_ends = 1.0 - constrained_ends(constraints, activations)
    for run in runs_in(window, acts, math.ceil(2.0 * SMOOTHING_HORIZON_SECONDS * standing.motion.frame_rate)):
        touched = self_contact.affecting_frames(run) if self_contact else run
        solved = _solved(window_of, standing, touched, eased)
        posed = solved.solution(touched)
        if self_contact:
            free = pushed[touched, None, None] * (1.0 - solved.arm_activations(touched))
            self_contact.push_out(touched, free, *posed[:2])
        lift_ends(standing, touched, free_ends[:, touched], *posed[:2])
        rows, own = (slice(run.start - frames.start, run.stop - frames.start) for frames in (window, touched))
        positions[rows], rotations[rows], residuals[acting, rows] = posed[0][own], posed[1][own], posed[2][:, own]
    return _answer(standing, first, positions, rotations, residuals)


def _solved(
    window_of: Callable[[slice], SolvedWindow], standing: GroundedMotion, touched: slice, eased: bool
) -> SolvedWindow:
    """Solved window that contains the frames ``touched`` and all frames that affect their smoothing."""
    seen = standing.around(touched, SMOOTHING_HORIZON_SECONDS if eased else 0.0)
    solved = window_of(seen)
    solved.solve()
    if eased and solved.may_exceed_peaks and solved.has_smoothed_frames(touched):
        while not is_frame_subset(
            wide := standing.around(solved.with_smoothing_runs(touched), SMOOTHING_HORIZON_SECONDS), seen
        ):
            seen = standing.around(wide, 0.5 * (wide.stop - wide.start) / standing.motion.frame_rate)
            solved = window_of(seen)
            solved.solve()
        solved.smooth_runs(touched)
    return solved


def is_frame_subset(frames: slice, others: slice) -> bool:
    """True if all frames of ``frames`` are among ``others``."""
    return bool(others.start <= frames.start and frames.stop <= others.stop)


def _answer(
    standing: GroundedMotion, first: int, positions: PoseArray, rotations: PoseArray, residuals: FloatArray
) -> AdaptedMotion:
    """``AdaptedMotion`` of solved poses that begin at frame ``first``."""
    body = standing.morphology
    return AdaptedMotion(
        morphology=body.first_frame_body,
        frame_rate=standing.motion.frame_rate,
        first_frame=first,
        positions=positions,
        rotations=rotations,
        residuals=residuals,
        animated=body if isinstance(body, AnimatedMorphology) else None,
        volume=standing.volume,
        unconstrained=standing.unconstrained,
        contacts=standing.contacts,
    )


def body_point_positions(point: BodyPoint, adapted: AdaptedMotion) -> FloatArray:
    """Positions (F, 3) of a body point in an adapted motion, in metres in the motion's space."""
    origin, segment = point_indices(point, adapted.morphology.layout)
    return np.asarray(adapted.positions[:, origin] + adapted.rotations[:, segment] @ np.array(point.offset))
