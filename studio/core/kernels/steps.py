"""One step of all joints for one level, with those above it held (METHOD 6).

``asked``, ``chain``, ``body``, ``work``, ``start`` and ``pose`` are what ``kernels.constraints`` describes.
"""

import math

from studio.core.kernels.again import is_kept, step_again
from studio.core.kernels.compiling import kernel
from studio.core.kernels.goals import counts
from studio.core.kernels.joints import set_brakes
from studio.core.kernels.limb_constraints import CLOSE_ENOUGH
from studio.core.kernels.newton import refine_step
from studio.core.kernels.priorities import find_step, go_on
from studio.core.kernels.pulls import BOUND, part_of_step
from studio.core.kernels.rows import add_feet_rows, add_rows

MET = 1.2e-4
"""Metres of error at which a wish is met."""
KEPT = 8e-5
"""Metres or radians by which a level may change what those above it miss."""
WITHIN = 0.1
"""Metres of error at which a lessened damping is lessened by half (its root): far out of reach it stays what it is."""
LITTLE, MUCH = 0.15, 0.35
"""Part of what was missed that the last step gained, up to which no late step follows, and from which a whole one."""
NEARLY, FAR_OFF = 0.004, 0.012
"""Metres of error up to which late steps are taken whole, and from which on they are not taken."""
NOUGHT = 0.03
"""Part of what was missed that the last step must gain for another to be taken whole where little is missed."""
HARDLY = 4e-5
"""Metres that a step must promise to be worth its way, and twice that to be taken whole."""
STILL = 2e-5
"""Metres by which a step must move something for another to be worth while."""
SURE, SURER = 4e-5, 1e-5
"""Metres that a step is to leave, as the one before it gained, for no other to be looked at, and for it to be found by
what was eliminated for the one before where several rows ask.
"""
NEAR = 0.03
"""Metres that a step may have moved things for the next to be found so, or one that mends."""


@kernel
def step(level, mending, whole, is_late, stays, damping, asked, chain, body, work, start, pose):
    """One step of all joints for this level with those above held, or, ``mending``, of those alone.

    How far it moves, in metres. ``stays``: the root does, so that feet need no holding; ``damping`` the part of it.
    """
    ask, past = work[0], work[9]
    if is_late:  # before all that is held is looked at
        count = add_own_rows(level, 0, asked, chain, body, work, pose)
        if late_part(greatest(0, count, ask), past[0]) <= 0.0:
            return 0.0
    set_brakes(work[3][0], chain[1], chain[3], work[2], ask[4])
    every = min(asked.shape[0] + level, chain[0].shape[0] - 1)
    feet = chain[2][-1] >= 0 and not stays
    count = add_feet_rows(every, 0, chain, body, ask, start, pose[0]) if feet else 0
    for c in range(asked.shape[0]):
        if counts(asked[c]) and asked[c].rank < level:
            count = add_rows(c, level, every, True, count, asked, chain, body, work, pose)
    own = count
    if not mending:
        count = add_own_rows(level, count, asked, chain, body, work, pose)
    worst, missed = greatest(0, own, ask), greatest(own, count, ask)
    ease = late_part(missed, past[0]) if is_late else 1.0
    left = missed * missed / max(past[0], 1e-9)
    past[3] = 1.0 if left < SURE and worst < KEPT else 0.0
    past[0] = missed
    if worst < (STILL if mending else CLOSE_ENOUGH) and missed < MET:
        return 0.0
    ways, part = work[1][5], 1.0
    again = (
        past[1] == own
        and past[2] < NEAR
        and (mending or (left < (SURE if count == own + 1 else SURER) and past[4] == count))
    )
    if not (again and is_kept(own, ask, work[1]) and step_again(own, count, ask, chain, work[1]) < NEAR):
        eased = damping if damping == 1.0 else damping ** (1.0 / (1.0 + (missed / WITHIN) ** 2))
        slope = find_step(own, count, eased, ask, chain, work[1], pose[0])
        if whole:
            slope = refine_step(count, ask, chain, work[2], work[3][0], ways[-1], work[8], pose[0])
        squared = 0.0
        for row in range(own, count):
            squared += ask[1][row] ** 2
        promised = slope / (2.0 * math.sqrt(squared) + 1e-9)
        worth = 1.0 if mending else min(max(promised / HARDLY - 1.0, 0.0), 1.0)
        part = worth * part_of_step(own, count, slope, ask[3], ask[5], ways[-1], chain[1], pose[0])
        past[3] = max(past[3], 1.0 if worth == 0.0 and worst < KEPT else 0.0)
        past[1], past[2], past[4] = own, 0.0, count
    moved = go_on(0.0 if mending else STILL, ease, part, body, start, chain, work[2], ways, work[3][0])
    past[2] += moved
    return moved


@kernel
def add_own_rows(level, count, asked, chain, body, work, pose):
    """Rows of what a level asks itself; their new number."""
    for c in range(asked.shape[0]):
        if asked[c].wanted == 1 and asked[c].rank == level:
            count = add_rows(c, level, c, False, count, asked, chain, body, work, pose)
    return count


@kernel
def greatest(first, past, ask):
    """The greatest error of some rows, in metres; what a bound has to spare is none."""
    worst = 0.0
    for row in range(first, past):
        error = ask[1][row]
        worst = max(worst, error if ask[3][row] == BOUND else abs(error))
    return worst


@kernel
def late_part(missed, before):
    """The part of a late step that is taken where ``missed`` metres are left of what was missed ``before`` the last."""
    near, gained = (FAR_OFF - missed) / (FAR_OFF - NEARLY), 1.0  # what was met is missed by what is held alone
    if before >= MET:
        gained -= missed / before
    near = min(near, 1.0) * min(max(gained / NOUGHT, 0.0), 1.0)
    return min(max(near, (gained - LITTLE) / (MUCH - LITTLE)), 1.0)
