"""Signed distance field of a triangle mesh: measured on a grid, evaluated as a smooth spline (METHOD 7).

A *field* is one row of numbers: its origin (3), cell size, counts along x, y and z, then the coefficients of a cubic
B-spline through the distances at the nodes, x slowest. The spline has continuous second derivatives, so that the
nearest surface point moves smoothly over edges; it rounds them by a fraction of a cell.
"""

import math

import numpy as np

from studio.core.kernels.compiling import allocating_kernel, kernel

FIELD_ORIGIN, FIELD_CELL, FIELD_COUNTS, FIELD_HEADER = 0, 3, 4, 7
"""Columns of a field: origin (3), cell size and counts (3); ``FIELD_HEADER`` numbers come before the coefficients."""
SURFACE_STEPS = 12
"""Greatest number of Newton steps along the gradient of a field to its surface."""


@kernel
def nearest_on_triangle(p, a, b, c):
    """(v, w, feature) of the point a + v (b - a) + w (c - a) of a triangle that is nearest to ``p`` (3,).

    The feature on which the point lies is 0 for the face, 1 to 3 for edge ab, bc, ca, 4 to 6 for corner a, b, c. By the
    regions of Ericson, Real-Time Collision Detection (2005), 5.1.5.
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    px, py, pz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    d1, d2 = ux * px + uy * py + uz * pz, vx * px + vy * py + vz * pz
    if d1 <= 0.0 and d2 <= 0.0:
        return 0.0, 0.0, 4
    d3, d4 = d1 - uu, d2 - uv
    if d3 >= 0.0 and d4 <= d3:
        return 1.0, 0.0, 5
    at_c = d1 * d4 - d3 * d2
    if at_c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return d1 / (d1 - d3), 0.0, 1
    d5, d6 = d1 - uv, d2 - vv
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 1.0, 6
    at_b = d5 * d2 - d1 * d6
    if at_b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return 0.0, d2 / (d2 - d6), 3
    at_a = d3 * d6 - d5 * d4
    if at_a <= 0.0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / (d4 - d3 + d5 - d6)
        return 1.0 - w, w, 2
    total = at_a + at_b + at_c
    return at_b / total, at_c / total, 0


@kernel
def signed_distance(p, triangle, corners, normals):
    """Signed distance of a point ``p`` (3,) from a triangle, negative behind the normal of its nearest feature.

    With angle-weighted normals (T, 7, 3) the sign is right for every closed mesh (Baerentzen 2005).
    """
    a, b, c = corners[triangle, 0], corners[triangle, 1], corners[triangle, 2]
    v, w, fraction = nearest_on_triangle(p, a, b, c)
    u = 1.0 - v - w
    x = p[0] - u * a[0] - v * b[0] - w * c[0]
    y = p[1] - u * a[1] - v * b[1] - w * c[1]
    z = p[2] - u * a[2] - v * b[2] - w * c[2]
    normal = normals[triangle, fraction]
    away = math.sqrt(x * x + y * y + z * z)
    return away if x * normal[0] + y * normal[1] + z * normal[2] >= 0.0 else -away


@allocating_kernel
def measure_near(corners, normals, origin, cell, band, out_distances, out_owners):
    """Write the signed distances at the nodes of a grid (X, Y, Z) within ``band`` cells of any triangle, and the index
    of the nearest triangle.

    ``corners`` (T, 3, 3), ``normals`` (T, 7, 3); nodes farther away are not changed.
    """
    p = np.empty(3)
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for t in range(corners.shape[0]):
        for axis in range(3):
            least = min(corners[t, 0, axis], corners[t, 1, axis], corners[t, 2, axis])
            most = max(corners[t, 0, axis], corners[t, 1, axis], corners[t, 2, axis])
            low[axis] = max(math.floor((least - origin[axis]) / cell) - band + 1, 0)
            high[axis] = min(math.ceil((most - origin[axis]) / cell) + band, out_distances.shape[axis])
        for i in range(low[0], high[0]):
            for j in range(low[1], high[1]):
                for k in range(low[2], high[2]):
                    p[0], p[1], p[2] = origin[0] + i * cell, origin[1] + j * cell, origin[2] + k * cell
                    found = signed_distance(p, t, corners, normals)
                    if abs(found) < abs(out_distances[i, j, k]):
                        out_distances[i, j, k], out_owners[i, j, k] = found, t


@allocating_kernel
def measure_far(corners, normals, origin, cell, far, owners, distances):
    """Write the signed distances at the nodes that are ``far`` (X, Y, Z) from all triangles.

    ``owners`` (X, Y, Z) is a guess of the nearest triangle of each node; in sweeps forwards and backwards each node
    tries those of its neighbours.
    """
    p = np.empty(3)
    x, y, z = distances.shape
    for sweep in range(3):
        for n in range(x * y * z):
            m = n if sweep % 2 == 0 else x * y * z - 1 - n
            i, j, k = m // (y * z), m // z % y, m % z
            if not far[i, j, k]:
                continue
            p[0], p[1], p[2] = origin[0] + i * cell, origin[1] + j * cell, origin[2] + k * cell
            if sweep == 0:
                distances[i, j, k] = signed_distance(p, owners[i, j, k], corners, normals)
                continue
            for axis in range(3):
                for sweep_direction in (-1, 1):
                    u, v, w = (
                        i + sweep_direction * (axis == 0),
                        j + sweep_direction * (axis == 1),
                        k + sweep_direction * (axis == 2),
                    )
                    if u < 0 or v < 0 or w < 0 or u >= x or v >= y or w >= z or owners[u, v, w] == owners[i, j, k]:
                        continue
                    found = signed_distance(p, owners[u, v, w], corners, normals)
                    if abs(found) < abs(distances[i, j, k]):
                        distances[i, j, k], owners[i, j, k] = found, owners[u, v, w]


@kernel
def spline_weights(t, out_weights):
    """Write the weights (4,) of a cubic B-spline and their derivatives (4,), at ``t`` from 0 to 1 between two nodes,
    into (2, 4).
    """
    s = 1.0 - t
    out_weights[0, 0], out_weights[0, 3] = s * s * s / 6.0, t * t * t / 6.0
    out_weights[0, 1] = 2.0 / 3.0 - 0.5 * t * t * (2.0 - t)
    out_weights[0, 2] = 2.0 / 3.0 - 0.5 * s * s * (2.0 - s)
    out_weights[1, 0], out_weights[1, 3] = -0.5 * s * s, 0.5 * t * t
    out_weights[1, 1] = t * (1.5 * t - 2.0)
    out_weights[1, 2] = -s * (1.5 * s - 2.0)


@allocating_kernel
def distance_at(field, x, y, z, weights, out_slope):
    """Signed distance at (x, y, z), and its gradient, which is written into ``out_slope`` (3,).

    Outside the grid it is the value at the edge. ``weights`` (3, 2, 4) is scratch.
    """
    cell = field[FIELD_CELL]
    ny, nz = int(field[FIELD_COUNTS + 1]), int(field[FIELD_COUNTS + 2])
    first = np.empty(3, np.int64)
    for axis in range(3):
        coordinate = ((x, y, z)[axis] - field[FIELD_ORIGIN + axis]) / cell
        count = int(field[FIELD_COUNTS + axis])
        coordinate = min(max(coordinate, 1.0), count - 2.001)
        first[axis] = int(coordinate) - 1
        spline_weights(coordinate - (first[axis] + 1), weights[axis])
    distance = 0.0
    out_slope[:] = 0.0
    for i in range(4):
        for j in range(4):
            start = FIELD_HEADER + ((first[0] + i) * ny + first[1] + j) * nz + first[2]
            value, slope = 0.0, 0.0
            for k in range(4):
                value += weights[2, 0, k] * field[start + k]
                slope += weights[2, 1, k] * field[start + k]
            w = weights[0, 0, i] * weights[1, 0, j]
            distance += w * value
            out_slope[0] += weights[0, 1, i] * weights[1, 0, j] * value / cell
            out_slope[1] += weights[0, 0, i] * weights[1, 1, j] * value / cell
            out_slope[2] += w * slope / cell
    return distance


@allocating_kernel
def nearest_allowed_in_field(field, x, y, z, side):
    """Nearest position to (x, y, z) outside the mesh (``side`` 0), inside (1) or on its surface (2).

    From outside the grid the descent begins where the line to the result enters the grid, found iteratively.
    """
    weights, slope = np.empty((3, 2, 4)), np.empty(3)
    inside = fraction_within_grid(field, x, y, z, x, y, z) == 1.0
    if side != 2:
        out = not inside or distance_at(field, x, y, z, weights, slope) >= 0.0
        if out == (side == 0):
            return x, y, z
    if inside:
        return descend_to_surface(field, x, y, z, weights, slope)
    qx, qy, qz = clamp_to_grid(field, 0, x), clamp_to_grid(field, 1, y), clamp_to_grid(field, 2, z)
    qx, qy, qz = descend_to_surface(field, qx, qy, qz, weights, slope)
    for _ in range(3):
        t = fraction_within_grid(field, x, y, z, qx, qy, qz)
        qx, qy, qz = descend_to_surface(field, qx + t * (x - qx), qy + t * (y - qy), qz + t * (z - qz), weights, slope)
    return qx, qy, qz


@allocating_kernel
def nearest_beyond_margin(field, x, y, z, margin):
    """Nearest position to (x, y, z) that is ``margin`` metres outside the mesh, along the normal of its nearest surface
    point.
    """
    weights, slope = np.empty((3, 2, 4)), np.empty(3)
    qx, qy, qz = nearest_allowed_in_field(field, x, y, z, 2)
    distance_at(field, qx, qy, qz, weights, slope)
    steep = max(math.sqrt(slope[0] ** 2 + slope[1] ** 2 + slope[2] ** 2), 0.5)
    if (x - qx) * slope[0] + (y - qy) * slope[1] + (z - qz) * slope[2] >= margin * steep:
        return x, y, z
    scale = margin / steep
    return qx + scale * slope[0], qy + scale * slope[1], qz + scale * slope[2]


@kernel
def clamp_to_grid(field, axis, coordinate):
    """Coordinate clamped to the range of the grid along ``axis``."""
    return min(
        max(coordinate, field[FIELD_ORIGIN + axis] + field[FIELD_CELL]),
        field[FIELD_ORIGIN + axis] + field[FIELD_CELL] * (field[FIELD_COUNTS + axis] - 2.0),
    )


@kernel
def fraction_within_grid(field, x, y, z, fx, fy, fz):
    """Fraction within the grid of the line from a position (fx, fy, fz) inside it to (x, y, z)."""
    fraction = 1.0
    for axis in range(3):
        low, high = (
            field[FIELD_ORIGIN + axis] + field[FIELD_CELL],
            field[FIELD_ORIGIN + axis] + field[FIELD_CELL] * (field[FIELD_COUNTS + axis] - 2.0),
        )
        coordinate, begin = (x, y, z)[axis], (fx, fy, fz)[axis]
        if coordinate > high:
            fraction = min(fraction, max(high - begin, 0.0) / max(coordinate - begin, 1e-12))
        elif coordinate < low:
            fraction = min(fraction, max(begin - low, 0.0) / max(begin - coordinate, 1e-12))
    return fraction


@kernel
def descend_to_surface(field, px, py, pz, weights, slope):
    """Position on the surface of the mesh, found by Newton steps along the field's gradient from (px, py, pz)."""
    for _ in range(SURFACE_STEPS):
        distance = distance_at(field, px, py, pz, weights, slope)
        steep = slope[0] ** 2 + slope[1] ** 2 + slope[2] ** 2
        scale = distance / max(steep, 0.25)
        px, py, pz = px - scale * slope[0], py - scale * slope[1], pz - scale * slope[2]
        if abs(distance) < 1e-8:
            break
    return px, py, pz
