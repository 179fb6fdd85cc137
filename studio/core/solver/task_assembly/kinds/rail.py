"""Rail tasks: a point on a line or a plane, solved as an area of that shape."""

import numpy as np

from studio.core.constraints.rail import RailConstraint, RailShape
from studio.core.kernels.tasks import area_shapes, goals
from studio.core.solver.task_assembly.kinds.kind import SolverKind
from studio.core.solver.task_assembly.target_trajectory import point_trajectory
from studio.core.solver.task_assembly.task_rows import TaskRecords

_SHAPES = {
    RailShape.LINE: (area_shapes.LINE_SHAPE, area_shapes.INSIDE_AREA),
    RailShape.PLANE: (area_shapes.HALF_SPACE_SHAPE, area_shapes.ON_AREA_SURFACE),
}


def write_task(rows: TaskRecords, c: int, constraint: RailConstraint) -> None:
    """Write record ``c`` of a rail constraint: an area with the rail's centre and the rotation that takes x to its
    direction.
    """
    if not rows.set_followed_point(c, constraint.centre):
        rows.positions[c] = rows.targets.positions(constraint.centre)
    rows.rotations[c] = rows.targets.rail_rotations(constraint)
    half = constraint.length / 2 * np.array(constraint.direction)
    rows.areas[c, : area_shapes.AREA_NUMBERS] = *_SHAPES[constraint.shape], *np.zeros(3), *half, 0.0, *np.eye(3).ravel()


RAIL_KIND = SolverKind(goals.AREA_TASK, write_task, point_trajectory, enters=True)
