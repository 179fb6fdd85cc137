"""One null-space step of a level (METHOD 9).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_tasks import NEGLIGIBLE_ERROR
from studio.core.kernels.limits.limited_step import NEARLY_MET_RESIDUAL
from studio.core.kernels.search.full_newton_step import full_newton_step
from studio.core.kernels.search.joints import update_joint_damping
from studio.core.kernels.search.null_space_step import apply_step, null_space_step
from studio.core.kernels.tasks.goals import has_residual
from studio.core.kernels.tasks.jacobian_rows import add_root_reach_rows, add_rows
from studio.core.kernels.tasks.second_order import INEQUALITY_ROW, optimal_step_length
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.kernels.tasks.task_status import ACTIVE

TASK_MET_RESIDUAL, ALLOWED_VIOLATION = 0.6 * PRIORITY_TOLERANCE, 0.4 * PRIORITY_TOLERANCE
"""Residual in metres below which a task is met, and greatest change of a higher task's residual by one level, in metres
or radians.
"""
FULL_DAMPING_ERROR = 0.1
"""Residual in metres at which half of a damping reduction applies (as an exponent): far targets keep the full damping.
"""
NO_LATE_STEP_GAIN, FULL_LATE_STEP_GAIN = 0.15, 0.35
"""Fractions of the residual removed by the last step: up to the first no late step follows, from the second on a full
one.
"""
NO_LATE_STEP_ERROR = 0.012
"""Residual in metres from which late steps are not taken; up to ``NEARLY_MET_RESIDUAL`` they are full."""
LEAST_GAIN = 0.03
"""Least fraction of the residual removed by the last step for a full late step near the goal."""
LEAST_DISPLACEMENT = 0.1 * PRIORITY_TOLERANCE
"""Least displacement in metres of a step that is taken."""
SUFFICIENT_ERROR = 0.2 * PRIORITY_TOLERANCE
"""Predicted residual in metres, at the rate of the last step, below which no further step is taken. A step must also
promise a greater decrease than this to be taken, and twice this to be full.
"""


@kernel
def take_level_step(level, restoring, all_joints, is_late, root_stays, damping, problem):
    """Take one step of all joints for a level, with the levels above held; returns its displacement in metres.

    With ``restoring`` only the residuals of the levels above are restored; ``all_joints`` uses the full Newton step;
    ``is_late`` marks a step after the regular ones, which is shortened near convergence. With ``root_stays`` the root
    does not move, so that planted feet need no rows. ``damping`` is the fraction of the regular damping.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    rows, past = search.rows, search.last_step[0]
    if is_late:  # before all that is held is looked at
        count = add_objective_rows(level, 0, problem)
        if late_step_length(greatest_error(0, count, rows), past.residual) <= 0.0:
            return 0.0
    update_joint_damping(search.state, chain.joints, chain.limits, search.segment_rotations, rows.damping)
    every = min(tasks.shape[0] + level, chain.weights.shape[0] - 1)
    feet = chain.joint_of_segment[-1] >= 0 and not root_stays
    count = add_root_reach_rows(every, 0, problem) if feet else 0
    for c in range(tasks.shape[0]):
        if has_residual(tasks[c]) and tasks[c].level < level:
            count = add_rows(c, level, every, True, count, problem)
    own = count
    if not restoring:
        count = add_objective_rows(level, count, problem)
    worst, residual = greatest_error(0, own, rows), greatest_error(own, count, rows)
    late_scale = late_step_length(residual, past.residual) if is_late else 1.0
    left = residual * residual / max(past.residual, 1e-9)
    past.suffices = left < SUFFICIENT_ERROR and worst < ALLOWED_VIOLATION
    past.residual = residual
    if worst < (LEAST_DISPLACEMENT if restoring else NEGLIGIBLE_ERROR) and residual < TASK_MET_RESIDUAL:
        return 0.0
    promised, fraction = newton_step(own, count, all_joints, damping, residual, problem)
    worth = 1.0 if restoring else min(max(promised / SUFFICIENT_ERROR - 1.0, 0.0), 1.0)
    past.suffices = past.suffices or (worth == 0.0 and worst < ALLOWED_VIOLATION)
    return apply_step(0.0 if restoring else LEAST_DISPLACEMENT, late_scale, worth * fraction, problem)


@kernel
def newton_step(own, count, all_joints, damping, residual, problem):
    """(predicted decrease in metres, step length) of a step from ``count`` rows, the first ``own`` of which are held.

    ``all_joints`` uses the full Newton step. Where the ``residual`` (metres) is large, the damping is full.
    """
    chain, search, positions = problem.chain, problem.search, problem.pose.positions
    rows, steps = search.rows, search.equations.directions
    smoothed = damping if damping == 1.0 else damping ** (1.0 / (1.0 + (residual / FULL_DAMPING_ERROR) ** 2))
    slope = null_space_step(own, count, smoothed, rows, chain, search.equations, positions)
    if all_joints:
        slope = full_newton_step(
            count, rows, chain, search.segment_rotations, search.state, steps[-1], search.damped, positions
        )
    squared = 0.0
    for row in range(own, count):
        squared += rows.errors[row] ** 2
    promised = slope / (2.0 * math.sqrt(squared) + 1e-9)
    return promised, optimal_step_length(
        own, count, slope, rows.roles, rows.point_errors, steps[-1], chain.joints, positions
    )


@kernel
def add_objective_rows(level, count, problem):
    """Add the objective rows of a level; returns the new number of rows."""
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        if tasks[c].status == ACTIVE and tasks[c].level == level:
            count = add_rows(c, level, c, False, count, problem)
    return count


@kernel
def greatest_error(first, past, rows):
    """Greatest error in metres of the rows ``first`` to ``past``; a satisfied inequality has none."""
    worst = 0.0
    for row in range(first, past):
        error = rows.errors[row]
        worst = max(worst, error if rows.roles[row] == INEQUALITY_ROW else abs(error))
    return worst


@kernel
def late_step_length(residual, before):
    """Step length of a late step in [0, 1], from the present ``residual`` and the one ``before`` the last step, in
    metres.
    """
    near, gained = (
        (NO_LATE_STEP_ERROR - residual) / (NO_LATE_STEP_ERROR - NEARLY_MET_RESIDUAL),
        1.0,
    )  # what was met is missed by what is held alone
    if before >= TASK_MET_RESIDUAL:
        gained -= residual / before
    near = min(near, 1.0) * min(max(gained / LEAST_GAIN, 0.0), 1.0)
    return min(max(near, (gained - NO_LATE_STEP_GAIN) / (FULL_LATE_STEP_GAIN - NO_LATE_STEP_GAIN)), 1.0)
