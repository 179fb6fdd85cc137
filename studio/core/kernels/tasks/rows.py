"""What each constraint asks of the joints in one step: rows for ``kernels.search.priorities`` (METHOD 6).

Records are those of ``kernels.records``.
"""

import math

from studio.core.kernels.algebra.turns import turn_error
from studio.core.kernels.algebra.vectors import between, distance, length
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.root_reach import root_reach_of
from studio.core.kernels.search.joints import add_point_row, add_turn_row, may_turn
from studio.core.kernels.search.reachability import reachable_place
from studio.core.kernels.tasks.balance import let_arm_reach, set_balance_rows, sum_masses
from studio.core.kernels.tasks.goals import (
    TURN_ARM,
    UPRIGHT,
    asks_length,
    asks_place,
    end_place,
    is_dormant,
    joins_points,
    moves_mass,
    turns_segment,
)
from studio.core.kernels.tasks.limb_rows import (
    HARDLY_MISSED,
    add_apart_row,
    add_point_rows,
    add_reach_rows,
    add_secondary_row,
    add_swivel_row,
    holds_already,
)
from studio.core.kernels.tasks.look_at import keeps_looking
from studio.core.kernels.tasks.second_order import BOUND, HOLD, begin_row, note_pull, note_row
from studio.core.kernels.tasks.task import ACTIVE, GIVEN_UP
from studio.core.kernels.tasks.upright import add_upright_rows


@kernel
def add_feet_rows(owner, count, problem):
    """Bounds of both legs: their hips go no further from the ankles than these reach. The new number of rows."""
    chain, body, task_rows, positions = problem.chain, problem.body, problem.search.rows, problem.pose.positions
    ankles = body.legs.ankles
    spine_count = positions.shape[0] - 23
    for side in range(2):
        if body.root_reaches[side] == math.inf:
            continue
        point = spine_count + 13 + 5 * side
        hip, ankle = positions[point], ankles[side]
        length, room = root_reach_of(side, body, problem.start)
        span = max(distance(hip, ankle), 1e-9)
        begin_row(task_rows, count, owner, span - length)
        task_rows.roles[count], task_rows.rooms[count] = BOUND, room
        per = 1.0 / span
        x, y, z = per * (ankle[0] - hip[0]), per * (ankle[1] - hip[1]), per * (ankle[2] - hip[2])
        note_pull(task_rows.pulls[count], x, y, z, span, hip, 0)
        add_point_row(hip, x, y, z, 0, chain.joints, positions, task_rows.jacobian[count])
        count += 1
    return count


@kernel
def add_rows(c, level, owner, is_held, count, problem):
    """Rows of one constraint, towards its goal or, when held, towards what it has; the new number of rows."""
    tasks, search = problem.tasks, problem.search
    task_rows = search.rows
    row = tasks[c]
    first = count
    if is_dormant(row):
        return count
    if row.secondary and not is_held:
        return add_secondary_row(c, owner, count, problem)
    if row.kind == UPRIGHT and row.limbs[0] < 0:
        count = add_upright_rows(row, owner, is_held, count, problem)
    elif turns_segment(row):
        count = add_turn_rows(row, owner, is_held, count, problem)
    elif moves_mass(row):
        count = add_balance_rows(row, level, owner, is_held, count, problem)
    else:
        for end in range(2):
            if row.points[end] < 0:
                continue
            free = row.limbs[end] >= 0 and row.freedoms[end, 0] > 0.0
            if row.status == GIVEN_UP and row.limbs[end] >= 0:
                count = add_idle_row(c, level, end, owner, count, problem)
                continue
            if is_held and joins_points(row) and row.kept_miss > HARDLY_MISSED:
                if end == 0:
                    count = add_apart_row(c, owner, count, problem)
                continue
            aims = not row.stiff or row.parts[end, 0] == 1.0
            if free and aims:
                if row.secondary and row.kept_miss > HARDLY_MISSED:
                    count = add_swivel_row(c, end, owner, count, problem)
                count = add_reach_rows(c, row, end, owner, is_held, count, problem)
            elif free or (end == 0 and not asks_length(row)):
                count = add_place_rows(row, end, owner, is_held, count, problem)
    if is_held:
        for other in range(first, count):
            task_rows.roles[other] = max(task_rows.roles[other], HOLD)
    elif row.counts != 1.0:
        scale = math.sqrt(row.counts)
        for other in range(first, count):
            task_rows.errors[other] *= scale
            task_rows.pulls[other].weight = row.counts
            for joint in range(task_rows.jacobian.shape[1]):
                for axis in range(3):
                    task_rows.jacobian[other, joint, axis] *= scale
    return count


