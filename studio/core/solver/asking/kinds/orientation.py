"""A segment turned one way."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from studio.core.constraints.follow import FollowBody
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.kernels.tasks import goals
from studio.core.rotations import to_matrix
from studio.core.solver.asking.course import Course, Unsolved
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.points import point_indices
from studio.core.solver.asking.rows import Rows
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: OrientationConstraint) -> None:
    """Its turn, or what it follows."""
    if not rows.put_followed(c, constraint.target):
        rows.turns[c] = rows.targets.turns(constraint.target)


def missed(constraint: OrientationConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) radians."""
    segment = point_indices(constraint.point, adapted.morphology.layout)[1]
    return _angle(adapted.rotations[:, segment], _turns(constraint.target, targets, adapted))


def _turns(target: object, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    if isinstance(target, FollowBody):
        segment = point_indices(target.point, adapted.morphology.layout)[1]
        return np.asarray(adapted.rotations[:, segment] @ to_matrix(np.array(target.turn)))
    return targets.turns(target)  # type: ignore[arg-type]


def _angle(one: FloatArray, other: FloatArray) -> FloatArray:
    """(F,) radians between rotations (F, 3, 3) and (F or 1, 3, 3)."""
    turn = np.swapaxes(one, 1, 2) @ other
    axis = [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]]
    return np.asarray(np.arctan2(np.linalg.norm(axis, axis=0), np.trace(turn, axis1=1, axis2=2) - 1.0))


def course(unsolved: Unsolved) -> Course:
    """The turn from where the segment is, as a rotation vector."""
    errors = unsolved.wanted_turn @ np.swapaxes(unsolved.segment, 1, 2)
    return np.asarray(Rotation.from_matrix(errors).as_rotvec()), 1.0


ORIENTATION = Kind(goals.ORIENTATION_TASK, put, course, missed)
