"""Positions of constrained points and their targets in given poses."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowBody
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.points import point_indices
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


def point_positions(point: BodyPoint, adapted: AdaptedMotion) -> FloatArray:
    """Positions (F, 3) in metres of a point of the body."""
    origin, segment = point_indices(point, adapted.morphology.layout)
    return np.asarray(adapted.positions[:, origin] + adapted.rotations[:, segment] @ np.array(point.offset))


def target_positions(target: object, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """Target positions (F or 1, 3) in metres; of a target on the own body, the positions of the followed point."""
    if isinstance(target, FollowBody | BodyPoint):
        return point_positions(target.point if isinstance(target, FollowBody) else target, adapted)
    return targets.positions(target)  # type: ignore[arg-type]
