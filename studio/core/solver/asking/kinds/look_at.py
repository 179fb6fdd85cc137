"""A segment's x axis, begun at a point, through a place."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.look_at import LookAtConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.points import point_indices
from studio.core.solver.asking.posed import place_of, wanted_place
from studio.core.solver.asking.rows import Rows
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: LookAtConstraint) -> None:
    """It turns what carries the eyes, and no limb."""
    rows.asked["kind"][c] = goals.LOOK_AT
    if not rows.put_followed(c, constraint.target):
        rows.places[c] = rows.targets.places(constraint.target)
    rows.asked["limbs"][c, 0] = -1


def missed(constraint: LookAtConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) radians."""
    segment = point_indices(constraint.point, adapted.morphology.layout)[1]
    ways = wanted_place(constraint.target, targets, adapted) - place_of(constraint.point, adapted)
    looks = adapted.rotations[:, segment, :, 0]
    across = np.linalg.norm(np.cross(looks, ways), axis=1)
    return np.asarray(np.arctan2(across, np.sum(looks * ways, axis=1)))


LOOK_AT = Kind(put, missed)
