"""The constraints of one frame, level by level: limbs in closed form, trunk and root only where limbs fall short.

Every frame starts from its own pose, and operations are meant to be continuous in their inputs, so that neighbouring
frames take neighbouring ways; where a level is given up, or a limb changes sides, ``kernels.time.easing`` does the
rest.
"""

import math

from studio.core.kernels.algebra.vectors import (
    between,
    blend_points,
    clear_points,
    copy_matrix,
    copy_point,
    copy_points,
    distance,
)
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.leg_room import make_room
from studio.core.kernels.limbs.limb import COMFORT, OWN_COMFORT, STRETCHED, soft_reach
from studio.core.kernels.limbs.limb_limits import bent_point
from studio.core.kernels.limbs.limb_tasks import (
    note_ends,
    note_secondary,
    range_of,
)
from studio.core.kernels.limbs.stiffness import free_stiff, stiffen
from studio.core.kernels.limits.joint_limits import keep_caps, note_own, restore_caps
from studio.core.kernels.limits.root_reach import free_part
from studio.core.kernels.search.placing import OUTLINED, carry_body, note_idle, place_limbs, put_back
from studio.core.kernels.search.reachability import is_alone, note_reachable, reachable_way, soft_way
from studio.core.kernels.search.recruiting import frees_limbs, note_balances
from studio.core.kernels.search.retreat import AIM, begin_retreat, note_disturbance, tries_share
from studio.core.kernels.search.step import KEPT, MET, step
from studio.core.kernels.tasks.balance import centre_of_mass
from studio.core.kernels.tasks.goals import asks_place, brings_point, counts, end_place, moves_mass, turns_segment
from studio.core.kernels.tasks.kinds import miss_of
from studio.core.kernels.tasks.task import ACTIVE, GIVEN_UP, INACTIVE

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
FOLDING = 0.05
"""Part of the way from its greatest to its least reach, the last, in which a limb folds ever less."""
MENDS = 8
"""Steps that may be taken to give those above back what a level has cost them."""
GAINS = 0.7
"""Part of the least disturbance so far that a mend may leave; where two leave more, no other follows."""


@kernel
def solve_frame(level_count, problem):
    """Move one posed frame until its constraints hold as well as their chains and priorities allow."""
    tasks, chain, body, search, pose = problem.tasks, problem.chain, problem.body, problem.search, problem.pose
    spine_count = pose.positions.shape[0] - 23
    clear_points(search.state)
    idle = search.idle
    note_idle(tasks, chain.slots, spine_count, idle)
    note_secondary(tasks)
    note_limits(problem)
    before = -1
    for level in range(level_count):
        if not wants_level(level, tasks):
            continue
        changed = note_ends(level, tasks, spine_count, search.ends)
        note_reaches(level, changed, problem)
        if before >= 0:
            note_kept(before, level, problem)
            keep_caps(body.limits)
        solve_level(level, before < 0, problem)
        before = level
    for limb in range(4):
        outlined = idle[limb] == OUTLINED
        idle[limb] = 0
        if outlined:
            put_back(limb, problem)


@kernel
def note_limits(problem):
    """What the unsolved pose has of every limb that a constraint is about, or a search turns; of wrists and ankles only
    where hand or foot are named.
    """
    tasks, slots, body, start = problem.tasks, problem.chain.slots, problem.body, problem.start
    limits = body.limits
    for limb in range(limits.shape[0]):
        upper = limb_parts(limb, start.positions.shape[0] - 23)[1]
        found, tip = slots[upper] >= 0, limb >= 2
        for c in range(tasks.shape[0]):
            for end in range(2):
                if tasks[c].limbs[end] == limb:
                    found = found or tasks[c].status == ACTIVE
                    tip = tip or tasks[c].segments[end] >= upper + 2
        if found:
            note_own(limb, 2 if tip else 1, limits, start)
            limits[limb].lets_go = free_part(limb - 2, body) if limb >= 2 else 1.0


@kernel
def wants_level(level, tasks):
    """Whether any constraint of this level acts now."""
    acts = False
    for c in range(tasks.shape[0]):
        acts = acts or (tasks[c].rank == level and tasks[c].status == ACTIVE)
    return acts


@kernel
def solve_level(level, fresh, problem):
    """Newton's steps on one level with those above held; in the end those above get back what it cost them."""
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    stiff = free_stiff(level, tasks)
    copy_points(search.state, search.before)
    place(level, fresh, problem)
    if stiff:
        stiffen(level, tasks)
        place(level, False, problem)
    if not fresh and yields(level, problem):
        begin_again(level, problem)
    if chain.joints.shape[0] > 0:
        take_steps(level, fresh, problem)
    if not fresh:
        give_back(level, problem)


