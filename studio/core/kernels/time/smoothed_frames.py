"""Frames posed again from smoothed states, where solved frames have acceleration peaks (METHOD (36) to (38)).

``above`` is the problem whose pose is that of the higher levels at the same frame.
"""

import math

from studio.core.kernels.algebra.vectors import ZERO_VECTOR, add_vectors, copy_matrix, copy_point, copy_points
from studio.core.kernels.body.parts import copy_pose
from studio.core.kernels.compiling import kernel, pack
from studio.core.kernels.limbs.limb_tasks import BLENDED_POSE_KEPT
from studio.core.kernels.limits.clearance_tiers import measure_frame_penetration
from studio.core.kernels.limits.root_reach_limit import limit_root_step
from studio.core.kernels.limits.self_collision import clear_after_tasks
from studio.core.kernels.records import Pose
from studio.core.kernels.search.backtracking import next_step_length, start_backtracking, update_bracket
from studio.core.kernels.search.body_placement import pose_body, with_pose
from studio.core.kernels.tasks.goals import is_balance
from studio.core.kernels.tasks.targets import set_goals
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.kernels.tasks.task_kinds import pin_goal, residual_of, update_goals
from studio.core.kernels.tasks.task_status import ACTIVE, INACTIVE, begin_transition, pin_to_residual
from studio.core.kernels.time.activation_blend import (
    blend_states,
    next_activation,
    pose_blended_state,
    write_limb_joint_rotations,
    write_residuals,
)

LEAST_ACTIVATION = 1e-9
"""Least activation that counts as positive."""
SMOOTHING_VIOLATION = 0.75 * PRIORITY_TOLERANCE
"""Greatest change, in metres or radians, of a higher task's residual by the smoothing of a level."""


@kernel
def pose_smoothed(frame, waited, clip, problem):
    """Pose a frame from its smoothed state, restore the results of the higher levels, and report all residuals.

    ``waited`` is true if self-collision constraints wait for tasks.
    """
    easing, chain, search = clip.easing, problem.chain, problem.search
    level, changes = easing.level[0], easing.violations
    above = pack(with_pose(problem, pack(Pose(easing.above.positions[frame], easing.above.rotations[frame]))))
    for joint in range(search.state.shape[0]):
        write_limited_state(easing.states[frame, joint], chain.limits[joint], search.state[joint])
    for rotation in range(16):
        copy_matrix(easing.rotations[frame, rotation], search.blended_rotations[rotation])
    limit_smoothed_root(problem)
    if easing.above.return_fractions[frame] == 1.0:
        changes[frame] = pose_from_higher_levels(frame, clip, problem, above)
    else:
        changes[frame] = pose_and_hold(frame, level.solves_again, waited, clip, problem, above)
        if level.keeps_priority and changes[frame] >= SMOOTHING_VIOLATION:
            back_track_smoothing(changes[frame], frame, waited, clip, problem, above)
    report_residuals(frame, clip, problem)


@kernel
def pose_and_hold(frame, solves_again, waited, clip, problem, above):
    """Pose the body from its smoothed state, and hold the results of the higher levels; returns the priority violation.

    With ``solves_again`` the tasks of the level are solved again as far as possible, otherwise they stay as smoothed.
    """
    tasks, activations = problem.tasks, clip.constraints.activations[-1]
    residuals, level = clip.easing.residuals, clip.easing.level[0]
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.blended_residual, row.residual_change = residuals[c, frame] if residuals[c, frame] > 0.0 else 0.0, math.inf
        if activations[c, frame] > 0.0 and row.level < level.level:
            pin_task(c, row.level < level.contact_levels, above)
        elif row.status == ACTIVE and not solves_again:
            begin_transition(row)
    pose_blended_state(frame, activations, problem)
    clears = clip.clearance.required_distances.shape[0]
    if clears > 0:
        report_residuals(frame, clip, problem)
        clear_after_tasks(frame, tasks.shape[0] + clears, True, waited, clip, problem)
    return smoothing_violation(frame, clip, problem, above)


@kernel
def back_track_smoothing(violation, frame, waited, clip, problem, above):
    """Back-track from the smoothed pose towards that of the higher levels until their results are not violated, if need
    be completely.
    """
    search, backtracking = problem.search, problem.search.backtracking[0]
    copy_points(search.state, search.level_start)
    copy_points(clip.easing.above.states[frame], search.kept_state)
    write_limb_joint_rotations(search.solved_rotations, problem.pose)
    write_limb_joint_rotations(search.kept_rotations, above.pose)
    start_backtracking(0.0, violation, SMOOTHING_VIOLATION, backtracking)
    while next_step_length(backtracking):
        blend_states(1.0 - backtracking.step_length, search)
        update_bracket(pose_and_hold(frame, False, waited, clip, problem, above), backtracking)
    if backtracking.violation >= SMOOTHING_VIOLATION:
        pose_from_higher_levels(frame, clip, problem, above)


