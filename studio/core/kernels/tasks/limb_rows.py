"""Jacobian rows by which a limb's task moves the root of the limb to where the limb reaches the goal (METHOD 8, "reach
sharing").

Functions that add rows write them from row ``count`` on, and return the new number of rows. ``weight_row`` is the row
of the joint weights that moves joints for them; ``is_held`` is true for the rows of a higher level, which hold its
result. Records are those of ``kernels.records``.
"""

import math
from typing import NamedTuple

from studio.core.kernels.algebra.vectors import distance, offset_between
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_limits import effective_point
from studio.core.kernels.limbs.limb_tasks import NEGLIGIBLE_ERROR
from studio.core.kernels.search.joints import add_point_jacobian, add_rotation_jacobian
from studio.core.kernels.search.null_space_step import MAX_ROW_ERROR
from studio.core.kernels.tasks.goals import end_position, is_position
from studio.core.kernels.tasks.second_order import EQUALITY_ROW, INEQUALITY_ROW, begin_zero_row, set_point_error
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE
from studio.core.kernels.tasks.task_status import ACTIVE

NEARLY_MET_LIMB_RESIDUAL = 2.5 * PRIORITY_TOLERANCE
"""Residual in metres up to which a higher task holds its limb's reach, and beyond which it holds the position of the
limb's root.
"""
LIMB_SHORT_RESIDUAL = 10.0 * PRIORITY_TOLERANCE
"""Residual in metres from which the root of a limb that falls short is held completely; less is held in proportion."""
LEAST_SWIVEL_LEVER = 0.01
"""Least lever, in metres per radian of swivel, of a limb's secondary task for its residual to be held by the swivel."""
SWIVEL_AMPLIFICATION = 2.0
"""Assumed ratio of a limb's swivel to the rotation of its parent. The true ratio is between 0 and about 3, because (17)
fades half turns.
"""

LIMITED_REACH_RADIUS, SIDEWAYS_RESIDUAL = 0.3, 0.03
"""Radius of curvature of a limited limb's reach, as a fraction of its length, and squared sine of the angle between
limb and residual at which the radius is half way from that of a free limb.
"""


class LimbLink(NamedTuple):
    """A limb seen from the trunk: a link of variable length from the limb's root to its goal."""

    root: int
    """Index of the point of the limb's root."""
    parent_segment: int
    """Index of the segment that carries the limb's root."""
    direction: tuple[float, float, float]
    """Unit direction from the root to the goal."""
    span: float
    """Distance in metres from the root to the goal."""
    min_length: float
    """Least length in metres."""
    max_length: float
    """Greatest length in metres."""


@kernel
def add_point_rows(point, segment, x, y, z, weight_row, count, problem):
    """Add three rows that move a point of ``segment`` by (x, y, z) metres."""
    chain, task_rows, positions = problem.chain, problem.search.rows, problem.pose.positions
    for axis in range(3):
        begin_zero_row(task_rows, count, weight_row, x if axis == 0 else (y if axis == 1 else z))
        along_x, along_y = 1.0 if axis == 0 else 0.0, 1.0 if axis == 1 else 0.0
        along_z = 1.0 if axis == 2 else 0.0
        add_point_jacobian(
            point, along_x, along_y, along_z, segment, chain.joints, positions, task_rows.jacobian[count]
        )
        count += 1
    return count


