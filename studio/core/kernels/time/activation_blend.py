"""Frames on the edge of a constraint's activation: what is solved is blended there, not what is asked (METHOD (31)).

On the straight way from where a point is to where it is to be, a hand passes by its own shoulder, where the arm whirls
about, or is out of reach after a moment, where elbow and trunk stop at once. So such a frame is solved with all its
constraints, then without the one that acts least, and so on until what is wholly active is left, and each pose is
blended with the one before, joint by joint. Those that both have then get back what the blend has cost them.

The pose before is the ``kept`` state and turns of a ``Search``, that just solved its ``before`` and ``solved_turns``,
and the blend its ``state`` and ``blended_turns``; misses are ``blended`` in the records of the tasks.
"""

import math

from studio.core.kernels.algebra.turns import ease_turn, put_turn, turn_between, turn_error, turn_in
from studio.core.kernels.algebra.vectors import (
    between,
    blend_points,
    copy_matrix,
    copy_point,
    copy_points,
    distance,
    length,
    length_along,
)
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_limits import bent_point
from studio.core.kernels.limbs.limb_tasks import BLENDED, CLOSE_ENOUGH
from studio.core.kernels.search.levels import disturbance, mend, note_kept
from studio.core.kernels.search.placing import carry_body, place_limbs
from studio.core.kernels.search.step import KEPT
from studio.core.kernels.tasks.goals import TURN_ARM, asks_place, ease_goal, has_own_goal, moves_mass, turns_segment
from studio.core.kernels.tasks.kinds import miss_of
from studio.core.kernels.tasks.limb_rows import MISSED
from studio.core.kernels.tasks.task import ACTIVE, FREE, INACTIVE, ON_EDGE, PINNED, STRICT

GIVEN_UP_THERE = 2
"""What a limb is whose constraint was given up in what is kept, while the next is solved."""

STRAIGHT = 0.01
"""Part of its length that a limb has to spare from which on it bends as its place wants, rather than the trunk."""


@kernel
def next_edge(least, frame, tasks, activations):
    """The smallest activation above ``least`` of what is on its edge; 1 where there is none."""
    found = 1.0
    for c in range(tasks.shape[0]):
        if least < activations[c, frame] < found and tasks[c].blends:
            found = activations[c, frame]
    return found


@kernel
def keep_solution(first, problem):
    """Note a pose, to be blended with the next; what is missed by the ``first``."""
    tasks, search, pose = problem.tasks, problem.search, problem.pose
    copy_points(search.state, search.kept)
    note_turns(search.kept_turns, pose)
    for limb in range(4):
        search.blended[limb] = 0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if first:
            row.blended_miss = miss_of(c, problem) if row.status != INACTIVE else 0.0
        mark_blended(row, GIVEN_UP_THERE, search.blended)


@kernel
def note_turns(out_turns, pose):
    """Note the rotations of all limbs' segments in what carries each, (16, 3, 3), four a limb."""
    for limb in range(4):
        before, upper, _ = limb_parts(limb, pose.positions.shape[0] - 23)
        for bone in range(3 if limb < 2 else 4):
            put_turn(turn_between(pose.rotations[before], pose.rotations[upper + bone]), out_turns[4 * limb + bone])
            before = upper + bone


@kernel
def mark_blended(row, how, out_blended):
    """A limb whose constraint is given up, or on its edge, is not to be solved anew from the motion."""
    if row.status > ACTIVE and not moves_mass(row):
        for end in range(2):
            if row.limbs[end] >= 0 and row.freedoms[end, 0] > 0.0:
                out_blended[row.limbs[end]] = how


@kernel
def note_blended(part, problem):
    """Note the pose just solved, and what is missed where that which is kept counts ``part``."""
    tasks, search, pose = problem.tasks, problem.search, problem.pose
    copy_points(search.state, search.before)
    note_turns(search.solved_turns, pose)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        now = miss_of(c, problem) if row.status != INACTIVE else 0.0
        row.miss_change = abs(row.blended_miss - now)
        row.blended_miss = part * row.blended_miss + (1.0 - part) * now


@kernel
def blend_kept(part, search):
    """Blend state and limbs of what is kept, which counts ``part``, into those of what was just solved."""
    blend_points(part, search.before, search.kept, search.state)
    for limb in range(4):
        blend_limb(part, limb, search)


@kernel
def blend_limb(part, limb, search):
    """``blend_kept`` of one limb alone."""
    for bone in range(4 * limb, 4 * limb + (3 if limb < 2 else 4)):
        solved, kept = turn_in(search.solved_turns[bone]), turn_in(search.kept_turns[bone])
        put_turn(ease_turn(solved, kept, part), search.blended_turns[bone])


@kernel
def pose_between(part, frame, activations, problem):
    """Pose the body ``part`` of the way from what was just solved to what was kept; what both have is held.

    Where that cannot be held in between, the body is as the nearer of both has it.
    """
    search = problem.search
    note_blended(part, problem)
    blend_kept(part, search)
    pose_kept(frame, activations, problem)
    if loses(problem):
        blend_kept(1.0 if part >= 0.5 else 0.0, search)
        for limb in range(4):
            search.blended[limb] = BLENDED
        carry_body(problem)
        for limb in range(4):
            search.blended[limb] = 0


@kernel
def loses(problem):
    """Whether anything that was to be held is missed by more than what is blended."""
    tasks = problem.tasks
    lost = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        may = STRICT + (row.blended_miss if row.pinned == FREE else row.miss_change)
        lost = lost or (row.status == ACTIVE and miss_of(c, problem) > may)
    return lost


