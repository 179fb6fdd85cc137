"""Rail tasks: a point on a line or on a plane, as an area of that shape."""

import numpy as np

from studio.core.constraints.rail import RailConstraint, RailShape
from studio.core.kernels.tasks import area_shapes, goals
from studio.core.solver.asking.kinds.kind import SolverKind
from studio.core.solver.asking.target_trajectory import point_trajectory
from studio.core.solver.asking.task_rows import TaskRecords

_SHAPES = {
    RailShape.LINE: (area_shapes.LINE_SHAPE, area_shapes.INSIDE_AREA),
    RailShape.PLANE: (area_shapes.HALF_SPACE_SHAPE, area_shapes.ON_AREA_SURFACE),
}


def write_task(rows: TaskRecords, c: int, constraint: RailConstraint) -> None:
    """Write the rail as an area, with its centre and the rotation that takes x to its direction."""
    if not rows.set_followed_point(c, constraint.centre):
        rows.positions[c] = rows.targets.positions(constraint.centre)
    rows.rotations[c] = rows.targets.tilted_rotations(0.0, constraint.centre, constraint.direction)
    half = constraint.length / 2 * np.array(constraint.direction)
    rows.areas[c, : area_shapes.AREA_NUMBERS] = *_SHAPES[constraint.shape], *np.zeros(3), *half, 1.0, 0.0, 0.0


RAIL_KIND = SolverKind(goals.AREA_TASK, write_task, point_trajectory, enters=True)
