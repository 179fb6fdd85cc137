"""Strict priorities where what keeps clear stands above wishes: a frame is solved stage by stage (METHOD 6).

Stage 0 is the highest that keep clear and all above and beside them, and every priority below is a stage of its own. A
frame is solved and cleared down to each stage in which something acts, and what has come to be is kept (``KeptStage``).

Where a stage changes what one above it misses, its arms are cleared closely; where it still does, it goes but a part of
its way from there. Arms alone come back where that does, for it is they that are kept clear; else all but neck and
head. An arm that comes back keeps its wrist where a wish above has it; where that leaves not all as it was, the whole
body is blended and nothing else is done.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation import add_rotated
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point, copy_points
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb_constraints import CLOSE_ENOUGH, HUNG
from studio.core.kernels.limits.clearance import PROBES, clear_arm, copy_arm, move_arm, place_capsules
from studio.core.kernels.limits.clearing import hold_arm, measure_side, note_lacking
from studio.core.kernels.limits.joint_limits import limb_parts
from studio.core.kernels.records import KeptStage, Pose
from studio.core.kernels.search.joints import hang_limb
from studio.core.kernels.search.placing import carry_body, follow, miss_of
from studio.core.kernels.search.retreat import AIM, NEAR, begin_retreat, note_disturbance, tries_share
from studio.core.kernels.search.step import KEPT
from studio.core.kernels.tasks.goals import DISTANCE, POSITION, counts, end_place
from studio.core.kernels.tasks.task import INACTIVE, ON_EDGE
from studio.core.kernels.time.activation_blend import blend_kept, blend_limb, note_turns

BOTH, WHOLE, PLAIN = 2, 3, 4
"""How a stage may go back, in this order: 0 with its left arm, 1 with its right one, with both, with all but neck and
head, or so that the whole body is blended and nothing else.
"""
LEFT = 0.8
"""Part of what a stage may change that it may where it is back wholly: stages above may have left it little."""


@allocating_kernel
def make_kept(clearance, constraints, joints):
    """Room for what is kept, none where nothing keeps clear."""
    clears = clearance.wanted.shape[0]
    count = constraints if clears > 0 else 0
    return KeptStage(
        np.empty((joints if clears > 0 else 0, 3)),
        np.empty((16 if clears > 0 else 0, 3, 3)),
        np.empty(count + clears),
        np.empty(count + clears),
        np.empty(count + clears),
        np.empty((count, 3)),
    )


@kernel
def next_stage(stage, frame, clip):
    """The first ``stage`` from one on that is to be solved at this frame, past the last where there is none.

    Something of it acts, and something that keeps clear does above it or in it. Where nothing keeps clear now, it is
    the last, with all that acts.
    """
    shares, stages, activations = clip.clearance.activations, clip.clearance.stages, clip.asked.activations
    count, last, first = shares.shape[0], activations.shape[0] - 1, activations.shape[0]
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
def keep_stage(stage, first, frame, clip, problem):
    """Note the pose of a stage and its misses, which are to stay as they are: the ``first`` has those of all above."""
    kept, tasks, stages = clip.kept, problem.tasks, clip.clearance.stages
    count, clears = tasks.shape[0], clip.clearance.wanted.shape[0]
    copy_points(problem.search.state, kept.state)
    note_turns(kept.turns, problem.pose)
    note_now(frame, clip)
    for each in range(count + clears):
        own = stages[clears + each if each < count else each - count]
        kept.first[each] = kept.now[each]
        if first or own == stage:
            kept.own[each] = kept.now[each]
    for c in range(count):
        if tasks[c].status != INACTIVE and tasks[c].points[0] >= 0:
            note_spot(tasks[c], problem.search, problem.pose, kept.spots[c])


@kernel
def note_now(frame, clip):
    """Note what is missed now as that of what was just solved."""
    now, misses, count = clip.kept.now, clip.clearance.misses, clip.asked.tasks.shape[0]
    for c in range(count):
        now[c] = clip.residuals[c, frame]
    for q in range(misses.shape[0]):
        now[count + q] = misses[q, frame]


@kernel
def change_of(stage, frame, clip):
    """By how much what stands above a stage is missed otherwise than when its own was kept, metres or radians."""
    tasks, clearance, own = clip.asked.tasks, clip.clearance, clip.kept.own
    count, clears, most = tasks.shape[0], clearance.wanted.shape[0], 0.0
    for c in range(count):
        if tasks[c].status != INACTIVE and clearance.stages[clears + c] < stage:
            most = max(most, abs(clip.residuals[c, frame] - own[c]))
    for q in range(clears):
        if clearance.activations[q, frame] > 0.0 and clearance.stages[q] < stage:
            most = max(most, abs(clearance.misses[q, frame] - own[count + q]))
    return most


@kernel
def hold_above(stage, frame, clip, problem):
    """Where a stage changes what stands above it, go but as far as it does not; in the end that is no way at all."""
    if change_of(stage, frame, clip) < KEPT:
        return
    note_now(frame, clip)
    place_capsules(clip.clearance.volume, problem.pose, clip.clearance.proximal, clip.clearing.capsules)
    for side in range(2):
        clear_closely(side, True, stage, frame, clip, problem)
    change = tell(1.0, stage, frame, clip, problem)
    if change < KEPT:
        return
    note_ways(frame, clip, problem)
    how = 0
    back = go_part(0.0, how, stage, frame, clip, problem)
    while back >= LEFT * KEPT and how < PLAIN:
        how += 1
        back = go_part(0.0, how, stage, frame, clip, problem)
    if back > (AIM - NEAR) * KEPT:
        return
    retreat = problem.search.retreat[0]
    begin_retreat(back, change, KEPT, retreat)
    while tries_share(retreat):
        note_disturbance(go_part(retreat.share, how, stage, frame, clip, problem), retreat)


@kernel
def clear_closely(side, moves, stage, frame, clip, problem):
    """Clear an arm once more, until it has the very room that what keeps clear above a stage is to keep; whether its
    wrist ``moves`` or the elbow alone.
    """
    tasks, clearance, clearing, pose = problem.tasks, clip.clearance, clip.clearing, problem.pose
    count, held = tasks.shape[0], clearing.held
    for q in range(clearance.wanted.shape[0]):
        if clearance.stages[q] < stage and clearance.activations[q, frame] * clearance.arms[q, side] > 0.0:
            hold_arm(side, tasks, clearance.above[q], pose.positions.shape[0] - 23, held)
            free = (1.0, clearance.freedoms[q] * (1.0 - held[0]) if moves else 0.0, 1.0 - held[1])
            for probe in range(PROBES):
                clearing.asks[probe] = clearance.wanted[q, frame, side, probe] - clip.kept.own[count + q] + CLOSE_ENOUGH
            clear_arm(side, CLOSE_ENOUGH, frame, free, clearance, clearing, pose)


@kernel
def note_ways(frame, clip, problem):
    """Note where a stage begins, and where it would get."""
    search = problem.search
    copy_points(search.state, search.before)
    copy_points(clip.kept.state, search.kept)
    note_turns(search.solved_turns, problem.pose)
    for turn in range(16):
        copy_matrix(clip.kept.turns[turn], search.kept_turns[turn])
    note_now(frame, clip)


@kernel
def go_part(share, how, stage, frame, clip, problem):
    """Pose the body where a stage has gone a ``share`` of its way, the whole of it or its arms, and tell all misses; by
    how much those above it change.
    """
    chain, search, start, pose = problem.chain, problem.search, problem.start, problem.pose
    spine_count = pose.positions.shape[0] - 23
    blend_kept(1.0 - share if how >= WHOLE else 0.0, search)
    if how == WHOLE:
        for joint in range(chain.joints.shape[0]):
            if spine_count <= chain.joints[joint].segment < spine_count + 2:
                copy_point(search.before[joint], search.state[joint])
    if how >= WHOLE:
        for limb in range(4):
            search.hung[limb] = HUNG if limb < 2 or is_named(limb, problem.tasks) else 0
        carry_body(problem)
        for limb in range(4):
            search.hung[limb] = 0
    for side in range(2):
        if how in (side, BOTH, WHOLE):
            held = how == WHOLE and wish_above(side, stage, clip, spine_count) >= 0
            blend_limb(1.0 if held else 1.0 - share, side, search)
        carrier, upper, root = limb_parts(side, spine_count)
        hang_limb(carrier, upper, root, 4 * side, search.hung_turns, start, pose)
    place_capsules(clip.clearance.volume, pose, clip.clearance.proximal, clip.clearing.capsules)
    for side in range(2):
        c = wish_above(side, stage, clip, spine_count)
        if c >= 0 and how in (side, BOTH, WHOLE):
            bring_back(side, c, clip, problem)
        if how in (side, BOTH, WHOLE):
            clear_closely(side, c < 0, stage, frame, clip, problem)
    return tell(share, stage, frame, clip, problem)


@kernel
def tell(share, stage, frame, clip, problem):
    """Tell all misses where a stage has gone a ``share`` of its way; by how much those above it change."""
    tasks, kept, residuals = problem.tasks, clip.kept, clip.residuals
    follow(tasks.shape[0], True, problem)
    measure_rooms(frame, clip, problem.pose)
    for c in range(tasks.shape[0]):
        if tasks[c].status != INACTIVE:
            miss = miss_of(c, problem)
            if tasks[c].status == ON_EDGE:
                miss = told_between(share, clip.asked.activations[stage, c, frame] * miss, kept.first[c], kept.now[c])
            residuals[c, frame] = miss
    return change_of(stage, frame, clip)


@kernel
def wish_above(side, stage, clip, spine_count):
    """The highest constraint above a stage that has a place for the wrist or hand of an arm, -1 for none."""
    tasks, stages, clears = clip.asked.tasks, clip.clearance.stages, clip.clearance.wanted.shape[0]
    for c in range(tasks.shape[0]):
        row = tasks[c]
        places = (row.kind == POSITION or row.kind == DISTANCE) and row.limbs[0] == side
        reaches = row.points[0] >= spine_count + 6 + 5 * side  # from the wrist on
        if places and reaches and stages[clears + c] < stage and counts(row):
            return c
    return -1


@kernel
def bring_back(side, c, clip, problem):
    """Bring an arm's point to the spot where a task's is kept: the hand keeps its orientation."""
    row, spot, pose, points = problem.tasks[c], clip.kept.spots[c], problem.pose, problem.search.points
    point, other, place, spine_count = points[0], points[1], points[3], pose.positions.shape[0] - 23
    _, upper, shoulder = limb_parts(side, spine_count)
    end_place(row, 0, pose, point)
    copy_point(spot, place)
    if row.points[1] >= 0:
        end_place(row, 1, pose, other)
        add_rotated(other, pose.rotations[row.segments[1]], spot[0], spot[1], spot[2], place)
    for axis in range(3):
        place[axis] -= point[axis]
    saved = clip.clearing.saved
    copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
    move_arm(side, 1.0, place, 0.0, saved, clip.clearing.turn, pose)


@kernel
def note_spot(row, search, pose, out_spot):
    """Where a constraint has its first point, (3,) in the axes of what it follows on its own body, or in the world."""
    point, other = search.points[0], search.points[1]
    end_place(row, 0, pose, point)
    copy_point(point, out_spot)
    if row.points[1] >= 0:
        end_place(row, 1, pose, other)
        axes = pose.rotations[row.segments[1]]
        x, y, z = point[0] - other[0], point[1] - other[1], point[2] - other[2]
        for axis in range(3):
            out_spot[axis] = axes[0, axis] * x + axes[1, axis] * y + axes[2, axis] * z


@kernel
def measure_rooms(frame, clip, pose):
    """Note how much room is missing as the body is posed now."""
    place_capsules(clip.clearance.volume, pose, clip.clearance.proximal, clip.clearing.capsules)
    for side in range(2):
        measure_side(side, clip, pose)
    note_lacking(frame, clip.clearance, clip.clearing.rooms)


@kernel
def told_between(share, miss, there, here):
    """What is told of one on its edge ``share`` of the way from what was told ``there``, NaN where it was not asked."""
    if math.isnan(there):
        return here + (1.0 - share) * miss
    return there + share * (here - there)


@kernel
def is_named(limb, tasks):
    """Whether anything that acts is about a limb."""
    named = False
    for c in range(tasks.shape[0]):
        for end in range(2):
            named = named or (tasks[c].status != INACTIVE and tasks[c].limbs[end] == limb)
    return named
