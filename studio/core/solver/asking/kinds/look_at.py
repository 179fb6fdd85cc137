"""A segment's x axis, begun at a point, through a place."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.look_at import LookAtConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.course import Course, Unsolved
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.points import point_indices
from studio.core.solver.asking.posed import place_of, wanted_place
from studio.core.solver.asking.rows import Rows
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: LookAtConstraint) -> None:
    """It turns what carries the eyes, and no limb."""
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


def course(unsolved: Unsolved) -> Course:
    """From where the eyes look to where they are to look, on a unit sphere."""
    way = unsolved.wanted - unsolved.place
    return way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9) - unsolved.segment[..., 0], 1.0


LOOK_AT = Kind(goals.LOOK_AT_TASK, put, course, missed)
