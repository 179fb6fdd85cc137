"""Look-at tasks: a segment's x axis, from a point of it, through a target."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.look_at import LookAtConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.posed_points import point_positions, target_positions
from studio.core.solver.task_assembly.target_trajectory import TargetTrajectory, UnsolvedTask
from studio.core.solver.task_assembly.task_rows import TaskRecords
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: LookAtConstraint) -> None:
    """Write record ``c`` of a look-at constraint: its target. The task moves the parents of the eyes, and no limb."""
    if not rows.set_followed_point(c, constraint.target):
        rows.positions[c] = rows.targets.positions(constraint.target)
    rows.tasks["limbs"][c, 0] = -1


def residual(constraint: LookAtConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Angle (F,) in radians from the gaze to the target."""
    segment = point_indices(constraint.point, adapted.morphology.layout)[1]
    displacements = target_positions(constraint.target, targets, adapted) - point_positions(constraint.point, adapted)
    looks = adapted.rotations[:, segment, :, 0]
    across = np.linalg.norm(np.cross(looks, displacements), axis=1)
    return np.asarray(np.arctan2(across, np.sum(looks * displacements, axis=1)))


def trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Target trajectory of the gaze direction on the unit sphere."""
    displacement = unsolved.target_positions - unsolved.point_positions
    return displacement / np.maximum(
        np.linalg.norm(displacement, axis=1, keepdims=True), 1e-9
    ) - unsolved.segment_rotations[..., 0], 1.0


LOOK_AT_KIND = SolverKind(goals.LOOK_AT_TASK, write_task, trajectory, residual)