@kernel
def add_reach_rows(c, row, end, weight_row, is_held, count, problem):
    """Add the rows by which a limb's root moves until the limb reaches its goal (METHOD 8, (18)).

    The row is an objective while the task's level is solved. Of a held task it is an inequality row if the limb reached
    the goal, so that the root may move wherever the limb still reaches; if the limb fell short, its root is held. A
    limb that joint limits keep from its goal is moved rigidly along its residual instead (29).
    """
    pose, limits, ends = problem.pose, problem.body.limits, problem.search.end_tasks
    limb = row.limbs[end]
    parent, _, root = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    shoulder, wanted = pose.positions[root], row.kept_positions[end] if is_held else row.goal_positions[end]
    point, goal = effective_point(row, end, wanted, limb >= 2 or ends[limb] >= 0, pose)
    x, y, z = offset_between(shoulder, goal)
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    per = 1.0 / span
    reach, fold = row.goal_reaches[end], min(row.min_reach[end], row.goal_reaches[end])
    second = row.secondary and row.kept_residual <= NEARLY_MET_LIMB_RESIDUAL
    if limits.shape[0] > 0 and (limits[limb].blocked_task == c or (second and limits[limb].blocked_task >= 0)):
        before = count
        count = add_limited_row(row, end, weight_row, is_held, count, (point, goal), problem)
        if not is_held:
            return count
        if count > before and row.kept_residual <= NEGLIGIBLE_ERROR and reach - fold > NEGLIGIBLE_ERROR:
            return count
    if row.stiff:
        fold = max(fold, row.own_reach[end] - row.max_change[end, 1])
        reach = max(min(reach, row.own_reach[end] + row.max_change[end, 1]), fold)
    link = LimbLink(root, parent, (per * x, per * y, per * z), span, fold, reach)
    if not is_held:
        return add_link_row(link, row.slack[end], weight_row, count, problem)
    if row.kept_residual > NEARLY_MET_LIMB_RESIDUAL:
        return hold_root(link, row, end, weight_row, count, problem)
    return bound_link(link, weight_row, count, problem)


@kernel
def add_link_row(link, slack, weight_row, count, problem):
    """Add an objective row for the root of a limb whose goal is beyond its reach, or too near, by more than ``slack``
    metres.
    """
    chain, positions, task_rows = problem.chain, problem.pose.positions, problem.search.rows
    error = link.span - min(max(link.span, link.min_length + min(slack, 0.0)), link.max_length + max(slack, 0.0))
    if error == 0.0:
        return count
    x, y, z = link.direction
    shoulder = positions[link.root]
    begin_zero_row(task_rows, count, weight_row, error)
    add_point_jacobian(shoulder, x, y, z, link.parent_segment, chain.joints, positions, task_rows.jacobian[count])
    clamped_error = min(max(error, -MAX_ROW_ERROR), MAX_ROW_ERROR)
    along = math.copysign(link.span, error)
    set_point_error(
        task_rows.point_errors[count],
        clamped_error * x,
        clamped_error * y,
        clamped_error * z,
        along,
        shoulder,
        link.parent_segment,
    )
    return count + 1


@kernel
def hold_root(link, row, end, weight_row, count, problem):
    """Add rows that hold the root of a limb that falls short at its saved position, weighted by the limb's residual."""
    task_rows, shoulder, first = problem.search.rows, problem.pose.positions[link.root], count
    if is_point_held(shoulder, link.parent_segment, count, task_rows):
        return count
    held, kept = min(row.kept_residual / LIMB_SHORT_RESIDUAL, 1.0), row.kept_roots[end]
    x, y, z = kept[0] - shoulder[0], kept[1] - shoulder[1], kept[2] - shoulder[2]
    count = add_point_rows(shoulder, link.parent_segment, x, y, z, weight_row, count, problem)
    set_point_error(task_rows.point_errors[first], x, y, z, 0.0, shoulder, link.parent_segment)
    for other in range(first, count):
        task_rows.errors[other] *= held
        for joint in range(task_rows.jacobian.shape[1]):
            for axis in range(3):
                task_rows.jacobian[other, joint, axis] *= held
    return count


@kernel
def bound_link(link, weight_row, count, problem):
    """Add an inequality row for the root of a limb that keeps the goal within the limb's reach."""
    chain, positions, task_rows = problem.chain, problem.pose.positions, problem.search.rows
    span, fold, reach, (x, y, z) = link.span, link.min_length, link.max_length, link.direction
    shoulder, side = positions[link.root], 1.0 if reach - span < span - fold else -1.0
    x, y, z = side * x, side * y, side * z
    begin_zero_row(task_rows, count, weight_row, span - reach if side > 0.0 else fold - span)
    task_rows.roles[count] = INEQUALITY_ROW if reach - fold > NEGLIGIBLE_ERROR else EQUALITY_ROW
    set_point_error(task_rows.point_errors[count], x, y, z, side * span, shoulder, link.parent_segment)
    add_point_jacobian(shoulder, x, y, z, link.parent_segment, chain.joints, positions, task_rows.jacobian[count])
    return count + 1


