"""Limbs kept above the ground by the freedom that their tasks leave (METHOD 7).

A limb without task is raised at its end; one with a task at elbow or knee bends there; one with a task beyond elbow or
knee swivels about the line from its root to the task's point. So no task of the limb itself changes. Changes of other
tasks, such as a balance, count as priority violations in the search. A point may be as low as in the unsolved pose.
Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix, rotation_from_vector, transform_point
from studio.core.kernels.algebra.smooth_steps import penetration_correction
from studio.core.kernels.algebra.vectors import distance, offset_between
from studio.core.kernels.body.parts import end_pose, limb_parts, restore_end, rotate_part
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limbs.limb_reach import bend_and_aim
from studio.core.kernels.limits.limb_joint_limits import damped_swivel
from studio.core.kernels.limits.swing_twist import bend_carrying_twist
from studio.core.kernels.tasks.goals import moves_point
from studio.core.kernels.tasks.task_status import ACTIVE

GROUND_MARGIN_METRES = 0.05
"""Height above the ground in metres below which a part of a limb begins to rise; at ground height it is raised by 3/16
of this.
"""
NEGLIGIBLE_RISE_METRES = 1e-6
"""Rise in metres that is ignored: rounding alone causes it in a limb that stays."""
LEAST_CIRCLE_RADIUS = 0.005
"""Radius in metres of the circle of elbow or knee about its limb's line at which a swivel is halved: on a smaller
circle it would whirl.
"""


@kernel
def raise_limb(limb, busy, level, problem):
    """Raise a limb out of the ground; ``busy`` is true if tasks down to ``level`` pose the limb."""
    state, pose = problem.search.limbs[limb], problem.pose
    used, root = state.freedoms_used if busy else 0, limb_root_point(limb, pose)
    if used > 1:
        return
    margin = 0.0 if moves_rigidly(limb, root, level, problem.tasks) else GROUND_MARGIN_METRES
    if used == 0 or state.aims_upper:
        rise = end_rise(limb, margin, problem)
        if rise > 0.0 and used == 0:
            raise_end(limb, rise, pose)
        elif rise > 0.0:
            bend_lower(limb, rise, problem)
    if used == 0 or state.swivels:
        rise = middle_rise(limb, margin, problem)
        if rise > 0.0:
            end, primary = pose.positions[root + 2], state.primary_point
            held = end[0], end[1], end[2]
            if used > 0 and not state.holds_end:
                held = primary[0], primary[1], primary[2]
            swivel_up(limb, rise, held, busy and state.has_limits, problem)


@small_kernel
def limb_root_point(limb, pose):
    """Index of the point of shoulder or hip of a limb."""
    return limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)[2]


@kernel
def moves_rigidly(limb, root, level, tasks):
    """True if a task down to ``level`` has a point beyond the ``root`` of a limb but may not bend the limb."""
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        for end in range(2):
            rigid = row.limbs[end] == limb and row.limb_weights[end, 0] == 0.0 and row.points[end] > root
            found = found or (rigid and moves_point(row) and row.status == ACTIVE and row.level <= level)
    return found


@small_kernel
def height_above(point, ground):
    """Height in metres of a point above a plane z = a + b x + c y, ``ground`` (3,)."""
    return point[2] - ground[0] - ground[1] * point[0] - ground[2] * point[1]


@kernel
def end_rise(limb, margin, problem):
    """Rise in metres that the end of a limb needs, fading in from a height of ``margin`` metres on."""
    now = end_height(limb, problem, problem.pose)
    return rise_between(end_height(limb, problem, problem.start), now, margin) if now < margin else 0.0


@kernel
def middle_rise(limb, margin, problem):
    """Rise in metres that elbow or knee needs, fading in from a height of ``margin`` metres on."""
    start, pose, ground = problem.start, problem.pose, problem.body.ground[limb]
    middle = limb_root_point(limb, pose) + 1
    now = height_above(pose.positions[middle], ground)
    return rise_between(height_above(start.positions[middle], ground), now, margin) if now < margin else 0.0


@kernel
def rise_between(before, now, margin):
    """Rise in metres that a part at the height ``now`` needs, ``before`` being its height in the unsolved pose.

    It fades in from a height of ``margin`` metres on.
    """
    least = min(before, 0.0)
    rise = penetration_correction(now - least, min(before - least, margin))
    return rise if rise > NEGLIGIBLE_RISE_METRES else 0.0


@kernel
def end_height(limb, problem, pose):
    """Height in metres above the ground of the lowest of wrist and finger tips, or of ankle and sole."""
    positions, ground, measures = pose.positions, problem.body.ground[limb], problem.body.measures
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    lowest = min(height_above(positions[root + 2], ground), height_above(positions[root + 3], ground))
    if limb < 2:
        return lowest
    side = limb - 2
    foot, toe = rotation_from_matrix(pose.rotations[upper + 2]), rotation_from_matrix(pose.rotations[upper + 3])
    tall, toe_at = measures[measure.ANKLE_HEIGHT + side], measure.TOE + 3 * side
    thick = tall + measures[measure.FOOT + 3 * side + 2]
    heel = transform_point(positions[root + 2], foot, -measures[measure.HEEL_LENGTH + side], 0.0, -tall)
    ball = transform_point(positions[root + 3], foot, 0.0, 0.0, -thick)
    bent = transform_point(positions[root + 3], toe, 0.0, 0.0, -thick)
    tip = transform_point(positions[root + 3], toe, math.hypot(measures[toe_at], measures[toe_at + 1]), 0.0, -thick)
    return min(
        lowest,
        height_above(heel, ground),
        height_above(ball, ground),
        height_above(bent, ground),
        height_above(tip, ground),
    )


@kernel
def raise_end(limb, rise, pose):
    """Bend and aim a limb until its end is ``rise`` metres higher; hand or foot keeps its world orientation."""
    positions, rotations = pose.positions, pose.rotations
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    end = positions[root + 2, 0], positions[root + 2, 1], positions[root + 2, 2]
    goal, lifted = (end[0], end[1], end[2] + rise), end_pose(limb, pose)
    bend_and_aim(goal, distance(goal, positions[root]), upper, root, end, positions, rotations)
    restore_end(limb, lifted, pose)


@kernel
def swivel_up(limb, rise, held, is_limited, problem):
    """Swivel a limb about the line from its root to the ``held`` point until elbow or knee is ``rise`` metres higher,
    or as high as possible.
    """
    pose, limits, state = problem.pose, problem.body.limits, problem.search.limbs[limb]
    positions, rotations = pose.positions, pose.rotations
    parent, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    axis = offset_between(positions[root], held)
    size = max(math.sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]), 1e-9)
    x, y, z = axis[0] / size, axis[1] / size, axis[2] / size
    phase, goal, weight = circle_to_rise((x, y, z), offset_between(positions[root], positions[root + 1]), rise)
    angle = weight * math.copysign(max(abs(phase) - goal, 0.0), phase)
    if is_limited:
        angle = damped_swivel(limits[limb], rotations[parent], rotations[upper], x, y, z, angle)
    lifted = end_pose(limb, pose)
    rotation = rotation_from_vector(angle * x, angle * y, angle * z)
    rotate_part(rotation, upper, positions.shape[0] - POINTS_BESIDE_SPINE, positions[root], positions, rotations)
    if state.holds_end or not is_limited:
        restore_end(limb, lifted, pose)


@kernel
def bend_lower(limb, rise, problem):
    """Bend elbow or knee, within its limits, until the end of the limb is ``rise`` metres higher, or as high as
    possible.

    Hand or foot keeps its world orientation.
    """
    pose, limits = problem.pose, problem.body.limits
    positions, rotations = pose.positions, pose.rotations
    _, upper, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    x, y, z = rotations[upper, 0, 0], rotations[upper, 1, 0], rotations[upper, 2, 0]
    phase, goal, weight = circle_to_rise((x, y, z), offset_between(positions[root + 1], positions[root + 2]), rise)
    angle, least, most = math.copysign(max(abs(phase) - goal, 0.0), phase), -math.inf, math.inf
    if limits.shape[0] > 0:
        bend = bend_carrying_twist(rotations[upper], rotations[upper + 1])[0]
        least, most = min(limits[limb].bends[0] - bend, 0.0), max(limits[limb].bends[1] - bend, 0.0)
    other = math.copysign(2.0 * math.pi - abs(phase) - goal, -phase)
    if not least <= angle <= most and least <= other <= most:
        angle = other
    angle = weight * min(max(angle, least), most)
    lifted = end_pose(limb, pose)
    rotation = rotation_from_vector(angle * x, angle * y, angle * z)
    rotate_part(
        rotation, upper + 1, positions.shape[0] - POINTS_BESIDE_SPINE, positions[root + 1], positions, rotations
    )
    restore_end(limb, lifted, pose)


@kernel
def circle_to_rise(axis, arm, rise):
    """(phase, goal, weight) of a rotation about the unit ``axis`` that raises the end of ``arm`` (3,) by ``rise``
    metres.

    ``phase`` is the angle in radians from the end's present position to the highest one on its circle, ``goal`` that
    from the raised position to the highest one, and ``weight`` the fraction of the rotation to be made, small for a
    small circle.
    """
    x, y, z = axis
    along = x * arm[0] + y * arm[1] + z * arm[2]
    height, aside = arm[2] - along * z, x * arm[1] - y * arm[0]
    most = math.sqrt(height * height + aside * aside)
    goal = math.acos(min(max((height + rise) / max(most, 1e-9), -1.0), 1.0))
    return math.atan2(aside, height), goal, most * most / (most * most + LEAST_CIRCLE_RADIUS * LEAST_CIRCLE_RADIUS)
