"""Tasks of one frame, level by level: limbs in closed form, trunk and root where limbs fall short.

Every frame starts from its own pose, and operations are continuous in their inputs, so that neighbouring frames have
neighbouring solutions. Where a level is dropped, or a limb changes sides, ``kernels.time.smoothed_frames`` smooths.

A level is a group of tasks of one priority, 0 the highest. The *agreed reach* of a limb (``goal_reaches`` of ``TASK``)
is the distance in metres from its root to its goal that the limb covers by itself, agreed when its level begins; the
joints of the chain move its root for the rest.
"""

import math

from studio.core.kernels.algebra.vectors import (
    blend_points,
    copy_matrix,
    copy_point,
    copy_points,
    distance,
    offset_between,
    zero_points,
)
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb import MAX_EXTENSION, SOFT_IK_THRESHOLD, SOLE_SOFT_IK_THRESHOLD, soft_extension
from studio.core.kernels.limbs.limb_limits import effective_point
from studio.core.kernels.limbs.limb_tasks import (
    find_end_tasks,
    mark_secondary_tasks,
    reach_range,
)
from studio.core.kernels.limbs.root_retreat import retreat_root
from studio.core.kernels.limbs.stiffness import release_stiff_limbs, restrict_stiff_limbs
from studio.core.kernels.limits.limb_joint_limits import note_unsolved_angles, restore_caps, save_caps
from studio.core.kernels.limits.root_reach_limit import release_fraction
from studio.core.kernels.search.backtracking import (
    BACKTRACKING_TARGET,
    next_step_length,
    start_backtracking,
    update_bracket,
)
from studio.core.kernels.search.body_placement import (
    ONLY_POINTS_POSED,
    find_idle_limbs,
    pose_body,
    reset_limb_pose,
    solve_limbs,
)
from studio.core.kernels.search.chain_reach import (
    has_single_joint,
    reachable_distance,
    soft_reachable_distance,
    update_unreachable_fraction,
)
from studio.core.kernels.search.level_step import ALLOWED_VIOLATION, TASK_MET_RESIDUAL, take_level_step
from studio.core.kernels.search.redundancy import may_rotate_limbs, set_reachable_balance_goals
from studio.core.kernels.tasks.balance import centre_of_mass
from studio.core.kernels.tasks.goals import (
    end_position,
    has_residual,
    is_balance,
    is_position,
    is_rotation,
    moves_point,
)
from studio.core.kernels.tasks.task_kinds import residual_of
from studio.core.kernels.tasks.task_status import ACTIVE, INACTIVE, drop_task

LEVEL_STEPS, LATE_LEVEL_STEPS = 4, 5
"""Steps of a level, and late steps while it is nearly met or still gains: a body far out of reach would take many more
to come to rest, for little gain.
"""
REDUNDANT_STEPS = 6
"""Greatest number of steps of a level whose chain frees shoulders or hips."""
FULL_NEWTON_STEPS = 12
"""Greatest number of steps of a level with full Newton steps: a spine that buckles under a head pulled down converges
slowly.
"""
DAMPING_DECAY = 0.25
"""Factor of the damping from one step of a level to the next: directions with little effect are freed last. Levels with
a balance keep their damping, because they would sink to the ground, or fling limbs about.
"""
LIMITED_LEG_STEPS = 12
"""Greatest number of steps of a level with a leg at its joint limits, whose residual hardly depends on the root to
first order.
"""
STEPS_BEFORE_FULL_NEWTON = 2
"""Steps along the rows' directions before full Newton steps. Those are taken only without planted feet and higher
levels, because held rows would bend the directions of all joints too.
"""
SOFT_FLEXION_RANGE = 0.05
"""Fraction of the range between greatest and least reach, above the least, in which a limb folds softly."""
RESTORATION_STEPS = 8
"""Greatest number of steps of a feasibility restoration for the levels above."""
RESTORATION_DECREASE = 0.7
"""Greatest fraction of the least violation so far that a successful restoration step leaves; the second unsuccessful
step ends the restoration.
"""


