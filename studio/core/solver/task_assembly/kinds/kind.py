"""Description of a kind of constraint to the solver, beside its kernels."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.solver.request import AdaptedMotion
from studio.core.solver.task_assembly.target_trajectory import TargetTrajectory, UnsolvedTask
from studio.core.solver.task_assembly.task_rows import TaskRecords
from studio.core.solver.task_assembly.tracks import Targets

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class SolverKind:
    """One kind of constraint in the solver."""

    code: int
    """Number of the kind in the kernels."""
    write_task: Callable[[TaskRecords, int, Any], None]
    """Writes a constraint into the record with a given index."""
    trajectory: Callable[[UnsolvedTask], TargetTrajectory]
    """Trajectory of the target relative to the unsolved poses."""
    residual: Callable[[Any, Targets, AdaptedMotion], FloatArray] | None = None
    """Residuals (F,) of given poses at full activation, metres or radians; None if only the solver knows them."""
    enters: bool = False
    """True if the kind is active only inside a region, so that it begins and ends within its activation."""
