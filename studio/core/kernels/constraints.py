"""The constraints of one frame, level by level: limbs in closed form, trunk and root only where limbs fall short.

What goes through the functions here, for C constraints on a body of S segments and P points:
``asked`` (C,) records of ``kernels.asked`` in order of rank; ``areas`` (C, n) as in ``kernels.areas``.
``chain`` the tuple (mobilities (C + L, N), joints (N, 5), slots (S + 1,), limits (N,)) of ``kernels.joints``: how
  freely each constraint moves each joint, and after the C constraints each of the L levels any down to it.
``body`` (measures, masses (S, 2), leashes (2,), legs, limits, shares (P,)): masses and shares are those of
  ``kernels.balance``; leashes the parts of their lengths to which the root may stretch the legs, inf where a foot is
  free; legs are channels, comforts, ankles, feet and toes; limits those of ``kernels.joint_limits``.
``work`` (ask, solving, carried (S + 1, 3, 3), turned (4, N, 3) state, the one before, ``edges``' and one that costs
  those above too much, grips (12,), points (8, 3), sums (S + 1, 4), turns (54, 3, 3), full, past (5,)): scratch, the
  first two as in ``kernels.priorities``; of each limb what holds its end, whether ``edges`` keeps it and whether it is
  idle; full ``newton``'s; past what the last step missed, how many rows held when one was last eliminated (-1 not
  yet) and how far all has moved since, whether the last will do, and how many rows there were in all then.
``start`` and ``pose`` (positions (P, 3), rotations (S, 3, 3)): the motion's own, and the one that is solved.

Every frame starts from its own pose, and operations are meant to be continuous in their inputs, so that neighbouring
frames take neighbouring ways; where a level is given up, or a limb changes sides, ``kernels.easing`` does the rest.
"""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.goals import BALANCE, GIVEN_UP, LOOK_AT, ORIENTATION, POSITION, counts, end_place
from studio.core.kernels.joint_limits import keep_caps, note_own, restore_caps
from studio.core.kernels.limb import soft_reach
from studio.core.kernels.limb_constraints import (
    LIMB_COMFORT,
    limb_indices,
    note_grips,
    note_seconds,
    range_of,
)
from studio.core.kernels.means import is_alone, means_of, note_means, soft_way
from studio.core.kernels.placing import OUTLINED, carry_body, miss_of, note_idle, place_limbs, put_back
from studio.core.kernels.recruiting import frees_limbs, note_balances
from studio.core.kernels.room import make_room
from studio.core.kernels.rows import aim_limb
from studio.core.kernels.stance import free_part
from studio.core.kernels.steps import KEPT, MET, step
from studio.core.kernels.stiffness import free_stiff, stiffen
from studio.core.kernels.vectors import copy_matrix, copy_point, distance

TRIES, LATE = 4, 5
"""Steps that a level takes, and those that it may add where it is nearly there or still gains: a body far out of reach
would take many more to come to rest, for little.
"""
THOROUGH = 6
"""Steps of a level that recruits limbs, which end where they get, and of one whose every joint is looked at."""
LESS = 0.25
"""Part of its damping that every step of a level leaves the next: ways that hardly bring anything go free last. Not of
one with a balance, for which that would be to sink to the ground, or to fling about limbs.
"""
CRAMPED = 12
"""Steps of a level with a leg that its limits keep from what it asks: what it misses tells the root little."""
SIMPLE = 2
"""Steps along the rows' own ways, which are all that most targets need, before all joints are looked at (where no feet
and no other level are to be held: there, what holds would bend the ways of all joints too).
"""
COMFORT = 0.97
"""Part of its reach that a limb takes before the trunk helps."""
FOLDING = 0.05
"""Part of the way from its greatest to its least reach, the last, in which a limb folds ever less."""
MENDS = 8
"""Steps that may be taken to give those above back what a level has cost them."""
HALVES, BACK = 4, 0.7
"""Times that the way of a level which disturbs those above is halved to find how far it can go, before it is given up,
and the part of what it may disturb that it is to be left with.
"""
GAINS = 0.7
"""Part of the least disturbance so far that a mend may leave; where two leave more, no other follows."""


