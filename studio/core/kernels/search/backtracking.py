"""Back-tracking along the step of a level until it violates no task of a higher level (METHOD 9).

A ``step_length`` names a pose between 0, the result of the higher levels, and 1, the full step. The caller poses the
body there and measures the priority violation, until the violation is ``BACKTRACKING_TARGET`` of the allowed one:

    start_backtracking(0.0, violation, allowed, backtracking)
    while next_step_length(backtracking):
        update_bracket(pose_at(backtracking.step_length), backtracking)

Regula falsi (Illinois; Dowell and Jarratt 1971) is used rather than bisection, so that similar frames return to similar
poses. In the end the body is posed at the greatest admissible step length, perhaps 0; where even the ``violation``
there exceeds the allowed one, the caller drops the step.
"""

import numpy as np

from studio.core.kernels.compiling import kernel

BACKTRACKING_TARGET, BACKTRACKING_TOLERANCE = 0.7, 0.02
"""Target violation as a fraction of the allowed one, and tolerance about it."""
BACKTRACKING_STEPS = 8
"""Greatest number of trials: 7 suffice for a violation of 10 cm that grows like a power of the step length, from the
first to the fifth.
"""
BACKTRACKING = np.dtype(
    [
        *(
            (name, np.float64)
            for name in (
                "step_length",
                "violation",
                "allowed",
                "low",
                "low_excess",
                "high",
                "high_excess",
                "last_excess",
            )
        ),
        ("step_count", np.int64),
    ],
    align=True,
)
"""State of a back-tracking: the ``step_length`` posed last, its ``violation`` and the ``allowed`` one; the bracket
``low`` to ``high`` with the excess of both ends, ``low_excess`` and ``high_excess``; the ``last_excess``; the
``step_count``.
"""


@kernel
def start_backtracking(at_start, at_end, allowed, backtracking):
    """Begin a back-tracking at the end of a step, given the violations at the start and at the end of the step.

    Violations are in metres or radians; one below ``allowed`` is admissible.
    """
    backtracking.allowed, backtracking.step_count = allowed, 0
    backtracking.step_length, backtracking.violation, backtracking.last_excess = 1.0, at_end, 0.0
    backtracking.low, backtracking.low_excess = 0.0, excess_violation(at_start, allowed)
    backtracking.high, backtracking.high_excess = 1.0, excess_violation(at_end, allowed)


@kernel
def next_step_length(backtracking):
    """Set ``backtracking.step_length`` to the next step length to be tried; False if the back-tracking has ended."""
    if (
        backtracking.step_count > 0
        and abs(excess_violation(backtracking.violation, backtracking.allowed))
        < BACKTRACKING_TOLERANCE * backtracking.allowed
    ):
        return False
    if backtracking.step_count == BACKTRACKING_STEPS:
        if backtracking.step_length == backtracking.low:
            return False
        backtracking.step_length = backtracking.low
        return True
    slope = backtracking.high_excess - backtracking.low_excess
    backtracking.step_length = (
        backtracking.low * backtracking.high_excess - backtracking.high * backtracking.low_excess
    ) / slope
    backtracking.step_count += 1
    return True


@kernel
def update_bracket(violation, backtracking):
    """Update the bracket with the ``violation`` measured at the present step length."""
    over = excess_violation(violation, backtracking.allowed)
    backtracking.violation = violation
    if over < 0.0:
        backtracking.high_excess *= 0.5 if backtracking.last_excess < 0.0 else 1.0
        backtracking.low, backtracking.low_excess = backtracking.step_length, over
    else:
        backtracking.low_excess *= 0.5 if backtracking.last_excess > 0.0 else 1.0
        backtracking.high, backtracking.high_excess = backtracking.step_length, over
    backtracking.last_excess = over


@kernel
def excess_violation(violation, allowed):
    """Violation beyond the target, at most ``allowed``; negative below the target."""
    return min(violation - BACKTRACKING_TARGET * allowed, allowed)
