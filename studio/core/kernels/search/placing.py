"""Limbs put where their constraints want them, and how well each constraint holds then (METHOD 6).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.turns import (
    inverse,
    product,
    put_beside,
    put_turn,
    rotation_vector,
    shortest,
    turn_by,
    turn_in,
    turn_of_gibbs,
)
from studio.core.kernels.algebra.vectors import between, copy_matrix, copy_point, distance, length, length_along
from studio.core.kernels.body.parts import limb_parts, turn_part
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.legs import place_leg, place_leg_points
from studio.core.kernels.limbs.limb_tasks import BLENDED, CLOSE_ENOUGH, solve_limb
from studio.core.kernels.limbs.stiffness import carry_leg
from studio.core.kernels.limits.joint_limits import is_well_within, keep_joint
from studio.core.kernels.records import Problem
from studio.core.kernels.search.joints import carry_arm, carry_point, carry_trunk, pose_limb
from studio.core.kernels.tasks.areas import COSINE, SINE, nearest_allowed, put_area
from studio.core.kernels.tasks.balance import centre_of_mass
from studio.core.kernels.tasks.goals import (
    AREA,
    BALANCE,
    DISTANCE,
    LOOK_AT,
    ORIENTATION,
    POSITION,
    UPRIGHT,
    counts,
    ease_goal,
    end_place,
    gaze_goal,
    part_to,
    second_place,
    turns_segment,
)
from studio.core.kernels.tasks.task import ACTIVE, FREE, PINNED_TURN
from studio.core.kernels.tasks.upright import follow_upright, miss_upright

ENGAGED = 1e-6
"""Metres into a forbidden area from which on a point counts as in it."""
OUTLINED = 2
"""What an idle limb becomes once its points alone were put where they are to be."""
AGAIN = 3
"""Times that limbs are placed once more because a point entered an area or a distance was not shared well."""


@small_kernel
def posed(problem, pose):
    """The same problem with another pose."""
    return Problem(problem.tasks, problem.areas, problem.chain, problem.body, problem.search, problem.start, pose)


@kernel
def carry_body(problem):
    """The whole body where the joints' state carries it: trunk in one pass, arms in their clavicles, legs on ankles."""
    chain, search, start, pose = problem.chain, problem.search, problem.start, problem.pose
    carry_trunk(search.state, chain.slots, start, search.carried, pose)
    for limb in range(4):
        put_back(limb, problem)


@kernel
def put_back(limb, problem):
    """One limb as the unsolved pose has it: arms in their clavicles, legs on their ankles. An idle one in outline."""
    chain, body, search, start, pose = problem.chain, problem.body, problem.search, problem.start, problem.pose
    slots, turned = chain.slots, search.state
    if search.idle[limb]:
        search.idle[limb] = OUTLINED
        put_outline(limb, problem)
        return
    if search.blended[limb] == BLENDED:
        carrier, upper, root = limb_parts(limb, pose.positions.shape[0] - 23)
        pose_limb(carrier, upper, root, 4 * limb, search.blended_turns, start, pose)
        return
    if limb < 2:
        carry_arm(limb, turned, slots, start, search.carried, pose)
        keep_recruited(limb, turned, slots, body.limits, pose)
        return
    positions, rotations = pose
    side = limb - 2
    spine_count = positions.shape[0] - 23
    thigh = spine_count + 10 + 4 * side
    joint = slots[thigh]
    if slots[slots.shape[0] - 1] < 0 and slots[0] < 0 and joint < 0:
        copy_leg(side, start, pose)
        return
    place_leg(side, body.measures, body.legs, pose)
    if joint < 0:
        return
    x, y, z = turned[joint, 0], turned[joint, 1], turned[joint, 2]
    if x != 0.0 or y != 0.0 or z != 0.0:
        hip = positions[spine_count + 13 + 5 * side]
        turn_part(turn_of_gibbs(x, y, z), thigh, spine_count, hip, positions, rotations)
    keep_recruited(limb, turned, slots, body.limits, pose)


