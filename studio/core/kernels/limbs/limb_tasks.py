"""The tasks of one limb, in closed form: the primary one exactly, the secondary by what freedom it leaves (K05 figure
11).

The primary task of a limb, the first that brings a point of it anywhere, has its bend and its aim. The secondary one
has the swivel about the axis from the limb's root through the point of the primary, or, where that is the elbow or the
knee, the lower segment. Hand or foot turns as a task asks before both. Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.turns import inverse, product, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_point, distance
from studio.core.kernels.body.parts import lift_end, limb_parts, put_end, turn_part
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_limits import bent_point, comfortable, keep_within
from studio.core.kernels.limbs.reach import aim_at, bend_range, reach_to, span_range, swivel_to, swivel_way
from studio.core.kernels.limbs.stiffness import stiff_span, turn_back
from studio.core.kernels.limits.joint_limits import braked_swivel, keep_middle, soft
from studio.core.kernels.limits.swing_twist import bend_of
from studio.core.kernels.tasks.goals import asks_place, ease_goal, end_place, is_dormant, turns_segment
from studio.core.kernels.tasks.task import ACTIVE, STRICT

CLOSE_ENOUGH = 0.25 * STRICT
"""Metres (or radians) of error that are left as they are."""
BLENDED = 1
"""What ``blended`` of a search is where a limb stays as ``kernels.time.activation_blend`` keeps it."""


@kernel
def note_ends(level, tasks, spine_count, out_ends):
    """Which constraint down to ``level`` holds the orientation of each limb's end segment, (4,), -1 for none.

    The limbs, as bits, of which another does than before.
    """
    changed = 0
    for limb in range(4):
        grip, end = -1, limb_parts(limb, spine_count)[1] + 2
        for c in range(tasks.shape[0]):
            row = tasks[c]
            holds = turns_segment(row) and row.status == ACTIVE and row.rank <= level and row.segments[0] == end
            if holds and grip < 0:
                grip = c
        changed |= (grip != out_ends[limb]) << limb
        out_ends[limb] = grip
    return changed


@kernel
def note_secondary(tasks):
    """Which places are asked of a limb that has to bring another point to its place first.

    They take what swivel that leaves (K05 figures 11 and 13); nothing else moves for them.
    """
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.secondary = 0
        for before in range(c):
            other = tasks[before]
            if asks_place(row) and asks_place(other) and other.status == ACTIVE and row.limbs[0] >= 0:
                row.secondary |= other.limbs[0] == row.limbs[0] and other.freedoms[0, 0] > 0.0


@kernel
def range_of(limb, segment, holds_end, point, limits, pose):
    """(least, greatest) distance in metres of ``point`` from the root of its limb; of the end joint if that is held.

    And what it is now. With ``limits``, elbow or knee bends no further than they, or ``pose``, the unsolved one, allow.
    """
    positions, rotations = pose
    _, upper, root = limb_parts(limb, positions.shape[0] - 23)
    if segment == upper:
        span = distance(point, positions[root])
        return span, span, span
    hinge, wrist = rotations[upper, :, 0], positions[root + 2]
    tip = (wrist[0], wrist[1], wrist[2]) if holds_end and segment >= upper + 2 else point
    own = distance(tip, positions[root])
    if limits.shape[0] == 0:
        fold, reach = span_range(positions[root], positions[root + 1], hinge, tip)
        return fold, reach, own
    c0, c1, angle, side = bend_range(positions[root], positions[root + 1], hinge, tip)
    bend, bends = bend_of(rotations[upper], rotations[upper + 1])[0], limits[limb].bends
    first, last = angle + side * min(bend - bends[1], 0.0), angle + side * max(bend - bends[0], 0.0)
    least, most = max(min(first, last), 0.0), min(max(first, last), math.pi)
    fold, reach = c0 - 2.0 * c1 * math.cos(least), c0 - 2.0 * c1 * math.cos(most)
    return math.sqrt(max(0.0, fold)), math.sqrt(max(0.0, reach)), own


@kernel
def solve_limb(limb, level, problem):
    """All tasks of one limb down to ``level``, in order of priority, and then its joints within their limits.

    A limb that ``kernels.time.activation_blend`` keeps is within them already: it bends and aims from where it is.
    """
    tasks, limits, state = problem.tasks, problem.body.limits, problem.search.limbs[limb]
    begin_limb(limb, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status != ACTIVE or row.rank > level or is_dormant(row):
            continue
        if turns_segment(row):
            if row.limbs[0] == limb:
                turn_bone(row, limb, problem)
            continue
        for end in range(2):
            if row.limbs[end] == limb and (row.freedoms[end, 0] > 0.0 or row.freedoms[end, 1] != 0.0):
                bring_point(c, end, problem)
    if state.limited:
        keep_within(limb, problem)
        if limits[limb].acts and (state.swivels or state.aims_upper):
            limits[limb].blocks = state.primary
        limits[limb].fresh = 0


@kernel
def begin_limb(limb, problem):
    """Before any of its tasks: hand or foot as one asks, and all freedoms there."""
    tasks, search, limits, state = problem.tasks, problem.search, problem.body.limits, problem.search.limbs[limb]
    _, upper, root = limb_parts(limb, problem.pose.positions.shape[0] - 23)
    turns_end = search.ends[limb] >= 0 and tasks[search.ends[limb]].status == ACTIVE
    state.limited = limits.shape[0] > 0 and search.blended[limb] != BLENDED
    state.turns_end, state.holds_end = turns_end, limb >= 2 or turns_end
    state.taken, state.primary, state.primary_end = 0, 0, 0
    state.aims_upper, state.swivels, state.turns_lower = 0, 0, 0
    if limits.shape[0] > 0:
        limits[limb].acts, limits[limb].blocks, limits[limb].tip_turns = 0, -1, state.holds_end
    if turns_end:
        turn_segment(tasks[search.ends[limb]].turn, upper + 2, root + 2, problem.pose)


@kernel
def bring_point(c, end, problem):
    """Bring one end of a task where it is to be: the primary by bend and aim, the secondary by what these leave, and a
    hand or foot by its own joint.
    """
    tasks, pose, limits = problem.tasks, problem.pose, problem.body.limits
    row, segment, limb = tasks[c], tasks[c].segments[end], tasks[c].limbs[end]
    state, free = problem.search.limbs[limb], row.freedoms[end, 0] > 0.0
    _, upper, root = limb_parts(limb, pose.positions.shape[0] - 23)
    before = turn_in(pose.rotations[upper + 1 if state.aims_upper else upper])
    is_primary = state.taken == 0
    if free and is_primary:
        state.primary, state.primary_end = c, end
        state.aims_upper, state.swivels = segment == upper, segment != upper and not row.stiff
        reach_with_limb(row, end, before, problem)
    elif free and state.taken == 1:
        if state.limited:
            keep_within(limb, problem)
            copy_point(end_place(tasks[state.primary], state.primary_end, pose), state.primary_point)
        swivel_with_limb(row, end, before, problem)
        state.turns_lower = state.turns_lower or (state.limited and state.aims_upper)
    if row.freedoms[end, 1] > 0.0 and segment > upper + 1 and not state.turns_end:
        aim_end(row, end, root + 2, upper + 2, pose)
        if limits.shape[0] > 0:
            limits[limb].tip_turns = 1
    if is_primary:
        copy_point(end_place(row, end, pose), state.primary_point)
    state.taken += 1


@kernel
def turn_bone(row, limb, problem):
    """Turn upper or lower segment of a limb as asked; a lower one by both, within limits, where it comes first."""
    pose, limits, state = problem.pose, problem.body.limits, problem.search.limbs[limb]
    _, upper, root = limb_parts(limb, pose.positions.shape[0] - 23)
    segment = row.segments[0]
    if segment >= upper + 2:
        return
    turn_segment(row.turn, segment, root + segment - upper, pose)
    if state.limited and state.taken == 0 and segment == upper + 1:
        keep_middle(limb, limits, pose)
        turn = product(turn_in(row.turn), inverse(turn_in(pose.rotations[segment])))
        turn_part(turn, upper, pose.positions.shape[0] - 23, pose.positions[root], pose.positions, pose.rotations)
    state.taken += 2
    state.swivels = 0
    state.turns_lower = state.turns_lower or (segment == upper + 1 and state.taken > 2)


@kernel
def turn_segment(wanted, segment, pivot, pose):
    """Turn a segment of a limb about its point ``pivot`` to the rotation ``wanted`` (3, 3)."""
    turn = product(turn_in(wanted), inverse(turn_in(pose.rotations[segment])))
    turn_part(turn, segment, pose.positions.shape[0] - 23, pose.positions[pivot], pose.positions, pose.rotations)


@kernel
def reach_with_limb(row, end, before, problem):
    """A limb's primary task: bend and aim until its point meets the goal, or comes as near as it can, or as far as
    ``kernels.time.activation_blend`` lets it stretch. ``before`` is the upper segment's turn.

    A foot, or a hand whose orientation is held, keeps its orientation in the world; else it goes with the limb.
    """
    pose, limits, limb = problem.pose, problem.body.limits, row.limbs[end]
    positions, rotations, holds_end = pose.positions, pose.rotations, problem.search.limbs[limb].holds_end
    _, upper, root = limb_parts(limb, positions.shape[0] - 23)
    lifted = lift_end(limb, pose)
    point, goal = bent_point(row, end, row.places[end], holds_end, pose)
    if row.segments[end] == upper:
        aim_at(goal, point, upper, positions.shape[0] - 23, positions[root], positions, rotations)
    else:
        span = distance(goal, positions[root])
        is_kept = problem.search.blended[limb] == BLENDED and asks_place(row)
        span = row.reaches[end] if is_kept else comfortable(row, end, span)
        if limits.shape[0] > 0 and span < row.easings[end]:
            span = -soft(-span, -math.inf, -row.easings[end], -row.folds[end])
            limits[limb].acts = 1
        if row.stiff:
            span = stiff_span(row, end, distance(point, positions[root]), span)
        reach_to(goal, span, upper, root, point, positions, rotations)
    if row.stiff:
        row.change[end, 0] = turn_back(1.0, row.most[end, 0], upper, root, before, pose)
    if holds_end:
        put_end(limb, lifted, pose)


@kernel
def swivel_with_limb(row, end, before, problem):
    """A limb's secondary task: a swivel about the point of the primary, within limits where these bound it, and the
    lower segment, whose turn was ``before``, where the primary holds but the upper one.

    What keeps its orientation in the world keeps it here as well.
    """
    pose, limits, limb = problem.pose, problem.body.limits, row.limbs[end]
    positions, rotations, state = pose.positions, pose.rotations, problem.search.limbs[limb]
    spine_count = positions.shape[0] - 23
    _, upper, root = limb_parts(limb, spine_count)
    lifted = lift_end(limb, pose)
    point, goal = bent_point(row, end, row.places[end], state.holds_end, pose)
    if state.limited:
        swivel_within_to(limb, goal, point, state.primary_point, limits, pose)
    elif not state.aims_upper:
        swivel_to(goal, point, state.primary_point, upper, spine_count, positions[root], positions, rotations)
    if state.aims_upper:
        point, _ = bent_point(row, end, row.places[end], state.holds_end, pose)
        aim_at(goal, point, upper + 1, spine_count, positions[root + 1], positions, rotations)
    if row.stiff:
        joint = 1 if state.aims_upper else 0
        turn_back(row.parts[end, joint], math.inf, upper + joint, root + joint, before, pose)
    if state.holds_end:
        put_end(limb, lifted, pose)


@kernel
def swivel_within_to(limb, target, point, held, limits, pose):
    """``swivel_to`` as far as the limits of the limb let it."""
    positions, rotations = pose
    carrier, upper, root = limb_parts(limb, positions.shape[0] - 23)
    (x, y, z), sine, cosine = swivel_way(target, point, held, positions[root])
    asked = math.atan2(sine, cosine)
    angle = braked_swivel(limits[limb], rotations[carrier], rotations[upper], x, y, z, asked)
    turn = turn_by(angle * x, angle * y, angle * z)
    turn_part(turn, upper, positions.shape[0] - 23, positions[root], positions, rotations)


@kernel
def aim_end(row, end, joint, segment, pose):
    """Turn hand or foot about its ``joint`` so that its point faces the goal, as far as the chain frees that."""
    positions, rotations, weight = pose.positions, pose.rotations, row.freedoms[end, 1]
    point, target = end_place(row, end, pose), row.places[end]
    if distance(point, target) < CLOSE_ENOUGH:
        return
    goal = ease_goal(point, target, weight)
    aim_at(goal, point, segment, positions.shape[0] - 23, positions[joint], positions, rotations)
