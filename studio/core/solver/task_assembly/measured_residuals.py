"""Residuals of constraints measured on given poses, at full activation."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.target import follows_of, own_places_of
from studio.core.curves.activation import LEAST_FULL_ACTIVATION
from studio.core.solver.grounding.support_polygon import mass_path
from studio.core.solver.performers.followed_tracks import own_track
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.kinds.known import solver_kind_of
from studio.core.solver.task_assembly.kinds.orientation import angle_to
from studio.core.solver.task_assembly.kinds.position import distance_to
from studio.core.solver.task_assembly.shared_goals import groups_with_shared_goal, weighted_mean
from studio.core.solver.task_assembly.tracks import Targets, Track, raised_along_arms


def full_residuals(constraints: Sequence[Constraint], targets: Targets, adapted: AdaptedMotion) -> NDArray[np.float64]:
    """Residuals (C, F) in metres or radians at full activation; ``targets`` are those of the same frames.

    Constraints that share a goal are measured to that goal. Areas and self-collision constraints have the residuals of
    the solver, NaN where inactive.
    """
    measured = np.array(adapted.residuals)
    for row, constraint in zip(measured, constraints, strict=True):
        kind = solver_kind_of(constraint)
        if kind is not None and kind.residual is not None:
            row[:] = kind.residual(constraint, targets, adapted)
    for group in groups_with_shared_goal(constraints):
        _measure_shared(measured, group, constraints, targets, adapted)
    return measured


def _measure_shared(
    measured: NDArray[np.float64],
    group: Sequence[int],
    constraints: Sequence[Constraint],
    targets: Targets,
    adapted: AdaptedMotion,
) -> None:
    """Write the residuals of constraints with a shared goal, to that goal, where they are active."""
    turns = constraints[group[0]].kind == "orientation"
    pulls = np.array(
        [constraints[c].weights_at(targets.times) * constraints[c].activation.at(targets.times) for c in group]
    )
    evaluate, residual_to = (targets.rotations, angle_to) if turns else (targets.positions, distance_to)
    goal = weighted_mean([evaluate(getattr(constraints[c], "target")) for c in group], pulls)  # noqa: B009 - both have
    for c, pull in zip(group, pulls, strict=True):
        measured[c] = np.where(pull > 0.0, residual_to(goal, constraints[c], adapted), measured[c])


def with_residuals_remeasured(adapted: AdaptedMotion, request: AdaptRequest) -> AdaptedMotion:
    """``adapted`` with residuals measured against the ``final_tracks`` of ``request``.

    Only those of fully active constraints that follow these tracks are replaced.
    """
    final, unasked = request.final_tracks, adapted.unconstrained
    shared = set(chain.from_iterable(groups_with_shared_goal(request.constraints)))  # measured together or not at all
    rows = [
        row
        for row, each in enumerate(request.constraints)
        if row not in shared and not final.keys().isdisjoint(follows_of(each))
    ]
    if not rows or unasked is None:
        return adapted
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    followers, body = [request.constraints[row] for row in rows], request.morphology
    known = {
        follow: raised_along_arms(
            follow, track.in_frames(window), unasked.positions[window], body.first_frame_body.layout
        )
        for follow, track in final.items()
        if isinstance(track, Track)
    }
    for place in (place for each in followers for place in own_places_of(each)):
        known[place] = own_track(place, unasked, body, adapted.frame_rate)
    times = np.arange(window.start, window.stop) / adapted.frame_rate
    masses = partial(mass_path, unasked.positions[window], body.first_frame_body)
    targets = Targets(times, known, masses, body.leg_length)
    before = adapted.residuals[rows]
    measured = full_residuals(followers, targets, replace(adapted, residuals=before))
    full = np.array([each.activation.at(times) >= LEAST_FULL_ACTIVATION for each in followers])
    residuals = np.array(adapted.residuals)
    residuals[rows] = np.where(full & np.isfinite(before), measured, before)
    return replace(adapted, residuals=residuals)
