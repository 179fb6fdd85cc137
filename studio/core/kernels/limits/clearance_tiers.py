"""Priority tiers: groups of task levels and self-collision constraints that are solved together (METHOD 10).

Tier 0 has the self-collision constraints of the highest priority and all tasks of the same or a higher priority; every
lower priority is a tier of its own, with its tasks and self-collision constraints. With self-collision constraints a
frame is solved tier by tier: for each tier with an active task the frame is solved with all tasks down to the tier,
arms are pushed out of the body, and the result is saved (``SavedTier``). Where the result violates a tier above, the
body moves only a fraction of the way to it from the saved pose.
"""

import math

import numpy as np

from studio.core.kernels.algebra.vectors import copy_matrix, copy_points
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb_tasks import BLENDED_POSE_KEPT
from studio.core.kernels.limits.arm_clearance import place_capsules
from studio.core.kernels.limits.self_collision import measure_side_distances, write_penetration
from studio.core.kernels.records import SavedTier
from studio.core.kernels.search.backtracking import (
    BACKTRACKING_TARGET,
    BACKTRACKING_TOLERANCE,
    next_step_length,
    start_backtracking,
    update_bracket,
)
from studio.core.kernels.search.body_placement import pose_body
from studio.core.kernels.search.joints import pose_limb
from studio.core.kernels.search.level_step import ALLOWED_VIOLATION
from studio.core.kernels.tasks.task_kinds import residual_of, update_goals
from studio.core.kernels.tasks.task_status import IN_TRANSITION, INACTIVE
from studio.core.kernels.time.activation_blend import blend_states, write_limb_joint_rotations


@allocating_kernel
def make_kept_tier(clearance, constraints, joints):
    """``SavedTier`` scratch for a search with these counts of ``constraints`` and ``joints``; empty without
    self-collision constraints.
    """
    clears = clearance.required_distances.shape[0]
    count = constraints if clears > 0 else 0
    return SavedTier(
        np.empty((joints if clears > 0 else 0, 3)),
        np.empty((16 if clears > 0 else 0, 3, 3)),
        np.empty(count + clears),
        np.empty(count + clears),
        np.empty(count + clears),
    )


@kernel
def next_tier(tier, frame, clip):
    """Number of the first tier from ``tier`` on that has to be solved at this frame; the number of tiers if there is
    none.

    Such a tier has an active task or constraint, and an active self-collision constraint of its own or of a higher
    tier. Without any active self-collision constraint the result is the last tier, which has all active tasks.
    """
    fractions, tiers, activations = clip.clearance.activations, clip.clearance.tiers, clip.constraints.activations
    count, last, first = fractions.shape[0], activations.shape[0] - 1, activations.shape[0]
    for q in range(count):
        if fractions[q, frame] > 0.0:
            first = min(first, tiers[q])
    if first > last:
        return max(tier, last)
    found, tier = last + 1, max(tier, first)
    for each in range(tiers.shape[0]):
        activation = fractions[each, frame] if each < count else activations[last, each - count, frame]
        if activation > 0.0 and tiers[each] >= tier:
            found = min(found, tiers[each])
    return found


@kernel
def save_tier(tier, first, frame, clip, problem):
    """Save the pose of the body and all residuals after a tier was solved, as the state that lower tiers have to keep.

    Residuals to be kept are replaced for the tasks of this tier only; for all tasks if the tier is the ``first`` of its
    frame.
    """
    kept, tasks, tiers = clip.kept, problem.tasks, clip.clearance.tiers
    count, clears = tasks.shape[0], clip.clearance.required_distances.shape[0]
    copy_points(problem.search.state, kept.state)
    write_limb_joint_rotations(kept.rotations, problem.pose)
    copy_residuals(frame, clip)
    for each in range(count + clears):
        own = tiers[clears + each if each < count else each - count]
        kept.first_residuals[each] = kept.new_residuals[each]
        if first or own == tier:
            kept.own_residuals[each] = kept.new_residuals[each]


@kernel
def copy_residuals(frame, clip):
    """Copy the residuals reported for a frame to ``SavedTier.new_residuals``."""
    now, residuals, count = clip.kept.new_residuals, clip.clearance.residuals, clip.constraints.tasks.shape[0]
    for c in range(count):
        now[c] = clip.residuals[c, frame]
    for q in range(residuals.shape[0]):
        now[count + q] = residuals[q, frame]