@kernel
def take_steps(level, fresh, problem):
    """Steps until a level has what it wants, or as much of it as there is."""
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    past = search.last[0]
    past.missed = 0.0
    balances = note_balances(level, problem)
    if is_met(level, problem):
        return
    frees = frees_limbs(min(tasks.shape[0] + level, chain.mobilities.shape[0] - 1), chain)
    stays = fresh and not frees_root(level, tasks, chain)
    whole = stays and not frees
    tries = THOROUGH if frees or whole else TRIES
    if not frees and make_room(level, problem):
        tries = CRAMPED
    for attempt in range(tries if frees else tries + LATE):
        refines, is_late = whole and attempt >= SIMPLE, attempt >= tries
        less = 1.0 if frees or balances else LESS**attempt
        if not step(level, False, refines, is_late, stays, less, problem) > 0.0:
            break
        place(level, False, problem)
        if past.suffices:
            break


@kernel
def give_back(level, problem):
    """Mend what a level has cost those above it, or go back; in the end it is given up, and all is as it began."""
    tasks, search = problem.tasks, problem.search
    disturbs, retreat = mend(level, KEPT, True, problem), search.retreat[0]
    if disturbs < KEPT:
        return
    copy_points(search.state, search.tried)
    begin_retreat(0.0, disturbs, KEPT, retreat)
    while tries_share(retreat):
        note_disturbance(go_part(retreat.share, level, problem), retreat)
    if retreat.disturbs < KEPT:
        return
    copy_points(search.before, search.state)
    give_up(level, tasks)
    begin_again(level, problem)


@kernel
def go_part(share, level, problem):
    """Pose the body where a level has gone a ``share`` of its way, and mend that; what that disturbs above."""
    search = problem.search
    blend_points(share, search.before, search.tried, search.state)
    place(level, False, problem)
    return mend(level, AIM * KEPT, True, problem)


@kernel
def begin_again(level, problem):
    """Limbs as this level is to have them once something of it is given up."""
    tasks, body, search, pose = problem.tasks, problem.body, problem.search, problem.pose
    restore_caps(body.limits)
    changed = note_ends(level, tasks, pose.positions.shape[0] - 23, search.ends)
    note_reaches(level, changed, problem)
    place(level, False, problem)


@kernel
def yields(level, problem):
    """Give up what this level asks of limbs whose turn, asked above, their limits do not leave beside it.

    No joint of the trunk would give that back. Whether there is any.
    """
    tasks = problem.tasks
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not turns_segment(row) or row.limbs[0] < 0 or row.status != ACTIVE or row.rank >= level:
            continue
        limb = row.limbs[0]
        if miss_of(c, problem) - row.kept_miss < KEPT:
            continue
        for other in range(tasks.shape[0]):
            named = tasks[other].limbs[0] == limb or tasks[other].limbs[1] == limb
            if named and tasks[other].rank == level and tasks[other].status == ACTIVE:
                tasks[other].status, tasks[other].engaged = GIVEN_UP, 0
                found = True
    return found


@kernel
def mend(level, most, both_ways, problem):
    """Give those above this level back what it has cost them, and, ``both_ways``, take back what it gave them, until
    that is less than ``most`` metres; what it is in the end.
    """
    chain, least, fails = problem.chain, math.inf, 0
    disturbs = disturbance(level, both_ways, problem)
    for _ in range(MENDS):
        if disturbs < most:
            break
        if disturbs > GAINS * least:
            fails += 1
            if fails > 1:
                break
        least, joints = min(least, disturbs), chain.joints.shape[0]
        if joints == 0 or not step(level, True, False, False, False, 1.0, problem) > 0.0:
            break
        place(level, False, problem)
        disturbs = disturbance(level, both_ways, problem)
    return disturbs


@kernel
def frees_root(level, tasks, chain):
    """Whether any constraint of this level may move the root: others that do must not change how it is solved."""
    root = chain.slots[-1]
    frees = False
    for c in range(tasks.shape[0]):
        frees = frees or (
            root >= 0 and tasks[c].rank == level and tasks[c].status == ACTIVE and chain.mobilities[c, root] > 0.0
        )
    return frees


@kernel
def give_up(level, tasks):
    """What cannot be had beside the levels above is not asked of limbs any more at this frame."""
    for c in range(tasks.shape[0]):
        if tasks[c].rank == level and tasks[c].status != INACTIVE:
            tasks[c].status, tasks[c].engaged = GIVEN_UP, 0


@kernel
def place(level, fresh, problem):
    """The body where its joints carry it, and its limbs where they are to be; a fresh pose is carried already."""
    chain, search = problem.chain, problem.search
    if not fresh:
        carry_body(problem)
    elif chain.joints.shape[0] > 0:
        note_carried(search.carried)
    place_limbs(level, problem)


