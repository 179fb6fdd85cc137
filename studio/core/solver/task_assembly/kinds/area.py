"""Area tasks: a point outside, inside or on the surface of a shape."""

import numpy as np

from studio.core.constraints.area import AreaConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.task_assembly.area_rows import area_row
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.target_trajectory import point_trajectory
from studio.core.solver.task_assembly.task_rows import TaskRecords


def write_task(rows: TaskRecords, c: int, constraint: AreaConstraint) -> None:
    """Write record ``c`` of an area constraint: the shape, followed by its distance field for a mesh."""
    if not rows.set_followed_point(c, constraint.centre):
        rows.positions[c] = rows.targets.positions(constraint.centre)
    rows.rotations[c] = rows.targets.area_rotations(constraint)
    row = area_row(constraint)
    if len(row) > rows.areas.shape[1]:
        rows.areas = np.pad(rows.areas, ((0, 0), (0, len(row) - rows.areas.shape[1])))
    rows.areas[c, : len(row)] = row


AREA_KIND = SolverKind(goals.AREA_TASK, write_task, point_trajectory, enters=True)
