"""An axis of a segment within a cone about a direction."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.upright import UprightConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.course import Course, Unsolved
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.points import point_indices
from studio.core.solver.asking.rows import Rows
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: UprightConstraint) -> None:
    """Its axis stands where others have their second offset, its cone where they have a distance."""
    rows.asked["offsets"][c, 1] = constraint.axis
    rows.places[c], rows.distances[c] = np.array([constraint.direction]), np.array([constraint.cone])


def missed(constraint: UprightConstraint, _targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) radians beyond the cone."""
    segment = point_indices(constraint.point, adapted.morphology.layout)[1]
    return constraint.lean(adapted.rotations[:, segment])


def course(unsolved: Unsolved) -> Course:
    """How far the axis is beyond its cone, towards its direction."""
    direction, cone = unsolved.rows.places[unsolved.c], unsolved.rows.distances[unsolved.c][:, None]
    axes = unsolved.segment @ unsolved.row["offsets"][1]
    lean = np.arccos(np.clip(np.sum(axes * direction, axis=1, keepdims=True), -1.0, 1.0))
    return (direction - axes) * np.maximum(lean - cone, 0.0) / np.maximum(lean, 1e-9), 1.0


UPRIGHT = Kind(goals.UPRIGHT_TASK, put, course, missed)
