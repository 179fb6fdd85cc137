"""Distance tasks: two points of the body, or one and a fixed position."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import BodyPoint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.posed_points import point_positions, target_positions
from studio.core.solver.task_assembly.target_trajectory import TargetTrajectory, UnsolvedTask
from studio.core.solver.task_assembly.task_rows import TaskRecords, write_end
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: DistanceConstraint) -> None:
    """Write record ``c`` of a distance constraint: both ends and the distance.

    If both ends may move, each makes a part of the correction.
    """
    row = rows.tasks[c]
    rows.distances[c] = rows.targets.numbers(constraint.distance)
    if isinstance(constraint.other, BodyPoint):
        write_end(row, 1, constraint.other, constraint.chain, rows.layout)
        # A leg comes to meet a hand only when it is asked for itself: the own thigh stays where it is.
        if row["limbs"][0] < 2 <= row["limbs"][1]:
            row["limb_weights"][1] = 0.0
    else:
        rows.positions[c] = rows.targets.positions(constraint.other)
    free = np.array([row["limbs"][end] >= 0 and row["limb_weights"][end, 0] > 0.0 for end in range(2)], dtype=float)
    row["end_fractions"] = free / max(free.sum(), 1.0)


def residual(constraint: DistanceConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Absolute difference (F,) in metres between the distance of both ends and its target."""
    apart = point_positions(constraint.point, adapted) - target_positions(constraint.other, targets, adapted)
    return np.asarray(np.abs(np.linalg.norm(apart, axis=1) - targets.numbers(constraint.distance)))


def trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Target trajectory of the distance between both ends."""
    now = np.linalg.norm(unsolved.point_positions - unsolved.target_positions, axis=1, keepdims=True)
    return unsolved.rows.distances[unsolved.c][:, None] - now, goals.RADIAN_LENGTH


DISTANCE_KIND = SolverKind(goals.DISTANCE_TASK, write_task, trajectory, residual)
