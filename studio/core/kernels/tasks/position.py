"""A point at a place, or at a point of its own body."""

from studio.core.kernels.algebra.turns import beside, inverse, put_beside, turn_in
from studio.core.kernels.algebra.vectors import ORIGIN, between, copy_point, distance
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import ease_goal, end_place
from studio.core.kernels.tasks.task import FREE


@kernel
def begin_position(row, target, start):
    """Its goal (METHOD 5, (12)), by how much it acts between where ``start`` has its point and its ``target``."""
    copy_point(ease_goal(end_place(row, 0, start), target, row.share), row.places[0])


@kernel
def follow_position(row, start, pose):
    """Its goal with the point that it follows; where it is pinned, in the axes of that."""
    place = end_place(row, 1, pose)
    if row.pinned == FREE:
        copy_point(ease_goal(end_place(row, 0, start), place, row.share), row.places[0])
    else:
        axes = turn_in(pose.rotations[row.segments[1]])
        put_beside(place, axes, row.relative[0, 0], row.relative[0, 1], row.relative[0, 2], row.places[0])


@kernel
def miss_position(row, pose):
    """Metres from its point to its goal."""
    return distance(end_place(row, 0, pose), row.places[0])


@kernel
def pin_position(row, pose):
    """Ask of it to stay where a ``pose`` has it: in the axes of what it follows on its own body, or in the world."""
    point = end_place(row, 0, pose)
    if row.points[1] < 0:
        copy_point(point, row.places[0])
    else:
        x, y, z = between(end_place(row, 1, pose), point)
        axes = turn_in(pose.rotations[row.segments[1]])
        copy_point(beside(ORIGIN, inverse(axes), x, y, z), row.relative[0])
