"""Strict priorities where what keeps clear stands above wishes: a frame is solved stage by stage (METHOD 6).

Stage 0 is the highest that keep clear and all above and beside them, and every priority below is a stage of its own. A
frame is solved and cleared down to each stage in which something acts, and what has come to be is ``kept``: the tuple
(state (N, 3), turns (16, 3, 3) of the limbs in what carries them, four a limb, misses (3, C + Q), spots (C, 3) where
each had its first point, in the axes of what it follows on its own body) of C constraints and Q that keep clear. The
misses are those that are kept, those that each had when its own stage was kept, and those of what has just been solved.

Where a stage changes what one above it misses, its arms are cleared closely; where it still does, it goes but a part of
its way from there. Arms alone come back where that does, for it is they that are kept clear; else all but neck and
head. An arm that comes back keeps its wrist where a wish above has it; where that leaves not all as it was, the whole
body is blended and nothing else is done.
"""

import math

import numpy as np

from studio.core.kernels.clearance import PROBES, clear_arm, copy_arm, measure_arm, move_arm, place_capsules
from studio.core.kernels.clearing import hold_arm, note_lacking
from studio.core.kernels.compiling import allocating_kernel, kernel, pack
from studio.core.kernels.edges import HERE, IN_PART, THERE, blend_kept, blend_limb, note_turns
from studio.core.kernels.goals import DISTANCE, POSITION, counts, end_place
from studio.core.kernels.joint_limits import limb_parts
from studio.core.kernels.joints import hang_limb
from studio.core.kernels.limb_constraints import HUNG
from studio.core.kernels.placing import KEPT_TURNS, carry_body, follow, miss_of
from studio.core.kernels.rotation import add_rotated
from studio.core.kernels.steps import KEPT
from studio.core.kernels.vectors import copy_matrix, copy_point

BOTH, WHOLE, PLAIN = 2, 3, 4
"""How a stage may go back, in this order: 0 with its left arm, 1 with its right one, with both, with all but neck and
head, or so that the whole body is blended and nothing else.
"""
AIM, NEAR = 0.7, 0.02
"""Part of what a stage may change that it is left with where it goes back, and how near that is found."""
LEFT = 0.8
"""The same that it may change where it is back wholly: stages above may have left it little."""
CLOSE = 5e-5
"""Metres of room to which arms are cleared where a stage changes what stands above it."""
TRIES = 12
"""Poses that are looked at to find it."""


@allocating_kernel
def make_kept(clearance, constraints, joints):
    """Room for what is ``kept``, none where nothing keeps clear."""
    clears = clearance[2].shape[0]
    count = constraints if clears > 0 else 0
    return (
        np.empty((joints if clears > 0 else 0, 3)),
        np.empty((16 if clears > 0 else 0, 3, 3)),
        np.empty((3, count + clears)),
        np.empty((count, 3)),
    )


@kernel
def next_stage(stage, frame, clearance, activations):
    """The first ``stage`` from one on that is to be solved at this frame, past the last where there is none.

    Something of it acts, and something that keeps clear does above it or in it. Where nothing keeps clear now, it is
    the last, with all that acts.
    """
    shares, stages, count = clearance[3], clearance[10], clearance[2].shape[0]
    last, first = activations.shape[0] - 1, activations.shape[0]
    for q in range(count):
        if shares[q, frame] > 0.0:
            first = min(first, stages[q])
    if first > last:
        return max(stage, last)
    found, stage = last + 1, max(stage, first)
    for each in range(stages.shape[0]):
        share = shares[each, frame] if each < count else activations[last, each - count, frame]
        if share > 0.0 and stages[each] >= stage:
            found = min(found, stages[each])
    return found


@kernel
def keep_stage(stage, first, frame, asked, clearance, kept, work, pose, residuals):
    """Note the pose of a stage and its misses, which are to stay as they are: the ``first`` has those of all above."""
    state, turns, misses, spots = kept
    count, clears = asked.shape[0], clearance[2].shape[0]
    for joint in range(state.shape[0]):
        copy_point(work[3][0, joint], state[joint])
    note_turns(0, turns, pose)
    note_now(frame, asked, clearance, kept, residuals)
    for each in range(count + clears):
        own = clearance[10][clears + each if each < count else each - count]
        misses[0, each] = misses[2, each]
        if first or own == stage:
            misses[1, each] = misses[2, each]
    for c in range(count):
        if asked[c].wanted and asked[c].ends[0, 0] >= 0:
            note_spot(asked[c], work, pose, spots[c])


@kernel
def note_now(frame, asked, clearance, kept, residuals):
    """Note what is missed now as that of what was just solved."""
    count = asked.shape[0]
    for c in range(count):
        kept[2][2, c] = residuals[c, frame]
    for q in range(clearance[7].shape[0]):
        kept[2][2, count + q] = clearance[7][q, frame]


