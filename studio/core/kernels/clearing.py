"""When arms are kept clear of their own body: before the constraints of a frame, and again after them.

``clearance`` is the tuple (volume, proximal points (S,), wanted rooms (Q, F, 2, 5), activations (Q, F), arms (Q, 2) 1
where meant, freedoms of the wrist (Q,), above (Q, C) how constraints stand to it, misses (Q, F), rooms (F, 2, 5) and
ways out (F, 2, 5, 3) of the actor, stages (Q + C,) of them and of the constraints, as ``kernels.stages`` has them) of
Q constraints that keep clear, the highest last.
"""

import math

import numpy as np

from studio.core.kernels.clearance import PROBES, TOUCH, clear_arm, copy_arm, measure_arm, place_capsules
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.goals import ORIENTATION, counts
from studio.core.kernels.placing import follow, miss_of

HIGHER, STANDS = 2, 3
"""How a constraint stands to one that keeps clear: 0 below it, 1 beside it, or above, the last as a contact."""
UNTOUCHED = 2e-5
"""Metres or radians by which arms that are cleared may change what is missed above."""


@allocating_kernel
def make_clear_work(clearance):
    """Scratch: capsules (N, 9), rooms now and before the constraints (2, 5), saved arm, a turn, three small ones."""
    return (
        np.empty((clearance[0][0].shape[0], 9)),
        np.empty((2, PROBES)),
        np.empty((2, PROBES)),
        (np.empty((4, 3)), np.empty((3, 3, 3))),
        np.empty((3, 3)),
        np.empty(2),
        np.empty(PROBES),
        np.empty((PROBES, 3)),
    )


@kernel
def clear_before(frame, is_clear, clearance, activations, work, pose):
    """Clear the arms of one frame before its constraints, unless a wish acts that stands above: then arms are cleared
    once it has what it wants. Whether they have to wait so.

    What keeps clear below another that does always waits. A pose that ``is_clear`` already is only looked at.
    """
    volume, wanted, shares, arms, stages = clearance[0], clearance[2], clearance[3], clearance[4], clearance[10]
    capsules, rooms, before, saved, turn = work[0], work[1], work[2], work[3], work[4]
    waited = waits(frame, clearance, activations)
    if not waited:
        place_capsules(volume, pose, clearance[1], capsules)
    for side in range(2):
        own, ways, moved = clearance[8][frame, side], clearance[9][frame, side], False
        for q in range(wanted.shape[0]):
            share = shares[q, frame] * arms[q, side]
            if share > 0.0 and not waited and not is_clear and stages[q] == 0:
                free, asks = (share, clearance[5][q], 1.0), wanted[q, frame, side]
                moved = clear_arm(side, 0.0, asks, own, ways, free, volume, capsules, saved, turn, pose, rooms[side])
        if moved or (is_clear and not waited):
            measure_arm(side, volume, capsules, pose[0], rooms[side], work[7])
        for probe in range(PROBES):
            before[side, probe] = math.inf if waited else rooms[side, probe]
    return waited


@kernel
def waits(frame, clearance, activations):
    """Whether a wish acts that stands above the highest that keep clear."""
    above, found = clearance[6], False
    for q in range(above.shape[0]):
        for c in range(above.shape[1]):
            acts = clearance[3][q, frame] > 0.0 and activations[c, frame] > 0.0
            found = found or (acts and clearance[10][q] == 0 and above[q, c] == HIGHER)
    return found


