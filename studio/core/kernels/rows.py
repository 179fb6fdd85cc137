"""What each constraint asks of the joints in one step: rows for ``kernels.priorities`` (METHOD 6).

``asked``, ``chain``, ``body``, ``work`` and ``pose`` are what ``kernels.constraints`` describes.
"""

import math

from studio.core.kernels.balance import let_arm_reach, set_balance_rows, sum_masses
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.goals import AREA, BALANCE, DISTANCE, GIVEN_UP, LOOK_AT, ORIENTATION, POSITION, end_place
from studio.core.kernels.joints import add_point_row, add_turn_row, may_turn
from studio.core.kernels.limb_constraints import CLOSE_ENOUGH, limb_indices
from studio.core.kernels.means import within_means
from studio.core.kernels.placing import turn_error
from studio.core.kernels.priorities import LONGEST_ERROR
from studio.core.kernels.pulls import ASK, BOUND, HOLD, note_pull
from studio.core.kernels.stance import leash_of
from studio.core.kernels.vectors import copy_point, distance

TURN_ARM = 0.3
"""Metres that count as one radian where both are weighed together."""
HARDLY_MISSED = 5e-4
"""Metres of miss up to which a limb is held to what it wants, and beyond which its root is held where it is."""
MISSED = 2e-3
"""Metres of miss from which on the root of a limb that falls short is held by levels below."""
AWAY = 1.0
"""Radians of miss from which on a look that is held keeps its turn: what it misses has no clear direction there."""
SWIVELS = 0.01
"""Metres that a radian of swivel has to bring a limb's second wish for it to be held by that."""
STEEP = 2.0
"""By how much more than what carries the limb it swivels: as (17) fades half turns, between 0 and some 3."""

LIMITED_ROUND, ASIDE = 0.3, 0.03
"""Radius of the edge of what a limb at its limits reaches, in parts of its length, and the squared sine of the angle
between limb and miss at which it is half way there from that of a free one.
"""


@kernel
def add_feet_rows(owner, count, chain, body, ask, start, positions):
    """Bounds of both legs: their hips go no further from the ankles than the leash. The new number of rows."""
    ankles = body[3][2]
    spine_count = positions.shape[0] - 23
    for side in range(2):
        if body[2][side] == math.inf:
            continue
        point = spine_count + 13 + 5 * side
        hip, ankle = positions[point], ankles[side]
        length, room = leash_of(side, body, start)
        span = max(distance(hip, ankle), 1e-9)
        begin_row(ask, count, owner, span - length)
        ask[3][count], ask[6][count] = BOUND, room
        per = 1.0 / span
        x, y, z = per * (ankle[0] - hip[0]), per * (ankle[1] - hip[1]), per * (ankle[2] - hip[2])
        note_pull(ask[5][count], x, y, z, span, hip, 0)
        add_point_row(hip, x, y, z, 0, chain[1], positions, ask[0][count])
        count += 1
    return count


