"""Position tasks: a point at a target."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.position import PositionConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.points import limb_of
from studio.core.solver.task_assembly.posed_points import point_positions, target_positions
from studio.core.solver.task_assembly.target_trajectory import point_trajectory
from studio.core.solver.task_assembly.task_rows import TaskRecords, write_end
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: PositionConstraint) -> None:
    """Write record ``c`` of a position constraint: its target, or the followed point.

    A followed point of the own body on another limb becomes a zero distance of both points.
    """
    target = constraint.target
    if isinstance(target, FollowBody) and _is_pair(constraint):
        # Nought metres from where the other point comes to be, by moving this one alone.
        rows.tasks["kind"][c], rows.tasks["end_fractions"][c, 0] = goals.DISTANCE_TASK, 1.0
        write_end(rows.tasks[c], 1, target.point, constraint.chain, rows.layout)
        rows.tasks["limb_weights"][c, 1] = 0.0
        return
    if not rows.set_followed_point(c, target):
        rows.tasks["blends"][c], rows.positions[c] = 1, rows.targets.positions(target)


def _is_pair(constraint: Constraint) -> bool:
    """True if a position follows a point of its own body that is not on the same limb, so that the kernel solves both
    points together.
    """
    if not isinstance(constraint, PositionConstraint) or not isinstance(constraint.target, FollowBody):
        return False
    limb = limb_of(constraint.point.part)
    return limb >= 0 and constraint.chain.limb > 0.0 and limb_of(constraint.target.point.part) != limb


def residual(constraint: PositionConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Distance (F,) in metres from the point to its target."""
    return distance_to(target_positions(constraint.target, targets, adapted), constraint, adapted)


def distance_to(goal: FloatArray, constraint: Constraint, adapted: AdaptedMotion) -> FloatArray:
    """Distance (F,) in metres from the constrained point to ``goal`` (F or 1, 3)."""
    return np.asarray(np.linalg.norm(point_positions(constraint.point, adapted) - goal, axis=1))


POSITION_KIND = SolverKind(goals.POSITION_TASK, write_task, point_trajectory, residual)
