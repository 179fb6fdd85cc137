"""What the solver knows of a kind of constraint, beside the kernels that hold it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.solver.asking.course import Course, Unsolved
from studio.core.solver.asking.rows import Rows
from studio.core.solver.asking.tracks import Targets
from studio.core.solver.request import AdaptedMotion

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Kind:
    """``code`` is the kind as the kernels know it. ``put`` writes constraint c of the rows. ``course`` is what one row
    asks beside the unsolved poses. ``missed`` measures poses: (F,) metres or radians by which a constraint is missed at
    full activation; None where only the solver knows that. ``enters``: it acts only while its point is where it may
    not be, and so begins and ends within its activation.
    """

    code: int
    put: Callable[[Rows, int, Any], None]
    course: Callable[[Unsolved], Course]
    missed: Callable[[Any, Targets, AdaptedMotion], FloatArray] | None = None
    enters: bool = False