@kernel
def solve_frame(level_count, problem):
    """Solve the tasks of one frame, ``level_count`` levels in order of priority, as far as chains and priorities
    allow.
    """
    tasks, chain, body, search, pose = problem.tasks, problem.chain, problem.body, problem.search, problem.pose
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    zero_points(search.state)
    idle = search.idle_limbs
    find_idle_limbs(tasks, chain.joint_of_segment, body.hand_contacts, spine_count, idle)
    mark_secondary_tasks(tasks)
    update_limb_limits(problem)
    before = -1
    for level in range(level_count):
        if not is_level_active(level, tasks):
            continue
        changed = find_end_tasks(level, tasks, spine_count, search.end_tasks)
        update_reaches(level, changed, problem)
        if before >= 0:
            save_task_results(before, level, problem)
            save_caps(body.limits)
        solve_level(level, before < 0, problem)
        before = level
    for limb in range(4):
        outlined = idle[limb] == ONLY_POINTS_POSED
        idle[limb] = 0
        if outlined:
            reset_limb_pose(limb, problem)


@kernel
def update_limb_limits(problem):
    """Write the unsolved joint angles of every limb that has a task or a joint in the search.

    Those of wrists and ankles are included where hand or foot have tasks.
    """
    tasks, joint_of_segment, body, start = problem.tasks, problem.chain.joint_of_segment, problem.body, problem.start
    limits = body.limits
    for limb in range(limits.shape[0]):
        upper = limb_parts(limb, start.positions.shape[0] - POINTS_BESIDE_SPINE)[1]
        found, tip = joint_of_segment[upper] >= 0, limb >= 2
        for c in range(tasks.shape[0]):
            for end in range(2):
                if tasks[c].limbs[end] == limb:
                    found = found or tasks[c].status == ACTIVE
                    tip = tip or tasks[c].segments[end] >= upper + 2
        if found:
            note_unsolved_angles(limb, 2 if tip else 1, limits, start)
            limits[limb].release = release_fraction(limb - 2, body) if limb >= 2 else 1.0


@kernel
def is_level_active(level, tasks):
    """True if any task of a level is active."""
    acts = False
    for c in range(tasks.shape[0]):
        acts = acts or (tasks[c].level == level and tasks[c].status == ACTIVE)
    return acts


