"""What a limb asks of the joints that carry it, which bring its root to where it reaches (METHOD 6, "reach sharing").

Records are those of ``kernels.records``.
"""

import math
from typing import NamedTuple

from studio.core.kernels.algebra.vectors import between, distance
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb_limits import bent_point
from studio.core.kernels.limbs.limb_tasks import CLOSE_ENOUGH
from studio.core.kernels.search.joints import add_point_row, add_turn_row
from studio.core.kernels.search.priorities import LONGEST_ERROR
from studio.core.kernels.tasks.goals import asks_place, end_place
from studio.core.kernels.tasks.second_order import BOUND, HOLD, begin_row, note_pull
from studio.core.kernels.tasks.task import ACTIVE, STRICT

HARDLY_MISSED = 2.5 * STRICT
"""Metres of miss up to which a limb is held to what it wants, and beyond which its root is held where it is."""
MISSED = 10.0 * STRICT
"""Metres of miss from which on the root of a limb that falls short is held by levels below."""
SWIVELS = 0.01
"""Metres that a radian of swivel has to bring a limb's secondary task for it to be held by that."""
STEEP = 2.0
"""By how much more than what carries the limb it swivels: as (17) fades half turns, between 0 and some 3."""

LIMITED_ROUND, ASIDE = 0.3, 0.03
"""Radius of the edge of what a limb at its limits reaches, in parts of its length, and the squared sine of the angle
between limb and miss at which it is half way there from that of a free one.
"""


class Link(NamedTuple):
    """A limb as a link of variable length from its root to where it reaches."""

    root: int
    """The point of its root."""
    carrier: int
    """The segment that carries it."""
    way: tuple[float, float, float]
    """Unit, from the root to the goal."""
    span: float
    """Metres from the root to the goal."""
    fold: float
    reach: float
    """Metres to which it folds and stretches."""


@kernel
def add_point_rows(point, segment, x, y, z, owner, count, problem):
    """Three rows that move a point by (x, y, z)."""
    chain, task_rows, positions = problem.chain, problem.search.rows, problem.pose.positions
    for axis in range(3):
        begin_row(task_rows, count, owner, x if axis == 0 else (y if axis == 1 else z))
        along_x, along_y = 1.0 if axis == 0 else 0.0, 1.0 if axis == 1 else 0.0
        along_z = 1.0 if axis == 2 else 0.0
        add_point_row(point, along_x, along_y, along_z, segment, chain.joints, positions, task_rows.jacobian[count])
        count += 1
    return count


@kernel
def add_reach_rows(c, row, end, owner, is_held, count, problem):
    """A limb as a link of variable length: its root nears the goal by what the limb falls short (METHOD 6, (18)).

    Held, it is a bound: the root may go wherever the limb still reaches; if the limb falls short, it stays. A limb
    that its ``limits`` keep from its goal is carried there, as it lies, along what it misses (29); a thigh that stands
    on its knee has to be as far from there as it is long as well.
    """
    pose, limits, ends = problem.pose, problem.body.limits, problem.search.ends
    limb = row.limbs[end]
    carrier, _, root = limb_parts(limb, pose.positions.shape[0] - 23)
    shoulder, wanted = pose.positions[root], row.kept_places[end] if is_held else row.places[end]
    point, goal = bent_point(row, end, wanted, limb >= 2 or ends[limb] >= 0, pose)
    x, y, z = between(shoulder, goal)
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    per = 1.0 / span
    reach, fold = row.reaches[end], min(row.folds[end], row.reaches[end])
    second = row.secondary and row.kept_miss <= HARDLY_MISSED
    if limits.shape[0] > 0 and (limits[limb].blocks == c or (second and limits[limb].blocks >= 0)):
        before = count
        count = add_limited_row(row, end, owner, is_held, count, (point, goal), problem)
        if not is_held:
            return count
        if count > before and row.kept_miss <= CLOSE_ENOUGH and reach - fold > CLOSE_ENOUGH:
            return count
    if row.stiff:
        fold = max(fold, row.own[end] - row.most[end, 1])
        reach = max(min(reach, row.own[end] + row.most[end, 1]), fold)
    link = Link(root, carrier, (per * x, per * y, per * z), span, fold, reach)
    if not is_held:
        return add_link_row(link, row.slack[end], owner, count, problem)
    if row.kept_miss > HARDLY_MISSED:
        return hold_root(link, row, end, owner, count, problem)
    return bound_link(link, owner, count, problem)


@kernel
def add_link_row(link, slack, owner, count, problem):
    """Ask the root of a limb for what that is too far from its goal, or too near, but for a ``slack``."""
    chain, positions, task_rows = problem.chain, problem.pose.positions, problem.search.rows
    error = link.span - min(max(link.span, link.fold + min(slack, 0.0)), link.reach + max(slack, 0.0))
    if error == 0.0:
        return count
    x, y, z = link.way
    shoulder = positions[link.root]
    begin_row(task_rows, count, owner, error)
    add_point_row(shoulder, x, y, z, link.carrier, chain.joints, positions, task_rows.jacobian[count])
    pull = min(max(error, -LONGEST_ERROR), LONGEST_ERROR)
    along = math.copysign(link.span, error)
    note_pull(task_rows.pulls[count], pull * x, pull * y, pull * z, along, shoulder, link.carrier)
    return count + 1


