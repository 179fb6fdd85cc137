"""The centre of mass over a place."""

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.balance import BalanceConstraint
from studio.core.kernels.tasks import goals
from studio.core.solver.asking.course import Course, Unsolved, course_to
from studio.core.solver.asking.kinds.kind import Kind
from studio.core.solver.asking.posed import wanted_place
from studio.core.solver.asking.rows import Rows
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion
from studio.core.solver.standing.support import mass_path

FloatArray = NDArray[np.float64]


def put(rows: Rows, c: int, constraint: BalanceConstraint) -> None:
    """A place of NaN is the motion's own."""
    rows.asked["axes"][c] = 3 if constraint.vertical else 2
    place = constraint.place
    rows.asked["blends"][c] = not rows.put_followed(c, place)
    if isinstance(place, tuple) and len(place) == 2:
        rows.places[c] = rows.targets.masses()
        rows.places[c][:, :2] = place
    elif place is not None and rows.asked["blends"][c]:
        rows.places[c] = rows.targets.places(place)


def missed(constraint: BalanceConstraint, targets: Targets, adapted: AdaptedMotion) -> FloatArray:
    """(F,) metres of the centre of mass from where it is to be, along the ground unless its height is asked too."""
    wanted = np.array(targets.masses())
    if isinstance(constraint.place, tuple) and len(constraint.place) == 2:
        wanted[:, :2] = constraint.place
    elif constraint.place is not None:
        wanted = wanted_place(constraint.place, targets, adapted)
    axes = 3 if constraint.vertical else 2
    away = mass_path(adapted.positions[:], adapted.morphology) - wanted
    return np.asarray(np.linalg.norm(away[:, :axes], axis=1))


def course(unsolved: Unsolved) -> Course:
    """From where the centre of mass is to its target."""
    return course_to(unsolved.wanted, mass_path(unsolved.positions, unsolved.body))


BALANCE = Kind(goals.BALANCE_TASK, put, course, missed)