@kernel
def solve_frame(level_count, asked, areas, chain, body, work, start, pose):
    """Move one posed frame until its constraints hold as well as their chains and priorities allow."""
    spine_count = pose[0].shape[0] - 23
    turned = work[3]
    for joint in range(turned.shape[1]):
        turned[0, joint, 0] = turned[0, joint, 1] = turned[0, joint, 2] = 0.0
    idle = work[4][8:]
    note_idle(asked, chain[2], spine_count, idle)
    note_seconds(asked)
    note_limits(asked, chain[2], body, start)
    before = -1
    for level in range(level_count):
        if not wants_level(level, asked):
            continue
        changed = note_grips(level, asked, spine_count, work[4])
        note_reaches(level, changed, asked, chain, work[4], body, work[5], start, pose)
        if before >= 0:
            note_kept(before, level, asked, areas, body, work, pose)
            keep_caps(body[4])
        solve_level(level, before < 0, asked, areas, chain, body, work, start, pose)
        before = level
    for limb in range(4):
        outlined = idle[limb] == OUTLINED
        idle[limb] = 0
        if outlined:
            put_back(limb, chain, body, work, start, pose)


@kernel
def note_limits(asked, slots, body, start):
    """What the unsolved pose has of every limb that a constraint is about, or a search turns; of wrists and ankles only
    where hand or foot are named.
    """
    limits = body[4]
    for limb in range(limits.shape[0]):
        upper = limb_indices(limb, start[0].shape[0] - 23)[1]
        found, tip = slots[upper] >= 0, limb >= 2
        for c in range(asked.shape[0]):
            for end in range(2):
                if asked[c].ends[end, 2] == limb:
                    found = found or asked[c].wanted == 1
                    tip = tip or asked[c].ends[end, 1] >= upper + 2
        if found:
            note_own(limb, 2 if tip else 1, limits, start)
            limits[limb].lets_go = free_part(limb - 2, body) if limb >= 2 else 1.0


@kernel
def wants_level(level, asked):
    """Whether any constraint of this level acts now."""
    acts = False
    for c in range(asked.shape[0]):
        acts = acts or (asked[c].rank == level and asked[c].wanted == 1)
    return acts


@kernel
def solve_level(level, fresh, asked, areas, chain, body, work, start, pose):
    """Newton's steps on one level with those above held; in the end those above get back what it cost them."""
    stiff = free_stiff(level, asked)
    turned = work[3]
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[1, joint])
    place(level, fresh, asked, areas, chain, body, work, start, pose)
    if stiff:
        stiffen(level, asked)
        place(level, False, asked, areas, chain, body, work, start, pose)
    if not fresh and yields(level, asked, areas, body, work, pose):
        begin_again(level, asked, areas, chain, body, work, start, pose)
    if chain[1].shape[0] > 0:
        take_steps(level, fresh, asked, areas, chain, body, work, start, pose)
    if not fresh:
        give_back(level, asked, areas, chain, body, work, start, pose)


@kernel
def take_steps(level, fresh, asked, areas, chain, body, work, start, pose):
    """Steps until a level has what it wants, or as much of it as there is."""
    past = work[9]
    past[0], past[1] = 0.0, -1.0
    balances = note_balances(level, asked, chain, body, work, pose)
    if is_met(level, asked, areas, body, work, pose):
        return
    frees = frees_limbs(min(asked.shape[0] + level, chain[0].shape[0] - 1), chain)
    stays = fresh and not frees_root(level, asked, chain)
    whole = stays and not frees
    tries = THOROUGH if frees or whole else TRIES
    if not frees and make_room(level, asked, areas, chain, body, work, start, pose):
        tries = CRAMPED
    for attempt in range(tries if frees else tries + LATE):
        refines, is_late = whole and attempt >= SIMPLE, attempt >= tries
        less = 1.0 if frees or balances else LESS**attempt
        if not step(level, False, refines, is_late, stays, less, asked, chain, body, work, start, pose) > 0.0:
            break
        place(level, False, asked, areas, chain, body, work, start, pose)
        if past[3] > 0.0:
            break


@kernel
def give_back(level, asked, areas, chain, body, work, start, pose):
    """Mend what a level has cost those above it, or go back; in the end it is given up, and all is as it began."""
    if mend(level, KEPT, True, asked, areas, chain, body, work, start, pose):
        return
    disturbs = disturbance(level, True, asked, areas, body, work, pose)
    if disturbs < KEPT:
        return
    turned, least, most, costs, cost = work[3], 0.0, 1.0, disturbs, 0.0
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[3, joint])
    for attempt in range(HALVES + 2):
        share = least  # where even what lies between does not do
        if attempt < HALVES:
            share = 0.5 * (least + most)
        elif attempt == HALVES:
            share += (most - least) * (BACK * KEPT - cost) / (costs - cost)
        go_back(share, level, asked, areas, chain, body, work, start, pose)
        disturbs = disturbance(level, True, asked, areas, body, work, pose)
        if attempt >= HALVES and disturbs < KEPT:
            return
        if disturbs < BACK * KEPT:
            least, cost = share, disturbs
        else:
            most, costs = share, disturbs
    for joint in range(turned.shape[1]):
        copy_point(turned[1, joint], turned[0, joint])
    give_up(level, asked)
    begin_again(level, asked, areas, chain, body, work, start, pose)


