"""Two points of the body, or one and a place, so far apart."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import BodyPoint
from studio.core.constraints.distance import DistanceConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.course import Course, Unsolved
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.posed import place_of, wanted_place
from studio.core.solver.asking.rows import Rows, put_end
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: DistanceConstraint) -> None:
    """Two ends that are free share the way."""
    row = rows.asked[c]
    rows.distances[c] = rows.targets.numbers(constraint.distance)
    if isinstance(constraint.other, BodyPoint):
        put_end(row, 1, constraint.other, constraint.chain, rows.layout)
        # A leg comes to meet a hand only when it is asked for itself: the own thigh stays where it is.
        if row["limbs"][0] < 2 <= row["limbs"][1]:
            row["limb_weights"][1] = 0.0
    else:
        rows.places[c] = rows.targets.places(constraint.other)
    free = np.array([row["limbs"][end] >= 0 and row["limb_weights"][end, 0] > 0.0 for end in range(2)], dtype=float)
    row["end_fractions"] = free / max(free.sum(), 1.0)


def missed(constraint: DistanceConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) metres."""
    apart = place_of(constraint.point, adapted) - wanted_place(constraint.other, targets, adapted)
    return np.asarray(np.abs(np.linalg.norm(apart, axis=1) - targets.numbers(constraint.distance)))


def course(unsolved: Unsolved) -> Course:
    """How much farther apart both ends are to be."""
    now = np.linalg.norm(unsolved.place - unsolved.wanted, axis=1, keepdims=True)
    return unsolved.rows.distances[unsolved.c][:, None] - now, goals.RADIAN_LENGTH


DISTANCE = Kind(goals.DISTANCE_TASK, put, course, missed)
