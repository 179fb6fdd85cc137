"""When arms are kept clear of their own body: before the constraints of a frame, and again after them."""

import math

import numpy as np

from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limits.clearance import PROBES, TOUCH, clear_arm, copy_arm, measure_arm, place_capsules
from studio.core.kernels.records import CAPSULE, Clearing, Pose
from studio.core.kernels.tasks.goals import counts, turns_segment
from studio.core.kernels.tasks.kinds import follow, miss_of
from studio.core.kernels.tasks.task import INACTIVE, STRICT

BELOW, BESIDE, ABOVE, CONTACT = range(4)
"""How a constraint stands to one that keeps clear; a contact is above all that is asked."""
UNTOUCHED = 0.1 * STRICT
"""Metres or radians by which arms that are cleared may change what is missed above."""


@allocating_kernel
def make_clearing(volume):
    """Scratch of what keeps arms clear."""
    return Clearing(
        np.empty(volume.segments.shape[0], CAPSULE),
        np.empty((2, PROBES)),
        np.empty((2, PROBES)),
        Pose(np.empty((4, 3)), np.empty((3, 3, 3))),
        np.empty((3, 3)),
        np.empty(3),
        np.empty(PROBES),
        np.empty((PROBES, 3)),
    )


@kernel
def clear_before(frame, is_clear, clip, pose):
    """Clear the arms of one frame before its constraints, unless a task acts that stands above: then arms are cleared
    once it has what it wants. Whether they have to wait so.

    What keeps clear below another that does always waits. A pose that ``is_clear`` already is only looked at.
    """
    clearance, clearing = clip.clearance, clip.clearing
    waited = waits(frame, clip)
    if not waited:
        place_capsules(clearance.volume, pose, clearance.proximal, clearing.capsules)
    for side in range(2):
        moved = False
        for q in range(clearance.wanted.shape[0]):
            share = clearance.activations[q, frame] * clearance.arms[q, side]
            if share > 0.0 and not waited and not is_clear and clearance.tiers[q] == 0:
                for probe in range(PROBES):
                    clearing.asks[probe] = clearance.wanted[q, frame, side, probe]
                free = (share, clearance.freedoms[q], clearance.freedoms[q], 1.0)
                moved = clear_arm(side, 0.0, frame, free, clearance, clearing, pose)
        if moved or (is_clear and not waited):
            measure_side(side, clip, pose)
        for probe in range(PROBES):
            clearing.before[side, probe] = math.inf if waited else clearing.rooms[side, probe]
    return waited


@kernel
def measure_side(side, clip, pose):
    """Note the room of one arm, whose body's capsules are placed."""
    clearing = clip.clearing
    measure_arm(side, clip.clearance.volume, clearing.capsules, pose.positions, clearing.rooms[side], clearing.ways)


@kernel
def waits(frame, clip):
    """Whether a task acts that stands above the highest that keep clear."""
    clearance, activations = clip.clearance, clip.asked.activations
    last, found = activations.shape[0] - 1, False
    for q in range(clearance.above.shape[0]):
        for c in range(clearance.above.shape[1]):
            acts = clearance.activations[q, frame] > 0.0 and activations[last, c, frame] > 0.0
            found = found or (acts and clearance.tiers[q] == 0 and clearance.above[q, c] == ABOVE)
    return found


@allocating_kernel
def clear_after(frame, tier, acted, waited, clip, problem):
    """Clear arms again that constraints have brought nearer, where they ``acted``, or, where that has ``waited``, for
    the first time, down to one ``tier``; and note how much room is missing.

    A task that stands above holds what it is about by its activation: a wrist or hand still lets the elbow swivel, a
    point further up holds the whole arm. Where something above would be missed otherwise than it is, the arm stays.
    """
    clearance, clearing, pose = clip.clearance, clip.clearing, problem.pose
    spine_count = pose.positions.shape[0] - 23
    if acted or tier > 0:
        place_capsules(clearance.volume, pose, clearance.proximal, clearing.capsules)
    for side in range(2):
        moved = False
        for q in range(clearance.wanted.shape[0]):
            share, late = clearance.activations[q, frame] * clearance.arms[q, side], waited or clearance.tiers[q] > 0
            if share > 0.0 and clearance.tiers[q] <= tier and (acted or late):
                held = clearing.held
                hold_arm(side, problem.tasks, clearance.above[q], spine_count, held)
                freedom = clearance.freedoms[q]
                free = (share if late else 1.0, freedom * (1.0 - held[0]), freedom * (1.0 - held[1]), 1.0 - held[2])
                for probe in range(PROBES):
                    clearing.asks[probe] = clearance.wanted[q, frame, side, probe]
                    if not late:
                        clearing.asks[probe] = min(clearing.asks[probe], clearing.before[side, probe] - TOUCH)
                moves = clear_arm(side, 0.0 if late else TOUCH, frame, free, clearance, clearing, pose)
                if moves and costs(frame, clearance.above[q], clip, problem):
                    first, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
                    copy_arm(clearing.saved, Pose(pose.positions[first : first + 4], pose.rotations[upper : upper + 3]))
                moved = moved or moves or late
        if moved:
            measure_side(side, clip, pose)
    note_lacking(frame, clearance, clearing.rooms)


@kernel
def note_lacking(frame, clearance, rooms):
    """By how much room each that keeps clear is missed at one frame, NaN where not active; ``rooms`` (2, 5)."""
    wanted, activations, arms, misses = clearance.wanted, clearance.activations, clearance.arms, clearance.misses
    for q in range(wanted.shape[0]):
        misses[q, frame] = math.nan if activations[q, frame] <= 0.0 else 0.0
        for side in range(2):
            if activations[q, frame] * arms[q, side] > 0.0:
                for probe in range(PROBES):
                    short = wanted[q, frame, side, probe] - rooms[side, probe]
                    misses[q, frame] = max(misses[q, frame], short)


@kernel
def costs(frame, above, clip, problem):
    """Whether anything that stands above is missed otherwise than was noted."""
    changed, tasks = False, problem.tasks
    follow(tasks.shape[0], True, problem)
    for c in range(tasks.shape[0]):
        if above[c] >= ABOVE and counts(tasks[c]):
            change = miss_of(c, problem) - clip.residuals[c, frame]
            changed = changed or abs(change) > UNTOUCHED
    return changed


@kernel
def hold_arm(side, tasks, above, spine_count, out_held):
    """How far constraints above hold an arm's wrist, its hand's turn and its swivel, (3,) from 0 to 1."""
    out_held[0], out_held[1], out_held[2] = 0.0, 0.0, 0.0
    upper, wrist = spine_count + 3 + 4 * side, spine_count + 6 + 5 * side
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if above[c] == BELOW or row.status == INACTIVE:
            continue
        for end in range(2):
            if row.limbs[end] != side:
                continue
            segment, offset = row.segments[end], row.offsets[end]
            at_wrist = row.points[end] == wrist and offset[0] == 0.0 and offset[1] == 0.0 and offset[2] == 0.0
            if not at_wrist:
                out_held[1] = max(out_held[1], row.share)
            if segment == upper + 2 and turns_segment(row):
                continue
            out_held[0] = max(out_held[0], row.share)
            if segment < upper + 2 and (turns_segment(row) or not at_wrist):
                out_held[2] = max(out_held[2], row.share)