@kernel
def add_rows(c, level, owner, is_held, count, asked, chain, body, work, pose):
    """Rows of one constraint, towards its goal or, when held, towards what it has; the new number of rows."""
    ask, grips, points = work[0], work[4], work[5]
    row = asked[c]
    first = count
    if row.kind == AREA and not row.engaged:
        return count
    if row.second and not is_held:
        return add_second_row(c, owner, count, asked, ask, chain, points, pose)
    if row.kind == ORIENTATION or row.kind == LOOK_AT:
        count = add_turn_rows(row, owner, is_held, count, ask, chain, work[7][0], points[0], pose)
    elif row.kind == BALANCE:
        count = add_balance_rows(row, level, owner, is_held, count, asked, chain, body, work, pose[0])
    else:
        for end in range(2):
            if row.ends[end, 0] < 0:
                continue
            free = row.ends[end, 2] >= 0 and row.freedoms[end, 0] > 0.0
            if row.wanted == GIVEN_UP and row.ends[end, 2] >= 0:
                count = add_idle_row(c, level, end, owner, count, asked, ask, chain, points[0], pose)
                continue
            if is_held and row.kind != AREA and row.ends[1, 0] >= 0 and row.kept_miss > HARDLY_MISSED:
                if end == 0:
                    count = add_apart_row(c, owner, count, asked, ask, chain, body[4], points, pose)
                continue
            aims = not row.stiff or row.parts[end, 0] == 1.0
            if free and aims:
                if row.second and row.kept_miss > HARDLY_MISSED:
                    count = add_swivel_row(c, end, owner, count, asked, ask, chain, points, pose)
                count = add_reach_rows(c, row, end, owner, is_held, count, ask, chain, grips, body[4], points, pose)
            elif free or (row.kind != DISTANCE and end == 0):
                count = add_place_rows(row, end, owner, is_held, count, ask, chain, points, pose)
    if is_held:
        for other in range(first, count):
            ask[3][other] = max(ask[3][other], HOLD)
    elif row.weight != 1.0:
        scale = math.sqrt(row.weight)
        for other in range(first, count):
            ask[1][other] *= scale
            ask[5][other, 8] = row.weight
            for joint in range(ask[0].shape[1]):
                for axis in range(3):
                    ask[0][other, joint, axis] *= scale
    return count


@kernel
def begin_row(ask, count, owner, error):
    """Start an empty row that asks."""
    note_row(ask, count, owner, error)
    row = ask[0][count]
    for joint in range(row.shape[0]):
        row[joint, 0] = row[joint, 1] = row[joint, 2] = 0.0


@small_kernel
def note_row(ask, count, owner, error):
    """Start a row that asks, but for its levers."""
    _, errors, owners, roles, _, pulls, rooms = ask
    pulls[count, 7], pulls[count, 8] = -1.0, 1.0
    errors[count], owners[count], roles[count], rooms[count] = error, owner, ASK, 0.0


@kernel
def add_turn_rows(row, owner, is_held, count, ask, chain, turn, vector, pose):
    """Three rows that turn a segment of the trunk; a limb's own segments are turned in closed form, and, held, keep
    what limits leave them to miss as if the limb were stiff.

    A look that is held keeps what it misses of its target, wherever the eyes go, unless it looks away.
    """
    segment = row.ends[0, 1]
    if row.ends[0, 2] >= 0:
        if not is_held or row.kept_miss <= HARDLY_MISSED:
            return count
        turn_error(row.turn, pose[1][segment], turn, vector)
        size = math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
        begin_row(ask, count, owner, TURN_ARM * (size - row.kept_miss))
        for axis in range(3):
            add_turn_row(axis, TURN_ARM * vector[axis] / max(size, 1e-9), segment, chain[1], ask[0][count])
        return count + 1
    if is_held and row.kind == LOOK_AT and row.kept_miss < AWAY:
        turn_error(row.turn, pose[1][segment], turn, vector)
        size = math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
        part = 1.0 - row.kept_miss / max(size, 0.5 * row.kept_miss, 1e-9)
        vector[0], vector[1], vector[2] = part * vector[0], part * vector[1], part * vector[2]
    else:
        turn_error(row.kept_turn if is_held else row.turn, pose[1][segment], turn, vector)
    for axis in range(3):
        begin_row(ask, count, owner, TURN_ARM * vector[axis])
        add_turn_row(axis, TURN_ARM, segment, chain[1], ask[0][count])
        count += 1
    return count


