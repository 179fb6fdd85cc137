"""Orientation tasks: a segment rotated to a target."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.kernels.tasks import goals
from studio.core.rotations import to_matrix
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.target_trajectory import TargetTrajectory, UnsolvedTask
from studio.core.solver.task_assembly.task_rows import TaskRecords
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: OrientationConstraint) -> None:
    """Write record ``c`` of an orientation constraint: its target rotation, or the followed segment."""
    if not rows.set_followed_point(c, constraint.target):
        rows.rotations[c] = rows.targets.rotations(constraint.target)


def residual(constraint: OrientationConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Angle (F,) in radians from the constrained segment to its target."""
    return angle_to(_turns(constraint.target, targets, adapted), constraint, adapted)


def angle_to(goal: FloatArray, constraint: Constraint, adapted: AdaptedMotion) -> FloatArray:
    """Angle (F,) in radians from the constrained segment to ``goal`` (F or 1, 3, 3)."""
    segment = point_indices(constraint.point, adapted.morphology.layout)[1]
    return _angle(adapted.rotations[:, segment], goal)


def _turns(target: object, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Target rotations (F or 1, 3, 3), or those of a followed segment of the body."""
    if isinstance(target, FollowBody):
        segment = point_indices(target.point, adapted.morphology.layout)[1]
        return np.asarray(adapted.rotations[:, segment] @ to_matrix(np.array(target.turn)))
    return targets.rotations(target)  # type: ignore[arg-type]


def _angle(one: FloatArray, other: FloatArray) -> FloatArray:
    """Angle (F,) in radians between rotations (F, 3, 3) and (F or 1, 3, 3)."""
    rotation = np.swapaxes(one, 1, 2) @ other
    axis = [
        rotation[:, 2, 1] - rotation[:, 1, 2],
        rotation[:, 0, 2] - rotation[:, 2, 0],
        rotation[:, 1, 0] - rotation[:, 0, 1],
    ]
    return np.asarray(np.arctan2(np.linalg.norm(axis, axis=0), np.trace(rotation, axis1=1, axis2=2) - 1.0))


def trajectory(unsolved: UnsolvedTask) -> TargetTrajectory:
    """Target trajectory: rotation vectors from the segment to its target."""
    errors = unsolved.target_rotation @ np.swapaxes(unsolved.segment_rotations, 1, 2)
    return np.asarray(Rotation.from_matrix(errors).as_rotvec()), 1.0


ORIENTATION_KIND = SolverKind(goals.ORIENTATION_TASK, write_task, trajectory, residual)
