"""Keep-upright tasks: an axis of a segment within a cone about a direction."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.upright import UprightConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.target_trajectory import TargetTrajectory, UnsolvedTask
from studio.core.solver.task_assembly.task_rows import TaskRecords
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: UprightConstraint) -> None:
    """Write record ``c`` of a keep-upright constraint: the axis as second offset, the direction as target, the cone as
    distance.
    """
    rows.tasks["offsets"][c, 1] = constraint.axis
    rows.positions[c], rows.distances[c] = np.array([constraint.direction]), np.array([constraint.cone])


def residual(constraint: UprightConstraint, _targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Lean (F,) in radians of the axis beyond the cone."""
    segment = point_indices(constraint.point, adapted.morphology.layout)[1]
    return constraint.lean(adapted.rotations[:, segment])


def trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Target trajectory of the axis, from its lean beyond the cone towards the direction."""
    direction, cone = unsolved.rows.positions[unsolved.c], unsolved.rows.distances[unsolved.c][:, None]
    if unsolved.task_record["points"][1] >= 0:
        direction = unsolved.target_rotation[..., 0]
    axes = unsolved.segment_rotations @ unsolved.task_record["offsets"][1]
    lean = np.arccos(np.clip(np.sum(axes * direction, axis=1, keepdims=True), -1.0, 1.0))
    return (direction - axes) * np.maximum(lean - cone, 0.0) / np.maximum(lean, 1e-9), 1.0


UPRIGHT_KIND = SolverKind(goals.UPRIGHT_TASK, write_task, trajectory, residual)