@kernel
def solve_level(level, fresh, problem):
    """Solve one level by Newton steps with the levels above held, then restore the residuals of those.

    ``fresh`` is true if no higher level has been solved at this frame.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    stiff = release_stiff_limbs(level, tasks)
    copy_points(search.state, search.level_start)
    place_body(level, fresh, problem)
    if stiff:
        restrict_stiff_limbs(level, tasks)
        place_body(level, False, problem)
    if not fresh and drop_conflicting_tasks(level, problem):
        restart_level(level, problem)
    if chain.joints.shape[0] > 0:
        take_steps(level, fresh, problem)
    if not fresh:
        keep_priority(level, problem)


@kernel
def take_steps(level, fresh, problem):
    """Take steps until a level is met, or gains no more."""
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    past = search.last_step[0]
    past.residual = 0.0
    balances = set_reachable_balance_goals(level, problem)
    if is_level_met(level, problem):
        return
    frees = may_rotate_limbs(min(tasks.shape[0] + level, chain.weights.shape[0] - 1), chain)
    stays = fresh and not level_moves_root(level, tasks, chain)
    whole = stays and not frees
    tries = REDUNDANT_STEPS if frees else FULL_NEWTON_STEPS if whole else LEVEL_STEPS
    if not frees and retreat_root(level, problem):
        tries = LIMITED_LEG_STEPS
    for attempt in range(tries if frees else tries + LATE_LEVEL_STEPS):
        refines, is_late = whole and attempt >= STEPS_BEFORE_FULL_NEWTON, attempt >= tries
        less = 1.0 if frees or balances else DAMPING_DECAY**attempt
        if not take_level_step(level, False, refines, is_late, stays, less, problem) > 0.0:
            break
        place_body(level, False, problem)
        if past.suffices:
            break


@kernel
def keep_priority(level, problem):
    """Restore the residuals of the levels above, or back-track; where that fails, drop the level and reset the body to
    its start.
    """
    tasks, search = problem.tasks, problem.search
    violation, backtracking = restore_feasibility(level, ALLOWED_VIOLATION, True, problem), search.backtracking[0]
    if violation < ALLOWED_VIOLATION:
        return
    copy_points(search.state, search.trial_state)
    start_backtracking(0.0, violation, ALLOWED_VIOLATION, backtracking)
    while next_step_length(backtracking):
        update_bracket(pose_level_fraction(backtracking.step_length, level, problem), backtracking)
    if backtracking.violation < ALLOWED_VIOLATION:
        return
    copy_points(search.level_start, search.state)
    drop_level(level, tasks)
    restart_level(level, problem)


@kernel
def pose_level_fraction(fraction, level, problem):
    """Pose the body at ``fraction`` of the level's step, and restore the levels above; returns the remaining priority
    violation.
    """
    search = problem.search
    blend_points(fraction, search.level_start, search.trial_state, search.state)
    place_body(level, False, problem)
    return restore_feasibility(level, BACKTRACKING_TARGET * ALLOWED_VIOLATION, True, problem)


@kernel
def restart_level(level, problem):
    """Solve the limbs again after tasks of a level were dropped."""
    tasks, body, search, pose = problem.tasks, problem.body, problem.search, problem.pose
    restore_caps(body.limits)
    changed = find_end_tasks(level, tasks, pose.positions.shape[0] - POINTS_BESIDE_SPINE, search.end_tasks)
    update_reaches(level, changed, problem)
    place_body(level, False, problem)


@kernel
def drop_conflicting_tasks(level, problem):
    """Drop tasks of a level on limbs whose joint limits do not allow them beside a higher orientation task; True if
    any.

    No joint of the trunk could restore that orientation.
    """
    tasks = problem.tasks
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not is_rotation(row) or row.limbs[0] < 0 or row.status != ACTIVE or row.level >= level:
            continue
        limb = row.limbs[0]
        if residual_of(c, problem) - row.kept_residual < ALLOWED_VIOLATION:
            continue
        for other in range(tasks.shape[0]):
            named = tasks[other].limbs[0] == limb or tasks[other].limbs[1] == limb
            if named and tasks[other].level == level and tasks[other].status == ACTIVE:
                drop_task(tasks[other])
                found = True
    return found


@kernel
def restore_feasibility(level, tolerance, counts_decreases, problem):
    """Restore the residuals of the levels above until they have increased by less than ``tolerance``; returns the
    remaining priority violation.

    Metres or radians. With ``counts_decreases`` decreases count as well as increases.
    """
    chain, least, fails = problem.chain, math.inf, 0
    violation = priority_violation(level, counts_decreases, problem)
    for _ in range(RESTORATION_STEPS):
        if violation < tolerance:
            break
        if violation > RESTORATION_DECREASE * least:
            fails += 1
            if fails > 1:
                break
        least, joints = min(least, violation), chain.joints.shape[0]
        if joints == 0 or not take_level_step(level, True, False, False, False, 1.0, problem) > 0.0:
            break
        place_body(level, False, problem)
        violation = priority_violation(level, counts_decreases, problem)
    return violation


@kernel
def level_moves_root(level, tasks, chain):
    """True if any active task of a level may move the root."""
    root = chain.joint_of_segment[-1]
    frees = False
    for c in range(tasks.shape[0]):
        frees = frees or (
            root >= 0 and tasks[c].level == level and tasks[c].status == ACTIVE and chain.weights[c, root] > 0.0
        )
    return frees


@kernel
def drop_level(level, tasks):
    """Drop the tasks of a level, which cannot be met beside the levels above at this frame."""
    for c in range(tasks.shape[0]):
        if tasks[c].level == level and tasks[c].status != INACTIVE:
            drop_task(tasks[c])


@kernel
def place_body(level, fresh, problem):
    """Pose the body from its joints' state, and solve its limbs for all tasks down to a level.

    With ``fresh`` the body is in its unsolved pose already.
    """
    chain, search = problem.chain, problem.search
    if not fresh:
        pose_body(problem)
    elif chain.joints.shape[0] > 0:
        reset_rotations(search.segment_rotations)
    solve_limbs(level, problem)


@kernel
def reset_rotations(segment_rotations):
    """Set all segment rotations to the identity."""
    for segment in range(segment_rotations.shape[0]):
        for row in range(3):
            for column in range(3):
                segment_rotations[segment, row, column] = 1.0 if row == column else 0.0


@kernel
def is_level_met(level, problem):
    """True if the tasks of a level are met by the limbs alone, and the residuals of the levels above are unchanged."""
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status == ACTIVE and row.level == level and residual_of(c, problem) >= TASK_MET_RESIDUAL:
            return False
    return priority_violation(level, True, problem) < ALLOWED_VIOLATION


@kernel
def priority_violation(level, counts_decreases, problem):
    """Greatest increase of a residual of the levels above since it was saved, in metres or radians; with
    ``counts_decreases`` the greatest change.
    """
    tasks = problem.tasks
    worst = 0.0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if has_residual(row) and row.level < level:
            change = residual_of(c, problem) - row.kept_residual
            worst = max(worst, abs(change) if counts_decreases else change)
    return worst


@kernel
def save_task_results(first, level, problem):
    """Save the results of all higher-priority tasks, which a level has to keep.

    Residuals of the levels above ``first``, the level solved last, stay as saved earlier, so that errors do not
    accumulate.
    """
    tasks, pose = problem.tasks, problem.pose
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not has_residual(row) or row.level >= level:
            continue
        residual = residual_of(c, problem)
        if row.level >= first:
            row.kept_residual = residual
        if is_rotation(row):
            copy_matrix(pose.rotations[row.segments[0]], row.kept_rotation)
        elif is_balance(row):
            copy_point(centre_of_mass(problem.body.mass_fractions, pose.positions), row.kept_positions[0])
        else:
            for end in range(2):
                if row.points[end] >= 0:
                    copy_point(end_position(row, end, pose), row.kept_positions[end])
                if row.limbs[end] >= 0:
                    root = limb_parts(row.limbs[end], spine_count)[2]
                    copy_point(pose.positions[root], row.kept_roots[end])


@kernel
def update_reaches(level, changed_limbs, problem):
    """Update the greatest, least and agreed reach of the limbs for each end of the tasks of a level, in metres.

    Tasks of the levels above keep theirs, except on the limbs in the bit mask ``changed_limbs``, whose hand or foot is
    held by another task now.
    """
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status != ACTIVE or row.level > level or not moves_point(row):
            continue
        for end in range(2):
            limb = row.limbs[end]
            if row.level < level and not (limb >= 0 and changed_limbs >> limb & 1):
                continue
            if end == 0 and is_position(row) and (limb < 0 or row.limb_weights[end, 0] == 0.0):
                copy_point(end_position(row, end, problem.start), row.start_position)
                update_unreachable_fraction(c, row, problem)
            if limb >= 0:
                update_reach(c, end, row.level == level, problem)


@kernel
def update_reach(c, end, is_own_level, problem):
    """Update least, greatest and agreed reach in metres of a limb for one end of task ``c``.

    With ``is_own_level``, for a task of the level being solved, the position of the limb's root is saved first. Beyond
    its soft-IK threshold (or its extension in the motion) the limb extends softly, so that its extension is smooth in
    time and the trunk covers the rest without error (METHOD 8, "reach sharing").
    """
    body, start, row = problem.body, problem.start, problem.tasks[c]
    limb, origin = row.limbs[end], row.root_positions[end]
    holds_end, point = limb >= 2 or problem.search.end_tasks[limb] >= 0, end_position(row, end, start)
    _, upper, root = limb_parts(limb, start.positions.shape[0] - POINTS_BESIDE_SPINE)
    if is_own_level:
        copy_point(problem.pose.positions[root], origin)
    fold, reach, now = reach_range(limb, row.segments[end], holds_end, point, body.limits, start)
    row.min_reach[end], row.max_reach[end], row.goal_reaches[end] = fold, reach, reach
    row.flexion_thresholds[end] = min(fold + SOFT_FLEXION_RANGE * (reach - fold), now)
    row.soft_thresholds[end], row.slack[end] = 1.0, 0.0
    if reach <= 0.0 or row.segments[end] == upper:
        return
    shoulder = start.positions[root]
    soft_threshold = SOFT_IK_THRESHOLD if row.assisted else SOLE_SOFT_IK_THRESHOLD
    row.soft_thresholds[end] = min(max(distance(point, shoulder) / reach, soft_threshold), MAX_EXTENSION)
    if is_position(row) and row.assisted:
        bent, goal = effective_point(row, end, row.goal_positions[end], holds_end, start)
        row.soft_thresholds[end] = min(max(distance(bent, shoulder) / reach, soft_threshold), MAX_EXTENSION)
        x, y, z = offset_between(origin, goal)
        span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
        taken = span / reach if row.stiff else max(span / reach, row.soft_thresholds[end])
        row.goal_reaches[end] = reach * min(soft_extension(taken, row.soft_thresholds[end]), MAX_EXTENSION)
        displacement, parent = span - min(max(span, fold), row.goal_reaches[end]), 0 if limb >= 2 else upper - 1
        if displacement < 0.0 or (displacement > 0.0 and has_single_joint(c, parent, problem.chain)):
            sign = math.copysign(1.0 / span, displacement)
            able = reachable_distance(c, sign * x, sign * y, sign * z, shoulder, parent, problem)
            row.slack[end] = displacement - math.copysign(
                soft_reachable_distance(abs(displacement), able), displacement
            )