@kernel
def add_balance_rows(row, level, owner, is_held, count, asked, chain, body, work, positions):
    """Two rows that move the centre of mass over the ground, or three, while arms reach for goals down to ``level``."""
    ask, sums, spine_count = work[0], work[6], positions.shape[0] - 23
    sum_masses(body[1], positions, sums)
    now = sums[sums.shape[0] - 1]
    for axis in range(row.axes):
        wanted = row.kept_places[0, axis] if is_held else row.places[1, axis]
        note_row(ask, count, owner, wanted - now[axis])
        count += 1
    rows, down_to = ask[0][count - row.axes : count], min(asked.shape[0] + level, chain[0].shape[0] - 1)
    set_balance_rows(row.axes, body[1], sums, chain[1], positions, rows)
    for c in range(asked.shape[0]):
        other = asked[c]
        if other.kind == POSITION and other.wanted == 1 and other.rank <= level and not other.second:
            limb = other.ends[0, 2]
            if not 0 <= limb < 2 or other.freedoms[0, 0] == 0.0:
                continue
            if not may_turn(down_to, limb_indices(limb, spine_count)[1], chain):
                let_arm_reach(limb, row.axes, other.places[0], other.reaches[0], sums, chain[1], positions, rows)
    return count


@kernel
def add_idle_row(c, level, end, owner, count, asked, ask, chain, point, pose):
    """Hold what an arm misses that is not asked for it any more, and goes as it lies with what carries it.

    Where another constraint poses it, what that does to the miss is only seen in the end.
    """
    row = asked[c]
    if row.kind != POSITION or row.ends[end, 2] >= 2:
        return count
    for other in asked:
        poses = other.ends[0, 2] == row.ends[end, 2] or other.ends[1, 2] == row.ends[end, 2]
        if poses and other.wanted == 1 and other.rank <= level:
            return count
    end_place(row, end, pose, point)
    goal = row.places[end]
    x, y, z = goal[0] - point[0], goal[1] - point[1], goal[2] - point[2]
    size = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    begin_row(ask, count, owner, size - row.kept_miss)
    add_point_row(point, x / size, y / size, z / size, row.ends[end, 1], chain[1], pose[0], ask[0][count])
    note_pull(ask[5][count], 0.0, 0.0, 0.0, 0.0, point, row.ends[end, 1])
    return count + 1


@kernel
def add_place_rows(row, end, owner, is_held, count, ask, chain, points, pose):
    """Three rows that bring a point of the trunk, or of a limb that is not free, to its place."""
    point = points[0]
    end_place(row, end, pose, point)
    wanted = row.kept_places[end] if is_held else row.places[end]
    segment = row.ends[end, 1]
    first, follows = count, row.kind == POSITION and row.ends[1, 0] >= 0
    if is_held and not follows and holds_already(point, segment, count, ask):
        return count
    if row.kind == POSITION and end == 0 and not is_held:
        wanted = points[1]
        within_means(row, wanted)
    x, y, z = wanted[0] - point[0], wanted[1] - point[1], wanted[2] - point[2]
    if is_held and follows:
        now, kept, share = points[1], row.kept_places[1], row.share
        end_place(row, 1, pose, now)
        x, y, z = x + share * (now[0] - kept[0]), y + share * (now[1] - kept[1]), z + share * (now[2] - kept[2])
    count = add_point_rows(point, segment, x, y, z, owner, count, ask, chain, pose[0])
    if not (is_held and follows):
        note_pull(ask[5][first], x, y, z, 0.0, point, segment)
    if follows:
        end_place(row, 1, pose, point)
        for axis in range(3):
            x, y, z = (1.0 if axis == 0 else 0.0), (1.0 if axis == 1 else 0.0), (1.0 if axis == 2 else 0.0)
            x, y, z = -row.share * x, -row.share * y, -row.share * z
            add_point_row(point, x, y, z, row.ends[1, 1], chain[1], pose[0], ask[0][first + axis])
    return count


@kernel
def holds_already(point, carrier, count, ask):
    """Whether a higher constraint holds the same point: the same three rows once more would say nothing."""
    for row in range(count):
        pull = ask[5][row]
        same = pull[7] == carrier and pull[3] == 0.0 and ask[3][row] == HOLD
        if same and pull[4] == point[0] and pull[5] == point[1] and pull[6] == point[2]:
            return True
    return False


