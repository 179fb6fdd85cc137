"""Strict priorities where what keeps clear stands above tasks: a frame is solved tier by tier (METHOD 6).

Tier 0 is the highest that keep clear and all above and beside them, and every priority below is a tier of its own. A
frame is solved and cleared down to each tier in which something acts, and what has come to be is kept (``KeptTier``).

Where a tier changes what one above it misses, the body goes but a part of its way from there.
"""

import math

import numpy as np

from studio.core.kernels.algebra.vectors import copy_matrix, copy_points
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb_tasks import BLENDED
from studio.core.kernels.limits.clearance import place_capsules
from studio.core.kernels.limits.clearing import measure_side, note_lacking
from studio.core.kernels.records import KeptTier
from studio.core.kernels.search.joints import pose_limb
from studio.core.kernels.search.placing import carry_body
from studio.core.kernels.search.retreat import AIM, NEAR, begin_retreat, note_disturbance, tries_share
from studio.core.kernels.search.step import KEPT
from studio.core.kernels.tasks.kinds import follow, miss_of
from studio.core.kernels.tasks.task import INACTIVE, ON_EDGE
from studio.core.kernels.time.activation_blend import blend_kept, note_turns


@allocating_kernel
def make_kept(clearance, constraints, joints):
    """Room for what is kept, none where nothing keeps clear."""
    clears = clearance.wanted.shape[0]
    count = constraints if clears > 0 else 0
    return KeptTier(
        np.empty((joints if clears > 0 else 0, 3)),
        np.empty((16 if clears > 0 else 0, 3, 3)),
        np.empty(count + clears),
        np.empty(count + clears),
        np.empty(count + clears),
    )


@kernel
def next_tier(tier, frame, clip):
    """The first ``tier`` from one on that is to be solved at this frame, past the last where there is none.

    Something of it acts, and something that keeps clear does above it or in it. Where nothing keeps clear now, it is
    the last, with all that acts.
    """
    shares, tiers, activations = clip.clearance.activations, clip.clearance.tiers, clip.asked.activations
    count, last, first = shares.shape[0], activations.shape[0] - 1, activations.shape[0]
    for q in range(count):
        if shares[q, frame] > 0.0:
            first = min(first, tiers[q])
    if first > last:
        return max(tier, last)
    found, tier = last + 1, max(tier, first)
    for each in range(tiers.shape[0]):
        share = shares[each, frame] if each < count else activations[last, each - count, frame]
        if share > 0.0 and tiers[each] >= tier:
            found = min(found, tiers[each])
    return found


@kernel
def keep_tier(tier, first, frame, clip, problem):
    """Note the pose of a tier and its misses, which are to stay as they are: the ``first`` has those of all above."""
    kept, tasks, tiers = clip.kept, problem.tasks, clip.clearance.tiers
    count, clears = tasks.shape[0], clip.clearance.wanted.shape[0]
    copy_points(problem.search.state, kept.state)
    note_turns(kept.turns, problem.pose)
    note_now(frame, clip)
    for each in range(count + clears):
        own = tiers[clears + each if each < count else each - count]
        kept.first[each] = kept.now[each]
        if first or own == tier:
            kept.own[each] = kept.now[each]


@kernel
def note_now(frame, clip):
    """Note what is missed now as that of what was just solved."""
    now, misses, count = clip.kept.now, clip.clearance.misses, clip.asked.tasks.shape[0]
    for c in range(count):
        now[c] = clip.residuals[c, frame]
    for q in range(misses.shape[0]):
        now[count + q] = misses[q, frame]


@kernel
def change_of(tier, frame, clip):
    """By how much what stands above a tier is missed otherwise than when its own was kept, metres or radians."""
    tasks, clearance, own = clip.asked.tasks, clip.clearance, clip.kept.own
    count, clears, most = tasks.shape[0], clearance.wanted.shape[0], 0.0
    for c in range(count):
        if tasks[c].status != INACTIVE and clearance.tiers[clears + c] < tier:
            most = max(most, abs(clip.residuals[c, frame] - own[c]))
    for q in range(clears):
        if clearance.activations[q, frame] > 0.0 and clearance.tiers[q] < tier:
            most = max(most, abs(clearance.misses[q, frame] - own[count + q]))
    return most


@kernel
def hold_above(tier, frame, clip, problem):
    """Where a tier changes what stands above it, go but as far as it does not; in the end that is no way at all."""
    change = change_of(tier, frame, clip)
    if change < KEPT:
        return
    note_ways(frame, clip, problem)
    back, retreat = go_part(0.0, tier, frame, clip, problem), problem.search.retreat[0]
    if back > (AIM - NEAR) * KEPT:
        return
    begin_retreat(back, change, KEPT, retreat)
    while tries_share(retreat):
        note_disturbance(go_part(retreat.share, tier, frame, clip, problem), retreat)


@kernel
def note_ways(frame, clip, problem):
    """Note where a tier begins, and where it would get."""
    search = problem.search
    copy_points(search.state, search.before)
    copy_points(clip.kept.state, search.kept)
    note_turns(search.solved_turns, problem.pose)
    for turn in range(16):
        copy_matrix(clip.kept.turns[turn], search.kept_turns[turn])
    note_now(frame, clip)


@kernel
def go_part(share, tier, frame, clip, problem):
    """Pose the body where it has gone a ``share`` of a tier's way, and tell all misses; by how much those above it
    change.
    """
    search, start, pose = problem.search, problem.start, problem.pose
    blend_kept(1.0 - share, search)
    for limb in range(4):
        search.blended[limb] = BLENDED if limb < 2 or is_named(limb, problem.tasks) else 0
    carry_body(problem)
    for limb in range(4):
        search.blended[limb] = 0
    for side in range(2):
        carrier, upper, root = limb_parts(side, pose.positions.shape[0] - 23)
        pose_limb(carrier, upper, root, 4 * side, search.blended_turns, start, pose)
    return tell(share, tier, frame, clip, problem)


@kernel
def tell(share, tier, frame, clip, problem):
    """Tell all misses where a tier has gone a ``share`` of its way; by how much those above it change."""
    tasks, kept, residuals = problem.tasks, clip.kept, clip.residuals
    follow(tasks.shape[0], True, problem)
    measure_rooms(frame, clip, problem.pose)
    for c in range(tasks.shape[0]):
        if tasks[c].status != INACTIVE:
            miss = miss_of(c, problem)
            if tasks[c].status == ON_EDGE:
                miss = told_between(share, clip.asked.activations[tier, c, frame] * miss, kept.first[c], kept.now[c])
            residuals[c, frame] = miss
    return change_of(tier, frame, clip)


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