@kernel
def go_back(share, level, asked, areas, chain, body, work, start, pose):
    """Leave but a ``share`` of the way that a level has gone, and mend that."""
    turned = work[3]
    for joint in range(turned.shape[1]):
        for axis in range(3):
            before = turned[1, joint, axis]
            turned[0, joint, axis] = before + share * (turned[3, joint, axis] - before)
    place(level, False, asked, areas, chain, body, work, start, pose)
    work[9][1] = -1.0
    mend(level, BACK * KEPT, True, asked, areas, chain, body, work, start, pose)


@kernel
def begin_again(level, asked, areas, chain, body, work, start, pose):
    """Limbs as this level is to have them once something of it is given up."""
    restore_caps(body[4])
    changed = note_grips(level, asked, pose[0].shape[0] - 23, work[4])
    note_reaches(level, changed, asked, chain, work[4], body, work[5], start, pose)
    place(level, False, asked, areas, chain, body, work, start, pose)


@kernel
def yields(level, asked, areas, body, work, pose):
    """Give up what this level asks of limbs whose turn, wished above, their limits do not leave beside it.

    No joint of the trunk would give that back. Whether there is any.
    """
    found = False
    for c in range(asked.shape[0]):
        row = asked[c]
        if row.kind != ORIENTATION or row.ends[0, 2] < 0 or row.wanted != 1 or row.rank >= level:
            continue
        limb = row.ends[0, 2]
        if miss_of(c, asked, areas, body, work, pose) - row.kept_miss < KEPT:
            continue
        for other in range(asked.shape[0]):
            named = asked[other].ends[0, 2] == limb or asked[other].ends[1, 2] == limb
            if named and asked[other].rank == level and asked[other].wanted == 1:
                asked[other].wanted, asked[other].engaged = GIVEN_UP, 0
                found = True
    return found


@kernel
def mend(level, most, both_ways, asked, areas, chain, body, work, start, pose):
    """Give those above this level back what it has cost them, and, ``both_ways``, take back what it gave them; whether
    that is less than ``most`` metres now.
    """
    least, fails, past = math.inf, 0, work[9]
    for _ in range(MENDS):
        disturbs = disturbance(level, both_ways, asked, areas, body, work, pose)
        if disturbs < most:
            return True
        if disturbs > GAINS * least:
            fails, past[1] = fails + 1, -1.0
            if fails > 1:
                break
        least, joints = min(least, disturbs), chain[1].shape[0]
        if joints == 0 or not step(level, True, False, False, False, 1.0, asked, chain, body, work, start, pose) > 0.0:
            break
        place(level, False, asked, areas, chain, body, work, start, pose)
    return False


@kernel
def frees_root(level, asked, chain):
    """Whether any constraint of this level may move the root: others that do must not change how it is solved."""
    root = chain[2][-1]
    frees = False
    for c in range(asked.shape[0]):
        frees = frees or (root >= 0 and asked[c].rank == level and asked[c].wanted == 1 and chain[0][c, root] > 0.0)
    return frees


@kernel
def give_up(level, asked):
    """What cannot be had beside the levels above is not asked of limbs any more at this frame."""
    for c in range(asked.shape[0]):
        if asked[c].rank == level and asked[c].wanted:
            asked[c].wanted, asked[c].engaged = GIVEN_UP, 0


@kernel
def place(level, fresh, asked, areas, chain, body, work, start, pose):
    """The body where its joints carry it, and its limbs where they are to be; a fresh pose is carried already."""
    if not fresh:
        carry_body(chain, body, work, start, pose)
    elif chain[1].shape[0] > 0:
        note_carried(work[2])
    place_limbs(level, asked, areas, chain, body, work, start, pose)


@kernel
def note_carried(carried):
    """Nothing has turned yet."""
    for segment in range(carried.shape[0]):
        for row in range(3):
            for column in range(3):
                carried[segment, row, column] = 1.0 if row == column else 0.0


@kernel
def is_met(level, asked, areas, body, work, pose):
    """Whether this level has what it wants as limbs were placed, and those above it have lost nothing."""
    for c in range(asked.shape[0]):
        row = asked[c]
        if row.wanted == 1 and row.rank == level and miss_of(c, asked, areas, body, work, pose) >= MET:
            return False
    return disturbance(level, True, asked, areas, body, work, pose) < KEPT


