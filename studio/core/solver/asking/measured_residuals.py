"""Residuals of constraints measured on given poses, active or not."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.target import follows_of, own_places_of
from studio.core.curves.activation import FULLY_ACTIVE
from studio.core.solver.asking.kinds.known import solver_kind_of
from studio.core.solver.asking.tracks import Targets, Track
from studio.core.solver.performers.followed_tracks import own_track
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.standing.support_polygon import mass_path


def full_residuals(constraints: Sequence[Constraint], targets: Targets, adapted: AdaptedMotion) -> NDArray[np.float64]:
    """Residuals (C, F) in metres or radians at full activation; ``targets`` are those of these frames.

    Areas and self-collision constraints have the solver's residuals: NaN where inactive.
    """
    measured = np.array(adapted.residuals)
    for row, constraint in zip(measured, constraints, strict=True):
        kind = solver_kind_of(constraint)
        if kind is not None and kind.residual is not None:
            row[:] = kind.residual(constraint, targets, adapted)
    return measured


def with_residuals_remeasured(adapted: AdaptedMotion, request: AdaptRequest) -> AdaptedMotion:
    """``adapted`` with residuals measured on the ``final_tracks`` of ``request``, for constraints that follow these and
    are fully active.
    """
    final, unasked = request.final_tracks, adapted.unconstrained
    rows = [row for row, each in enumerate(request.constraints) if not final.keys().isdisjoint(follows_of(each))]
    if not rows or unasked is None:
        return adapted
    window = slice(adapted.first_frame, adapted.first_frame + adapted.frame_count)
    followers, body = [request.constraints[row] for row in rows], request.morphology
    known = {follow: track.in_frames(window) for follow, track in final.items() if isinstance(track, Track)}
    for place in (place for each in followers for place in own_places_of(each)):
        known[place] = own_track(place, unasked, body, adapted.frame_rate)
    times = np.arange(window.start, window.stop) / adapted.frame_rate
    masses = partial(mass_path, unasked.positions[window], body.first_frame_body)
    targets = Targets(times, known, masses, body.leg_length)
    before = adapted.residuals[rows]
    measured = full_residuals(followers, targets, replace(adapted, residuals=before))
    full = np.array([each.activation.at(times) >= FULLY_ACTIVE for each in followers])
    residuals = np.array(adapted.residuals)
    residuals[rows] = np.where(full & np.isfinite(before), measured, before)
    return replace(adapted, residuals=residuals)