@kernel
def priority_violation_of_tier(tier, frame, clip):
    """Greatest change, in metres or radians, of a residual of a higher tier since that tier was saved."""
    tasks, clearance, own = clip.constraints.tasks, clip.clearance, clip.kept.own_residuals
    count, clears, most = tasks.shape[0], clearance.required_distances.shape[0], 0.0
    for c in range(count):
        if tasks[c].status != INACTIVE and clearance.tiers[clears + c] < tier:
            most = max(most, abs(clip.residuals[c, frame] - own[c]))
    for q in range(clears):
        if clearance.activations[q, frame] > 0.0 and clearance.tiers[q] < tier:
            most = max(most, abs(clearance.residuals[q, frame] - own[count + q]))
    return most


@kernel
def back_track_tier(tier, frame, clip, problem):
    """Back-track from the pose of a tier towards the saved pose until the tiers above are not violated, if need be
    completely.
    """
    change = priority_violation_of_tier(tier, frame, clip)
    if change < ALLOWED_VIOLATION:
        return
    save_endpoints(frame, clip, problem)
    back, backtracking = pose_tier_fraction(0.0, tier, frame, clip, problem), problem.search.backtracking[0]
    if back > (BACKTRACKING_TARGET - BACKTRACKING_TOLERANCE) * ALLOWED_VIOLATION:
        return
    start_backtracking(back, change, ALLOWED_VIOLATION, backtracking)
    while next_step_length(backtracking):
        update_bracket(pose_tier_fraction(backtracking.step_length, tier, frame, clip, problem), backtracking)


@kernel
def save_endpoints(frame, clip, problem):
    """Save the saved pose and the pose just solved as both ends of a blend."""
    search = problem.search
    copy_points(search.state, search.level_start)
    copy_points(clip.kept.state, search.kept_state)
    write_limb_joint_rotations(search.solved_rotations, problem.pose)
    for rotation in range(16):
        copy_matrix(clip.kept.rotations[rotation], search.kept_rotations[rotation])
    copy_residuals(frame, clip)


@kernel
def pose_tier_fraction(fraction, tier, frame, clip, problem):
    """Pose the body at ``fraction`` of the way from the saved pose to the pose of the tier just solved, and report all
    residuals.

    Returns the priority violation, metres or radians.
    """
    search, start, pose = problem.search, problem.start, problem.pose
    blend_states(1.0 - fraction, search)
    for limb in range(4):
        search.blended_limbs[limb] = BLENDED_POSE_KEPT if limb < 2 or has_active_task(limb, problem.tasks) else 0
    pose_body(problem)
    for limb in range(4):
        search.blended_limbs[limb] = 0
    for side in range(2):
        parent, upper, root = limb_parts(side, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
        pose_limb(parent, upper, root, 4 * side, search.blended_rotations, start, pose)
    return report_tier_residuals(fraction, tier, frame, clip, problem)


@kernel
def report_tier_residuals(fraction, tier, frame, clip, problem):
    """Report all residuals in the present pose, at ``fraction`` from the saved pose to the tier's; returns the priority
    violation.

    Residuals of tasks in transition are interpolated between both poses.
    """
    tasks, kept, residuals = problem.tasks, clip.kept, clip.residuals
    update_goals(tasks.shape[0], True, problem)
    measure_frame_penetration(frame, clip, problem.pose)
    for c in range(tasks.shape[0]):
        if tasks[c].status != INACTIVE:
            residual = residual_of(c, problem)
            if tasks[c].status == IN_TRANSITION:
                residual = interpolated_residual(
                    fraction,
                    clip.constraints.activations[tier, c, frame] * residual,
                    kept.first_residuals[c],
                    kept.new_residuals[c],
                )
            residuals[c, frame] = residual
    return priority_violation_of_tier(tier, frame, clip)


@kernel
def measure_frame_penetration(frame, clip, pose):
    """Write the penetration in metres of each self-collision constraint in the pose of one frame."""
    place_capsules(clip.clearance.volume, pose, clip.clearance.proximal, clip.clearing.capsules)
    for side in range(2):
        measure_side_distances(side, clip, pose)
    write_penetration(frame, clip.clearance, clip.clearing.distances)


@kernel
def interpolated_residual(fraction, residual, saved, solved):
    """Residual reported for a task in transition, ``fraction`` of the way from the saved pose to the pose just solved.

    ``saved`` and ``solved`` are its residuals in the saved pose and in the pose just solved. If the task was inactive
    in the saved pose (``saved`` is NaN), its measured ``residual`` is added with the weight 1 - ``fraction``.
    """
    if math.isnan(saved):
        return solved + (1.0 - fraction) * residual
    return saved + fraction * (solved - saved)


@kernel
def has_active_task(limb, tasks):
    """True if a task that is not inactive has a point on a limb."""
    named = False
    for c in range(tasks.shape[0]):
        for end in range(2):
            named = named or (tasks[c].status != INACTIVE and tasks[c].limbs[end] == limb)
    return named
