"""The constraints of one limb: the first exactly, the second by what freedom it leaves (K05 figure 11).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.turns import inverse, product, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point, distance
from studio.core.kernels.body.parts import turn_part
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb import soft_reach
from studio.core.kernels.limbs.reach import aim_at, bend_range, reach_to, span_range, swivel_to, swivel_way
from studio.core.kernels.limbs.stiffness import stiff_span, turn_back
from studio.core.kernels.limits.joint_limits import (
    braked_swivel,
    is_well_within,
    keep_joint,
    keep_middle,
    lift_end,
    limb_parts,
    put_end,
    soft,
)
from studio.core.kernels.limits.swing_twist import bend_of
from studio.core.kernels.limits.within_limits import NEARLY, step_within
from studio.core.kernels.tasks.goals import AREA, POSITION, end_place, turns_segment
from studio.core.kernels.tasks.task import ACTIVE, STRICT

CLOSE_ENOUGH = 0.25 * STRICT
"""Metres (or radians) of error that are left as they are."""
STEPS_WITHIN, LATE_WITHIN = 6, 3
"""Steps that a limb takes along its limits towards what it misses, at most, and those that it may add where little is
missed: whole up to ``NEARLY``, none from twice that on.
"""
STILL_WITHIN = 1e-4
"""Radians of such a step after which no other follows."""
HUNG = 1
"""What ``hung`` of a search is where a limb stays as ``kernels.time.activation_blend`` keeps it."""


@kernel
def limb_indices(limb, spine_count):
    """(root point, upper segment) of a limb: shoulder and upper arm, hip and thigh."""
    _, upper, root = limb_parts(limb, spine_count)
    return root, upper


@kernel
def note_ends(level, tasks, spine_count, out_ends):
    """Which constraint down to ``level`` holds the orientation of each limb's end segment, (4,), -1 for none.

    The limbs, as bits, of which another does than before.
    """
    changed = 0
    for limb in range(4):
        grip, end = -1, limb_indices(limb, spine_count)[1] + 2
        for c in range(tasks.shape[0]):
            row = tasks[c]
            holds = turns_segment(row) and row.status == ACTIVE and row.rank <= level and row.segments[0] == end
            if holds and grip < 0:
                grip = c
        changed |= (grip != out_ends[limb]) << limb
        out_ends[limb] = grip
    return changed


@kernel
def note_seconds(tasks):
    """Which places are wanted of a limb that has to bring another point to its place first.

    They take what swivel that leaves (K05 figures 11 and 13); nothing else moves for them.
    """
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.second = 0
        for before in range(c):
            other = tasks[before]
            if row.kind == POSITION and other.kind == POSITION and other.status == ACTIVE and row.limbs[0] >= 0:
                row.second |= other.limbs[0] == row.limbs[0] and other.freedoms[0, 0] > 0.0


@kernel
def range_of(limb, segment, holds_end, point, limits, pose):
    """(least, greatest) distance in metres of ``point`` from the root of its limb; of the end joint if that is held.

    And what it is now. With ``limits``, elbow or knee bends no further than they, or ``pose``, the unsolved one, allow.
    """
    positions, rotations = pose
    root, upper = limb_indices(limb, positions.shape[0] - 23)
    if segment == upper:
        span = distance(point, positions[root])
        return span, span, span
    hinge = rotations[upper, :, 0]
    if holds_end and segment >= upper + 2:
        tip = positions[root + 2]
    else:
        tip = point
    own = distance(tip, positions[root])
    if limits.shape[0] == 0:
        fold, reach = span_range(positions[root], positions[root + 1], hinge, tip)
        return fold, reach, own
    c0, c1, angle = bend_range(positions[root], positions[root + 1], hinge, tip)
    bend, bends = bend_of(rotations[upper], rotations[upper + 1])[0], limits[limb].bends
    side = -1.0 if -0.85 * math.pi < angle < 0.0 else 1.0
    angle = abs(angle) if angle > -0.85 * math.pi else angle + 2.0 * math.pi
    first, last = angle + side * min(bend - bends[1], 0.0), angle + side * max(bend - bends[0], 0.0)
    least, most = max(min(first, last), 0.0), min(max(first, last), math.pi)
    fold, reach = c0 - 2.0 * c1 * math.cos(least), c0 - 2.0 * c1 * math.cos(most)
    return math.sqrt(max(0.0, fold)), math.sqrt(max(0.0, reach)), own


@kernel
def solve_limb(limb, level, problem):
    """All constraints of one limb down to ``level``, in order, within its ``limits``.

    One that ``kernels.time.activation_blend`` keeps has come within them already, and only bends and aims from where
    it is.
    """
    tasks, limits, state = problem.tasks, problem.body.limits, problem.search.limbs[limb]
    begin_limb(limb, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.status != ACTIVE or row.rank > level or (row.kind == AREA and not row.engaged):
            continue
        if turns_segment(row):
            if row.limbs[0] == limb:
                turn_limb(row, limb, limits, state, problem.pose)
            continue
        for end in range(2):
            if row.limbs[end] == limb and (row.freedoms[end, 0] > 0.0 or row.freedoms[end, 1] != 0.0):
                grant_wish(c, end, problem)
    if state.bound:
        keep_within(limb, problem)
        limits[limb].acts *= (state.first + 1) * (state.swivels or state.aims_upper)
        limits[limb].fresh = 0


@kernel
def begin_limb(limb, problem):
    """Before any of its constraints: hand or foot as one asks, and nothing reached."""
    tasks, search, limits, state = problem.tasks, problem.search, problem.body.limits, problem.search.limbs[limb]
    root, upper = limb_indices(limb, problem.pose.positions.shape[0] - 23)
    turns_end = search.ends[limb] >= 0 and tasks[search.ends[limb]].status == ACTIVE
    state.bound = limits.shape[0] > 0 and search.hung[limb] != HUNG
    state.turns_end, state.holds_end = turns_end, limb >= 2 or turns_end
    state.wishes, state.first, state.end = 0, 0, 0
    state.aims_upper, state.swivels, state.turns_lower = 0, 0, 0
    if limits.shape[0] > 0:
        limits[limb].acts, limits[limb].tip_turns = 0, state.holds_end
    if turns_end:
        turn_segment(tasks[search.ends[limb]].turn, upper + 2, root + 2, problem.pose)


@kernel
def grant_wish(c, end, problem):
    """Bring one end of a constraint where it is to be: the first by all of its limb, the second by what swivel that
    leaves, and a hand or foot by its own joint.
    """
    tasks, search, pose, limits = problem.tasks, problem.search, problem.pose, problem.body.limits
    row, first, point = tasks[c], search.points[2], search.points[3]
    limb, segment, free = row.limbs[end], row.segments[end], row.freedoms[end, 0] > 0.0
    state = search.limbs[limb]
    root, upper = limb_indices(limb, pose.positions.shape[0] - 23)
    end_place(row, end, pose, point)
    if row.stiff:
        copy_matrix(pose.rotations[upper + 1 if state.aims_upper else upper], search.turns[5])
    if free and state.wishes == 0:
        state.aims_upper, state.swivels = segment == upper, segment != upper and not row.stiff
        state.first, state.end = c, end
        reach_with_limb(row, end, problem)
    elif free and state.wishes == 1:
        if state.bound:
            keep_within(limb, problem)
            end_place(tasks[state.first], state.end, pose, first)
        swivel_with_limb(row, end, problem)
        state.turns_lower = state.turns_lower or (state.bound and state.aims_upper)
    end_place(row, end, pose, point)
    if row.freedoms[end, 1] > 0.0 and segment > upper + 1 and not state.turns_end:
        aim_end(row.freedoms[end, 1], row.places[end], point, root + 2, upper + 2, search.points[4], pose)
        if limits.shape[0] > 0:
            limits[limb].tip_turns = 1
    if state.wishes == 0:
        end_place(row, end, pose, first)
    state.wishes += 1


@kernel
def turn_limb(row, limb, limits, state, pose):
    """Turn upper or lower segment of a limb as wanted; a lower one by both, within limits, where it comes first."""
    root, upper = limb_indices(limb, pose.positions.shape[0] - 23)
    segment = row.segments[0]
    if segment >= upper + 2:
        return
    turn_segment(row.turn, segment, root + segment - upper, pose)
    if state.bound and state.wishes == 0 and segment == upper + 1:
        keep_middle(limb, limits, pose)
        turn = product(turn_in(row.turn), inverse(turn_in(pose.rotations[segment])))
        turn_part(turn, upper, pose.positions.shape[0] - 23, pose.positions[root], pose.positions, pose.rotations)
    state.wishes += 2
    state.swivels = 0
    state.turns_lower = state.turns_lower or (segment == upper + 1 and state.wishes > 2)


@kernel
def turn_segment(wanted, segment, pivot, pose):
    """Turn a segment of a limb about its point ``pivot`` to the rotation ``wanted`` (3, 3)."""
    turn = product(turn_in(wanted), inverse(turn_in(pose.rotations[segment])))
    turn_part(turn, segment, pose.positions.shape[0] - 23, pose.positions[pivot], pose.positions, pose.rotations)


@kernel
def swivel_with_limb(row, end, problem):
    """A limb's second wish, by what its first, whose point is ``points[2]``, leaves: a swivel about that, within limits
    where these bound it, and the lower segment where the first holds but the upper one.

    What keeps its orientation in the world keeps it here as well.
    """
    pose, points, turns, limits = problem.pose, problem.search.points, problem.search.turns, problem.body.limits
    positions, rotations = pose
    limb, segment, state = row.limbs[end], row.segments[end], problem.search.limbs[row.limbs[end]]
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(limb, spine_count)
    tip, first, point, goal = root + 2, points[2], points[3], points[4]
    by_tip = state.holds_end and segment >= upper + 2
    end_place(row, end, pose, point)
    copy_point(row.places[end], goal)
    if by_tip:
        for axis in range(3):
            goal[axis] -= point[axis] - positions[tip, axis]
        copy_point(positions[tip], point)
    if state.holds_end:
        lift_end(limb, tip, upper + 2, turns, points, pose)
    if state.bound:
        swivel_within_to(limb, goal, point, first, limits, pose)
    elif not state.aims_upper:
        swivel_to(goal, point, first, upper, spine_count, positions[root], positions, rotations)
    if state.aims_upper:
        if by_tip:
            copy_point(positions[tip], point)
        else:
            end_place(row, end, pose, point)
        aim_at(goal, point, upper + 1, spine_count, positions[root + 1], positions, rotations)
    if row.stiff:
        joint = 1 if state.aims_upper else 0
        part = row.parts[end, joint]
        turn_back(part, math.inf, upper + joint, root + joint, turns[5], turns[0], points[0], pose)
    if state.holds_end:
        put_end(limb, tip, upper + 2, turns, points, pose)


@kernel
def swivel_within_to(limb, target, point, held, limits, pose):
    """``swivel_to`` as far as the limits of the limb let it."""
    positions, rotations = pose
    carrier, upper, root = limb_parts(limb, positions.shape[0] - 23)
    (x, y, z), sine, cosine = swivel_way(target, point, held, positions[root])
    wish = math.atan2(sine, cosine)
    angle = braked_swivel(limits[limb], rotations[carrier], rotations[upper], x, y, z, wish)
    turn = turn_by(angle * x, angle * y, angle * z)
    turn_part(turn, upper, positions.shape[0] - 23, positions[root], positions, rotations)


@kernel
def keep_within(limb, problem):
    """Bring a limb back within its limits where its constraints have put it beyond (METHOD 6, (28)).

    Where its first wish leaves it a swivel, it goes on from there along its limits to where that is missed least.
    Helped by joints beside it, it goes by the limits that the first placing found.
    """
    state, limits = problem.search.limbs[limb], problem.body.limits
    rotations, limit = problem.pose.rotations, limits[limb]
    tip_stays = not limit.tip_turns or is_well_within(limb, 1, limits, rotations)
    if not state.turns_lower and tip_stays and is_well_within(limb, 0, limits, rotations):
        return
    limit.sure = 1.0
    for joint in range(2):
        copy_point(limit.agreed[joint], limit.caps[joint])
    helped = (state.swivels or state.aims_upper) and problem.tasks[state.first].helped
    drawn = draw_back(limb, True, limit.fresh or not helped, problem)
    if helped and limit.fresh:  # whatever comes after goes by them, and so does the next placing
        for joint in range(2):
            copy_point(limit.caps[joint], limit.agreed[joint])
        limit.fresh = 0
    if drawn and state.swivels:
        go_along_limits(limb, problem)


@kernel
def go_along_limits(limb, problem):
    """Steps of a limb that lies at its limits, within them, to where its first wish is missed least (METHOD (28))."""
    pose, points, turns, state = problem.pose, problem.search.points, problem.search.turns, problem.search.limbs[limb]
    limit, row, end = problem.body.limits[limb], problem.tasks[state.first], state.end
    parts = limb_parts(limb, pose.positions.shape[0] - 23)
    upper, root = parts[1], parts[2]
    point, goal, tip = points[3], row.places[end], pose.positions[root + 2]
    by_tip = state.holds_end and row.segments[end] >= upper + 2
    end_place(row, end, pose, point)
    wish = (
        point[0] + limit.sure * (goal[0] - point[0]),
        point[1] + limit.sure * (goal[1] - point[1]),
        point[2] + limit.sure * (goal[2] - point[2]),
    )
    for attempt in range(STEPS_WITHIN + (LATE_WITHIN if row.helped else 0)):
        left = distance(goal, point) if attempt >= STEPS_WITHIN else 0.0
        part = min((2.0 * NEARLY - left) / NEARLY, 1.0)
        if part <= 0.0:
            return
        x, y, z = wish[0], wish[1], wish[2]
        if by_tip:
            x, y, z = x + tip[0] - point[0], y + tip[1] - point[1], z + tip[2] - point[2]
            copy_point(tip, point)
        shoulder = pose.positions[root]
        far = math.sqrt((x - shoulder[0]) ** 2 + (y - shoulder[1]) ** 2 + (z - shoulder[2]) ** 2)
        now = distance(point, shoulder)
        spans = min(row.easings[end], now), max(comfortable(row, end, far), now)
        if state.holds_end:
            lift_end(limb, root + 2, upper + 2, turns, points, pose)
        size = step_within(part, limit, parts, point, (x, y, z), spans, pose)
        if state.holds_end:
            put_end(limb, root + 2, upper + 2, turns, points, pose)
        draw_back(limb, False, False, problem)
        if size < STILL_WITHIN:
            return
        end_place(row, end, pose, point)


@kernel
def draw_back(limb, anew, noting, problem):
    """Draw all joints of a limb back within their limits (``keep_joint``); whether any was."""
    pose, points, turns, limits = problem.pose, problem.search.points, problem.search.turns, problem.body.limits
    state = problem.search.limbs[limb]
    root, upper = limb_indices(limb, pose.positions.shape[0] - 23)
    drawn = False
    if anew or not is_well_within(limb, 0, limits, pose.rotations):
        if state.holds_end:
            lift_end(limb, root + 2, upper + 2, turns, points, pose)
        drawn = keep_joint(limb, 0, anew, noting, limits, pose)
        if anew and state.turns_lower:
            drawn = keep_middle(limb, limits, pose) or drawn
        if state.holds_end:
            put_end(limb, root + 2, upper + 2, turns, points, pose)
    if limits[limb].tip_turns and (anew or not is_well_within(limb, 1, limits, pose.rotations)):
        drawn = keep_joint(limb, 1, anew, noting, limits, pose) or drawn
    return drawn


@kernel
def reach_with_limb(row, end, problem):
    """Bend and aim one limb so that its point meets the target, or comes as near as it can, or as far as
    ``kernels.time.activation_blend`` lets it stretch.

    A foot, or a hand whose orientation is held, keeps its orientation in the world; else it goes with the limb.
    ``points[3]`` is the point as it was.
    """
    pose, points, turns, limits = problem.pose, problem.search.points, problem.search.turns, problem.body.limits
    positions, rotations = pose
    limb, segment, holds_end = row.limbs[end], row.segments[end], problem.search.limbs[row.limbs[end]].holds_end
    kept = problem.search.hung[limb] == HUNG and row.kind == POSITION
    spine_count = positions.shape[0] - 23
    root, upper = limb_indices(limb, spine_count)
    tip, point, goal = root + 2, points[3], points[4]
    copy_point(row.places[end], goal)
    if holds_end:
        lift_end(limb, tip, upper + 2, turns, points, pose)
        if segment >= upper + 2:
            for axis in range(3):
                goal[axis] -= point[axis] - positions[tip, axis]
            copy_point(positions[tip], point)
    if segment != upper:
        span = distance(goal, positions[root])
        span = row.reaches[end] if kept else comfortable(row, end, span)
        if limits.shape[0] > 0 and span < row.easings[end]:
            span = -soft(-span, -math.inf, -row.easings[end], -row.folds[end])
            limits[limb].acts = 1
        if row.stiff:
            span = stiff_span(row, end, distance(point, positions[root]), span)
        reach_to(goal, span, upper, root, point, positions, rotations)
    else:
        aim_at(goal, point, upper, spine_count, positions[root], positions, rotations)
    if row.stiff:
        row.change[end, 0] = turn_back(1.0, row.most[end, 0], upper, root, turns[5], turns[0], points[0], pose)
    if holds_end:
        put_end(limb, tip, upper + 2, turns, points, pose)


@kernel
def comfortable(row, end, span):
    """How far a limb stretches for a place ``span`` metres from its root: as far as agreed, or softly if alone.

    METHOD (11).
    """
    if row.helped:
        return min(span, row.reaches[end])
    longest = row.longest[end]
    return longest * soft_reach(span / longest, row.comforts[end]) if longest > 0.0 else span


@kernel
def aim_end(weight, target, point, joint, end, goal, pose):
    """Turn hand or foot about its joint so that its point faces the target, ``weight`` times the whole way."""
    if distance(point, target) < CLOSE_ENOUGH:
        return
    positions, rotations = pose
    for axis in range(3):
        goal[axis] = point[axis] + weight * (target[axis] - point[axis])
    aim_at(goal, point, end, positions.shape[0] - 23, positions[joint], positions, rotations)
