"""Restricted areas: the nearest allowed place to a point (METHOD 5, "area")."""

import math

from studio.core.kernels.algebra.turns import product, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.distance_field import surface_place
from studio.core.kernels.tasks.goals import ease_goal, end_place

HALF_SPACE, BOX, SPHERE, CYLINDER, TABLE, MESH = 0, 1, 2, 3, 4, 5
"""Shapes of an area."""
OUTSIDE, INSIDE, ON = 0, 1, 2
"""Sides: where the point may be."""
SHAPE, SIDE, CENTRE_X, CENTRE_Y, CENTRE_Z, SIZE_X, SIZE_Y, SIZE_Z, COSINE, SINE = range(10)
"""The numbers of an area; a half-space has its normal for its size, cosine and sine are those of the heading."""
NUMBERS = 10
"""After them comes, for a mesh, its field (``kernels.tasks.distance_field``) in the area's own space."""

EDGE = 0.1
"""Metres from a table's edge within which its push turns outwards, so that a hand coming from the side does not pop,
and from its lower face within which it goes back there.
"""
ENGAGED = 1e-6
"""Metres into a forbidden area from which on a point counts as in it."""


@kernel
def begin_area(row, area, centre, turn):
    """Put an ``area`` where it is at this frame."""
    row.distance = row.share
    copy_matrix(turn, row.turn)
    put_area(area, centre, row.turn)


@kernel
def follow_area(row, area, pose):
    """Put an ``area`` where the point of the own body is that it goes with, headed as that is."""
    turn = product(turn_in(pose.rotations[row.segments[1]]), turn_in(row.relative))
    c, s = turn[0] + turn[4], turn[3] - turn[1]
    size = max(math.sqrt(c * c + s * s), 1e-9)
    put_area(area, end_place(row, 1, pose), row.turn)
    cosine, sine = area[COSINE], area[SINE]
    area[COSINE], area[SINE] = (c * cosine - s * sine) / size, (s * cosine + c * sine) / size


@kernel
def engage_area(row, area, pose):
    """Engage a task whose point is where it may not be: the goal is the nearest place where it may. Whether it is."""
    point = end_place(row, 0, pose)
    depth, place = nearest_allowed(area, point)
    if depth > ENGAGED:
        row.engaged = 1
        copy_point(ease_goal(point, place, row.distance), row.places[0])
        return True
    return False


@kernel
def miss_area(row, area, pose):
    """Metres from its point to the nearest place where that may be, which may be another than it was sent to."""
    return row.distance * nearest_allowed(area, end_place(row, 0, pose))[0]


@kernel
def put_area(area, centre, turn):
    """Move an area (10,) to ``centre`` (3,) and head it as ``turn`` (3, 3) does; a centre of NaN leaves it.

    The normal of a half-space is the first column of its turn.
    """
    if math.isnan(centre[0]):
        return
    area[CENTRE_X], area[CENTRE_Y], area[CENTRE_Z] = centre[0], centre[1], centre[2]
    if int(area[SHAPE]) == HALF_SPACE:
        area[SIZE_X], area[SIZE_Y], area[SIZE_Z], area[COSINE], area[SINE] = (
            turn[0, 0],
            turn[1, 0],
            turn[2, 0],
            1.0,
            0.0,
        )
    else:
        area[COSINE], area[SINE] = turn[0, 0], turn[1, 0]


@kernel
def nearest_allowed(area, point):
    """(metres, (x, y, z)): how far the nearest place is where the point may be, 0 when it may stay, and that place.

    ``area`` (10 or more,) as above; ``point`` (3,) metres.
    """
    x, y, z = point[0] - area[CENTRE_X], point[1] - area[CENTRE_Y], point[2] - area[CENTRE_Z]
    c, s = area[COSINE], area[SINE]
    x, y = c * x + s * y, c * y - s * x
    side = int(area[SIDE])
    if int(area[SHAPE]) == MESH:
        nx, ny, nz = surface_place(area[NUMBERS:], x, y, z, side)
    else:
        nx, ny, nz = place_of(area, x, y, z, side == INSIDE)
        if side == ON and nx == x and ny == y and nz == z:
            nx, ny, nz = place_of(area, x, y, z, True)
    distance = math.sqrt((nx - x) ** 2 + (ny - y) ** 2 + (nz - z) ** 2)
    return distance, (area[CENTRE_X] + c * nx - s * ny, area[CENTRE_Y] + s * nx + c * ny, area[CENTRE_Z] + nz)