@kernel
def put_outline(limb, problem):
    """The points alone of a limb that nothing but the centre of mass is asked of."""
    body, start, pose, carried = problem.body, problem.start, problem.pose, problem.search.carried
    spine_count = pose.positions.shape[0] - 23
    if limb < 2:
        shoulder, turn = spine_count + 4 + 5 * limb, turn_in(carried[spine_count + 2 + 4 * limb])
        for bone in range(1, 4):
            carry_point(shoulder + bone, shoulder, turn, start, pose.positions)
        return
    place_leg_points(limb - 2, body.measures, body.legs, start.positions, pose)


@kernel
def note_idle(tasks, slots, spine_count, out_idle):
    """Which limbs no constraint names and no search turns (4,): their rotations can wait until all is solved.

    Legs on a root that stays are not worth it.
    """
    stays = slots[slots.shape[0] - 1] < 0 and slots[0] < 0
    for limb in range(4):
        _, upper, _ = limb_parts(limb, spine_count)
        out_idle[limb] = 1 if slots[upper] < 0 and (limb < 2 or not stays) else 0
    for c in range(tasks.shape[0]):
        for end in range(2):
            segment = tasks[c].segments[end]
            if tasks[c].points[end] >= 0 and segment >= spine_count + 2:
                out_idle[(segment - spine_count - 2) // 4] = 0


@kernel
def keep_recruited(limb, turned, slots, limits, pose):
    """A limb that a search has turned stays within its limits."""
    joint = slots[limb_parts(limb, pose.positions.shape[0] - 23)[1]]
    if limits.shape[0] == 0 or joint < 0:
        return
    moves = turned[joint, 0] != 0.0 or turned[joint, 1] != 0.0 or turned[joint, 2] != 0.0
    if moves and not is_well_within(limb, 0, limits, pose.rotations):
        keep_joint(limb, 0, True, True, limits, pose)


@kernel
def copy_leg(side, start, pose):
    """One leg as the motion has it, where nothing moves its hip."""
    spine_count = pose.positions.shape[0] - 23
    for bone in range(5):
        point = spine_count + 13 + 5 * side + bone
        copy_point(start.positions[point], pose.positions[point])
    for bone in range(4):
        segment = spine_count + 10 + 4 * side + bone
        copy_matrix(start.rotations[segment], pose.rotations[segment])


@kernel
def place_limbs(level, problem):
    """Every limb with a constraint down to ``level``, solved from where the body carries it.

    Once more where a point ends in an area that it may not be in, or a distance is not shared well.
    """
    tasks, search, start, pose = problem.tasks, problem.search, problem.start, problem.pose
    busy, stiff, moving = 0, 0, False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if counts(row) and row.rank <= level:
            follows = row.kind != DISTANCE and row.points[1] >= 0
            moving = moving or follows or (row.kind > ORIENTATION and row.kind != BALANCE)
            row.engaged = 0
            for end in range(2):
                if row.limbs[end] >= 0 and row.status == ACTIVE:
                    busy |= 1 << row.limbs[end]
                    stiff |= row.stiff << row.limbs[end]
    for attempt in range(1 + AGAIN):
        if moving:
            follow(level, False, problem)
        for limb in range(4):
            if busy >> limb & 1:
                if stiff >> limb & 1:
                    if attempt > 0:
                        put_back(limb, problem)
                    if limb >= 2:
                        carry_leg(limb - 2, start, search.carried, pose)
                solve_limb(limb, level, problem)
        if not moving:
            return
        follow(level, True, problem)
        if attempt == AGAIN:
            return
        if engage(level, problem):
            for limb in range(4):
                if busy >> limb & 1:
                    put_back(limb, problem)
        elif not falls_short(level, problem):
            return


@kernel
def follow(level, solved, problem):
    """Goals that depend on where things are now: both ends of distances, areas, the line of sight, what is followed on
    the own body (METHOD 5). Once limbs are ``solved``, those that depend on where the limbs have come to be.
    """
    tasks, areas, pose = problem.tasks, problem.areas, problem.pose
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not counts(row) or row.rank > level:
            continue
        if row.kind != DISTANCE and row.points[1] >= 0:
            follow_body(row, areas[c], pose, problem)
        if row.kind == DISTANCE and not solved:
            part_to(end_place(row, 0, pose), second_place(row, pose), row.distance, row.shares, row.places)
        elif row.kind == LOOK_AT and row.pinned != PINNED_TURN:
            now = turn_in(pose.rotations[row.segments[0]])
            x, y, z = gaze_goal(row.places[1], row.places[0], end_place(row, 0, pose), row.distance)
            put_turn(product(shortest(now[0], now[3], now[6], x, y, z), now), row.turn)
        elif row.kind == UPRIGHT:
            follow_upright(row, pose)
        elif row.kind == AREA and row.status == ACTIVE and not row.engaged and not solved:
            engage_one(c, problem)


@kernel
def follow_body(row, area, pose, problem):
    """Bring what a constraint asks to where the point or segment is now that it follows on its own body."""
    start, place, axes = problem.start, end_place(row, 1, pose), turn_in(pose.rotations[row.segments[1]])
    if row.kind == POSITION and row.pinned != FREE:
        put_beside(place, axes, row.relative[0, 0], row.relative[0, 1], row.relative[0, 2], row.places[0])
    elif row.kind == POSITION:
        copy_point(ease_goal(end_place(row, 0, start), place, row.share), row.places[0])
    elif row.kind == ORIENTATION:
        wanted = product(axes, turn_in(row.relative))
        put_turn(ease_turn(turn_in(start.rotations[row.segments[0]]), wanted, row.share), row.turn)
    elif row.kind == LOOK_AT:
        copy_point(place, row.places[0])
    elif row.kind == BALANCE:
        copy_point(ease_goal(row.begin, place, row.share), row.places[0])
        copy_point(row.places[0], row.places[1])
    else:
        turn = product(axes, turn_in(row.relative))
        c, s = turn[0] + turn[4], turn[3] - turn[1]
        size = max(math.sqrt(c * c + s * s), 1e-9)
        put_area(area, place, row.turn)
        cosine, sine = area[COSINE], area[SINE]
        area[COSINE], area[SINE] = (c * cosine - s * sine) / size, (s * cosine + c * sine) / size


@kernel
def falls_short(level, problem):
    """Whether a distance is missed because one of its limbs could not do its share: then the other does more.

    Or a limb does not hold to what it follows on its own body, which has moved with it.
    """
    tasks = problem.tasks
    short = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        follows = row.limbs[0] >= 0 and row.points[1] >= 0 and row.kind <= ORIENTATION
        if (row.kind == DISTANCE or follows) and row.status == ACTIVE and row.rank <= level:
            short = short or miss_of(c, problem) > CLOSE_ENOUGH
    return short


@kernel
def engage(level, problem):
    """Areas whose points are where they may not be after all else was solved; True when there are new ones."""
    tasks = problem.tasks
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.kind == AREA and row.status == ACTIVE and row.rank <= level and not row.engaged:
            found = engage_one(c, problem) or found
    return found


@kernel
def engage_one(c, problem):
    """Engage one area if its point is where it may not be: the goal is the nearest place where it may."""
    row = problem.tasks[c]
    point = end_place(row, 0, problem.pose)
    depth, place = nearest_allowed(problem.areas[c], point)
    if depth > ENGAGED:
        row.engaged = 1
        copy_point(ease_goal(point, place, row.distance), row.places[0])
        return True
    return False


@kernel
def miss_of(c, problem):
    """By how much a constraint is missed now: metres, or radians for an orientation or a look.

    An area by the nearest place where its point may be, which may be another than it was sent to.
    """
    row, pose = problem.tasks[c], problem.pose
    if row.kind == UPRIGHT:
        return miss_upright(row, pose)
    if turns_segment(row):
        return length(turn_error(row.turn, pose.rotations[row.segments[0]]))
    if row.kind == BALANCE:
        return length_along(between(row.places[0], centre_of_mass(problem.body.shares, pose.positions)), row.axes)
    point = end_place(row, 0, pose)
    if row.kind == DISTANCE:
        return abs(distance(point, second_place(row, pose)) - row.distance)
    if row.kind == AREA:
        return row.distance * nearest_allowed(problem.areas[c], point)[0]
    return distance(point, row.places[0])


@kernel
def ease_turn(begin, wanted, share):
    """The turn a ``share`` of the shortest way from one to another."""
    x, y, z = rotation_vector(product(wanted, inverse(begin)))
    return product(turn_by(share * x, share * y, share * z), begin)


@small_kernel
def turn_error(wanted, now):
    """Rotation vector (x, y, z), radians, that turns ``now`` to ``wanted``, both (3, 3)."""
    return rotation_vector(product(turn_in(wanted), inverse(turn_in(now))))
