"""A segment turned one way, in the world or as a segment of its own body is."""

from studio.core.kernels.algebra.turns import ease_turn, product, put_turn, turn_error, turn_in
from studio.core.kernels.algebra.vectors import length
from studio.core.kernels.compiling import kernel


@kernel
def begin_orientation(row, wanted, start):
    """Its goal: by how much it acts on the shortest way from how ``start`` has its segment to what is ``wanted``."""
    put_turn(ease_turn(turn_in(start.rotations[row.segments[0]]), wanted, row.share), row.turn)


@kernel
def follow_orientation(row, start, pose):
    """Its goal with the segment that it follows."""
    axes = turn_in(pose.rotations[row.segments[1]])
    begin_orientation(row, product(axes, turn_in(row.relative)), start)


@kernel
def miss_turn(row, pose):
    """Radians by which its segment is turned off its goal."""
    return length(turn_error(row.turn, pose.rotations[row.segments[0]]))
