"""Functions of the solver for a kind of constraint, beside its kernels."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.solver.asking.target_trajectory import TargetTrajectory, UnsolvedTask
from studio.core.solver.asking.task_rows import TaskRecords
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class SolverKind:
    """Functions of the solver for one kind.

    ``code`` is its number in the kernels. ``write_task`` writes constraint c of the records. ``trajectory`` is its
    target relative to the unsolved poses. ``residual`` measures poses: (F,) metres or radians at full activation, None
    if only the solver knows it. ``enters``: the kind is active only inside a region, so that it begins and ends within
    its activation.
    """

    code: int
    write_task: Callable[[TaskRecords, int, Any], None]
    trajectory: Callable[[UnsolvedTask], TargetTrajectory]
    residual: Callable[[Any, Targets, AdaptedMotion], FloatArray] | None = None
    enters: bool = False
