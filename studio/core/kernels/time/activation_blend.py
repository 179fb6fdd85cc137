"""Activation transitions: solutions are blended in them, and not targets (METHOD (31)).

On the straight line from a point to its target a hand may pass its own shoulder, where the arm whirls about, or be out
of reach after a moment, where elbow and trunk stop at once. So such a frame is solved with all its tasks, then without
the one of least activation, and so on until only the fully active ones are left. Each pose is blended with the pose
before, joint by joint; then the tasks of both poses are restored.

In a ``SearchState`` the *saved* pose, that before, is ``kept_state`` and ``kept_rotations``; the pose just solved is
``level_start`` and ``solved_rotations``; the blend is ``state`` and ``blended_rotations``. Blended residuals are in the
tasks.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    interpolate_rotation,
    relative_rotation,
    rotation_error,
    rotation_from_matrix,
    write_rotation,
)
from studio.core.kernels.algebra.vectors import (
    blend_points,
    copy_matrix,
    copy_point,
    copy_points,
    distance,
    length,
    length_in_axes,
    offset_between,
)
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_limits import effective_point
from studio.core.kernels.limbs.limb_tasks import BLENDED_POSE_KEPT, NEGLIGIBLE_ERROR
from studio.core.kernels.search.body_placement import pose_body, solve_limbs
from studio.core.kernels.search.level_step import ALLOWED_VIOLATION
from studio.core.kernels.search.levels import priority_violation, restore_feasibility, save_task_results
from studio.core.kernels.tasks.goals import (
    RADIAN_LENGTH,
    has_own_goal,
    interpolate_point,
    is_balance,
    is_position,
    is_rotation,
)
from studio.core.kernels.tasks.limb_rows import LIMB_SHORT_RESIDUAL
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.kernels.tasks.task_kinds import residual_of
from studio.core.kernels.tasks.task_status import (
    ACTIVE,
    IN_TRANSITION,
    INACTIVE,
    UNPINNED,
    begin_transition,
    pin_to_residual,
)

TASK_DROPPED_IN_SAVED_POSE = 2
"""Value of ``blended_limbs`` for a limb whose task was dropped in the saved pose, while the next pose is solved."""

STRAIGHT_LIMB_TOLERANCE = 0.01
"""Distance of a limb from full extension, as a fraction of its length, from which the limb rather than the trunk bends
for its goal.
"""


@kernel
def next_activation(least, frame, tasks, activations):
    """Least activation, above ``least``, of all tasks with a blended transition at this frame; 1 if there is none."""
    found = 1.0
    for c in range(tasks.shape[0]):
        if least < activations[c, frame] < found and tasks[c].blends:
            found = activations[c, frame]
    return found


@kernel
def save_solution(first, problem):
    """Save the pose just solved, to be blended with the next one; with ``first`` also the residuals of its tasks."""
    tasks, search, pose = problem.tasks, problem.search, problem.pose
    copy_points(search.state, search.kept_state)
    write_limb_joint_rotations(search.kept_rotations, pose)
    for limb in range(4):
        search.blended_limbs[limb] = 0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if first:
            row.blended_residual = residual_of(c, problem) if row.status != INACTIVE else 0.0
        mark_blended_limbs(row, TASK_DROPPED_IN_SAVED_POSE, search.blended_limbs)


@kernel
def write_limb_joint_rotations(out_rotations, pose):
    """Write the rotations of all limbs' segments in their parents, (16, 3, 3), four a limb."""
    for limb in range(4):
        before, upper, _ = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
        for bone in range(3 if limb < 2 else 4):
            write_rotation(
                relative_rotation(pose.rotations[before], pose.rotations[upper + bone]), out_rotations[4 * limb + bone]
            )
            before = upper + bone


@kernel
def mark_blended_limbs(row, value, out_blended):
    """Write ``value`` into ``out_blended`` (4,) for the limbs of a task that is dropped, or in transition."""
    if row.status > ACTIVE and not is_balance(row):
        for end in range(2):
            if row.limbs[end] >= 0 and row.limb_weights[end, 0] > 0.0:
                out_blended[row.limbs[end]] = value