@kernel
def add_point_rows(point, segment, x, y, z, owner, count, ask, chain, positions):
    """Three rows that move a point by (x, y, z)."""
    for axis in range(3):
        begin_row(ask, count, owner, x if axis == 0 else (y if axis == 1 else z))
        along_x, along_y = 1.0 if axis == 0 else 0.0, 1.0 if axis == 1 else 0.0
        along_z = 1.0 if axis == 2 else 0.0
        add_point_row(point, along_x, along_y, along_z, segment, chain[1], positions, ask[0][count])
        count += 1
    return count


@kernel
def aim_limb(row, end, is_held, holds_end, points, pose):
    """Where the limb itself must bring what it bends: the goal, or the wrist's or ankle's part of it, as (x, y, z).

    ``points[0]`` becomes the point that the limb moves there.
    """
    wanted = row.kept_places[end] if is_held else row.places[end]
    root, upper = limb_indices(row.ends[end, 2], pose[0].shape[0] - 23)
    point, tip = points[0], pose[0][root + 2]
    end_place(row, end, pose, point)
    x, y, z = wanted[0], wanted[1], wanted[2]
    if holds_end and row.ends[end, 1] >= upper + 2:
        x, y, z = x + tip[0] - point[0], y + tip[1] - point[1], z + tip[2] - point[2]
        copy_point(tip, point)
    return x, y, z


@kernel
def add_reach_rows(c, row, end, owner, is_held, count, ask, chain, grips, limits, points, pose):
    """A limb as a link of variable length: its root nears the goal by what the limb falls short (METHOD 6, (18)).

    Held, it is a bound: the root may go wherever the limb still reaches; if the limb falls short, it stays. A limb
    that its ``limits`` keep from its goal is carried there, as it lies, along what it misses (29); a thigh that stands
    on its knee has to be as far from there as it is long as well.
    """
    positions = pose[0]
    limb = row.ends[end, 2]
    root, upper = limb_indices(limb, positions.shape[0] - 23)
    carrier = 0 if limb >= 2 else upper - 1
    shoulder = positions[root]
    ax, ay, az = aim_limb(row, end, is_held, limb >= 2 or grips[limb] >= 0, points, pose)
    x, y, z = ax - shoulder[0], ay - shoulder[1], az - shoulder[2]
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    per = 1.0 / span
    x, y, z = per * x, per * y, per * z
    reach, fold = row.reaches[end], min(row.folds[end], row.reaches[end])
    second = row.second and row.kept_miss <= HARDLY_MISSED
    if limits.shape[0] > 0 and (limits[limb].acts == c + 1 or (second and limits[limb].acts > 0)):
        before = count
        count = add_limited_row(row, end, owner, is_held, count, ask, chain, (ax, ay, az), points, pose)
        if not is_held:
            return count
        if count > before and row.kept_miss <= CLOSE_ENOUGH and reach - fold > CLOSE_ENOUGH:
            return count
    if row.stiff:
        fold = max(fold, row.own[end] - row.most[end, 1])
        reach = max(min(reach, row.own[end] + row.most[end, 1]), fold)
    if not is_held:
        slack = row.slack[end]
        error = span - min(max(span, fold + min(slack, 0.0)), reach + max(slack, 0.0))
        if error == 0.0:
            return count
        begin_row(ask, count, owner, error)
        add_point_row(shoulder, x, y, z, carrier, chain[1], positions, ask[0][count])
        pull = min(max(error, -LONGEST_ERROR), LONGEST_ERROR)
        along = math.copysign(span, error)
        note_pull(ask[5][count], pull * x, pull * y, pull * z, along, shoulder, carrier)
        return count + 1
    if row.kept_miss > HARDLY_MISSED:
        if holds_already(shoulder, carrier, count, ask):
            return count
        held = min(row.kept_miss / MISSED, 1.0)
        kept, first = row.kept_roots[end], count
        x, y, z = kept[0] - shoulder[0], kept[1] - shoulder[1], kept[2] - shoulder[2]
        count = add_point_rows(shoulder, carrier, x, y, z, owner, count, ask, chain, positions)
        note_pull(ask[5][first], x, y, z, 0.0, shoulder, carrier)
        for other in range(first, count):
            ask[1][other] *= held
            for joint in range(ask[0].shape[1]):
                for axis in range(3):
                    ask[0][other, joint, axis] *= held
        return count
    side = 1.0 if reach - span < span - fold else -1.0
    begin_row(ask, count, owner, span - reach if side > 0.0 else fold - span)
    ask[3][count] = BOUND if reach - fold > CLOSE_ENOUGH else HOLD
    note_pull(ask[5][count], side * x, side * y, side * z, side * span, shoulder, carrier)
    add_point_row(shoulder, side * x, side * y, side * z, carrier, chain[1], positions, ask[0][count])
    return count + 1


