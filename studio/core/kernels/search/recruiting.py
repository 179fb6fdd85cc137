"""Arms and legs that a balance recruits: as free as they are at a frame, and no farther than they can (METHOD 7).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.vectors import between, copy_point, length_along
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb import soft_reach
from studio.core.kernels.search.joints import may_turn
from studio.core.kernels.tasks.balance import centre_of_mass, set_balance_rows, sum_masses
from studio.core.kernels.tasks.goals import moves_mass
from studio.core.kernels.tasks.task import ACTIVE

MASS_COMFORT, MASS_REACH = 0.5, 0.65
"""Part of what joints can do for the centre of mass that is asked of them freely, and of what their levers promise that
they can do.
"""


@kernel
def free_joints(least, frame, activations, recruits, problem):
    """What each level may move at this frame: what any down to it may that acts as ``set_goals`` has it from ``least``
    on, shoulders and hips as free as their limbs are for the level; these turn as far as the highest lets them.
    """
    tasks, mobilities, limits, count = (
        problem.tasks,
        problem.chain.mobilities,
        problem.chain.limits,
        problem.tasks.shape[0],
    )
    joints, usual, free = recruits.joints, recruits.usual, recruits.free
    for n in range(joints.shape[0]):
        for c in range(count):
            mobilities[c, joints[n]] = usual[c, n]
    for level in range(mobilities.shape[0] - count):
        add_up_level(level, least, frame, activations, tasks, mobilities)
    for n in range(joints.shape[0]):
        joint, most = joints[n], 0.0
        for row in range(mobilities.shape[0]):
            part = free[tasks[row].rank if row < count else row - count, n, frame]
            if row >= count and mobilities[row, joint] > 0.0:
                most = max(most, part)
            mobilities[row, joint] *= part
        limits[joint] = most * usual[mobilities.shape[0], n]


@kernel
def add_up_level(level, least, frame, activations, tasks, mobilities):
    """The mobilities of a ``level``: the greatest of those down to it that act."""
    count = tasks.shape[0]
    out_level = mobilities[count + level]
    for k in range(out_level.shape[0]):
        out_level[k] = 0.0
    for c in range(count):
        share = activations[c, frame]
        if tasks[c].rank <= level and share > 0.0 and (share >= least or not tasks[c].blends):
            for k in range(out_level.shape[0]):
                out_level[k] = max(out_level[k], mobilities[c, k])


@kernel
def note_balances(level, problem):
    """Where a level's balances are to bring the centre of mass: where they want it, or (METHOD (33)) softly on the way
    there as far as the joints can, where limbs help: at their limits arms would whirl about for what is out of reach.

    Whether there are any.
    """
    tasks, chain, body, pose = problem.tasks, problem.chain, problem.body, problem.pose
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not moves_mass(row) or row.status != ACTIVE or row.rank != level:
            continue
        found = True
        copy_point(row.places[0], row.places[1])
        if not frees_limbs(c, chain):
            continue
        mass = centre_of_mass(body.shares, pose.positions)
        way = length_along(between(mass, row.places[0]), row.axes)
        if way < 1e-6:
            continue
        reach = MASS_REACH * mass_reach(row, mass, chain.mobilities[c], problem) / way
        part = reach * soft_reach(way / reach, MASS_COMFORT) / way if reach > 1e-9 else 0.0
        for axis in range(row.axes):
            row.places[1, axis] = mass[axis] + part * (row.places[0, axis] - mass[axis])
    return found


@kernel
def frees_limbs(row, chain):
    """Whether a constraint, or a level any down to it (``row`` of the mobilities), may turn a shoulder or a hip."""
    found = False
    for limb in range(4):
        found = found or may_turn(row, limb_parts(limb, chain.slots.shape[0] - 19)[1], chain)
    return found


@kernel
def mass_reach(row, mass, mobilities, problem):
    """How far (metres squared) all joints that may help, each turned to its limit, move the centre of ``mass`` (3,)
    towards its place, times that way: their levers along it.
    """
    chain, masses, search, positions = problem.chain, problem.body.masses, problem.search, problem.pose.positions
    jacobian, total = search.rows.jacobian, 0.0
    sum_masses(masses, positions, search.sums)
    set_balance_rows(row.axes, masses, search.sums, chain.joints, positions, jacobian)
    for joint in range(chain.joints.shape[0]):
        if mobilities[joint] <= 0.0:
            continue
        squared = 0.0
        for side in range(3):
            along = 0.0
            for axis in range(row.axes):
                along += jacobian[axis, joint, side] * (row.places[0, axis] - mass[axis])
            squared += along * along
        total += 2.0 * math.atan(chain.limits[joint]) * math.sqrt(squared)
    return total
