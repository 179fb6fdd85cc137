"""One step of all joints for one level, with those above it held (METHOD 6).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_tasks import CLOSE_ENOUGH
from studio.core.kernels.limits.within_limits import NEARLY
from studio.core.kernels.search.all_joints import refine_step
from studio.core.kernels.search.joints import set_brakes
from studio.core.kernels.search.priorities import find_step, go_on
from studio.core.kernels.tasks.goals import counts
from studio.core.kernels.tasks.rows import add_feet_rows, add_rows
from studio.core.kernels.tasks.second_order import BOUND, part_of_step
from studio.core.kernels.tasks.task import ACTIVE, STRICT

MET, KEPT = 0.6 * STRICT, 0.4 * STRICT
"""Metres of residual at which a task is met, and metres or radians by which one level may change those above it."""
WITHIN = 0.1
"""Metres of error at which a lessened damping is lessened by half (its root): far out of reach it stays what it is."""
LITTLE, MUCH = 0.15, 0.35
"""Part of what was missed that the last step gained, up to which no late step follows, and from which a whole one."""
FAR_OFF = 0.012
"""Metres of error from which on late steps are not taken; up to ``NEARLY`` they are taken whole."""
NOUGHT = 0.03
"""Part of what was missed that the last step must gain for another to be taken whole where little is missed."""
STILL = 0.1 * STRICT
"""Metres by which a step must move something for another to be worth while."""
SURE = 0.2 * STRICT
"""Metres that a step is to leave, as the one before it gained, for no other to be looked at. It must promise as many to
be worth its way, and twice that to be taken whole.
"""


@kernel
def step(level, mending, whole, is_late, stays, damping, problem):
    """One step of all joints for this level with those above held, or, ``mending``, of those alone.

    How far it moves, in metres. ``stays``: the root does, so that feet need no holding; ``damping`` the part of it.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    rows, past = search.rows, search.last[0]
    if is_late:  # before all that is held is looked at
        count = add_own_rows(level, 0, problem)
        if late_part(greatest(0, count, rows), past.missed) <= 0.0:
            return 0.0
    set_brakes(search.state, chain.joints, chain.limits, search.carried, rows.brakes)
    every = min(tasks.shape[0] + level, chain.mobilities.shape[0] - 1)
    feet = chain.slots[-1] >= 0 and not stays
    count = add_feet_rows(every, 0, problem) if feet else 0
    for c in range(tasks.shape[0]):
        if counts(tasks[c]) and tasks[c].rank < level:
            count = add_rows(c, level, every, True, count, problem)
    own = count
    if not mending:
        count = add_own_rows(level, count, problem)
    worst, missed = greatest(0, own, rows), greatest(own, count, rows)
    ease = late_part(missed, past.missed) if is_late else 1.0
    left = missed * missed / max(past.missed, 1e-9)
    past.suffices = left < SURE and worst < KEPT
    past.missed = missed
    if worst < (STILL if mending else CLOSE_ENOUGH) and missed < MET:
        return 0.0
    promised, part = newton_step(own, count, whole, damping, missed, problem)
    worth = 1.0 if mending else min(max(promised / SURE - 1.0, 0.0), 1.0)
    past.suffices = past.suffices or (worth == 0.0 and worst < KEPT)
    return go_on(0.0 if mending else STILL, ease, worth * part, problem)


@kernel
def newton_step(own, count, whole, damping, missed, problem):
    """A step from rows of which the first ``own`` are held; the metres that it promises, and the part of it to go.

    ``whole``: every joint is looked at; ``missed`` metres, near which it is damped in full.
    """
    chain, search, positions = problem.chain, problem.search, problem.pose.positions
    rows, steps = search.rows, search.equations.steps
    eased = damping if damping == 1.0 else damping ** (1.0 / (1.0 + (missed / WITHIN) ** 2))
    slope = find_step(own, count, eased, rows, chain, search.equations, positions)
    if whole:
        slope = refine_step(count, rows, chain, search.carried, search.state, steps[-1], search.damped, positions)
    squared = 0.0
    for row in range(own, count):
        squared += rows.errors[row] ** 2
    promised = slope / (2.0 * math.sqrt(squared) + 1e-9)
    return promised, part_of_step(own, count, slope, rows.roles, rows.pulls, steps[-1], chain.joints, positions)


@kernel
def add_own_rows(level, count, problem):
    """Rows of what a level asks itself; their new number."""
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        if tasks[c].status == ACTIVE and tasks[c].rank == level:
            count = add_rows(c, level, c, False, count, problem)
    return count


@kernel
def greatest(first, past, rows):
    """The greatest error of some rows, in metres; what a bound has to spare is none."""
    worst = 0.0
    for row in range(first, past):
        error = rows.errors[row]
        worst = max(worst, error if rows.roles[row] == BOUND else abs(error))
    return worst


@kernel
def late_part(missed, before):
    """The part of a late step that is taken where ``missed`` metres are left of what was missed ``before`` the last."""
    near, gained = (FAR_OFF - missed) / (FAR_OFF - NEARLY), 1.0  # what was met is missed by what is held alone
    if before >= MET:
        gained -= missed / before
    near = min(near, 1.0) * min(max(gained / NOUGHT, 0.0), 1.0)
    return min(max(near, (gained - LITTLE) / (MUCH - LITTLE)), 1.0)
