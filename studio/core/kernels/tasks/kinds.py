"""The kinds of task: what each asks at a frame, where that is now, and by how much it is missed.

Each kind's own file has these; a new kind stands in each list here, in ``kernels.tasks.rows`` and in
``solver/asking/kinds``.
"""

from studio.core.kernels.algebra.turns import turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.areas import begin_area, engage_area, follow_area, miss_area
from studio.core.kernels.tasks.balance import begin_balance, follow_balance, miss_balance, pin_balance
from studio.core.kernels.tasks.distance import begin_distance, follow_distance, length_between, miss_distance
from studio.core.kernels.tasks.goals import (
    AREA,
    BALANCE,
    DISTANCE,
    LOOK_AT,
    ORIENTATION,
    POSITION,
    UPRIGHT,
    counts,
    end_place,
    goes_with_body,
)
from studio.core.kernels.tasks.look_at import begin_look, follow_look, pin_look
from studio.core.kernels.tasks.orientation import begin_orientation, follow_orientation, miss_turn
from studio.core.kernels.tasks.position import begin_position, follow_position, miss_position, pin_position
from studio.core.kernels.tasks.task import ACTIVE, FREE
from studio.core.kernels.tasks.upright import begin_upright, follow_upright, miss_upright, pin_upright


@kernel
def begin_goal(c, frame, targets, problem):
    """What a constraint asks at a frame: between the unsolved pose and its target, by its share (METHOD 5)."""
    row, area, start = problem.tasks[c], problem.areas[c], problem.start
    place = targets.places[c, frame if targets.places.shape[1] > 1 else 0]
    turn = targets.turns[c, frame if targets.turns.shape[1] > 1 else 0]
    number = targets.distances[c, frame if targets.distances.shape[1] > 1 else 0]
    if row.kind == ORIENTATION:
        begin_orientation(row, turn_in(turn), start)
    elif row.kind == BALANCE:
        begin_balance(row, place, problem.body.shares, start)
    elif row.kind == LOOK_AT:
        begin_look(row, place, start)
    elif row.kind == UPRIGHT:
        begin_upright(row, place, number, start)
    elif row.kind == AREA:
        begin_area(row, area, place, turn)
    elif row.kind == DISTANCE:
        begin_distance(row, place, number, start)
    else:
        begin_position(row, place, start)
    if goes_with_body(row):
        follow_body(c, problem)


@kernel
def follow(level, solved, problem):
    """Goals that depend on where things are now: both ends of distances, areas, the line of sight, what is followed on
    the own body (METHOD 5). Once limbs are ``solved``, those that depend on where the limbs have come to be.
    """
    tasks, pose = problem.tasks, problem.pose
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if not counts(row) or row.rank > level:
            continue
        if goes_with_body(row):
            follow_body(c, problem)
        if row.kind == DISTANCE and not solved:
            follow_distance(row, pose)
        elif row.kind == LOOK_AT:
            follow_look(row, pose)
        elif row.kind == UPRIGHT:
            follow_upright(row, pose)
        elif row.kind == AREA and row.status == ACTIVE and not row.engaged and not solved:
            engage_area(row, problem.areas[c], pose)


@kernel
def follow_body(c, problem):
    """Bring what a constraint asks to where the point or segment is now that it follows on its own body."""
    row, start, pose = problem.tasks[c], problem.start, problem.pose
    if row.kind == POSITION:
        follow_position(row, start, pose)
    elif row.kind == ORIENTATION:
        follow_orientation(row, start, pose)
    elif row.kind == LOOK_AT:
        copy_point(end_place(row, 1, pose), row.places[0])
    elif row.kind == BALANCE:
        follow_balance(row, pose)
    else:
        follow_area(row, problem.areas[c], pose)


@kernel
def miss_of(c, problem):
    """By how much a constraint is missed now: metres, or radians for an orientation, a look or an axis."""
    row, pose = problem.tasks[c], problem.pose
    if row.kind == UPRIGHT:
        return miss_upright(row, pose)
    if row.kind == ORIENTATION or row.kind == LOOK_AT:
        return miss_turn(row, pose)
    if row.kind == BALANCE:
        return miss_balance(row, problem.body.shares, pose)
    if row.kind == DISTANCE:
        return miss_distance(row, pose)
    if row.kind == AREA:
        return miss_area(row, problem.areas[c], pose)
    return miss_position(row, pose)


@kernel
def pin_goal(c, above):
    """Ask of a constraint what it has in the pose ``above``."""
    row, pose = above.tasks[c], above.pose
    if row.kind == DISTANCE:
        row.distance = length_between(row, pose)
    elif row.kind == POSITION:
        pin_position(row, pose)
    elif row.kind == ORIENTATION and row.points[1] < 0:
        copy_matrix(pose.rotations[row.segments[0]], row.turn)
    elif row.kind == UPRIGHT:
        pin_upright(row, pose)
    elif row.kind == BALANCE and row.points[1] < 0:
        pin_balance(row, above.body.shares, pose)
    else:
        row.engaged = 0
        follow(row.rank, False, above)
        row.pinned, row.blended_miss = FREE, miss_of(c, above)
        if row.kind == LOOK_AT:
            pin_look(row, pose)