@allocating_kernel
def clear_after(frame, stage, acted, waited, asked, areas, clearance, clear_work, body, work, start, pose, residuals):
    """Clear arms again that constraints have brought nearer, where they ``acted``, or, where that has ``waited``, for
    the first time, down to one ``stage``; and note how much room is missing.

    A constraint of ``asked`` (C,) that stands above holds what it is about by its activation: a wrist or hand still
    lets the elbow swivel, a point further up holds the whole arm. Where something above would be missed otherwise than
    by its ``residuals`` (C, F), the arm stays.
    """
    volume, wanted, activations, arms = clearance[0], clearance[2], clearance[3], clearance[4]
    capsules, rooms, before, saved = clear_work[0], clear_work[1], clear_work[2], clear_work[3]
    turn, held, asks, stages = clear_work[4], clear_work[5], clear_work[6], clearance[10]
    spine_count = pose[0].shape[0] - 23
    if acted or stage > 0:
        place_capsules(volume, pose, clearance[1], capsules)
    for side in range(2):
        own, ways, moved = clearance[8][frame, side], clearance[9][frame, side], False
        for q in range(wanted.shape[0]):
            share, late = activations[q, frame] * arms[q, side], waited or stages[q] > 0
            if share > 0.0 and stages[q] <= stage and (acted or late):
                hold_arm(side, asked, clearance[6][q], spine_count, held)
                free = (share if late else 1.0, clearance[5][q] * (1.0 - held[0]), 1.0 - held[1])
                for probe in range(PROBES):
                    asks[probe] = wanted[q, frame, side, probe]
                    if not late:
                        asks[probe] = min(asks[probe], before[side, probe] - TOUCH)
                moves = clear_arm(
                    side,
                    0.0 if late else TOUCH,
                    asks,
                    own,
                    ways,
                    free,
                    volume,
                    capsules,
                    saved,
                    turn,
                    pose,
                    rooms[side],
                )
                if moves and costs(frame, clearance[6][q], asked, areas, body, work, start, pose, residuals):
                    first, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
                    copy_arm(saved, (pose[0][first : first + 4], pose[1][upper : upper + 3]))
                moved = moved or moves or late
        if moved:
            measure_arm(side, volume, capsules, pose[0], rooms[side], clear_work[7])
    note_lacking(frame, clearance, rooms)


@kernel
def note_lacking(frame, clearance, rooms):
    """By how much room each that keeps clear is missed at one frame, NaN where not active; ``rooms`` (2, 5)."""
    wanted, activations, arms, misses = clearance[2], clearance[3], clearance[4], clearance[7]
    for q in range(wanted.shape[0]):
        misses[q, frame] = math.nan if activations[q, frame] <= 0.0 else 0.0
        for side in range(2):
            if activations[q, frame] * arms[q, side] > 0.0:
                for probe in range(PROBES):
                    short = wanted[q, frame, side, probe] - rooms[side, probe]
                    misses[q, frame] = max(misses[q, frame], short)


@kernel
def costs(frame, above, asked, areas, body, work, start, pose, residuals):
    """Whether anything that stands above is missed otherwise than by its ``residuals`` (C, F)."""
    changed = False
    follow(asked.shape[0], True, asked, areas, work, start, pose)
    for c in range(asked.shape[0]):
        if above[c] >= HIGHER and counts(asked[c]):
            change = miss_of(c, asked, areas, body, work, pose) - residuals[c, frame]
            changed = changed or abs(change) > UNTOUCHED
    return changed


@kernel
def hold_arm(side, asked, above, spine_count, out_held):
    """How far constraints above hold an arm's wrist and its swivel, (2,) from 0 to 1."""
    out_held[0], out_held[1] = 0.0, 0.0
    upper, wrist = spine_count + 3 + 4 * side, spine_count + 6 + 5 * side
    for c in range(asked.shape[0]):
        row = asked[c]
        if not above[c] or row.wanted == 0:
            continue
        for end in range(2):
            if row.ends[end, 2] != side:
                continue
            segment, offset = row.ends[end, 1], row.offsets[end]
            at_wrist = row.ends[end, 0] == wrist and offset[0] == 0.0 and offset[1] == 0.0 and offset[2] == 0.0
            if segment == upper + 2 and row.kind == ORIENTATION:
                continue
            out_held[0] = max(out_held[0], row.share)
            if segment < upper + 2 and (row.kind == ORIENTATION or not at_wrist):
                out_held[1] = max(out_held[1], row.share)
