"""Quality of each task: reachable targets met, others neared, feet held, balance kept, nothing jerked."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.optimum import excess
from studio.cli.bench_cases import BenchCase
from studio.core.body.canonical import BodyLayout
from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import Constraint
from studio.core.grounds.ground import Ground
from studio.core.normalized.transition import QUIET_PEAK
from studio.core.quality.metrics import angular_acceleration, centre_of_mass, contact_quality
from studio.core.solver.adapt import adapt, solve_constraints
from studio.core.solver.grounding.grounded_motion import GroundedMotion, ground_motion
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]

SAMPLES = 12
"""Frames of a clip at which the numerical optimum is sought."""
REACHED = 2e-4
"""Metres of miss that need no excuse."""


@dataclass(frozen=True)
class Quality:
    """Worst values of one task on one clip; None where the task has nothing of the kind. Lengths in millimetres."""

    reachable: float | None
    """Largest miss of what can be reached."""
    slide: float | None
    balance: float | None
    """Largest horizontal distance of the centre of mass from its place."""
    excess: tuple[float, float] | None
    """Median and largest of what unreachable wrists miss beyond the numerical optimum."""
    acceleration: float
    """Largest peak angular acceleration in the body beside the largest in the source."""
    segment_acceleration: float
    """The same of each segment beside itself in the source; of the worst segment."""


def quality(task: BenchCase, source: AdaptedMotion) -> Quality:
    """Solve one task, and judge the answer; ``source`` is the motion on its own actor."""
    request = task.request
    adapted = adapt(request)
    standing = ground_motion(request.motion, request.morphology, request.contacts, request.ground)
    balances = [each for each in request.constraints if isinstance(each, BalanceConstraint)]
    reachable = excesses = None
    if task.reachable:
        reachable = reachable_miss((*balances, task.highest), task, adapted, standing)
    else:
        frames = np.linspace(0, adapted.frame_count - 1, SAMPLES).astype(int).tolist()
        beyond = 1e3 * excess(task, request.constraints, standing, adapted.residuals, frames)
        excesses = float(np.nanmedian(beyond)), float(np.nanmax(beyond))
    balance = None
    if balances:
        before = centre_of_mass(solve_constraints(standing, ()))
        balance = float(1e3 * np.linalg.norm((centre_of_mass(adapted) - before)[:, :2], axis=1).max())
    body, segment = accelerations(adapted, source)
    return Quality(
        reachable=reachable,
        slide=1e3 * contact_quality(adapted, request.contacts, Ground()).slide if request.contacts else None,
        balance=balance,
        excess=excesses,
        acceleration=body,
        segment_acceleration=segment,
    )


def reachable_miss(
    constraints: Sequence[Constraint], task: BenchCase, adapted: AdaptedMotion, standing: GroundedMotion
) -> float:
    """Largest miss, in millimetres, of what can be reached.

    Where the highest wish is missed by more than ``REACHED``, the numerical optimum says how much of that is owed to
    the body; it is asked at frames from the least of these misses to the largest.
    """
    rows = [task.request.constraints.index(each) for each in constraints]
    missed = adapted.residuals[rows[-1]]
    order = np.argsort(missed)[np.searchsorted(np.sort(missed), REACHED, side="right") :]
    doubtful = order[np.unique(np.linspace(0, len(order) - 1, min(len(order), SAMPLES)).astype(int))].tolist()
    owed = excess(task, constraints, standing, adapted.residuals[rows], doubtful) if doubtful else np.zeros(1)
    return float(1e3 * max(missed[missed <= REACHED].max(initial=0.0), np.nanmax(owed)))


def accelerations(adapted: AdaptedMotion, source: AdaptedMotion) -> tuple[float, float]:
    """Ratios of peak angular accelerations: of all segments together, and of the worst segment beside itself.

    A segment whose own peak in the source is below ``metrics.QUIET`` counts as having that.
    """
    now = angular_acceleration(adapted.rotations, adapted.frame_rate).max(axis=0)
    before = angular_acceleration(source.rotations[-adapted.frame_count - source.first_frame :], source.frame_rate).max(
        axis=0
    )
    own = np.array([before[k] for k in _matching(adapted.morphology.layout, source.morphology.layout)])
    return float(now.max() / before.max()), float((now / np.maximum(own, QUIET_PEAK)).max())


def _matching(layout: BodyLayout, other: BodyLayout) -> list[int]:
    """For each segment of one layout the segment of another: the same one, vertebrae by their place in the trunk."""
    last, other_last = layout.spine_count - 1, other.spine_count - 1
    spine = [round(k * other_last / last) for k in range(layout.spine_count)]
    return [*spine, *range(other.spine_count, other.segment_count)]
