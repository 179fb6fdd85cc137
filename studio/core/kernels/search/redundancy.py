"""Arms and legs as redundant limbs of a balance: their joint weights at a frame, and goals within their reach (METHOD
11).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.vectors import copy_point, length_in_axes, offset_between
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb import soft_extension
from studio.core.kernels.search.joints import may_rotate
from studio.core.kernels.tasks.balance import accumulate_masses, centre_of_mass, write_balance_jacobian
from studio.core.kernels.tasks.goals import is_balance
from studio.core.kernels.tasks.task_status import ACTIVE

SOFT_MASS_TRAVEL, USABLE_MASS_TRAVEL = 0.5, 0.65
"""Fraction of the centre of mass' reachable travel up to which travel is not reduced, and fraction of the travel
predicted by the levers that counts as reachable.
"""


@kernel
def update_joint_weights(least, frame, activations, redundancy, problem):
    """Update the joint weights of each level for one frame: the greatest over the active tasks down to the level.

    Tasks with blended transitions count as active from the activation ``least`` on. Shoulders and hips are scaled by
    the availability of their limbs; their joint limits follow the level that frees them most.
    """
    tasks, weights, limits, count = (
        problem.tasks,
        problem.chain.weights,
        problem.chain.limits,
        problem.tasks.shape[0],
    )
    joints, nominal_weights, free = redundancy.joints, redundancy.nominal_weights, redundancy.availability
    for n in range(joints.shape[0]):
        for c in range(count):
            weights[c, joints[n]] = nominal_weights[c, n]
    for level in range(weights.shape[0] - count):
        update_level_weights(level, least, frame, activations, tasks, weights)
    for n in range(joints.shape[0]):
        joint, most = joints[n], 0.0
        for row in range(weights.shape[0]):
            fraction = free[tasks[row].level if row < count else row - count, n, frame]
            if row >= count and weights[row, joint] > 0.0:
                most = max(most, fraction)
            weights[row, joint] *= fraction
        limits[joint] = most * nominal_weights[weights.shape[0], n]


@kernel
def update_level_weights(level, least, frame, activations, tasks, weights):
    """Update the joint weights of one level: the greatest over the active tasks down to it."""
    count = tasks.shape[0]
    out_level = weights[count + level]
    for k in range(out_level.shape[0]):
        out_level[k] = 0.0
    for c in range(count):
        activation = activations[c, frame]
        if tasks[c].level <= level and activation > 0.0 and (activation >= least or not tasks[c].blends):
            for k in range(out_level.shape[0]):
                out_level[k] = max(out_level[k], weights[c, k])


@kernel
def set_reachable_balance_goals(level, problem):
    """Set the goals of a level's balances: their targets or, where limbs help, as near to these as the joints softly
    reach (METHOD (33)).

    Returns True if the level has a balance. At their limits arms would whirl about for a target out of reach.
    """
    tasks, chain, body, pose = problem.tasks, problem.chain, problem.body, problem.pose
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not is_balance(row) or row.status != ACTIVE or row.level != level:
            continue
        found = True
        copy_point(row.goal_positions[0], row.goal_positions[1])
        if not may_rotate_limbs(c, chain):
            continue
        mass = centre_of_mass(body.mass_fractions, pose.positions)
        displacement = length_in_axes(offset_between(mass, row.goal_positions[0]), row.axes)
        if displacement < 1e-6:
            continue
        reach = USABLE_MASS_TRAVEL * mass_travel_product(row, mass, chain.weights[c], problem) / displacement
        fraction = (
            reach * soft_extension(displacement / reach, SOFT_MASS_TRAVEL) / displacement if reach > 1e-9 else 0.0
        )
        for axis in range(row.axes):
            row.goal_positions[1, axis] = mass[axis] + fraction * (row.goal_positions[0, axis] - mass[axis])
    return found


@kernel
def may_rotate_limbs(row, chain):
    """True if ``row`` of the joint weights, a task's or a level's, may rotate a shoulder or a hip."""
    found = False
    for limb in range(4):
        found = found or may_rotate(row, limb_parts(limb, chain.joint_of_segment.shape[0] - 19)[1], chain)
    return found


@kernel
def mass_travel_product(row, mass, weights, problem):
    """Dot product (m2) of the vector from the centre of ``mass`` (3,) to its target with the travel that the helping
    joints can give it.

    The travel is that of all helping joints rotated to their limits, by their present levers.
    """
    chain, masses, search, positions = problem.chain, problem.body.masses, problem.search, problem.pose.positions
    jacobian, total = search.rows.jacobian, 0.0
    accumulate_masses(masses, positions, search.mass_sums)
    write_balance_jacobian(row.axes, masses, search.mass_sums, chain.joints, positions, jacobian)
    for joint in range(chain.joints.shape[0]):
        if weights[joint] <= 0.0:
            continue
        squared = 0.0
        for side in range(3):
            along = 0.0
            for axis in range(row.axes):
                along += jacobian[axis, joint, side] * (row.goal_positions[0, axis] - mass[axis])
            squared += along * along
        total += 2.0 * math.atan(chain.limits[joint]) * math.sqrt(squared)
    return total