@kernel
def add_separation_row(c, weight_row, count, problem):
    """Add a row that holds the residual of a task between two points of the body.

    A point on a limb moves with the limb's root, or rigidly with its segment if joint limits keep the limb from its
    goal.
    """
    tasks, chain, pose = problem.tasks, problem.chain, problem.pose
    row, task_rows, limits = tasks[c], problem.search.rows, problem.body.limits
    points = end_position(row, 0, pose), end_position(row, 1, pose)
    x, y, z = (
        offset_between(points[0], row.goal_positions[0]) if is_position(row) else offset_between(points[0], points[1])
    )
    size = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    more = size if is_position(row) else size - row.goal_distance
    scale = math.copysign(1.0 / size, more)
    x, y, z = scale * x, scale * y, scale * z
    begin_zero_row(task_rows, count, weight_row, abs(more) - row.kept_residual)
    for end in range(2):
        point, parent, limb = points[end], row.segments[end], row.limbs[end]
        if (
            limb >= 0
            and row.limb_weights[end, 0] > 0.0
            and not (limits.shape[0] > 0 and limits[limb].blocked_task == c)
        ):
            parent, _, root = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
            shoulder = pose.positions[root]
            point = shoulder[0], shoulder[1], shoulder[2]
        fraction = 1.0 if end == 0 else -(row.activation if is_position(row) else 1.0)
        add_point_jacobian(
            point,
            fraction * x,
            fraction * y,
            fraction * z,
            parent,
            chain.joints,
            pose.positions,
            task_rows.jacobian[count],
        )
    return count + 1


@kernel
def primary_task_of(c, tasks):
    """Index of the primary position task on the limb of a secondary task ``c``, -1 for none."""
    for before in range(c):
        first = tasks[before]
        same = is_position(first) and first.status == ACTIVE and first.limbs[0] == tasks[c].limbs[0]
        if same and first.limb_weights[0, 0] > 0.0:
            return before
    return -1