@kernel
def blend_residuals(fraction, problem):
    """Blend the residuals of the pose just solved with those of the saved one, which has the weight ``fraction``."""
    tasks, search, pose = problem.tasks, problem.search, problem.pose
    copy_points(search.state, search.level_start)
    write_limb_joint_rotations(search.solved_rotations, pose)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        now = residual_of(c, problem) if row.status != INACTIVE else 0.0
        row.residual_change = abs(row.blended_residual - now)
        row.blended_residual = fraction * row.blended_residual + (1.0 - fraction) * now


@kernel
def blend_states(fraction, search):
    """Blend state and limbs of the saved pose, with the weight ``fraction``, into those just solved."""
    blend_points(fraction, search.level_start, search.kept_state, search.state)
    for limb in range(4):
        blend_limb(fraction, limb, search)


@kernel
def blend_limb(fraction, limb, search):
    """Blend one limb of the saved pose, with weight ``fraction``, into the pose just solved."""
    for bone in range(4 * limb, 4 * limb + (3 if limb < 2 else 4)):
        solved, kept = (
            rotation_from_matrix(search.solved_rotations[bone]),
            rotation_from_matrix(search.kept_rotations[bone]),
        )
        write_rotation(interpolate_rotation(solved, kept, fraction), search.blended_rotations[bone])


@kernel
def pose_blend(fraction, frame, activations, problem):
    """Pose the body between the pose just solved (``fraction`` 0) and the saved one (1), and hold the tasks of both.

    Where they cannot be held in between, the body takes the nearer one of both poses.
    """
    search = problem.search
    blend_residuals(fraction, problem)
    blend_states(fraction, search)
    pose_blended_state(frame, activations, problem)
    if exceeds_blended_residuals(problem):
        blend_states(1.0 if fraction >= 0.5 else 0.0, search)
        for limb in range(4):
            search.blended_limbs[limb] = BLENDED_POSE_KEPT
        pose_body(problem)
        for limb in range(4):
            search.blended_limbs[limb] = 0


@kernel
def exceeds_blended_residuals(problem):
    """True if the residual of an active task exceeds its blended residual."""
    tasks = problem.tasks
    lost = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        may = PRIORITY_TOLERANCE + (row.blended_residual if row.pinned == UNPINNED else row.residual_change)
        lost = lost or (row.status == ACTIVE and residual_of(c, problem) > may)
    return lost


@kernel
def write_residuals(frame, problem, out_residuals):
    """Write the residual of each task at one frame."""
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        out_residuals[c, frame] = math.nan
        if tasks[c].status == IN_TRANSITION:
            out_residuals[c, frame] = tasks[c].blended_residual
        elif tasks[c].status != INACTIVE:
            out_residuals[c, frame] = residual_of(c, problem)


