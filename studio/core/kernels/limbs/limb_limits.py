"""A limb within the limits of its joints: drawn back, and then along them to where its primary task is missed least.

METHOD 6, (25) to (28). Records are those of ``kernels.records``.
"""

from studio.core.kernels.algebra.vectors import copy_point, distance
from studio.core.kernels.body.parts import lift_end, limb_parts, put_end
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.limb import soft_reach
from studio.core.kernels.limits.joint_limits import is_well_within, keep_joint, keep_middle
from studio.core.kernels.limits.within_limits import NEARLY, step_within
from studio.core.kernels.tasks.goals import ease_goal, end_place
from studio.core.kernels.tasks.task import STRICT

STEPS_WITHIN, LATE_WITHIN = 6, 3
"""Steps that a limb takes along its limits towards what it misses, at most, and those that it may add where little is
missed: whole up to ``NEARLY``, none from twice that on.
"""
STILL_WITHIN = 0.5 * STRICT
"""Radians of such a step after which no other follows."""


@small_kernel
def bent_point(row, end, goal, holds_end, pose):
    """(point, goal): what bend and aim of a limb move, and where to, both (x, y, z): a task's own point and ``goal``,
    or, where hand or foot keeps its orientation in the world, wrist or ankle and its part of the way.
    """
    _, upper, root = limb_parts(row.limbs[end], pose.positions.shape[0] - 23)
    point, tip = end_place(row, end, pose), pose.positions[root + 2]
    x, y, z = goal[0], goal[1], goal[2]
    if holds_end and row.segments[end] >= upper + 2:
        return (tip[0], tip[1], tip[2]), (x + tip[0] - point[0], y + tip[1] - point[1], z + tip[2] - point[2])
    return point, (x, y, z)


@kernel
def comfortable(row, end, span):
    """How far a limb stretches for a place ``span`` metres from its root: as far as agreed, or softly if alone.

    METHOD (11).
    """
    if row.helped:
        return min(span, row.reaches[end])
    longest = row.longest[end]
    return longest * soft_reach(span / longest, row.comforts[end]) if longest > 0.0 else span


@kernel
def keep_within(limb, problem):
    """Bring a limb back within its limits where its tasks have put it beyond.

    Where its primary task leaves it a swivel, it goes on from there along its limits to where that is missed least.
    Helped by joints beside it, it goes by the limits that the first placing found.
    """
    state, limits = problem.search.limbs[limb], problem.body.limits
    rotations, limit = problem.pose.rotations, limits[limb]
    tip_stays = not limit.tip_turns or is_well_within(limb, 1, limits, rotations)
    if not state.turns_lower and tip_stays and is_well_within(limb, 0, limits, rotations):
        return
    limit.sure = 1.0
    for joint in range(2):
        copy_point(limit.agreed[joint], limit.caps[joint])
    helped = (state.swivels or state.aims_upper) and problem.tasks[state.primary].helped
    drawn = draw_back(limb, True, limit.fresh or not helped, problem)
    if helped and limit.fresh:  # whatever comes after goes by them, and so does the next placing
        for joint in range(2):
            copy_point(limit.caps[joint], limit.agreed[joint])
        limit.fresh = 0
    if drawn and state.swivels:
        go_along_limits(limb, problem)


@kernel
def go_along_limits(limb, problem):
    """Steps of a limb that lies at its limits, within them, to where its primary task is missed least (METHOD (28))."""
    pose, state, limit = problem.pose, problem.search.limbs[limb], problem.body.limits[limb]
    row, end = problem.tasks[state.primary], state.primary_end
    parts = limb_parts(limb, pose.positions.shape[0] - 23)
    wanted, root = row.places[end], pose.positions[parts[2]]
    surely = ease_goal(end_place(row, end, pose), wanted, limit.sure)
    for attempt in range(STEPS_WITHIN + (LATE_WITHIN if row.helped else 0)):
        left = distance(wanted, end_place(row, end, pose)) if attempt >= STEPS_WITHIN else 0.0
        part = min((2.0 * NEARLY - left) / NEARLY, 1.0)
        if part <= 0.0:
            return
        point, goal = bent_point(row, end, surely, state.holds_end, pose)
        far, now = distance(goal, root), distance(point, root)
        spans = min(row.easings[end], now), max(comfortable(row, end, far), now)
        lifted = lift_end(limb, pose)
        size = step_within(part, limit, parts, point, goal, spans, pose)
        if state.holds_end:
            put_end(limb, lifted, pose)
        draw_back(limb, False, False, problem)
        if size < STILL_WITHIN:
            return


@kernel
def draw_back(limb, anew, noting, problem):
    """Draw all joints of a limb back within their limits (``keep_joint``); whether any was."""
    pose, limits, state = problem.pose, problem.body.limits, problem.search.limbs[limb]
    drawn = False
    if anew or not is_well_within(limb, 0, limits, pose.rotations):
        lifted = lift_end(limb, pose)
        drawn = keep_joint(limb, 0, anew, noting, limits, pose)
        if anew and state.turns_lower:
            drawn = keep_middle(limb, limits, pose) or drawn
        if state.holds_end:
            put_end(limb, lifted, pose)
    if limits[limb].tip_turns and (anew or not is_well_within(limb, 1, limits, pose.rotations)):
        drawn = keep_joint(limb, 1, anew, noting, limits, pose) or drawn
    return drawn
