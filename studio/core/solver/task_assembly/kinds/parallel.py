"""Parallel tasks: an axis of a segment within a cone about an axis of another segment."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.follow import FollowBody
from studio.core.constraints.parallel import ParallelConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.kinds import upright
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.points import limb_of, point_indices
from studio.core.solver.task_assembly.task_rows import TaskRecords
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def write_task(rows: TaskRecords, c: int, constraint: ParallelConstraint) -> None:
    """Write record ``c`` of a parallel constraint: a keep-upright task whose direction is fixed to the other segment.

    Rows rotate both segments if both are in the trunk.
    """
    rows.set_followed_point(c, FollowBody(constraint.other))
    rows.tasks["offsets"][c, 1], rows.tasks["relative"][c, :, 0] = constraint.axis, constraint.other_axis
    rows.tasks["end_fractions"][c, 1] = limb_of(constraint.other.part) < 0
    rows.distances[c] = np.array([constraint.cone])


def residual(constraint: ParallelConstraint, _targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Angle (F,) in radians between both axes beyond the cone."""
    layout = adapted.morphology.layout
    one, other = (point_indices(point, layout)[1] for point in (constraint.point, constraint.other))
    return constraint.lean(adapted.rotations[:, one], adapted.rotations[:, other])


PARALLEL_KIND = SolverKind(goals.UPRIGHT_TASK, write_task, upright.trajectory, residual)