@kernel
def pose_blended_state(frame, activations, problem):
    """Pose the body from the blended state and limbs, and restore tasks with small blended residuals.

    A task whose goal does not depend on the pose is pinned to its blended residual, so that lower tasks cannot change
    it.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    level = chain.weights.shape[0] - tasks.shape[0]
    blended = search.blended_limbs
    for c in range(tasks.shape[0]):
        row = tasks[c]
        on_edge = row.status == INACTIVE and 0.0 < activations[c, frame] < 1.0
        both = row.residual_change < math.inf  # else it is eased, and there is no other pose
        residual = max(row.blended_residual, row.residual_change if both else 0.0) * (
            RADIAN_LENGTH if is_rotation(row) else 1.0
        )
        if on_edge or (row.status == ACTIVE and row.pinned == UNPINNED and residual > LIMB_SHORT_RESIDUAL):
            begin_transition(row)
        mark_blended_limbs(row, BLENDED_POSE_KEPT, blended)
        if both and row.status != INACTIVE and not on_edge and has_own_goal(row):
            pin_to_residual(row)
    for limb in range(4):
        blended[limb] = BLENDED_POSE_KEPT if blended[limb] else 0
    pose_body(problem)
    save_task_results(0, level, problem)
    for c in range(tasks.shape[0]):
        if tasks[c].status == ACTIVE:
            hold_blended_task(tasks[c], problem)
    solve_limbs(level, problem)
    restore_blended_tasks(level, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        residual = row.pinned == UNPINNED and row.blended_residual > ALLOWED_VIOLATION
        if row.status == ACTIVE and residual and row.limbs[0] >= 0 and blended[row.limbs[0]]:
            begin_transition(row)  # its place was where the blend has it, and not where it wants to be
    for limb in range(4):
        blended[limb] = 0


@kernel
def restore_blended_tasks(level, problem):
    """Restore the tasks of the blended pose; if that increases the priority violation, the pose stays."""
    search = problem.search
    copy_points(search.state, search.trial_state)
    residual = priority_violation(level, False, problem)
    if restore_feasibility(level, NEGLIGIBLE_ERROR, False, problem) > residual:
        copy_points(search.trial_state, search.state)
        pose_body(problem)
        solve_limbs(level, problem)


@kernel
def hold_blended_task(row, problem):
    """Set the result that a task of both poses keeps: its goal, or its blended residual."""
    search, pose = problem.search, problem.pose
    blended = search.blended_limbs
    pinned = row.pinned != UNPINNED and has_own_goal(row)
    row.kept_residual, left = (0.0, row.blended_residual) if pinned else (row.blended_residual, 0.0)
    fraction = min(
        max(1.1 * (1.0 - row.kept_residual * (RADIAN_LENGTH if is_rotation(row) else 1.0) / LIMB_SHORT_RESIDUAL), 0.0),
        1.0,
    )
    if is_rotation(row):
        now = pose.rotations[row.segments[0]]
        fraction *= 1.0 - left / max(length(rotation_error(row.goal_rotation, now)), left, 1e-9)
        write_rotation(
            interpolate_rotation(rotation_from_matrix(now), rotation_from_matrix(row.goal_rotation), fraction),
            row.kept_rotation,
        )
        if pinned or (row.limbs[0] >= 0 and blended[row.limbs[0]]):
            copy_matrix(row.kept_rotation, row.goal_rotation)
        return
    for end in range(2):
        goal = row.goal_positions[1 if is_balance(row) else end]
        displacement = length_in_axes(offset_between(row.kept_positions[end], goal), row.axes if is_balance(row) else 3)
        more = fraction * (1.0 - left / max(displacement, 1e-9))
        copy_point(interpolate_point(row.kept_positions[end], goal, more), row.kept_positions[end])
        if is_position(row) and row.limbs[end] >= 0 and blended[row.limbs[end]]:
            copy_point(row.kept_positions[end], row.goal_positions[end])
            row.soft_thresholds[end], row.flexion_thresholds[end] = 1.0, 0.0
            if row.max_reach[end] > 0.0:  # a shoulder has no limb before it
                update_blended_reach(row, end, row.limbs[end] >= 2 or search.end_tasks[row.limbs[end]] >= 0, pose)
    if pinned:
        copy_point(row.kept_positions[0], row.goal_positions[0])
        copy_point(row.kept_positions[0], row.goal_positions[1])


@kernel
def update_blended_reach(row, end, holds_end, pose):
    """Limit the extension of a blended limb near full stretch: the straighter it is, the less it extends to its goal.

    With d metres left to full stretch in the blend, and w at its goal, d s(w) / s(d) are left (``soft_positive``); the
    trunk covers the difference to w (METHOD (31)).
    """
    root, longest = limb_parts(row.limbs[end], pose.positions.shape[0] - POINTS_BESIDE_SPINE)[2], row.max_reach[end]
    point, goal = effective_point(row, end, row.goal_positions[end], holds_end, pose)
    shoulder, edge = pose.positions[root], STRAIGHT_LIMB_TOLERANCE * longest
    span, spare = distance(goal, shoulder), max(longest - distance(point, shoulder), 0.0)
    row.goal_reaches[end] = longest - spare * soft_positive(longest - span, edge) / soft_positive(spare, edge)
    row.min_reach[end] = row.goal_reaches[end]


@kernel
def soft_positive(value, edge):
    """``value`` far above ``edge``, smoothly decaying to 0 for negative values, always positive."""
    return 0.5 * (value + math.sqrt(value * value + 4.0 * edge * edge))