@kernel
def add_secondary_row(c, weight_row, count, problem):
    """Add a row that moves a limb's root until the goal of its secondary task, at elbow or knee, is at the length of
    the upper bone.

    That goal is first moved to the bone's length from the primary task's point: the swivel (16) does the rest.
    """
    tasks, chain, pose = problem.tasks, problem.chain, problem.pose
    row, task_rows, first = tasks[c], problem.search.rows, primary_task_of(c, tasks)
    parent, upper, root = limb_parts(row.limbs[0], pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    if (
        first < 0
        or row.segments[0] != upper
        or tasks[first].segments[0] == upper
        or row.stiff
        or row.limb_weights[0, 0] == 0
    ):
        return count
    shoulder, goal = pose.positions[root], row.goal_positions[0]
    point, held = end_position(row, 0, pose), end_position(tasks[first], 0, pose)
    fraction = distance(point, held) / max(distance(goal, held), 1e-9)
    x = held[0] + fraction * (goal[0] - held[0]) - shoulder[0]
    y = held[1] + fraction * (goal[1] - held[1]) - shoulder[1]
    z = held[2] + fraction * (goal[2] - held[2]) - shoulder[2]
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    error = span - distance(point, shoulder)
    if abs(error) < NEGLIGIBLE_ERROR:
        return count
    x, y, z = x / span, y / span, z / span
    begin_zero_row(task_rows, count, weight_row, error)
    add_point_jacobian(shoulder, x, y, z, parent, chain.joints, pose.positions, task_rows.jacobian[count])
    clamped_error = min(max(error, -MAX_ROW_ERROR), MAX_ROW_ERROR)
    set_point_error(
        task_rows.point_errors[count],
        clamped_error * x,
        clamped_error * y,
        clamped_error * z,
        math.copysign(span, error),
        shoulder,
        parent,
    )
    return count + 1


@kernel
def add_swivel_row(c, end, weight_row, count, problem):
    """Add a row that holds the residual of a limb's secondary task, which its limited swivel could not remove.

    The swivel is assumed to follow the parent's rotation about the axis from the limb's root to its primary point.
    """
    tasks, chain, pose = problem.tasks, problem.chain, problem.pose
    row, task_rows = tasks[c], problem.search.rows
    parent, _, root = limb_parts(row.limbs[end], pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    origin, point = pose.positions[root], end_position(row, end, pose)
    ax, ay, az = offset_between(origin, end_position(tasks[primary_task_of(c, tasks)], 0, pose))
    x, y, z = offset_between(point, row.goal_positions[end])
    px, py, pz = offset_between(origin, point)
    size = math.sqrt(x * x + y * y + z * z)
    scale = SWIVEL_AMPLIFICATION / max((ax * ax + ay * ay + az * az) * size, 1e-12)
    arm = scale * (ax * (py * z - pz * y) + ay * (pz * x - px * z) + az * (px * y - py * x))
    if arm * arm * (ax * ax + ay * ay + az * az) < LEAST_SWIVEL_LEVER**2:
        return count
    begin_zero_row(task_rows, count, weight_row, size - row.kept_residual)
    add_rotation_jacobian(0, arm * ax, parent, chain.joints, task_rows.jacobian[count])
    add_rotation_jacobian(1, arm * ay, parent, chain.joints, task_rows.jacobian[count])
    add_rotation_jacobian(2, arm * az, parent, chain.joints, task_rows.jacobian[count])
    return count + 1


@kernel
def add_limited_row(row, end, weight_row, is_held, count, aim, problem):
    """Add a row that moves a limb at its joint limits along its residual, to first order as a rigid body (METHOD (29)).

    With ``is_held`` the residual is kept. ``aim`` is the (point, goal) of ``effective_point``.
    """
    chain, pose, task_rows = problem.chain, problem.pose, problem.search.rows
    (point, goal), kept = aim, 0.0
    x, y, z = offset_between(point, goal)
    if is_held and row.kept_residual > NEGLIGIBLE_ERROR:
        x, y, z = offset_between(end_position(row, end, pose), row.goal_positions[end])
        kept = row.kept_residual
    size = math.sqrt(x * x + y * y + z * z)
    if size < NEGLIGIBLE_ERROR:
        return count
    parent, _, root = limb_parts(row.limbs[end], pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    x, y, z, error = x / size, y / size, z / size, size - kept
    begin_zero_row(task_rows, count, weight_row, error)
    add_point_jacobian(point, x, y, z, parent, chain.joints, pose.positions, task_rows.jacobian[count])
    clamped_error = min(max(error, -MAX_ROW_ERROR), MAX_ROW_ERROR)
    radius = reach_curvature_radius(x, y, z, point, pose.positions[root])
    centre = point[0] - radius * x, point[1] - radius * y, point[2] - radius * z
    set_point_error(
        task_rows.point_errors[count],
        clamped_error * x,
        clamped_error * y,
        clamped_error * z,
        radius + size,
        centre,
        parent,
    )
    return count + 1


@kernel
def reach_curvature_radius(x, y, z, point, root):
    """Radius of curvature in metres of the boundary of a limb's reach at ``point``, along the unit residual (x, y, z)
    (30).

    A free limb reaches a ball about its ``root``, and its residual is radial; the more sideways the residual of a limb
    at its limits, the more rigid the limb.
    """
    rx, ry, rz = point[0] - root[0], point[1] - root[1], point[2] - root[2]
    squared = max(rx * rx + ry * ry + rz * rz, 1e-12)
    aside = max(1.0 - (x * rx + y * ry + z * rz) ** 2 / squared, 0.0)
    return math.sqrt(squared) * (
        LIMITED_REACH_RADIUS + (1.0 - LIMITED_REACH_RADIUS) * SIDEWAYS_RESIDUAL / (SIDEWAYS_RESIDUAL + aside)
    )


@kernel
def is_point_held(point, segment, count, task_rows):
    """True if the first ``count`` rows hold the same point of ``segment`` already: three more rows would be
    redundant.
    """
    for row in range(count):
        clamped_error = task_rows.point_errors[row]
        same = clamped_error.segment == segment and clamped_error.span == 0.0 and task_rows.roles[row] == EQUALITY_ROW
        if (
            same
            and clamped_error.point[0] == point[0]
            and clamped_error.point[1] == point[1]
            and clamped_error.point[2] == point[2]
        ):
            return True
    return False