@kernel
def pose_from_higher_levels(frame, clip, problem, above):
    """Pose the body as the higher levels solved it; returns the priority violation."""
    copy_points(clip.easing.above.states[frame], problem.search.state)
    copy_pose(above.pose, problem.pose)
    if clip.clearance.required_distances.shape[0] > 0:
        measure_frame_penetration(frame, clip, problem.pose)
    return smoothing_violation(frame, clip, problem, above)


@kernel
def smoothing_violation(frame, clip, problem, above):
    """Greatest change of a residual of the higher levels by the smoothing, metres or radians.

    In transitions reported residuals are blended, so that residuals are compared with those of the pose ``above``.
    """
    tasks, activations, residuals = problem.tasks, clip.constraints.activations[-1], clip.easing.residuals
    clearance, level = clip.clearance, clip.easing.level[0]
    set_goals(LEAST_ACTIVATION, frame, activations, clip.constraints, problem)
    edges = has_transition(frame, tasks, activations)
    for row in tasks:
        row.engaged = 0
    if edges:
        update_goals(tasks.shape[0], False, above)
        for c in range(tasks.shape[0]):
            tasks[c].engaged = 0
            if tasks[c].level < level.level and tasks[c].status != INACTIVE:
                tasks[c].blended_residual = residual_of(c, above)
    update_goals(tasks.shape[0], False, problem)
    most = 0.0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.engaged = 0
        if row.level < level.level and row.status != INACTIVE:
            before = row.blended_residual if edges else residuals[c, frame]
            most = max(most, abs(residual_of(c, problem) - before))
    for q in range(level.clear_count, clearance.required_distances.shape[0]):
        if clearance.activations[q, frame] > 0.0:
            most = max(most, abs(clearance.residuals[q, frame] - residuals[tasks.shape[0] + q, frame]))
    return most


@kernel
def report_residuals(frame, clip, problem):
    """Report the residuals of all tasks of a frame; in transitions the blended ones for tasks of higher levels."""
    tasks, activations, residuals = problem.tasks, clip.constraints.activations[-1], clip.easing.residuals
    restore_goals(frame, activations, clip.constraints, problem)
    edges = has_transition(frame, tasks, activations)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.blended_residual = residuals[c, frame] if residuals[c, frame] > 0.0 else 0.0
        if edges and row.level < clip.easing.level[0].level and row.status != INACTIVE:
            begin_transition(row)
    write_residuals(frame, problem, clip.residuals)


@kernel
def has_transition(frame, tasks, activations):
    """True if any task is in a blended activation transition."""
    return next_activation(0.0, frame, tasks, activations) < 1.0


@kernel
def pin_task(c, is_contact, above):
    """Pin task ``c``, which may be a contact, to its result in the pose ``above``."""
    row, search = above.tasks[c], above.search
    pin_to_residual(row)
    row.blended_residual, row.residual_change = 0.0, 0.0
    pin_goal(c, above)
    for end in range(2):
        limb = row.limbs[end]
        if not is_balance(row) and limb >= 0 and row.limb_weights[end, 0] > 0.0 and not (is_contact and limb >= 2):
            search.blended_limbs[limb] = BLENDED_POSE_KEPT  # legs that stand are placed on their ankles


@kernel
def write_limited_state(state, most, out_state):
    """Write the state of a joint (3,), shortened to its limit ``most`` at this frame."""
    size = math.sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2])
    fraction = most / size if size > most else 1.0
    for axis in range(3):
        out_state[axis] = fraction * state[axis]


@kernel
def limit_smoothed_root(problem):
    """Move the root back to within the reach of planted feet."""
    search, root = problem.search, problem.chain.joint_of_segment[-1]
    if root < 0:
        return
    pose_body(problem)
    displacement = limit_root_step(
        problem.body, problem.start, search.segment_rotations, search.state[root], ZERO_VECTOR
    )
    copy_point(add_vectors(search.state[root], displacement), search.state[root])


@kernel
def restore_goals(frame, activations, constraints, problem):
    """Restore the goals that tasks had before the smoothing, to report their residuals."""
    tasks = problem.tasks
    set_goals(1.0, frame, activations, constraints, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.engaged = 0
        if row.status == INACTIVE and activations[c, frame] > 0.0:
            begin_transition(row)
    update_goals(tasks.shape[0], False, problem)
    for c in range(tasks.shape[0]):
        tasks[c].engaged = 0
