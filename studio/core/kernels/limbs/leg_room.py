"""Room for a leg whose target is too near for how far hip and knee bend: the root goes back (METHOD 6).

The arc that such a leg reaches bends round its target, so what it misses tells the root nothing of the way out: to the
first order the root is asked straight for the target, where a foot that stands holds it.

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.vectors import copy_point, copy_points, plus
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.root_reach import keep_feet_in_reach
from studio.core.kernels.search.placing import carry_body, place_limbs
from studio.core.kernels.search.step import MET
from studio.core.kernels.tasks.goals import asks_place, end_place
from studio.core.kernels.tasks.kinds import miss_of
from studio.core.kernels.tasks.limb_rows import MISSED
from studio.core.kernels.tasks.task import ACTIVE

STEPS = 30
"""Times that the root goes back, at most: each leaves a third to two thirds of what was missed, and what more than
``MET`` is left of it leads the steps that follow astray.
"""
WORTH = 0.8
"""Part of what was missed that is to be left for the root to stay where it went."""


@kernel
def make_room(level, problem):
    """Take the root back from what a leg of this level misses for its limits; whether there is such a leg.

    Every time by what is missed, which is never too far: nobody comes nearer to a place by more than he moves. Where
    that brings it no nearer nothing has moved.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    c = cramped_leg(level, problem)
    first = miss_of(c, problem) if c >= 0 else 0.0
    if first < MISSED:
        return False
    miss = first
    copy_points(search.state, search.tried)
    for attempt in range(STEPS):
        go_back(miss, tasks[c], chain.slots[-1], problem)
        carry_body(problem)
        place_limbs(level, problem)
        miss = miss_of(c, problem)
        if miss < MET or (attempt > 0 and miss > first):
            break
    if miss > WORTH * first:
        copy_points(search.tried, search.state)
        carry_body(problem)
        place_limbs(level, problem)
    return True


@kernel
def cramped_leg(level, problem):
    """The place that a leg misses for its limits and for which the root may move, -1 for none."""
    tasks, chain, body = problem.tasks, problem.chain, problem.body
    limits, root = body.limits, chain.slots[-1]
    if limits.shape[0] == 0 or root < 0:
        return -1
    for c in range(tasks.shape[0]):
        row = tasks[c]
        limb = row.limbs[0]
        asks = asks_place(row) and row.status == ACTIVE and row.rank == level and chain.mobilities[c, root] > 0.0
        if asks and limb >= 2 and limits[limb].blocks == c:
            return c
    return -1


@kernel
def go_back(miss, row, root, problem):
    """Move the root ``miss`` metres, level, away from the target of ``row`` across what is missed, as feet allow."""
    body, search, start, pose = problem.body, problem.search, problem.start, problem.pose
    point, goal = end_place(row, 0, pose), row.places[0]
    hip = pose.positions[limb_parts(row.limbs[0], pose.positions.shape[0] - 23)[2]]
    along = 0.0
    for axis in range(3):
        along += (hip[axis] - goal[axis]) * (goal[axis] - point[axis]) / (miss * miss)
    x, y = hip[0] - goal[0] - along * (goal[0] - point[0]), hip[1] - goal[1] - along * (goal[1] - point[1])
    scale = miss / max(math.sqrt(x * x + y * y), 1e-9)
    way = keep_feet_in_reach(body, start, search.carried, search.state[root], (scale * x, scale * y, 0.0))
    copy_point(plus(search.state[root], way), search.state[root])
