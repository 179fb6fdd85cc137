"""By how much constraints are missed, measured on poses as they are, whoever made them and whether they act or not."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.solver.asking.kinds.known import KINDS
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion


def misses(constraints: Sequence[Constraint], targets: Targets, adapted: AdaptedMotion) -> NDArray[np.float64]:
    """(C, F) metres or radians by which each is missed at full activation; ``targets`` are those of these frames.

    Areas, and what keeps clear of the body, are as the solver has them: NaN where they do not act.
    """
    measured = np.array(adapted.residuals)
    for row, constraint in zip(measured, constraints, strict=True):
        kind = KINDS.get(type(constraint))
        if kind is not None and kind.missed is not None:
            row[:] = kind.missed(constraint, targets, adapted)
    return measured