@kernel
def hold_root(link, row, end, owner, count, problem):
    """Hold the root of a limb that falls short where it was, the more the more is missed."""
    task_rows, shoulder, first = problem.search.rows, problem.pose.positions[link.root], count
    if holds_already(shoulder, link.carrier, count, task_rows):
        return count
    held, kept = min(row.kept_miss / MISSED, 1.0), row.kept_roots[end]
    x, y, z = kept[0] - shoulder[0], kept[1] - shoulder[1], kept[2] - shoulder[2]
    count = add_point_rows(shoulder, link.carrier, x, y, z, owner, count, problem)
    note_pull(task_rows.pulls[first], x, y, z, 0.0, shoulder, link.carrier)
    for other in range(first, count):
        task_rows.errors[other] *= held
        for joint in range(task_rows.jacobian.shape[1]):
            for axis in range(3):
                task_rows.jacobian[other, joint, axis] *= held
    return count


@kernel
def bound_link(link, owner, count, problem):
    """Let the root of a limb that meets its goal go wherever the limb still reaches."""
    chain, positions, task_rows = problem.chain, problem.pose.positions, problem.search.rows
    span, fold, reach, (x, y, z) = link.span, link.fold, link.reach, link.way
    shoulder, side = positions[link.root], 1.0 if reach - span < span - fold else -1.0
    x, y, z = side * x, side * y, side * z
    begin_row(task_rows, count, owner, span - reach if side > 0.0 else fold - span)
    task_rows.roles[count] = BOUND if reach - fold > CLOSE_ENOUGH else HOLD
    note_pull(task_rows.pulls[count], x, y, z, side * span, shoulder, link.carrier)
    add_point_row(shoulder, x, y, z, link.carrier, chain.joints, positions, task_rows.jacobian[count])
    return count + 1


@kernel
def add_apart_row(c, owner, count, problem):
    """Hold what is missed between two points of the body: limbs are links of their length from their roots, or, where
    limits keep them from more, as if stiff.
    """
    tasks, chain, pose = problem.tasks, problem.chain, problem.pose
    row, task_rows, limits = tasks[c], problem.search.rows, problem.body.limits
    points = end_place(row, 0, pose), end_place(row, 1, pose)
    x, y, z = between(points[0], row.places[0]) if asks_place(row) else between(points[0], points[1])
    size = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    more = size if asks_place(row) else size - row.distance
    scale = math.copysign(1.0 / size, more)
    x, y, z = scale * x, scale * y, scale * z
    begin_row(task_rows, count, owner, abs(more) - row.kept_miss)
    for end in range(2):
        point, carrier, limb = points[end], row.segments[end], row.limbs[end]
        if limb >= 0 and row.freedoms[end, 0] > 0.0 and not (limits.shape[0] > 0 and limits[limb].blocks == c):
            carrier, _, root = limb_parts(limb, pose.positions.shape[0] - 23)
            shoulder = pose.positions[root]
            point = shoulder[0], shoulder[1], shoulder[2]
        part = 1.0 if end == 0 else -(row.share if asks_place(row) else 1.0)
        add_point_row(
            point, part * x, part * y, part * z, carrier, chain.joints, pose.positions, task_rows.jacobian[count]
        )
    return count + 1


@kernel
def first_of(c, tasks):
    """The place that the limb of a secondary task has to bring its point to first, -1 for none."""
    for before in range(c):
        first = tasks[before]
        same = asks_place(first) and first.status == ACTIVE and first.limbs[0] == tasks[c].limbs[0]
        if same and first.freedoms[0, 0] > 0.0:
            return before
    return -1


@kernel
def add_secondary_row(c, owner, count, problem):
    """A limb's secondary task for its elbow or knee: the root nears its place by what the upper bone does not span.

    The place is the nearest to what is wanted that is as far from the primary task's point as the bone between them is
    long: the swivel about the axis to there (16) does the rest.
    """
    tasks, chain, pose = problem.tasks, problem.chain, problem.pose
    row, task_rows, first = tasks[c], problem.search.rows, first_of(c, tasks)
    carrier, upper, root = limb_parts(row.limbs[0], pose.positions.shape[0] - 23)
    if (
        first < 0
        or row.segments[0] != upper
        or tasks[first].segments[0] == upper
        or row.stiff
        or row.freedoms[0, 0] == 0
    ):
        return count
    shoulder, goal = pose.positions[root], row.places[0]
    point, held = end_place(row, 0, pose), end_place(tasks[first], 0, pose)
    part = distance(point, held) / max(distance(goal, held), 1e-9)
    x = held[0] + part * (goal[0] - held[0]) - shoulder[0]
    y = held[1] + part * (goal[1] - held[1]) - shoulder[1]
    z = held[2] + part * (goal[2] - held[2]) - shoulder[2]
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    error = span - distance(point, shoulder)
    if abs(error) < CLOSE_ENOUGH:
        return count
    x, y, z = x / span, y / span, z / span
    begin_row(task_rows, count, owner, error)
    add_point_row(shoulder, x, y, z, carrier, chain.joints, pose.positions, task_rows.jacobian[count])
    pull = min(max(error, -LONGEST_ERROR), LONGEST_ERROR)
    note_pull(task_rows.pulls[count], pull * x, pull * y, pull * z, math.copysign(span, error), shoulder, carrier)
    return count + 1


