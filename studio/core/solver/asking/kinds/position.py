"""A point at a place."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.position import PositionConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.course import course_of_point
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.points import limb_of
from studio.core.solver.asking.posed import place_of, wanted_place
from studio.core.solver.asking.rows import Rows, put_end
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: PositionConstraint) -> None:
    """Its place, or what it follows: no distance from a point of its own body that another limb carries."""
    target = constraint.target
    if isinstance(target, FollowBody) and _is_pair(constraint):
        # Nought metres from where the other point comes to be, by moving this one alone.
        rows.asked["kind"][c], rows.asked["end_fractions"][c, 0] = goals.DISTANCE_TASK, 1.0
        put_end(rows.asked[c], 1, target.point, constraint.chain, rows.layout)
        rows.asked["limb_weights"][c, 1] = 0.0
        return
    if not rows.put_followed(c, target):
        rows.asked["blends"][c], rows.places[c] = 1, rows.targets.places(target)


def _is_pair(constraint: Constraint) -> bool:
    """Whether a position follows a point of its own body that another limb, or none, carries.

    Then the kernel itself sees to it that it is where the other point comes to be.
    """
    if not isinstance(constraint, PositionConstraint) or not isinstance(constraint.target, FollowBody):
        return False
    limb = limb_of(constraint.point.part)
    return limb >= 0 and constraint.chain.limb > 0.0 and limb_of(constraint.target.point.part) != limb


def missed(constraint: PositionConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) metres."""
    away = place_of(constraint.point, adapted) - wanted_place(constraint.target, targets, adapted)
    return np.asarray(np.linalg.norm(away, axis=1))


POSITION = Kind(goals.POSITION_TASK, put, course_of_point, missed)
