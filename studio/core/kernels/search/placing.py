"""Limbs put where their constraints want them, and how well each constraint holds then (METHOD 6).

Records are those of ``kernels.records``.
"""

from studio.core.kernels.algebra.turns import (
    turn_in,
    turn_of_gibbs,
)
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.body.parts import limb_parts, turn_part
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.legs import place_leg, place_leg_points
from studio.core.kernels.limbs.limb_tasks import BLENDED, CLOSE_ENOUGH, solve_limb
from studio.core.kernels.limbs.stiffness import carry_leg
from studio.core.kernels.limits.joint_limits import is_well_within, keep_joint
from studio.core.kernels.records import Problem
from studio.core.kernels.search.joints import carry_arm, carry_point, carry_trunk, pose_limb
from studio.core.kernels.tasks.areas import engage_area
from studio.core.kernels.tasks.goals import (
    asks_length,
    counts,
    has_own_goal,
    is_dormant,
    limb_follows,
)
from studio.core.kernels.tasks.kinds import follow, miss_of
from studio.core.kernels.tasks.task import ACTIVE

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
            moving = moving or not has_own_goal(row)
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
def falls_short(level, problem):
    """Whether a distance is missed because one of its limbs could not do its share: then the other does more.

    Or a limb does not hold to what it follows on its own body, which has moved with it.
    """
    tasks = problem.tasks
    short = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if (asks_length(row) or limb_follows(row)) and row.status == ACTIVE and row.rank <= level:
            short = short or miss_of(c, problem) > CLOSE_ENOUGH
    return short


@kernel
def engage(level, problem):
    """Areas whose points are where they may not be after all else was solved; True when there are new ones."""
    tasks = problem.tasks
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if is_dormant(row) and row.status == ACTIVE and row.rank <= level:
            found = engage_area(row, problem.areas[c], problem.pose) or found
    return found