@kernel
def disturbance(level, both_ways, asked, areas, body, work, pose):
    """By how much more or, ``both_ways``, less than before those above this level are missed, in metres or radians."""
    worst = 0.0
    for c in range(asked.shape[0]):
        row = asked[c]
        if counts(row) and row.rank < level:
            change = miss_of(c, asked, areas, body, work, pose) - row.kept_miss
            worst = max(worst, abs(change) if both_ways else change)
    return worst


@kernel
def note_kept(first, level, asked, areas, body, work, pose):
    """Note what the constraints above this level have got: it is theirs to keep.

    Those above ``first``, the level that was solved last, keep what they missed when it began: changes do not add up.
    """
    spine_count = pose[0].shape[0] - 23
    for c in range(asked.shape[0]):
        row = asked[c]
        if not counts(row) or row.rank >= level:
            continue
        miss = miss_of(c, asked, areas, body, work, pose)
        if row.rank >= first:
            row.kept_miss = miss
        if row.kind == ORIENTATION or row.kind == LOOK_AT:
            copy_matrix(pose[1][row.ends[0, 1]], row.kept_turn)
        elif row.kind == BALANCE:
            copy_point(work[5][0], row.kept_places[0])  # where its miss was measured
        else:
            for end in range(2):
                if row.ends[end, 0] >= 0:
                    end_place(row, end, pose, row.kept_places[end])
                if row.ends[end, 2] >= 0:
                    root = limb_indices(row.ends[end, 2], spine_count)[0]
                    copy_point(pose[0][root], row.kept_roots[end])


@kernel
def note_reaches(level, changed, asked, chain, grips, body, points, start, pose):
    """How far each limb can stretch for each end and how far it shall, and how near it can fold, in metres.

    Beyond its comfort (or what the motion itself stretches) the limb takes ``soft_reach``, so its extension is smooth
    in time and the trunk does the rest without error (METHOD 6, "reach sharing"). Levels above have noted theirs, but
    for limbs whose grip has ``changed`` (bits).
    """
    spine_count = pose[0].shape[0] - 23
    point = points[0]
    for c in range(asked.shape[0]):
        row = asked[c]
        if row.wanted != 1 or row.rank > level or row.kind == ORIENTATION or row.kind == BALANCE or row.kind == LOOK_AT:
            continue
        for end in range(2):
            limb = row.ends[end, 2]
            if row.rank < level and not (limb >= 0 and changed >> limb & 1):
                continue
            if end == 0 and row.kind == POSITION and (limb < 0 or row.freedoms[end, 0] == 0.0):
                end_place(row, end, start, row.begin)
                note_means(c, row, chain, body, start)
            if limb < 0:
                continue
            holds_end = limb >= 2 or grips[limb] >= 0
            end_place(row, end, start, point)
            root, upper = limb_indices(limb, spine_count)
            origin = row.origins[end]
            if row.rank == level:
                copy_point(pose[0][root], origin)
            fold, reach, own = range_of(limb, row.ends[end, 1], holds_end, point, body[4], start)
            row.folds[end], row.longest[end], row.reaches[end] = fold, reach, reach
            row.easings[end] = min(fold + FOLDING * (reach - fold), own)
            row.comforts[end], row.slack[end] = 1.0, 0.0
            if reach <= 0.0 or row.ends[end, 1] == upper:
                continue
            shoulder = start[0][root]
            comfort = COMFORT if row.helped else LIMB_COMFORT
            row.comforts[end] = min(max(distance(point, shoulder) / reach, comfort), 0.9999)
            if row.kind == POSITION and row.helped:
                x, y, z = aim_limb(row, end, False, holds_end, points, start)
                row.comforts[end] = min(max(distance(point, shoulder) / reach, comfort), 0.9999)
                x, y, z = x - origin[0], y - origin[1], z - origin[2]
                span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
                taken = span / reach if row.stiff else max(span / reach, row.comforts[end])
                row.reaches[end] = reach * min(soft_reach(taken, row.comforts[end]), 0.9999)
                way, carrier = span - min(max(span, fold), row.reaches[end]), 0 if limb >= 2 else upper - 1
                if way < 0.0 or (way > 0.0 and is_alone(c, carrier, chain)):
                    sign = math.copysign(1.0 / span, way)
                    able = means_of(c, sign * x, sign * y, sign * z, shoulder, carrier, chain, body, start)
                    row.slack[end] = way - math.copysign(soft_way(abs(way), able), way)
