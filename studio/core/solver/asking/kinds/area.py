"""A point outside, inside or on the surface of a shape; by how much it is missed the solver alone knows."""

import numpy as np

from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.areas import area_row
from studio.core.solver.asking.course import course_of_point
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.rows import Rows


def put(rows: Rows, c: int, constraint: AreaConstraint) -> None:
    """Its shape stands beside its row, longer by its field for a mesh."""
    if not rows.put_followed(c, constraint.centre):
        rows.places[c] = rows.targets.places(constraint.centre)
    if constraint.shape is AreaShape.HALF_SPACE:
        rows.turns[c] = rows.targets.tilts(constraint.heading, constraint.centre, constraint.size)
    else:
        rows.turns[c] = rows.targets.headings(constraint.heading, constraint.centre)
    row = area_row(constraint)
    if len(row) > rows.areas.shape[1]:
        rows.areas = np.pad(rows.areas, ((0, 0), (0, len(row) - rows.areas.shape[1])))
    rows.areas[c, : len(row)] = row


AREA = Kind(goals.AREA_TASK, put, course_of_point, enters=True)