@kernel
def add_turn_rows(row, owner, is_held, count, problem):
    """Three rows that turn a segment of the trunk; a limb's own segments are turned in closed form, and, held, keep
    what limits leave them to miss as if the limb were stiff.
    """
    chain, pose, task_rows = problem.chain, problem.pose, problem.search.rows
    segment = row.segments[0]
    if row.limbs[0] >= 0:
        if not is_held or row.kept_miss <= HARDLY_MISSED:
            return count
        error = turn_error(row.turn, pose.rotations[segment])
        size = length(error)
        begin_row(task_rows, count, owner, TURN_ARM * (size - row.kept_miss))
        for axis in range(3):
            add_turn_row(
                axis, TURN_ARM * error[axis] / max(size, 1e-9), segment, chain.joints, task_rows.jacobian[count]
            )
        return count + 1
    if is_held and keeps_looking(row):
        x, y, z = turn_error(row.turn, pose.rotations[segment])
        part = 1.0 - row.kept_miss / max(length((x, y, z)), 0.5 * row.kept_miss, 1e-9)
        error = part * x, part * y, part * z
    else:
        error = turn_error(row.kept_turn if is_held else row.turn, pose.rotations[segment])
    for axis in range(3):
        begin_row(task_rows, count, owner, TURN_ARM * error[axis])
        add_turn_row(axis, TURN_ARM, segment, chain.joints, task_rows.jacobian[count])
        count += 1
    return count


@kernel
def add_balance_rows(row, level, owner, is_held, count, problem):
    """Two rows that move the centre of mass over the ground, or three, while arms reach for goals down to ``level``."""
    tasks, chain, masses, positions = problem.tasks, problem.chain, problem.body.masses, problem.pose.positions
    task_rows, sums = problem.search.rows, problem.search.sums
    sum_masses(masses, positions, sums)
    now = sums[sums.shape[0] - 1]
    for axis in range(row.axes):
        wanted = row.kept_places[0, axis] if is_held else row.places[1, axis]
        note_row(task_rows, count, owner, wanted - now[axis])
        count += 1
    rows = task_rows.jacobian[count - row.axes : count]
    spine_count, down_to = positions.shape[0] - 23, min(tasks.shape[0] + level, chain.mobilities.shape[0] - 1)
    set_balance_rows(row.axes, masses, sums, chain.joints, positions, rows)
    for c in range(tasks.shape[0]):
        other = tasks[c]
        if asks_place(other) and other.status == ACTIVE and other.rank <= level and not other.secondary:
            limb = other.limbs[0]
            if not 0 <= limb < 2 or other.freedoms[0, 0] == 0.0:
                continue
            if not may_turn(down_to, limb_parts(limb, spine_count)[1], chain):
                let_arm_reach(limb, row.axes, other.places[0], other.reaches[0], sums, chain.joints, positions, rows)
    return count


@kernel
def add_idle_row(c, level, end, owner, count, problem):
    """Hold what an arm misses that is not asked for it any more, and goes as it lies with what carries it.

    Where another constraint poses it, what that does to the miss is only seen in the end.
    """
    tasks, chain, pose, task_rows = problem.tasks, problem.chain, problem.pose, problem.search.rows
    row = tasks[c]
    if not asks_place(row) or row.limbs[end] >= 2:
        return count
    for other in tasks:
        poses = other.limbs[0] == row.limbs[end] or other.limbs[1] == row.limbs[end]
        if poses and other.status == ACTIVE and other.rank <= level:
            return count
    point = end_place(row, end, pose)
    x, y, z = between(point, row.places[end])
    size = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    begin_row(task_rows, count, owner, size - row.kept_miss)
    add_point_row(
        point, x / size, y / size, z / size, row.segments[end], chain.joints, pose.positions, task_rows.jacobian[count]
    )
    note_pull(task_rows.pulls[count], 0.0, 0.0, 0.0, 0.0, point, row.segments[end])
    return count + 1


@kernel
def add_place_rows(row, end, owner, is_held, count, problem):
    """Three rows that bring a point of the trunk, or of a limb that is not free, to its place."""
    chain, pose, task_rows = problem.chain, problem.pose, problem.search.rows
    point, segment = end_place(row, end, pose), row.segments[end]
    first, follows = count, asks_place(row) and row.points[1] >= 0
    if is_held and not follows and holds_already(point, segment, count, task_rows):
        return count
    if is_held:
        x, y, z = between(point, row.kept_places[end])
    elif asks_place(row) and end == 0:
        x, y, z = between(point, reachable_place(row))
    else:
        x, y, z = between(point, row.places[end])
    if is_held and follows:
        share, (dx, dy, dz) = row.share, between(row.kept_places[1], end_place(row, 1, pose))
        x, y, z = x + share * dx, y + share * dy, z + share * dz
    count = add_point_rows(point, segment, x, y, z, owner, count, problem)
    if not (is_held and follows):
        note_pull(task_rows.pulls[first], x, y, z, 0.0, point, segment)
    if follows:
        followed = end_place(row, 1, pose)
        for axis in range(3):
            x, y, z = (1.0 if axis == 0 else 0.0), (1.0 if axis == 1 else 0.0), (1.0 if axis == 2 else 0.0)
            x, y, z = -row.share * x, -row.share * y, -row.share * z
            add_point_row(
                followed, x, y, z, row.segments[1], chain.joints, pose.positions, task_rows.jacobian[first + axis]
            )
    return count
