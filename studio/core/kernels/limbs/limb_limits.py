"""Joint limits of one limb: it is clamped, then moved along its limits to the least residual of its primary task.

METHOD 10, (25) to (28). Records are those of ``kernels.records``.
"""

from studio.core.kernels.algebra.vectors import copy_point, distance
from studio.core.kernels.body.parts import end_pose, limb_parts, restore_end
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.limb import soft_extension
from studio.core.kernels.limits.limb_joint_limits import clamp_elbow_or_knee, clamp_joint, is_well_within
from studio.core.kernels.limits.limited_step import NEARLY_MET_RESIDUAL, limited_limb_step
from studio.core.kernels.tasks.goals import end_position, interpolate_point
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE

LIMITED_STEPS, LATE_LIMITED_STEPS = 6, 3
"""Greatest number of steps of a limb along its limits, and of further steps while the residual is small: full steps up
to ``NEARLY_MET_RESIDUAL``, none from twice that on.
"""
LEAST_LIMITED_STEP = 0.5 * PRIORITY_TOLERANCE
"""Length in radians of a step along the limits below which no further one follows."""


@small_kernel
def effective_point(row, end, goal, holds_end, pose):
    """(point, goal), each (x, y, z) in metres: the point of a limb that is moved to its task's goal, and that goal.

    Normally they are the task's own point and ``goal``. If hand or foot keeps its world orientation (``holds_end``),
    they are wrist or ankle, and the goal moved by the same vector.
    """
    _, upper, root = limb_parts(row.limbs[end], pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    point, tip = end_position(row, end, pose), pose.positions[root + 2]
    x, y, z = goal[0], goal[1], goal[2]
    if holds_end and row.segments[end] >= upper + 2:
        return (tip[0], tip[1], tip[2]), (x + tip[0] - point[0], y + tip[1] - point[1], z + tip[2] - point[2])
    return point, (x, y, z)


@kernel
def allowed_reach(row, end, span):
    """Distance in metres of a limb's end from its root for a goal at distance ``span``.

    It is at most the limb's agreed reach if the trunk or the root may help, else ``soft_extension`` (METHOD (11)). The
    agreed reach (``goal_reaches`` of ``TASK``) is the distance from limb root to goal that the limb covers by itself;
    the joints of the chain cover the rest.
    """
    if row.assisted:
        return min(span, row.goal_reaches[end])
    longest = row.max_reach[end]
    return longest * soft_extension(span / longest, row.soft_thresholds[end]) if longest > 0.0 else span


@kernel
def limit_limb(limb, problem):
    """Clamp a limb to its joint limits, then move it along active limits to the least residual of its primary task.

    If other joints help the limb, the limits that its first placement finds active stay active in the whole search.
    """
    state, limits = problem.search.limbs[limb], problem.body.limits
    rotations, limit = problem.pose.rotations, limits[limb]
    tip_stays = not limit.end_rotates or is_well_within(limb, 1, limits, rotations)
    if not state.lower_rotated and tip_stays and is_well_within(limb, 0, limits, rotations):
        return
    limit.certainty = 1.0
    for joint in range(2):
        copy_point(limit.agreed_caps[joint], limit.caps[joint])
    helped = (state.swivels or state.aims_upper) and problem.tasks[state.primary].assisted
    drawn = clamp_limb_joints(limb, True, limit.caps_unset or not helped, problem)
    if helped and limit.caps_unset:  # whatever comes after goes by them, and so does the next placing
        for joint in range(2):
            copy_point(limit.caps[joint], limit.agreed_caps[joint])
        limit.caps_unset = 0
    if drawn and state.swivels:
        step_along_limits(limb, problem)


@kernel
def step_along_limits(limb, problem):
    """Move a limb along its active joint limits to the least residual of its primary task (METHOD (28))."""
    pose, state, limit = problem.pose, problem.search.limbs[limb], problem.body.limits[limb]
    row, end = problem.tasks[state.primary], state.primary_end
    parts = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    wanted, root = row.goal_positions[end], pose.positions[parts[2]]
    surely = interpolate_point(end_position(row, end, pose), wanted, limit.certainty)
    for attempt in range(LIMITED_STEPS + (LATE_LIMITED_STEPS if row.assisted else 0)):
        left = distance(wanted, end_position(row, end, pose)) if attempt >= LIMITED_STEPS else 0.0
        fraction = min((2.0 * NEARLY_MET_RESIDUAL - left) / NEARLY_MET_RESIDUAL, 1.0)
        if fraction <= 0.0:
            return
        point, goal = effective_point(row, end, surely, state.holds_end, pose)
        far, now = distance(goal, root), distance(point, root)
        spans = min(row.flexion_thresholds[end], now), max(allowed_reach(row, end, far), now)
        lifted = end_pose(limb, pose)
        size = limited_limb_step(fraction, limit, parts, point, goal, spans, pose)
        if state.holds_end:
            restore_end(limb, lifted, pose)
        clamp_limb_joints(limb, False, False, problem)
        if size < LEAST_LIMITED_STEP:
            return


@kernel
def clamp_limb_joints(limb, task_moved, updates_caps, problem):
    """Clamp all joints of a limb to their limits; True if any was beyond them.

    ``task_moved`` is true if a task has moved the joints since they were last clamped; ``updates_caps`` to update their
    soft bounds (caps).
    """
    pose, limits, state = problem.pose, problem.body.limits, problem.search.limbs[limb]
    drawn = False
    if task_moved or not is_well_within(limb, 0, limits, pose.rotations):
        end = end_pose(limb, pose)
        drawn = clamp_joint(limb, 0, task_moved, updates_caps, limits, pose)
        if task_moved and state.lower_rotated:
            drawn = clamp_elbow_or_knee(limb, limits, pose) or drawn
        if state.holds_end:
            restore_end(limb, end, pose)
    if limits[limb].end_rotates and (task_moved or not is_well_within(limb, 1, limits, pose.rotations)):
        drawn = clamp_joint(limb, 1, task_moved, updates_caps, limits, pose) or drawn
    return drawn
