"""Self-collision constraints of the arms in one frame: arms are pushed out before the tasks, and again after them."""

import math

import numpy as np

from studio.core.kernels.body_indices import (
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    UPPER_ARM_SEGMENT,
    WRIST_POINT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limits.arm_clearance import (
    CONTACT_MARGIN,
    PROBE_COUNT,
    copy_arm,
    measure_arm_distances,
    place_capsules,
    push_arm_out,
)
from studio.core.kernels.records import CAPSULE, ClearanceScratch, Pose
from studio.core.kernels.tasks.goals import has_residual, is_rotation
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.kernels.tasks.task_kinds import residual_of, update_goals
from studio.core.kernels.tasks.task_status import INACTIVE

TASK_BELOW, TASK_BESIDE, TASK_ABOVE, TASK_IS_CONTACT = range(4)
"""Priority of a task relative to a self-collision constraint: lower, equal, higher, or a contact, which is higher than
all.
"""
CLEARANCE_VIOLATION = 0.1 * PRIORITY_TOLERANCE
"""Greatest change of a higher task's residual, in metres or radians, by pushing an arm out."""


@allocating_kernel
def make_clearance_scratch(volume):
    """``ClearanceScratch`` for a body ``volume``."""
    return ClearanceScratch(
        np.empty(volume.segments.shape[0], CAPSULE),
        np.empty((2, PROBE_COUNT)),
        np.empty((2, PROBE_COUNT)),
        Pose(np.empty((4, 3)), np.empty((3, 3, 3))),
        np.empty((3, 3)),
        np.empty(3),
        np.empty(PROBE_COUNT),
        np.empty((PROBE_COUNT, 3)),
    )


@kernel
def clear_before_tasks(frame, is_clear, clip, pose):
    """Push the arms of one frame out of the body before its tasks; True if they have to wait because a higher task is
    active.

    Constraints of lower tiers always wait. If the pose ``is_clear`` already, its distances are only measured.
    """
    clearance, clearing = clip.clearance, clip.clearing
    waited = waits_for_tasks(frame, clip)
    if not waited:
        place_capsules(clearance.volume, pose, clearance.proximal, clearing.capsules)
    for side in range(2):
        moved = False
        for q in range(clearance.required_distances.shape[0]):
            activation = clearance.activations[q, frame] * clearance.arms[q, side]
            if activation > 0.0 and not waited and not is_clear and clearance.tiers[q] == 0:
                for probe in range(PROBE_COUNT):
                    clearing.required_distances[probe] = clearance.required_distances[q, frame, side, probe]
                free = (activation, clearance.freedoms[q], clearance.freedoms[q], 1.0)
                moved = push_arm_out(side, 0.0, frame, free, clearance, clearing, pose)
        if moved or (is_clear and not waited):
            measure_side_distances(side, clip, pose)
        for probe in range(PROBE_COUNT):
            clearing.distances_before[side, probe] = math.inf if waited else clearing.distances[side, probe]
    return waited


@kernel
def measure_side_distances(side, clip, pose):
    """Write the signed distances and outward directions of one arm's probes into the scratch; capsules must be placed
    before.
    """
    clearing = clip.clearing
    measure_arm_distances(
        side, clip.clearance.volume, clearing.capsules, pose.positions, clearing.distances[side], clearing.directions
    )


@kernel
def waits_for_tasks(frame, clip):
    """True if a task with a higher priority than the self-collision constraints of tier 0 is active."""
    clearance, activations = clip.clearance, clip.constraints.activations
    last, found = activations.shape[0] - 1, False
    for q in range(clearance.above.shape[0]):
        for c in range(clearance.above.shape[1]):
            acts = clearance.activations[q, frame] > 0.0 and activations[last, c, frame] > 0.0
            found = found or (acts and clearance.tiers[q] == 0 and clearance.above[q, c] == TASK_ABOVE)
    return found


@allocating_kernel
def clear_after_tasks(frame, tier, acted, waited, clip, problem):
    """Push arms out of the body after the tasks of one ``tier``, and write the penetration of all constraints.

    ``acted``: tasks have moved the body; ``waited``: arms were not pushed out before the tasks. A task with a higher
    priority holds its part of the arm by its activation: one on wrist or hand still lets the elbow swivel, one farther
    up holds the whole arm. An arm stays where it is if a higher task's residual would change.
    """
    clearance, clearing, pose = clip.clearance, clip.clearing, problem.pose
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    if acted or tier > 0:
        place_capsules(clearance.volume, pose, clearance.proximal, clearing.capsules)
    for side in range(2):
        moved = False
        for q in range(clearance.required_distances.shape[0]):
            activation, late = (
                clearance.activations[q, frame] * clearance.arms[q, side],
                waited or clearance.tiers[q] > 0,
            )
            if activation > 0.0 and clearance.tiers[q] <= tier and (acted or late):
                held = clearing.arm_holds
                arm_task_fractions(side, problem.tasks, clearance.above[q], spine_count, held)
                freedom = clearance.freedoms[q]
                free = (
                    activation if late else 1.0,
                    freedom * (1.0 - held[0]),
                    freedom * (1.0 - held[1]),
                    1.0 - held[2],
                )
                for probe in range(PROBE_COUNT):
                    clearing.required_distances[probe] = clearance.required_distances[q, frame, side, probe]
                    if not late:
                        clearing.required_distances[probe] = min(
                            clearing.required_distances[probe], clearing.distances_before[side, probe] - CONTACT_MARGIN
                        )
                moves = push_arm_out(side, 0.0 if late else CONTACT_MARGIN, frame, free, clearance, clearing, pose)
                if moves and violates_priority(frame, clearance.above[q], clip, problem):
                    first, upper = (
                        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
                        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
                    )
                    copy_arm(clearing.saved, Pose(pose.positions[first : first + 4], pose.rotations[upper : upper + 3]))
                moved = moved or moves or late
        if moved:
            measure_side_distances(side, clip, pose)
    write_penetration(frame, clearance, clearing.distances)


@kernel
def write_penetration(frame, clearance, distances):
    """Write the penetration in metres of each self-collision constraint at one frame, NaN where inactive.

    ``distances`` (2, 5) are the signed distances of both arms' probes.
    """
    required, activations, arms, residuals = (
        clearance.required_distances,
        clearance.activations,
        clearance.arms,
        clearance.residuals,
    )
    for q in range(required.shape[0]):
        residuals[q, frame] = math.nan if activations[q, frame] <= 0.0 else 0.0
        for side in range(2):
            if activations[q, frame] * arms[q, side] > 0.0:
                for probe in range(PROBE_COUNT):
                    short = required[q, frame, side, probe] - distances[side, probe]
                    residuals[q, frame] = max(residuals[q, frame], short)


@kernel
def violates_priority(frame, above, clip, problem):
    """True if the residual of a task with a higher priority (``above`` (C,), ``TASK_ABOVE`` or more) has changed."""
    changed, tasks = False, problem.tasks
    update_goals(tasks.shape[0], True, problem)
    for c in range(tasks.shape[0]):
        if above[c] >= TASK_ABOVE and has_residual(tasks[c]):
            change = residual_of(c, problem) - clip.residuals[c, frame]
            changed = changed or abs(change) > CLEARANCE_VIOLATION
    return changed


@kernel
def arm_task_fractions(side, tasks, above, spine_count, out_holds):
    """Write the fractions (3,) to which higher tasks hold an arm's wrist, its hand's rotation and its swivel, 0 to
    1.
    """
    out_holds[0], out_holds[1], out_holds[2] = 0.0, 0.0, 0.0
    upper, wrist = (
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
        spine_count + WRIST_POINT + POINTS_PER_LIMB * side,
    )
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if above[c] == TASK_BELOW or row.status == INACTIVE:
            continue
        for end in range(2):
            if row.limbs[end] != side:
                continue
            segment, offset = row.segments[end], row.offsets[end]
            at_wrist = row.points[end] == wrist and offset[0] == 0.0 and offset[1] == 0.0 and offset[2] == 0.0
            if not at_wrist:
                out_holds[1] = max(out_holds[1], row.activation)
            if segment == upper + 2 and is_rotation(row):
                continue
            out_holds[0] = max(out_holds[0], row.activation)
            if segment < upper + 2 and (is_rotation(row) or not at_wrist):
                out_holds[2] = max(out_holds[2], row.activation)