@kernel
def note_carried(carried):
    """Nothing has turned yet."""
    for segment in range(carried.shape[0]):
        for row in range(3):
            for column in range(3):
                carried[segment, row, column] = 1.0 if row == column else 0.0


@kernel
def is_met(level, problem):
    """Whether this level has what it wants as limbs were placed, and those above it have lost nothing."""
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status == ACTIVE and row.rank == level and miss_of(c, problem) >= MET:
            return False
    return disturbance(level, True, problem) < KEPT


@kernel
def disturbance(level, both_ways, problem):
    """By how much more or, ``both_ways``, less than before those above this level are missed, in metres or radians."""
    tasks = problem.tasks
    worst = 0.0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if counts(row) and row.rank < level:
            change = miss_of(c, problem) - row.kept_miss
            worst = max(worst, abs(change) if both_ways else change)
    return worst


@kernel
def note_kept(first, level, problem):
    """Note what the constraints above this level have got: it is theirs to keep.

    Those above ``first``, the level that was solved last, keep what they missed when it began: changes do not add up.
    """
    tasks, pose = problem.tasks, problem.pose
    spine_count = pose.positions.shape[0] - 23
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not counts(row) or row.rank >= level:
            continue
        miss = miss_of(c, problem)
        if row.rank >= first:
            row.kept_miss = miss
        if turns_segment(row):
            copy_matrix(pose.rotations[row.segments[0]], row.kept_turn)
        elif moves_mass(row):
            copy_point(centre_of_mass(problem.body.shares, pose.positions), row.kept_places[0])
        else:
            for end in range(2):
                if row.points[end] >= 0:
                    copy_point(end_place(row, end, pose), row.kept_places[end])
                if row.limbs[end] >= 0:
                    root = limb_parts(row.limbs[end], spine_count)[2]
                    copy_point(pose.positions[root], row.kept_roots[end])


@kernel
def note_reaches(level, changed, problem):
    """How far each limb can stretch for each end and how far it shall, and how near it can fold, in metres.

    Levels above have noted theirs, but for limbs whose end is held by another task now, the ``changed`` (bits).
    """
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status != ACTIVE or row.rank > level or not brings_point(row):
            continue
        for end in range(2):
            limb = row.limbs[end]
            if row.rank < level and not (limb >= 0 and changed >> limb & 1):
                continue
            if end == 0 and asks_place(row) and (limb < 0 or row.freedoms[end, 0] == 0.0):
                copy_point(end_place(row, end, problem.start), row.begin)
                note_reachable(c, row, problem)
            if limb >= 0:
                note_reach(c, end, row.rank == level, problem)


@kernel
def note_reach(c, end, own, problem):
    """``note_reaches`` of one end of a constraint, of a level's ``own`` from where its limb begins now.

    Beyond its comfort (or what the motion itself stretches) the limb takes ``soft_reach``, so its extension is smooth
    in time and the trunk does the rest without error (METHOD 6, "reach sharing").
    """
    body, start, row = problem.body, problem.start, problem.tasks[c]
    limb, origin = row.limbs[end], row.origins[end]
    holds_end, point = limb >= 2 or problem.search.ends[limb] >= 0, end_place(row, end, start)
    _, upper, root = limb_parts(limb, start.positions.shape[0] - 23)
    if own:
        copy_point(problem.pose.positions[root], origin)
    fold, reach, now = range_of(limb, row.segments[end], holds_end, point, body.limits, start)
    row.folds[end], row.longest[end], row.reaches[end] = fold, reach, reach
    row.easings[end] = min(fold + FOLDING * (reach - fold), now)
    row.comforts[end], row.slack[end] = 1.0, 0.0
    if reach <= 0.0 or row.segments[end] == upper:
        return
    shoulder = start.positions[root]
    comfort = COMFORT if row.helped else OWN_COMFORT
    row.comforts[end] = min(max(distance(point, shoulder) / reach, comfort), STRETCHED)
    if asks_place(row) and row.helped:
        bent, goal = bent_point(row, end, row.places[end], holds_end, start)
        row.comforts[end] = min(max(distance(bent, shoulder) / reach, comfort), STRETCHED)
        x, y, z = between(origin, goal)
        span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
        taken = span / reach if row.stiff else max(span / reach, row.comforts[end])
        row.reaches[end] = reach * min(soft_reach(taken, row.comforts[end]), STRETCHED)
        way, carrier = span - min(max(span, fold), row.reaches[end]), 0 if limb >= 2 else upper - 1
        if way < 0.0 or (way > 0.0 and is_alone(c, carrier, problem.chain)):
            sign = math.copysign(1.0 / span, way)
            able = reachable_way(c, sign * x, sign * y, sign * z, shoulder, carrier, problem)
            row.slack[end] = way - math.copysign(soft_way(abs(way), able), way)
