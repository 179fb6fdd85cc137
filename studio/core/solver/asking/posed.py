"""What constraints name, as poses have it: points of the body, places that are wanted."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import BodyPoint
from studio.core.constraints.follow import FollowBody
from studio.core.solver.asking.points import point_indices
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def place_of(point: BodyPoint, adapted: AdaptedMotion) -> FloatArray:
    """(F, 3) where a point of the body is."""
    origin, segment = point_indices(point, adapted.morphology.layout)
    return np.asarray(adapted.positions[:, origin] + adapted.rotations[:, segment] @ np.array(point.offset))


def wanted_place(target: object, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F or 1, 3) where something is to be: a place, or a point of the body itself."""
    if isinstance(target, FollowBody | BodyPoint):
        return place_of(target.point if isinstance(target, FollowBody) else target, adapted)
    return targets.places(target)  # type: ignore[arg-type]