@kernel
def add_apart_row(c, owner, count, asked, ask, chain, limits, points, pose):
    """Hold what is missed between two points of the body: limbs are links of their length from their roots, or, where
    limits keep them from more, as if stiff.
    """
    row, first, second = asked[c], points[0], points[1]
    end_place(row, 0, pose, first)
    end_place(row, 1, pose, second)
    goal = row.places[0] if row.kind == POSITION else second
    x, y, z = goal[0] - first[0], goal[1] - first[1], goal[2] - first[2]
    size = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    more = size if row.kind == POSITION else size - row.distance
    scale = math.copysign(1.0 / size, more)
    x, y, z = scale * x, scale * y, scale * z
    begin_row(ask, count, owner, abs(more) - row.kept_miss)
    for end in range(2):
        point, carrier, limb = points[end], row.ends[end, 1], row.ends[end, 2]
        if limb >= 0 and row.freedoms[end, 0] > 0.0 and not (limits.shape[0] > 0 and limits[limb].acts == c + 1):
            root, upper = limb_indices(limb, pose[0].shape[0] - 23)
            point, carrier = pose[0][root], (0 if limb >= 2 else upper - 1)
        part = 1.0 if end == 0 else -(row.share if row.kind == POSITION else 1.0)
        add_point_row(point, part * x, part * y, part * z, carrier, chain[1], pose[0], ask[0][count])
    return count + 1


@kernel
def first_of(c, asked):
    """The place that the limb of a second wish has to bring its point to first, -1 for none."""
    for before in range(c):
        first = asked[before]
        same = first.kind == POSITION and first.wanted == 1 and first.ends[0, 2] == asked[c].ends[0, 2]
        if same and first.freedoms[0, 0] > 0.0:
            return before
    return -1


@kernel
def add_second_row(c, owner, count, asked, ask, chain, points, pose):
    """A limb's second wish for its elbow or knee: the root nears its place by what the upper bone does not span.

    The place is the nearest to what is wanted that is as far from the first wish's point as the bone between them is
    long: the swivel about the axis to there (16) does the rest.
    """
    row, point, held, first = asked[c], points[0], points[1], first_of(c, asked)
    root, upper = limb_indices(row.ends[0, 2], pose[0].shape[0] - 23)
    if first < 0 or row.ends[0, 1] != upper or asked[first].ends[0, 1] == upper or row.stiff or row.freedoms[0, 0] == 0:
        return count
    shoulder, goal = pose[0][root], row.places[0]
    end_place(row, 0, pose, point)
    end_place(asked[first], 0, pose, held)
    part = distance(point, held) / max(distance(goal, held), 1e-9)
    x = held[0] + part * (goal[0] - held[0]) - shoulder[0]
    y = held[1] + part * (goal[1] - held[1]) - shoulder[1]
    z = held[2] + part * (goal[2] - held[2]) - shoulder[2]
    span = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    error = span - distance(point, shoulder)
    if abs(error) < CLOSE_ENOUGH:
        return count
    x, y, z, carrier = x / span, y / span, z / span, 0 if row.ends[0, 2] >= 2 else upper - 1
    begin_row(ask, count, owner, error)
    add_point_row(shoulder, x, y, z, carrier, chain[1], pose[0], ask[0][count])
    pull = min(max(error, -LONGEST_ERROR), LONGEST_ERROR)
    note_pull(ask[5][count], pull * x, pull * y, pull * z, math.copysign(span, error), shoulder, carrier)
    return count + 1


