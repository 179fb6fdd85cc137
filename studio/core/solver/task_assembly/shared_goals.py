"""Shared goals of constraints with one priority on one point, or on the rotation of one segment: their weighted mean.

The kernels meet the first of such tasks. The weighted sum of their squared residuals is least at the weighted mean of
their targets, which therefore becomes the goal of each. Where weights cross, the point passes from target to target.
"""

from collections import defaultdict
from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.objections import blended_thing
from studio.core.curves.keyed import KeyedNumber
from studio.core.rotations import from_matrix, slerp, to_matrix
from studio.core.solver.task_assembly.task_rows import TaskRecords

FloatArray = NDArray[np.float64]


def groups_with_shared_goal(constraints: Sequence[Constraint]) -> list[list[int]]:
    """Indices of the constraints of each group that share a goal while several of them are active, at least two a
    group.

    At least one weight of a group is keyed. Constraints with constant weights contradict each other instead, and are
    reported with residuals.
    """
    if not any(isinstance(each.weight, KeyedNumber) for each in constraints):
        return []
    groups: dict[Hashable, list[int]] = defaultdict(list)
    for c, constraint in enumerate(constraints):
        thing = blended_thing(constraint)
        groups[c if thing is None else (constraint.priority, thing)].append(c)
    return [
        group
        for group in groups.values()
        if len(group) > 1 and any(isinstance(constraints[c].weight, KeyedNumber) for c in group)
    ]


def weighted_mean(targets: Sequence[FloatArray], weights: FloatArray) -> FloatArray:
    """Mean of n positions (F or 1, 3), or of n rotations (F or 1, 3, 3) along their shortest arcs, by ``weights`` (n,
    F).

    It is exactly the target that alone has a weight.
    """
    totals = np.cumsum(weights, axis=0)
    fractions = np.divide(weights, totals, out=np.zeros(weights.shape), where=totals > 0.0)
    mean = targets[0]
    for target, fraction in zip(targets[1:], fractions[1:], strict=True):
        mean = (_between_rotations if target.ndim == 3 else _between_positions)(mean, target, fraction)
    return mean


def _between_positions(one: FloatArray, other: FloatArray, fraction: FloatArray) -> FloatArray:
    """Positions (F or 1, 3) at ``fraction`` (F,) from ``one`` to ``other``."""
    return np.asarray((1.0 - fraction[:, None]) * one + fraction[:, None] * other)


def _between_rotations(one: FloatArray, other: FloatArray, fraction: FloatArray) -> FloatArray:
    """Rotations (F or 1, 3, 3) at ``fraction`` (F,) of the shortest arc from ``one`` to ``other``."""
    part = fraction[:, None, None]
    between = to_matrix(slerp(from_matrix(one), from_matrix(other), fraction))
    return np.where(part <= 0.0, one, np.where(part >= 1.0, other, between))


def share_goals(rows: TaskRecords, constraints: Sequence[Constraint], first: int, activations: FloatArray) -> None:
    """Write shared goals into the targets of ``constraints``, which begin at row ``first`` of ``rows``.

    On a limb, where only the first of them is solved, their common weight is written too. ``activations`` (C, F) of all
    rows are factors of the weights.
    """
    for group in groups_with_shared_goal(constraints):
        places = [first + c for c in group]
        acting = activations[places]
        several = np.count_nonzero(acting, axis=0) > 1
        if not several.any():
            continue
        pulls = np.array([row * rows.weights[c] for row, c in zip(acting, places, strict=True)])
        goals = rows.rotations if constraints[group[0]].kind == "orientation" else rows.positions
        mean = weighted_mean([goals[c] for c in places], pulls)
        common = pulls.sum(axis=0) / np.where(several, acting.max(axis=0), 1.0)
        for c in places:
            goals[c] = mean
            if rows.tasks["limbs"][c, 0] >= 0:
                rows.weights[c] = np.where(several, common, rows.weights[c])
