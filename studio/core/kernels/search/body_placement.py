"""Poses of the whole body from the joints' state, and limbs solved on it (METHOD 9).

Records are those of ``kernels.records``.
"""

from studio.core.kernels.algebra.rotation_tuples import (
    rotation_from_gibbs,
    rotation_from_matrix,
)
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.body.parts import limb_parts, rotate_part
from studio.core.kernels.body_indices import (
    CLAVICLE_SEGMENT,
    HIP_POINT,
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    THIGH_SEGMENT,
)
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.legs import place_leg, place_leg_points
from studio.core.kernels.limbs.limb_tasks import BLENDED_POSE_KEPT, NEGLIGIBLE_ERROR, solve_limb
from studio.core.kernels.limbs.limbs_above_ground import GROUND_MARGIN_METRES, end_rise, middle_rise, raise_limb
from studio.core.kernels.limbs.stiffness import move_stiff_leg
from studio.core.kernels.limbs.touching_arms import follow_contacts, follows_contact
from studio.core.kernels.limits.limb_joint_limits import clamp_joint, is_well_within
from studio.core.kernels.records import FrameProblem
from studio.core.kernels.search.joints import pose_arm, pose_limb, pose_point, pose_trunk
from studio.core.kernels.tasks.area_shapes import activate_area
from studio.core.kernels.tasks.goals import (
    has_own_goal,
    has_residual,
    is_distance,
    is_dormant,
    limb_follows,
)
from studio.core.kernels.tasks.task_kinds import residual_of, update_goals
from studio.core.kernels.tasks.task_status import ACTIVE

ONLY_POINTS_POSED = 2
"""Value of ``idle_limbs`` for a limb of which only the points have been posed."""
LIMB_REPEATS = 3
"""Greatest number of repeated solutions of the limbs, because a point entered an area or two limbs did not share a
distance well.
"""


@small_kernel
def with_pose(problem, pose):
    """``problem`` with another pose."""
    return FrameProblem(problem.tasks, problem.areas, problem.chain, problem.body, problem.search, problem.start, pose)


@kernel
def pose_body(problem):
    """Pose the whole body from the joints' state: the trunk, arms on their clavicles, legs on their ankle targets."""
    chain, search, start, pose = problem.chain, problem.search, problem.start, problem.pose
    pose_trunk(search.state, chain.joint_of_segment, start, search.segment_rotations, pose)
    for limb in range(4):
        reset_limb_pose(limb, problem)


@kernel
def reset_limb_pose(limb, problem):
    """Pose one limb as in the unsolved pose: an arm relative to its clavicle, a leg on its ankle target.

    Only the points of an idle limb are posed. A limb whose blended pose is kept takes that.
    """
    chain, body, search, start, pose = problem.chain, problem.body, problem.search, problem.start, problem.pose
    joint_of_segment, state = chain.joint_of_segment, search.state
    if search.idle_limbs[limb]:
        search.idle_limbs[limb] = ONLY_POINTS_POSED
        pose_limb_points(limb, problem)
        return
    if search.blended_limbs[limb] == BLENDED_POSE_KEPT:
        parent, upper, root = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
        pose_limb(parent, upper, root, 4 * limb, search.blended_rotations, start, pose)
        return
    if limb < 2:
        pose_arm(limb, state, joint_of_segment, start, search.segment_rotations, pose)
        limit_redundant_limb(limb, state, joint_of_segment, body.limits, pose)
        return
    positions, rotations = pose
    side = limb - 2
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    thigh = spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side
    joint = joint_of_segment[thigh]
    if joint_of_segment[joint_of_segment.shape[0] - 1] < 0 and joint_of_segment[0] < 0 and joint < 0:
        copy_leg(side, start, pose)
        return
    place_leg(side, body.measures, body.legs, pose)
    if joint < 0:
        return
    x, y, z = state[joint, 0], state[joint, 1], state[joint, 2]
    if x != 0.0 or y != 0.0 or z != 0.0:
        hip = positions[spine_count + HIP_POINT + POINTS_PER_LIMB * side]
        rotate_part(rotation_from_gibbs(x, y, z), thigh, spine_count, hip, positions, rotations)
    limit_redundant_limb(limb, state, joint_of_segment, body.limits, pose)


@kernel
def pose_limb_points(limb, problem):
    """Pose the points of an idle limb without its rotations: such a limb only contributes to the centre of mass."""
    body, start, pose, segment_rotations = problem.body, problem.start, problem.pose, problem.search.segment_rotations
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    if limb < 2:
        shoulder, rotation = (
            spine_count + SHOULDER_POINT + POINTS_PER_LIMB * limb,
            rotation_from_matrix(segment_rotations[spine_count + CLAVICLE_SEGMENT + SEGMENTS_PER_LIMB * limb]),
        )
        for bone in range(1, 4):
            pose_point(shoulder + bone, shoulder, rotation, start, pose.positions)
        return
    place_leg_points(limb - 2, body.measures, body.legs, start.positions, pose)