@kernel
def add_swivel_row(c, end, owner, count, asked, ask, chain, points, pose):
    """Hold what a limb's second wish misses, where the swivel that its first leaves was not to be had.

    It begins at the motion's own and ends at limits: it goes with what carries the limb about the axis from its root to
    its first point.
    """
    row, point, held = asked[c], points[0], points[1]
    limb, goal = row.ends[end, 2], row.places[end]
    end_place(asked[first_of(c, asked)], 0, pose, held)
    root, upper = limb_indices(limb, pose[0].shape[0] - 23)
    origin = pose[0][root]
    end_place(row, end, pose, point)
    ax, ay, az = held[0] - origin[0], held[1] - origin[1], held[2] - origin[2]
    x, y, z = goal[0] - point[0], goal[1] - point[1], goal[2] - point[2]
    px, py, pz = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    size = math.sqrt(x * x + y * y + z * z)
    scale = STEEP / max((ax * ax + ay * ay + az * az) * size, 1e-12)
    arm = scale * (ax * (py * z - pz * y) + ay * (pz * x - px * z) + az * (px * y - py * x))
    if arm * arm * (ax * ax + ay * ay + az * az) < SWIVELS**2:
        return count
    begin_row(ask, count, owner, size - row.kept_miss)
    carrier = 0 if limb >= 2 else upper - 1
    add_turn_row(0, arm * ax, carrier, chain[1], ask[0][count])
    add_turn_row(1, arm * ay, carrier, chain[1], ask[0][count])
    add_turn_row(2, arm * az, carrier, chain[1], ask[0][count])
    return count + 1


@kernel
def add_limited_row(row, end, owner, is_held, count, ask, chain, wanted, points, pose):
    """Carry a limb that lies at a limit along what it misses (29): to the first order as if it were stiff.

    Held, it keeps the miss that it had. ``points[0]`` is the point that is to be at ``wanted`` (3,).
    """
    limb, point, goal = row.ends[end, 2], points[0], row.places[end]
    x, y, z, kept = wanted[0] - point[0], wanted[1] - point[1], wanted[2] - point[2], 0.0
    if is_held and row.kept_miss > CLOSE_ENOUGH:
        end_place(row, end, pose, points[1])
        x, y, z, kept = goal[0] - points[1, 0], goal[1] - points[1, 1], goal[2] - points[1, 2], row.kept_miss
    size = math.sqrt(x * x + y * y + z * z)
    if size < CLOSE_ENOUGH:
        return count
    root, upper = limb_indices(limb, pose[0].shape[0] - 23)
    carrier = 0 if limb >= 2 else upper - 1
    x, y, z, error = x / size, y / size, z / size, size - kept
    begin_row(ask, count, owner, error)
    add_point_row(point, x, y, z, carrier, chain[1], pose[0], ask[0][count])
    pull = min(max(error, -LONGEST_ERROR), LONGEST_ERROR)
    radius = radius_of_reach(x, y, z, point, pose[0][root])
    centre = points[1]
    centre[0], centre[1], centre[2] = point[0] - radius * x, point[1] - radius * y, point[2] - radius * z
    note_pull(ask[5][count], pull * x, pull * y, pull * z, radius + size, centre, carrier)
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
