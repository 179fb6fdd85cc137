"""Root retreat for a leg whose target is too near for the flexion limits of hip and knee (METHOD 10).

The boundary of such a leg's reach curves round its target, so the gradient of the residual does not show the root which
way to move: to first order the root would move straight to the target, where a planted foot holds it.

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.vectors import add_vectors, copy_point, copy_points
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.root_reach_limit import limit_root_step
from studio.core.kernels.search.body_placement import pose_body, solve_limbs
from studio.core.kernels.search.level_step import TASK_MET_RESIDUAL
from studio.core.kernels.tasks.goals import end_position, is_position
from studio.core.kernels.tasks.limb_rows import LIMB_SHORT_RESIDUAL
from studio.core.kernels.tasks.task_kinds import residual_of
from studio.core.kernels.tasks.task_status import ACTIVE

ROOT_RETREAT_STEPS = 30
"""Greatest number of retreat steps. Each leaves a third to two thirds of the residual; the steps of the search that
follow are misled if more than ``TASK_MET_RESIDUAL`` is left.
"""
KEPT_RESIDUAL_FRACTION = 0.8
"""Greatest fraction of the residual left by the retreat for which its result is kept."""


@kernel
def retreat_root(level, problem):
    """Move the root away from the target of a leg that its joint limits keep from it; True if this level has such a
    leg.

    Each step is as long as the residual, which is never too far: no point comes nearer to a position by more than its
    displacement. The root's state is restored if the residual does not decrease enough.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    c = limited_leg_task(level, problem)
    first = residual_of(c, problem) if c >= 0 else 0.0
    if first < LIMB_SHORT_RESIDUAL:
        return False
    residual = first
    copy_points(search.state, search.trial_state)
    for attempt in range(ROOT_RETREAT_STEPS):
        move_root_back(residual, tasks[c], chain.joint_of_segment[-1], problem)
        pose_body(problem)
        solve_limbs(level, problem)
        residual = residual_of(c, problem)
        if residual < TASK_MET_RESIDUAL or (attempt > 0 and residual > first):
            break
    if residual > KEPT_RESIDUAL_FRACTION * first:
        copy_points(search.trial_state, search.state)
        pose_body(problem)
        solve_limbs(level, problem)
    return True


@kernel
def limited_leg_task(level, problem):
    """Index of the position task that joint limits of a leg keep from its goal and that may move the root, -1 for
    none.
    """
    tasks, chain, body = problem.tasks, problem.chain, problem.body
    limits, root = body.limits, chain.joint_of_segment[-1]
    if limits.shape[0] == 0 or root < 0:
        return -1
    for c in range(tasks.shape[0]):
        row = tasks[c]
        limb = row.limbs[0]
        asks = is_position(row) and row.status == ACTIVE and row.level == level and chain.weights[c, root] > 0.0
        if asks and limb >= 2 and limits[limb].blocked_task == c:
            return c
    return -1


@kernel
def move_root_back(residual, row, root, problem):
    """Move the root horizontally by ``residual`` metres, away from the goal of task ``row`` and perpendicular to the
    error, within the reach of planted feet.

    ``root`` is the index of the root's joint.
    """
    body, search, start, pose = problem.body, problem.search, problem.start, problem.pose
    point, goal = end_position(row, 0, pose), row.goal_positions[0]
    hip = pose.positions[limb_parts(row.limbs[0], pose.positions.shape[0] - POINTS_BESIDE_SPINE)[2]]
    along = 0.0
    for axis in range(3):
        along += (hip[axis] - goal[axis]) * (goal[axis] - point[axis]) / (residual * residual)
    x, y = hip[0] - goal[0] - along * (goal[0] - point[0]), hip[1] - goal[1] - along * (goal[1] - point[1])
    scale = residual / max(math.sqrt(x * x + y * y), 1e-9)
    displacement = limit_root_step(
        body, start, search.segment_rotations, search.state[root], (scale * x, scale * y, 0.0)
    )
    copy_point(add_vectors(search.state[root], displacement), search.state[root])
