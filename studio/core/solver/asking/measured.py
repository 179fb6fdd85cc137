"""By how much constraints are missed, measured on poses as they are, whoever made them and whether they act or not."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import BalanceConstraint
from studio.core.constraints.base import BodyPoint, Constraint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.constraints.follow import FollowBody
from studio.core.constraints.look_at import LookAtConstraint
from studio.core.constraints.orientation import OrientationConstraint
from studio.core.constraints.position import PositionConstraint
from studio.core.constraints.upright import UprightConstraint
from studio.core.rotations import to_matrix
from studio.core.solver.asking.packing import point_indices
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.standing.support import mass_path

FloatArray = NDArray[np.float64]


def misses(constraints: Sequence[Constraint], targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(C, F) metres or radians by which each is missed at full activation; ``targets`` are those of these frames.

    Areas, and what keeps clear of the body, are as the solver has them: NaN where they do not act.
    """
    measured = np.array(adapted.residuals)
    for row, constraint in zip(measured, constraints, strict=True):
        match constraint:
            case PositionConstraint():
                away = _place(constraint.point, adapted) - _wanted(constraint.target, targets, adapted)
                row[:] = np.linalg.norm(away, axis=1)
            case OrientationConstraint():
                segment = point_indices(constraint.point, adapted.morphology.layout)[1]
                row[:] = _angle(adapted.rotations[:, segment], _turns(constraint.target, targets, adapted))
            case UprightConstraint():
                segment = point_indices(constraint.point, adapted.morphology.layout)[1]
                row[:] = constraint.lean(adapted.rotations[:, segment])
            case LookAtConstraint():
                segment = point_indices(constraint.point, adapted.morphology.layout)[1]
                ways = _wanted(constraint.target, targets, adapted) - _place(constraint.point, adapted)
                looks = adapted.rotations[:, segment, :, 0]
                across = np.linalg.norm(np.cross(looks, ways), axis=1)
                row[:] = np.arctan2(across, np.sum(looks * ways, axis=1))
            case DistanceConstraint():
                apart = _place(constraint.point, adapted) - _wanted(constraint.other, targets, adapted)
                row[:] = np.abs(np.linalg.norm(apart, axis=1) - targets.numbers(constraint.distance))
            case BalanceConstraint():
                row[:] = _off_balance(constraint, targets, adapted)
    return measured


def _place(point: BodyPoint, adapted: AdaptedMotion) -> FloatArray:
    """(F, 3) where a point of the body is."""
    origin, segment = point_indices(point, adapted.morphology.layout)
    return np.asarray(adapted.positions[:, origin] + adapted.rotations[:, segment] @ np.array(point.offset))


def _wanted(target: object, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F or 1, 3) where something is to be: a place, or a point of the body itself."""
    if isinstance(target, FollowBody | BodyPoint):
        return _place(target.point if isinstance(target, FollowBody) else target, adapted)
    return targets.places(target)  # type: ignore[arg-type]


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


def _off_balance(constraint: BalanceConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) metres of the centre of mass from where it is to be, along the ground unless its height is asked too."""
    wanted = np.array(targets.masses())
    if isinstance(constraint.place, tuple) and len(constraint.place) == 2:
        wanted[:, :2] = constraint.place
    elif constraint.place is not None:
        wanted = _wanted(constraint.place, targets, adapted)
    axes = 3 if constraint.vertical else 2
    away = mass_path(adapted.positions[:], adapted.morphology) - wanted
    return np.asarray(np.linalg.norm(away[:, :axes], axis=1))