@kernel
def change_of(stage, frame, asked, clearance, kept, residuals):
    """By how much what stands above a stage is missed otherwise than when its own was kept, metres or radians."""
    misses, count, clears, most = kept[2][1], asked.shape[0], clearance[2].shape[0], 0.0
    for c in range(count):
        if asked[c].wanted and clearance[10][clears + c] < stage:
            most = max(most, abs(residuals[c, frame] - misses[c]))
    for q in range(clearance[7].shape[0]):
        if clearance[3][q, frame] > 0.0 and clearance[10][q] < stage:
            most = max(most, abs(clearance[7][q, frame] - misses[count + q]))
    return most


@kernel
def hold_above(
    stage, frame, asked, areas, activations, chain, body, clearance, clear_work, kept, work, start, pose, residuals
):
    """Where a stage changes what stands above it, go but as far as it does not; in the end that is no way at all."""
    if change_of(stage, frame, asked, clearance, kept, residuals) < KEPT:
        return
    given = pack((asked, areas, activations, chain, body, clearance, clear_work, kept, work, start, pose, residuals))
    note_now(frame, asked, clearance, kept, residuals)
    place_capsules(clearance[0], pose, clearance[1], clear_work[0])
    for side in range(2):
        clear_closely(side, True, stage, frame, given)
    change = tell(1.0, stage, frame, given)
    if change < KEPT:
        return
    note_ways(stage, frame, asked, clearance, kept, work, pose, residuals)
    how = 0
    back = go_part(0.0, how, stage, frame, given)
    while back >= LEFT * KEPT and how < PLAIN:
        how += 1
        back = go_part(0.0, how, stage, frame, given)
    if back > (AIM - NEAR) * KEPT:
        return
    least, low, most, high, before = 0.0, back - AIM * KEPT, 1.0, min(change - AIM * KEPT, KEPT), 0.0
    for _ in range(TRIES):
        share = (least * high - most * low) / (high - low)
        gap = min(go_part(share, how, stage, frame, given) - AIM * KEPT, KEPT)
        if abs(gap) < NEAR * KEPT:
            return
        if gap < 0.0:
            least, low, high = share, gap, high * (0.5 if before < 0.0 else 1.0)
        else:
            most, high, low = share, gap, low * (0.5 if before > 0.0 else 1.0)
        before = gap
    go_part(least, how, stage, frame, given)


@kernel
def clear_closely(side, moves, stage, frame, given):
    """Clear an arm once more, until it has the very room that what keeps clear above a stage is to keep; whether its
    wrist ``moves`` or the elbow alone.
    """
    asked, _, _, _, _, clearance, clear_work, kept, _, _, pose, _ = given
    capsules, rooms, _, saved, turn, held, asks, _ = clear_work
    count, own, ways = asked.shape[0], clearance[8][frame, side], clearance[9][frame, side]
    for q in range(clearance[2].shape[0]):
        if clearance[10][q] < stage and clearance[3][q, frame] * clearance[4][q, side] > 0.0:
            hold_arm(side, asked, clearance[6][q], pose[0].shape[0] - 23, held)
            free = (1.0, clearance[5][q] * (1.0 - held[0]) if moves else 0.0, 1.0 - held[1])
            for probe in range(PROBES):
                asks[probe] = clearance[2][q, frame, side, probe] - kept[2][1, count + q] + CLOSE
            clear_arm(side, CLOSE, asks, own, ways, free, clearance[0], capsules, saved, turn, pose, rooms[side])


@kernel
def note_ways(stage, frame, asked, clearance, kept, work, pose, residuals):
    """Note where a stage begins, and where it would get."""
    state, turns, _, _ = kept
    turned = work[3]
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[1, joint])
        copy_point(state[joint], turned[2, joint])
    note_turns(HERE, work[7], pose)
    for turn in range(16):
        copy_matrix(turns[turn], work[7][THERE + turn])
    note_now(frame, asked, clearance, kept, residuals)


