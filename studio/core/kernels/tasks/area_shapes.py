"""Shapes of restricted areas, and the nearest allowed position of a point (METHOD 7, "area").

An ``area`` is a row of numbers with the columns ``AREA_SHAPE`` to ``AREA_ROTATION``.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import compose, rotation_from_matrix
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import end_position, interpolate_point
from studio.core.kernels.tasks.mesh_distance_field import nearest_allowed_in_field, nearest_beyond_margin

HALF_SPACE_SHAPE, BOX_SHAPE, SPHERE_SHAPE, CYLINDER_SHAPE, TABLE_SHAPE, MESH_SHAPE, LINE_SHAPE = range(7)
"""Values of column ``AREA_SHAPE``."""
OUTSIDE_AREA, INSIDE_AREA, ON_AREA_SURFACE = 0, 1, 2
"""Values of column ``AREA_SIDE``, the side of the shape on which a point is allowed."""
(
    AREA_SHAPE, AREA_SIDE, CENTRE_X, CENTRE_Y, CENTRE_Z, SIZE_X, SIZE_Y, SIZE_Z, AREA_MARGIN, AREA_ROTATION,
) = range(10)  # fmt: skip
"""Columns of an area; the last is the first of nine with its rotation (3, 3), row by row. The size of a half-space is
its normal, that of a line half of its extent, both as vectors; other sizes are extents in metres. The margin is the
distance in metres from the shape that a point outside keeps.
"""
AREA_NUMBERS = AREA_ROTATION + 9
"""Number of columns of an area. The distance field of a mesh follows them, in the area's own space
(``kernels.tasks.mesh_distance_field``).
"""

TABLE_EDGE_WIDTH = 0.1
"""Distance in metres from a table's edge within which its outward direction turns sideways, so that a hand from the
side does not pop, and from its lower face within which the direction turns downwards.
"""
MARGIN_BISECTIONS = 32
"""Number of bisections of a path by which the end of a margin is found."""
AREA_ENGAGED_DEPTH = 1e-6
"""Depth in metres of a point in an area from which its task is engaged."""


@kernel
def set_area_pose(row, area, centre, rotation):
    """Set the position and rotation of an ``area``, and the activation of its task ``row``, at this frame."""
    row.goal_distance = row.activation
    copy_matrix(rotation, row.goal_rotation)
    place_area(area, centre, row.goal_rotation)


@kernel
def follow_area(row, area, pose):
    """Move an ``area`` with the point of the own body that its task follows, and rotate it by the heading of that
    point's segment.
    """
    rotation = compose(rotation_from_matrix(pose.rotations[row.segments[1]]), rotation_from_matrix(row.relative))
    c, s = rotation[0] + rotation[4], rotation[3] - rotation[1]
    size = max(math.sqrt(c * c + s * s), 1e-9)
    place_area(area, end_position(row, 1, pose), row.goal_rotation)
    for axis in range(AREA_ROTATION, AREA_ROTATION + 3):
        x, y = area[axis], area[axis + 3]
        area[axis], area[axis + 3] = (c * x - s * y) / size, (s * x + c * y) / size


@kernel
def activate_area(row, area, pose):
    """Engage a task whose point is in its ``area``; True if it is.

    The goal becomes the nearest allowed position, or a fraction of the way to it, by activation.
    """
    point = end_position(row, 0, pose)
    depth, position = nearest_allowed_point(area, point)
    if depth > AREA_ENGAGED_DEPTH:
        row.engaged = 1
        copy_point(interpolate_point(point, position, row.goal_distance), row.goal_positions[0])
        return True
    return False


@kernel
def area_residual(row, area, pose):
    """Distance in metres, times the activation, from the task's point to the nearest allowed position, which may differ
    from its goal.
    """
    return row.goal_distance * nearest_allowed_point(area, end_position(row, 0, pose))[0]


@kernel
def place_area(area, centre, rotation):
    """Move an area to ``centre`` (3,) with ``rotation`` (3, 3); nothing moves if the centre is NaN.

    The normal of a half-space and the direction of a line are the first column of their rotation.
    """
    if math.isnan(centre[0]):
        return
    area[CENTRE_X], area[CENTRE_Y], area[CENTRE_Z] = centre[0], centre[1], centre[2]
    if int(area[AREA_SHAPE]) == HALF_SPACE_SHAPE or int(area[AREA_SHAPE]) == LINE_SHAPE:
        size = math.sqrt(area[SIZE_X] ** 2 + area[SIZE_Y] ** 2 + area[SIZE_Z] ** 2)
        for axis in range(3):
            area[SIZE_X + axis] = size * rotation[axis, 0]
        for entry in range(9):
            area[AREA_ROTATION + entry] = 1.0 if entry % 4 == 0 else 0.0
    else:
        for entry in range(9):
            area[AREA_ROTATION + entry] = rotation[entry // 3, entry % 3]


@kernel
def nearest_allowed_point(area, point):
    """(distance in metres, (x, y, z)): the nearest allowed position and its distance, 0 if ``point`` (3,) is
    allowed.
    """
    dx, dy, dz = point[0] - area[CENTRE_X], point[1] - area[CENTRE_Y], point[2] - area[CENTRE_Z]
    turn = area[AREA_ROTATION:]
    x, y, z = (
        turn[0] * dx + turn[3] * dy + turn[6] * dz,
        turn[1] * dx + turn[4] * dy + turn[7] * dz,
        turn[2] * dx + turn[5] * dy + turn[8] * dz,
    )
    side = int(area[AREA_SIDE])
    if int(area[AREA_SHAPE]) == MESH_SHAPE:
        if area[AREA_MARGIN] > 0.0:
            nx, ny, nz = nearest_beyond_margin(area[AREA_NUMBERS:], x, y, z, area[AREA_MARGIN])
        else:
            nx, ny, nz = nearest_allowed_in_field(area[AREA_NUMBERS:], x, y, z, side)
    else:
        nx, ny, nz = nearest_on_shape(area, x, y, z, side == INSIDE_AREA)
        if side == ON_AREA_SURFACE and nx == x and ny == y and nz == z:
            nx, ny, nz = nearest_on_shape(area, x, y, z, True)
    distance = math.sqrt((nx - x) ** 2 + (ny - y) ** 2 + (nz - z) ** 2)
    return distance, (
        area[CENTRE_X] + turn[0] * nx + turn[1] * ny + turn[2] * nz,
        area[CENTRE_Y] + turn[3] * nx + turn[4] * ny + turn[5] * nz,
        area[CENTRE_Z] + turn[6] * nx + turn[7] * ny + turn[8] * nz,
    )


@kernel
def nearest_on_shape(area, x, y, z, inside):
    """Nearest position to (x, y, z) on the allowed side of a shape, in the area's own space; outside, beyond its
    margin.
    """
    shape, margin = int(area[AREA_SHAPE]), area[AREA_MARGIN]
    if shape == HALF_SPACE_SHAPE:
        return nearest_on_half_space(area, x, y, z, inside)
    if shape == LINE_SHAPE:
        return nearest_on_line(x, y, z, area[SIZE_X], area[SIZE_Y], area[SIZE_Z])
    if shape == SPHERE_SHAPE:
        return nearest_on_sphere(x, y, z, 0.5 * area[SIZE_X] + margin, inside)
    a, b, h = 0.5 * area[SIZE_X], 0.5 * area[SIZE_Y], 0.5 * area[SIZE_Z]
    if shape == CYLINDER_SHAPE:
        nx, ny, nz = nearest_on_cylinder(x, y, z, a + margin, h + margin, inside)
    else:
        nx, ny, nz = nearest_on_box(x, y, z, a + margin, b + margin, h + margin, inside, shape == TABLE_SHAPE)
    if margin > 0.0:
        share = fraction_to_margin(area, x, y, z, nx, ny, nz)
        return x + share * (nx - x), y + share * (ny - y), z + share * (nz - z)
    return nx, ny, nz


@kernel
def fraction_to_margin(area, x, y, z, nx, ny, nz):
    """Fraction of the path from (x, y, z) to the allowed position (nx, ny, nz) at which the area's margin is reached.

    The margin is rounded at edges and corners.
    """
    if distance_to_shape(area, x, y, z) >= area[AREA_MARGIN]:
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(MARGIN_BISECTIONS):
        middle = 0.5 * (low + high)
        distance = distance_to_shape(area, x + middle * (nx - x), y + middle * (ny - y), z + middle * (nz - z))
        if distance < area[AREA_MARGIN]:
            low = middle
        else:
            high = middle
    return high


@kernel
def distance_to_shape(area, x, y, z):
    """Distance in metres of (x, y, z) from a box, a table, or a cylinder along z, centred at the origin; 0 inside."""
    a, b, h = 0.5 * area[SIZE_X], 0.5 * area[SIZE_Y], 0.5 * area[SIZE_Z]
    if int(area[AREA_SHAPE]) == CYLINDER_SHAPE:
        level = max(math.sqrt(x * x + y * y) - a, 0.0)
    else:
        level = math.sqrt(max(abs(x) - a, 0.0) ** 2 + max(abs(y) - b, 0.0) ** 2)
    return math.sqrt(level * level + max(abs(z) - h, 0.0) ** 2)


@kernel
def nearest_on_half_space(area, x, y, z, inside):
    """Nearest position to (x, y, z) on the allowed side of the plane through the origin with an area's normal, beyond
    its margin.
    """
    nx, ny, nz = area[SIZE_X], area[SIZE_Y], area[SIZE_Z]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    nx, ny, nz = nx / length, ny / length, nz / length
    height = x * nx + y * ny + z * nz - area[AREA_MARGIN]
    wrong = height > 0.0 if inside else height < 0.0
    if wrong:
        return x - height * nx, y - height * ny, z - height * nz
    return x, y, z


@kernel
def nearest_on_line(x, y, z, a, b, h):
    """Nearest position to (x, y, z) on the line from (-a, -b, -h) to (a, b, h)."""
    fraction = min(max((x * a + y * b + z * h) / (a * a + b * b + h * h), -1.0), 1.0)
    return fraction * a, fraction * b, fraction * h


@kernel
def nearest_on_sphere(x, y, z, radius, inside):
    """Nearest position to (x, y, z) inside, or outside, a sphere about the origin; from its centre straight up."""
    length = math.sqrt(x * x + y * y + z * z)
    if (length > radius) if inside else (length < radius):
        if length < 1e-9:
            return 0.0, 0.0, radius
        return x * radius / length, y * radius / length, z * radius / length
    return x, y, z


@kernel
def nearest_on_cylinder(x, y, z, radius, half, inside):
    """Nearest position to (x, y, z) inside, or outside, a cylinder along z about the origin, of half height
    ``half``.
    """
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
def nearest_on_box(x, y, z, a, b, h, inside, upwards):
    """Nearest position to (x, y, z) inside, or outside, a box about the origin with half extents (a, b, h).

    With ``upwards`` the box is a table: points leave it upwards, sideways near its edges, downwards near its lower
    face.
    """
    if inside:
        return min(max(x, -a), a), min(max(y, -b), b), min(max(z, -h), h)
    if abs(x) >= a or abs(y) >= b or abs(z) >= h:
        return x, y, z
    if upwards and h + z > min(TABLE_EDGE_WIDTH, h):
        return nearest_on_table(x, y, z, a, b, h)
    left, right, over = a - abs(x), b - abs(y), h - abs(z)
    if left <= right and left <= over:
        return (a if x >= 0.0 else -a), y, z
    if right <= over:
        return x, (b if y >= 0.0 else -b), z
    return x, y, (h if z >= 0.0 else -h)


@kernel
def nearest_on_table(x, y, z, a, b, h):
    """Position to which a point (x, y, z) inside a table is pushed: up in the middle, increasingly outwards near the
    edges.

    The result is continuous inside, and equals the point at the top and the sides.
    """
    edge = min(TABLE_EDGE_WIDTH, a, b)
    inner_x, inner_y = min(max(x, edge - a), a - edge), min(max(y, edge - b), b - edge)
    below = max(z - TABLE_EDGE_WIDTH, -h)
    out_x, out_y, up = x - inner_x, y - inner_y, z - below
    far = (h - below) / up
    if out_x != 0.0:
        far = min(far, edge / abs(out_x))
    if out_y != 0.0:
        far = min(far, edge / abs(out_y))
    return inner_x + far * out_x, inner_y + far * out_y, below + far * up
