"""Goals of tasks of one priority on one point, or on the rotation of one segment: their weighted mean.

The kernels meet the first of such tasks. The weighted sum of their squared residuals is least at the weighted mean of
their goals, which is therefore the goal of each. Where weights cross, the point passes from target to target.
"""

from collections import defaultdict
from collections.abc import Hashable

import numpy as np
from numpy.typing import NDArray

from studio.core.kernels.tasks.goals import ORIENTATION_TASK, POSITION_TASK
from studio.core.rotations import angle_between, from_matrix, slerp, to_matrix
from studio.core.solver.asking.task_rows import TaskRecords

FloatArray = NDArray[np.float64]
LEAST_PART = 1e-9
"""Part of the mean below which a target counts for nothing."""


def share_goals(rows: TaskRecords, first: int, activations: FloatArray) -> FloatArray:
    """Give the tasks from row ``first`` on that share a point or a rotation their weighted mean for a goal, and on a
    limb, where only the first of them is solved, their common weight.

    Activations (C, F) are factors of the weights. Returns the shifts (C, F) from target to goal, metres or radians;
    NaN where a target counts for nothing.
    """
    shifts = np.zeros(activations.shape)
    groups: dict[Hashable, list[int]] = defaultdict(list)
    for c in range(first, len(rows.tasks)):
        groups[_ruled(rows.tasks[c], c)].append(c)
    for group in groups.values():
        acting = activations[group]
        several = np.count_nonzero(acting, axis=0) > 1
        if not several.any():
            continue
        pulls = np.array([row * rows.weights[c] for row, c in zip(acting, group, strict=True)])
        totals = np.cumsum(pulls, axis=0)
        fractions = np.divide(pulls, totals, out=np.zeros(pulls.shape), where=totals > 0.0)
        turns = rows.tasks["kind"][group[0]] == ORIENTATION_TASK
        goals, blend, between = (
            (rows.rotations, _blended_rotations, _angles) if turns else (rows.positions, _blended_positions, _distances)
        )
        mean = goals[group[0]]
        for c, fraction in zip(group[1:], fractions[1:], strict=True):
            mean = blend(mean, goals[c], fraction)
        for c, pull in zip(group, pulls, strict=True):
            counts = pull > LEAST_PART * totals[-1]
            shifts[c] = np.where(several, np.where(counts, between(mean, goals[c]), np.nan), 0.0)
            goals[c] = mean
            if rows.tasks["limbs"][c, 0] >= 0:
                common = totals[-1] / np.where(several, acting.max(axis=0), 1.0)
                rows.weights[c] = np.where(several, common, rows.weights[c])
    return shifts


def _ruled(task: np.void, c: int) -> Hashable:
    """Level and point or segment of a task; ``c`` for other kinds, and for goals that depend on the pose."""
    if task["points"][1] < 0 and task["kind"] == POSITION_TASK:
        return int(task["level"]), int(task["points"][0]), int(task["segments"][0]), tuple(task["offsets"][0].tolist())
    if task["points"][1] < 0 and task["kind"] == ORIENTATION_TASK:
        return int(task["level"]), int(task["segments"][0])
    return c


def _blended_positions(one: FloatArray, other: FloatArray, fraction: FloatArray) -> FloatArray:
    """Positions (F, 3) at ``fraction`` (F,) of the way; exactly the ends at 0 and 1."""
    return np.asarray((1.0 - fraction[:, None]) * one + fraction[:, None] * other)


def _blended_rotations(one: FloatArray, other: FloatArray, fraction: FloatArray) -> FloatArray:
    """Rotations (F, 3, 3) at ``fraction`` (F,) of the shortest arc; exactly the ends at 0 and 1."""
    part = fraction[:, None, None]
    between = to_matrix(slerp(from_matrix(one), from_matrix(other), fraction))
    return np.where(part <= 0.0, one, np.where(part >= 1.0, other, between))


def _distances(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(one - other, axis=-1))


def _angles(one: FloatArray, other: FloatArray) -> FloatArray:
    return angle_between(from_matrix(one), from_matrix(other))