@kernel
def find_idle_limbs(tasks, joint_of_segment, hand_contacts, spine_count, out_idle):
    """Write 1 into ``out_idle`` (4,) for limbs without tasks, contacts and joints in the search: their rotations can
    wait for the solution.

    Legs are not idle if the root cannot move.
    """
    stays = joint_of_segment[joint_of_segment.shape[0] - 1] < 0 and joint_of_segment[0] < 0
    for limb in range(4):
        _, upper, _ = limb_parts(limb, spine_count)
        out_idle[limb] = 1 if joint_of_segment[upper] < 0 and (limb < 2 or not stays) else 0
    for c in range(tasks.shape[0]):
        for end in range(2):
            segment = tasks[c].segments[end]
            if tasks[c].points[end] >= 0 and segment >= spine_count + 2:
                out_idle[(segment - spine_count - 2) // 4] = 0
    for side in range(2):
        if hand_contacts[side].together > 0.0 or hand_contacts[side].resting > 0.0:
            out_idle[side] = 0


@kernel
def limit_redundant_limb(limb, state, joint_of_segment, limits, pose):
    """Clamp a limb whose shoulder or hip the search has rotated to its joint limits."""
    joint = joint_of_segment[limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)[1]]
    if limits.shape[0] == 0 or joint < 0:
        return
    moves = state[joint, 0] != 0.0 or state[joint, 1] != 0.0 or state[joint, 2] != 0.0
    if moves and not is_well_within(limb, 0, limits, pose.rotations):
        clamp_joint(limb, 0, True, True, limits, pose)


@kernel
def copy_leg(side, start, pose):
    """Copy one leg from the unsolved pose, for a hip that cannot move."""
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    for bone in range(5):
        point = spine_count + HIP_POINT + POINTS_PER_LIMB * side + bone
        copy_point(start.positions[point], pose.positions[point])
    for bone in range(4):
        segment = spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side + bone
        copy_matrix(start.rotations[segment], pose.rotations[segment])


@kernel
def solve_limbs(level, problem):
    """Solve every limb that has a task of levels 0 to ``level`` on the present trunk, and raise limbs out of the
    ground.
    """
    tasks, idle, busy = problem.tasks, problem.search.idle_limbs, 0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        for end in range(2):
            if row.status == ACTIVE and row.level <= level and row.limbs[end] >= 0:
                busy |= 1 << row.limbs[end]
    solve_limb_tasks(busy, level, problem)
    for limb in range(4):
        if (
            idle[limb]
            and end_rise(limb, GROUND_MARGIN_METRES, problem) + middle_rise(limb, GROUND_MARGIN_METRES, problem) > 0.0
        ):
            idle[limb] = 0
            reset_limb_pose(limb, problem)
        if limb >= 2 or not follows_contact(limb, level, problem):
            raise_limb(limb, busy >> limb & 1, level, problem)


@kernel
def solve_limb_tasks(busy, level, problem):
    """Solve the tasks of levels 0 to ``level`` of the limbs in the bit mask ``busy``.

    The solution is repeated where a point ends in a forbidden area, or where one of the two limbs of a distance could
    not make its part.
    """
    tasks, search, start, pose = problem.tasks, problem.search, problem.start, problem.pose
    stiff, moving = 0, False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if has_residual(row) and row.level <= level:
            moving = moving or not has_own_goal(row)
            row.engaged = 0
            for end in range(2):
                if row.limbs[end] >= 0 and row.status == ACTIVE:
                    stiff |= row.stiff << row.limbs[end]
    for attempt in range(1 + LIMB_REPEATS):
        if moving:
            update_goals(level, False, problem)
        for limb in range(4):
            if busy >> limb & 1:
                if stiff >> limb & 1:
                    if attempt > 0:
                        reset_limb_pose(limb, problem)
                    if limb >= 2:
                        move_stiff_leg(limb - 2, start, search.segment_rotations, pose)
                solve_limb(limb, level, problem)
        follow_contacts(level, problem)
        if not moving:
            return
        update_goals(level, True, problem)
        if attempt == LIMB_REPEATS:
            return
        if activate_areas(level, problem):
            for limb in range(4):
                if busy >> limb & 1:
                    reset_limb_pose(limb, problem)
        elif not has_unshared_residual(level, problem):
            return


@kernel
def has_unshared_residual(level, problem):
    """True if a distance has a residual because one of its limbs could not make its part, so that the other has to make
    more.

    Also true if a limb misses a target on its own body that has moved with the limb.
    """
    tasks = problem.tasks
    short = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if (is_distance(row) or limb_follows(row)) and row.status == ACTIVE and row.level <= level:
            short = short or residual_of(c, problem) > NEGLIGIBLE_ERROR
    return short


@kernel
def activate_areas(level, problem):
    """Activate area tasks whose points are inside after all else was solved; True if there are new ones."""
    tasks = problem.tasks
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if is_dormant(row) and row.status == ACTIVE and row.level <= level:
            found = activate_area(row, problem.areas[c], problem.pose) or found
    return found