@kernel
def place_of(area, x, y, z, inside):
    """Nearest place on the allowed side of a shape, in the area's own space."""
    shape = int(area[SHAPE])
    if shape == HALF_SPACE:
        return half_space(area, x, y, z, inside)
    if shape == SPHERE:
        return round_place(x, y, z, 0.5 * area[SIZE_X], inside)
    if shape == CYLINDER:
        return upright(x, y, z, 0.5 * area[SIZE_X], 0.5 * area[SIZE_Z], inside)
    return box(x, y, z, 0.5 * area[SIZE_X], 0.5 * area[SIZE_Y], 0.5 * area[SIZE_Z], inside, shape == TABLE)


@kernel
def half_space(area, x, y, z, inside):
    """Nearest place on the allowed side of the plane through 0 with the normal of an area."""
    nx, ny, nz = area[SIZE_X], area[SIZE_Y], area[SIZE_Z]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    nx, ny, nz = nx / length, ny / length, nz / length
    height = x * nx + y * ny + z * nz
    wrong = height > 0.0 if inside else height < 0.0
    if wrong:
        return x - height * nx, y - height * ny, z - height * nz
    return x, y, z


@kernel
def round_place(x, y, z, radius, inside):
    """Nearest place within, or outside of, a sphere about 0; from its centre, upwards."""
    length = math.sqrt(x * x + y * y + z * z)
    if (length > radius) if inside else (length < radius):
        if length < 1e-9:
            return 0.0, 0.0, radius
        return x * radius / length, y * radius / length, z * radius / length
    return x, y, z


@kernel
def upright(x, y, z, radius, half, inside):
    """Nearest place within, or outside of, an upright cylinder about 0."""
    length = math.sqrt(x * x + y * y)
    if inside:
        scale = min(1.0, radius / max(length, 1e-9))
        return x * scale, y * scale, min(max(z, -half), half)
    if length >= radius or abs(z) >= half:
        return x, y, z
    if radius - length < half - abs(z):
        scale = radius / max(length, 1e-9)
        return (x * scale, y * scale, z) if length > 1e-9 else (radius, 0.0, z)
    return x, y, half if z >= 0.0 else -half


@kernel
def box(x, y, z, a, b, h, inside, upwards):
    """Nearest place within, or outside of, a box about 0; out of a table upwards, fading at edges and below."""
    if inside:
        return min(max(x, -a), a), min(max(y, -b), b), min(max(z, -h), h)
    if abs(x) >= a or abs(y) >= b or abs(z) >= h:
        return x, y, z
    if upwards and h + z > min(EDGE, h):
        return over_edge(x, y, z, a, b, h)
    left, right, over = a - abs(x), b - abs(y), h - abs(z)
    if left <= right and left <= over:
        return (a if x >= 0.0 else -a), y, z
    if right <= over:
        return x, (b if y >= 0.0 else -b), z
    return x, y, (h if z >= 0.0 else -h)


@kernel
def over_edge(x, y, z, a, b, h):
    """Out of a table: straight up, and near its edge ever more outwards, away from what lies as far within and below.

    Continuous wherever it is inside, and at its top and sides, where a point stays.
    """
    edge = min(EDGE, a, b)
    inner_x, inner_y = min(max(x, edge - a), a - edge), min(max(y, edge - b), b - edge)
    below = max(z - EDGE, -h)
    out_x, out_y, up = x - inner_x, y - inner_y, z - below
    far = (h - below) / up
    if out_x != 0.0:
        far = min(far, edge / abs(out_x))
    if out_y != 0.0:
        far = min(far, edge / abs(out_y))
    return inner_x + far * out_x, inner_y + far * out_y, below + far * up
