"""What each constraint asks of one frame: places and rotations between the unsolved pose and the target (METHOD 5)."""

from studio.core.kernels.body.parts import body_point
from studio.core.kernels.compiling import small_kernel
from studio.core.kernels.tasks.task import ACTIVE, GIVEN_UP

POSITION = 0
ORIENTATION = 1
DISTANCE = 2
BALANCE = 3
LOOK_AT = 4
AREA = 5
UPRIGHT = 6
"""Kinds as the solver knows them. What else is asked of a kind, beside what it does itself, is asked below."""
TURN_ARM = 0.3
"""Metres that count as one radian where both are weighed together."""


@small_kernel
def counts(row):
    """Whether a constraint acts at this frame: what it has is its own, also where it was given up."""
    return row.status == ACTIVE or row.status == GIVEN_UP


@small_kernel
def brings_point(row):
    """Whether a constraint brings a point of the body somewhere: neither a turn, nor the centre of mass."""
    return row.kind == POSITION or row.kind == DISTANCE or row.kind == AREA


@small_kernel
def asks_place(row):
    """Whether a constraint asks of one point to be at one place."""
    return row.kind == POSITION


@small_kernel
def asks_length(row):
    """Whether a constraint asks how far apart two ends are, wherever these are."""
    return row.kind == DISTANCE


@small_kernel
def moves_mass(row):
    """Whether a constraint brings the centre of mass somewhere, by whatever moves it."""
    return row.kind == BALANCE


@small_kernel
def is_dormant(row):
    """Whether a constraint asks nothing now: an area whose point is where it may be."""
    return row.kind == AREA and not row.engaged


@small_kernel
def has_own_goal(row):
    """Whether a constraint is for a place or a turn that does not depend on where the body is now."""
    return (row.kind == POSITION or row.kind == ORIENTATION or row.kind == BALANCE) and row.points[1] < 0


@small_kernel
def limb_follows(row):
    """Whether a constraint's limb is to have what a point or a segment of the own body has."""
    return (row.kind == POSITION or row.kind == ORIENTATION) and row.points[1] >= 0 and row.limbs[0] >= 0


@small_kernel
def joins_points(row):
    """Whether a constraint is between two points of the body, which both may move."""
    return (row.kind == POSITION or row.kind == DISTANCE) and row.points[1] >= 0


@small_kernel
def goes_with_body(row):
    """Whether what a constraint asks goes with a point or a segment of its own body."""
    return row.kind != DISTANCE and row.points[1] >= 0


@small_kernel
def turns_segment(row):
    """Whether a constraint turns a segment, and its miss is an angle."""
    return row.kind == ORIENTATION or row.kind == LOOK_AT or row.kind == UPRIGHT


@small_kernel
def end_place(row, end, pose):
    """Where one end of a constraint (a record of ``kernels.tasks.task``) is now, (x, y, z)."""
    return body_point(row.points[end], row.segments[end], row.offsets[end], pose.positions, pose.rotations)


@small_kernel
def ease_goal(start, target, share):
    """Goal (x, y, z) between where a point is and where it is to be (METHOD 5, (12): interpolate the target)."""
    return (
        start[0] + share * (target[0] - start[0]),
        start[1] + share * (target[1] - start[1]),
        start[2] + share * (target[2] - start[2]),
    )