@kernel
def go_part(share, how, stage, frame, given):
    """Pose the body where a stage has gone a ``share`` of its way, the whole of it or its arms, and tell all misses; by
    how much those above it change.
    """
    asked, _, _, chain, body, clearance, clear_work, kept, work, start, pose, _ = given
    hung, spine_count = work[4], pose[0].shape[0] - 23
    blend_kept(1.0 - share if how >= WHOLE else 0.0, work)
    if how == WHOLE:
        for joint in range(chain[1].shape[0]):
            if spine_count <= chain[1][joint, 0] < spine_count + 2:
                copy_point(work[3][1, joint], work[3][0, joint])
    if how >= WHOLE:
        for limb in range(4):
            hung[4 + limb] = HUNG if limb < 2 or is_named(limb, asked) else 0
        carry_body(chain, body, work, start, pose)
        for limb in range(4):
            hung[4 + limb] = 0
    for side in range(2):
        if how in (side, BOTH, WHOLE):
            held = how == WHOLE and wish_above(side, stage, asked, clearance, spine_count) >= 0
            blend_limb(1.0 if held else 1.0 - share, side, work)
        carrier, upper, root = limb_parts(side, spine_count)
        hang_limb(carrier, upper, root, KEPT_TURNS + 4 * side, work[7], start, pose)
    place_capsules(clearance[0], pose, clearance[1], clear_work[0])
    for side in range(2):
        c = wish_above(side, stage, asked, clearance, spine_count)
        if c >= 0 and how in (side, BOTH, WHOLE):
            bring_back(side, asked[c], kept[3][c], clear_work, work, pose)
        if how in (side, BOTH, WHOLE):
            clear_closely(side, c < 0, stage, frame, given)
    return tell(share, stage, frame, given)


@kernel
def tell(share, stage, frame, given):
    """Tell all misses where a stage has gone a ``share`` of its way; by how much those above it change."""
    asked, areas, activations, _, body, clearance, clear_work, kept, work, start, pose, residuals = given
    follow(asked.shape[0], True, asked, areas, work, start, pose)
    measure_rooms(frame, clearance, clear_work, pose)
    for c in range(asked.shape[0]):
        if asked[c].wanted:
            miss = miss_of(c, asked, areas, body, work, pose)
            if asked[c].wanted == IN_PART:
                miss = told_between(share, activations[c, frame] * miss, kept[2][0, c], kept[2][2, c])
            residuals[c, frame] = miss
    return change_of(stage, frame, asked, clearance, kept, residuals)


@kernel
def wish_above(side, stage, asked, clearance, spine_count):
    """The highest constraint above a stage that has a place for the wrist or hand of an arm, -1 for none."""
    clears = clearance[2].shape[0]
    for c in range(asked.shape[0]):
        row = asked[c]
        places = (row.kind == POSITION or row.kind == DISTANCE) and row.ends[0, 2] == side
        reaches = row.ends[0, 0] >= spine_count + 6 + 5 * side  # from the wrist on
        if places and reaches and clearance[10][clears + c] < stage and counts(row):
            return c
    return -1


@kernel
def bring_back(side, row, spot, clear_work, work, pose):
    """Bring an arm's point to the ``spot`` (3,) where it is kept: the hand keeps its orientation."""
    point, other, saved, spine_count = work[5][0], work[5][1], clear_work[3], pose[0].shape[0] - 23
    place, (_, upper, shoulder) = work[5][3], limb_parts(side, spine_count)
    end_place(row, 0, pose, point)
    copy_point(spot, place)
    if row.ends[1, 0] >= 0:
        end_place(row, 1, pose, other)
        add_rotated(other, pose[1][row.ends[1, 1]], spot[0], spot[1], spot[2], place)
    for axis in range(3):
        place[axis] -= point[axis]
    copy_arm((pose[0][shoulder : shoulder + 4], pose[1][upper : upper + 3]), saved)
    move_arm(side, 1.0, place, 0.0, saved, clear_work[4], pose)


@kernel
def note_spot(row, work, pose, out_spot):
    """Where a constraint has its first point, (3,) in the axes of what it follows on its own body, or in the world."""
    point, other = work[5][0], work[5][1]
    end_place(row, 0, pose, point)
    copy_point(point, out_spot)
    if row.ends[1, 0] >= 0:
        end_place(row, 1, pose, other)
        axes = pose[1][row.ends[1, 1]]
        x, y, z = point[0] - other[0], point[1] - other[1], point[2] - other[2]
        for axis in range(3):
            out_spot[axis] = axes[0, axis] * x + axes[1, axis] * y + axes[2, axis] * z


@kernel
def measure_rooms(frame, clearance, clear_work, pose):
    """Note how much room is missing as the body is posed now."""
    place_capsules(clearance[0], pose, clearance[1], clear_work[0])
    for side in range(2):
        measure_arm(side, clearance[0], clear_work[0], pose[0], clear_work[1][side], clear_work[7])
    note_lacking(frame, clearance, clear_work[1])


@kernel
def told_between(share, miss, there, here):
    """What is told of one on its edge ``share`` of the way from what was told ``there``, NaN where it was not asked."""
    if math.isnan(there):
        return here + (1.0 - share) * miss
    return there + share * (here - there)


@kernel
def is_named(limb, asked):
    """Whether anything that acts is about a limb."""
    named = False
    for c in range(asked.shape[0]):
        for end in range(2):
            named = named or (asked[c].wanted > 0 and asked[c].ends[end, 2] == limb)
    return named