@kernel
def note_misses(frame, problem, out_residuals):
    """By how much each constraint is missed at one frame."""
    tasks = problem.tasks
    for c in range(tasks.shape[0]):
        out_residuals[c, frame] = math.nan
        if tasks[c].status == ON_EDGE:
            out_residuals[c, frame] = tasks[c].blended_miss
        elif tasks[c].status != INACTIVE:
            out_residuals[c, frame] = miss_of(c, problem)


@kernel
def pose_kept(frame, activations, problem):
    """Pose the body as state and limbs were kept, and give what was ``blended`` with little missing what it asks.

    What has a goal of its own is pinned to where it misses what is ``blended`` of both poses: so it stays as far off
    whatever acts below it.
    """
    tasks, chain, search = problem.tasks, problem.chain, problem.search
    level = chain.mobilities.shape[0] - tasks.shape[0]
    blended = search.blended
    for c in range(tasks.shape[0]):
        row = tasks[c]
        on_edge = row.status == INACTIVE and 0.0 < activations[c, frame] < 1.0
        both = row.miss_change < math.inf  # else it is eased, and there is no other pose
        missed = max(row.blended_miss, row.miss_change if both else 0.0) * (TURN_ARM if turns_segment(row) else 1.0)
        if on_edge or (row.status == ACTIVE and row.pinned == FREE and missed > MISSED):
            row.status = ON_EDGE
        mark_blended(row, BLENDED, blended)
        if both and row.status != INACTIVE and not on_edge and has_own_goal(row):
            row.status, row.pinned = ACTIVE, PINNED
    for limb in range(4):
        blended[limb] = BLENDED if blended[limb] else 0
    carry_body(problem)
    note_kept(0, level, problem)
    for c in range(tasks.shape[0]):
        if tasks[c].status == ACTIVE:
            note_held(tasks[c], problem)
    place_limbs(level, problem)
    mend_kept(level, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        missed = row.pinned == FREE and row.blended_miss > KEPT
        if row.status == ACTIVE and missed and row.limbs[0] >= 0 and blended[row.limbs[0]]:
            row.status = ON_EDGE  # its place was where the blend has it, and not where it wants to be
    for limb in range(4):
        blended[limb] = 0


@kernel
def mend_kept(level, problem):
    """Give what was blended with little missing what it asks; where steps lead away from that, none is taken."""
    search = problem.search
    copy_points(search.state, search.tried)
    missed = disturbance(level, False, problem)
    if mend(level, CLOSE_ENOUGH, False, problem) > missed:
        copy_points(search.tried, search.state)
        carry_body(problem)
        place_limbs(level, problem)


@kernel
def note_held(row, problem):
    """What both poses have keeps what it asks, or as much of it as they brought."""
    search, pose = problem.search, problem.pose
    blended = search.blended
    pinned = row.pinned != FREE and has_own_goal(row)
    row.kept_miss, left = (0.0, row.blended_miss) if pinned else (row.blended_miss, 0.0)
    part = min(max(1.1 * (1.0 - row.kept_miss * (TURN_ARM if turns_segment(row) else 1.0) / MISSED), 0.0), 1.0)
    if turns_segment(row):
        now = pose.rotations[row.segments[0]]
        part *= 1.0 - left / max(length(turn_error(row.turn, now)), left, 1e-9)
        put_turn(ease_turn(turn_in(now), turn_in(row.turn), part), row.kept_turn)
        if pinned or (row.limbs[0] >= 0 and blended[row.limbs[0]]):
            copy_matrix(row.kept_turn, row.turn)
        return
    for end in range(2):
        wanted = row.places[1 if moves_mass(row) else end]
        way = length_along(between(row.kept_places[end], wanted), row.axes if moves_mass(row) else 3)
        more = part * (1.0 - left / max(way, 1e-9))
        copy_point(ease_goal(row.kept_places[end], wanted, more), row.kept_places[end])
        if asks_place(row) and row.limbs[end] >= 0 and blended[row.limbs[end]]:
            copy_point(row.kept_places[end], row.places[end])
            row.comforts[end], row.easings[end] = 1.0, 0.0
            if row.longest[end] > 0.0:  # a shoulder has no limb before it
                note_stretch(row, end, row.limbs[end] >= 2 or search.ends[row.limbs[end]] >= 0, pose)
    if pinned:
        copy_point(row.kept_places[0], row.places[0])
        copy_point(row.kept_places[0], row.places[1])


@kernel
def note_stretch(row, end, holds_end, pose):
    """How far a limb that was blended is to stretch for its place: the straighter it is, the less it does.

    With d of its length to spare as it was blended, and w for its place, it keeps d s(w) / s(d) (``softly``); what that
    is beside w is for the trunk (METHOD (31)).
    """
    root, longest = limb_parts(row.limbs[end], pose.positions.shape[0] - 23)[2], row.longest[end]
    point, goal = bent_point(row, end, row.places[end], holds_end, pose)
    shoulder, edge = pose.positions[root], STRAIGHT * longest
    span, spare = distance(goal, shoulder), max(longest - distance(point, shoulder), 0.0)
    row.reaches[end] = longest - spare * softly(longest - span, edge) / softly(spare, edge)
    row.folds[end] = row.reaches[end]


@kernel
def softly(value, edge):
    """``value`` where it is well above ``edge``, and ever less but never 0 below."""
    return 0.5 * (value + math.sqrt(value * value + 4.0 * edge * edge))
