"""Residuals of constraints measured on given poses, active or not."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.solver.asking.kinds.known import solver_kind_of
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion


def full_residuals(constraints: Sequence[Constraint], targets: Targets, adapted: AdaptedMotion) -> NDArray[np.float64]:
    """Residuals (C, F) in metres or radians at full activation; ``targets`` are those of these frames.

    Areas and self-collision constraints have the solver's residuals: NaN where inactive.
    """
    measured = np.array(adapted.residuals)
    for row, constraint in zip(measured, constraints, strict=True):
        kind = solver_kind_of(constraint)
        if kind is not None and kind.residual is not None:
            row[:] = kind.residual(constraint, targets, adapted)
    return measured