@kernel
def add_swivel_row(c, end, owner, count, problem):
    """Hold what a limb's secondary task misses, where the swivel that its first leaves was not to be had.

    It begins at the motion's own and ends at limits: it goes with what carries the limb about the axis from its root to
    its first point.
    """
    tasks, chain, pose = problem.tasks, problem.chain, problem.pose
    row, task_rows = tasks[c], problem.search.rows
    carrier, _, root = limb_parts(row.limbs[end], pose.positions.shape[0] - 23)
    origin, point = pose.positions[root], end_place(row, end, pose)
    ax, ay, az = between(origin, end_place(tasks[first_of(c, tasks)], 0, pose))
    x, y, z = between(point, row.places[end])
    px, py, pz = between(origin, point)
    size = math.sqrt(x * x + y * y + z * z)
    scale = STEEP / max((ax * ax + ay * ay + az * az) * size, 1e-12)
    arm = scale * (ax * (py * z - pz * y) + ay * (pz * x - px * z) + az * (px * y - py * x))
    if arm * arm * (ax * ax + ay * ay + az * az) < SWIVELS**2:
        return count
    begin_row(task_rows, count, owner, size - row.kept_miss)
    add_turn_row(0, arm * ax, carrier, chain.joints, task_rows.jacobian[count])
    add_turn_row(1, arm * ay, carrier, chain.joints, task_rows.jacobian[count])
    add_turn_row(2, arm * az, carrier, chain.joints, task_rows.jacobian[count])
    return count + 1


@kernel
def add_limited_row(row, end, owner, is_held, count, aim, problem):
    """Carry a limb that lies at a limit along what it misses (29): to the first order as if it were stiff.

    Held, it keeps the miss that it had. ``aim`` as of ``bent_point``.
    """
    chain, pose, task_rows = problem.chain, problem.pose, problem.search.rows
    (point, wanted), kept = aim, 0.0
    x, y, z = between(point, wanted)
    if is_held and row.kept_miss > CLOSE_ENOUGH:
        x, y, z = between(end_place(row, end, pose), row.places[end])
        kept = row.kept_miss
    size = math.sqrt(x * x + y * y + z * z)
    if size < CLOSE_ENOUGH:
        return count
    carrier, _, root = limb_parts(row.limbs[end], pose.positions.shape[0] - 23)
    x, y, z, error = x / size, y / size, z / size, size - kept
    begin_row(task_rows, count, owner, error)
    add_point_row(point, x, y, z, carrier, chain.joints, pose.positions, task_rows.jacobian[count])
    pull = min(max(error, -LONGEST_ERROR), LONGEST_ERROR)
    radius = radius_of_reach(x, y, z, point, pose.positions[root])
    centre = point[0] - radius * x, point[1] - radius * y, point[2] - radius * z
    note_pull(task_rows.pulls[count], pull * x, pull * y, pull * z, radius + size, centre, carrier)
    return count + 1


@kernel
def radius_of_reach(x, y, z, point, root):
    """Metres by which what a limb reaches curves about ``point``, seen along the unit (x, y, z) of its miss (30).

    A free limb reaches a ball about its ``root``, and misses along itself; the further it misses aside, at limits, the
    more it is a stiff one.
    """
    rx, ry, rz = point[0] - root[0], point[1] - root[1], point[2] - root[2]
    squared = max(rx * rx + ry * ry + rz * rz, 1e-12)
    aside = max(1.0 - (x * rx + y * ry + z * rz) ** 2 / squared, 0.0)
    return math.sqrt(squared) * (LIMITED_ROUND + (1.0 - LIMITED_ROUND) * ASIDE / (ASIDE + aside))


@kernel
def holds_already(point, carrier, count, task_rows):
    """Whether a higher constraint holds the same point: the same three rows once more would say nothing."""
    for row in range(count):
        pull = task_rows.pulls[row]
        same = pull.carrier == carrier and pull.span == 0.0 and task_rows.roles[row] == HOLD
        if same and pull.point[0] == point[0] and pull.point[1] == point[1] and pull.point[2] == point[2]:
            return True
    return False
