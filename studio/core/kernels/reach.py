"""Reaching with one limb: bend elbow or knee to the right distance, aim from shoulder or hip, swivel between.

A limb with a point fixed anywhere below its middle joint is a link of variable length: the distance from its
root to the point depends on the bend alone, the direction on the aim alone. Both have closed forms.
"""

import math

from studio.core.kernels.body import turn_part
from studio.core.kernels.compiling import kernel
from studio.core.kernels.rotation import rotation_vector_to_matrix, shortest_arc

SWIVEL_LEVER = 0.08 * 0.08
"""Square metres of lever (point times target, from the axis) above which a swivel is not faded."""


@kernel
def bend_range(root, middle, hinge, point):
    """How the distance root-point depends on the bend: (c0, c1, angle now), d^2 = c0 - 2 c1 cos(angle).

    ``hinge`` (3,) is the unit axis through ``middle`` about which ``point`` turns. The angle is 0 when the point
    is folded over the root and pi when stretched away from it.
    """
    sx, sy, sz = root[0] - middle[0], root[1] - middle[1], root[2] - middle[2]
    px, py, pz = point[0] - middle[0], point[1] - middle[1], point[2] - middle[2]
    s_along = sx * hinge[0] + sy * hinge[1] + sz * hinge[2]
    p_along = px * hinge[0] + py * hinge[1] + pz * hinge[2]
    sx, sy, sz = sx - s_along * hinge[0], sy - s_along * hinge[1], sz - s_along * hinge[2]
    px, py, pz = px - p_along * hinge[0], py - p_along * hinge[1], pz - p_along * hinge[2]
    ss, pp = sx * sx + sy * sy + sz * sz, px * px + py * py + pz * pz
    c0 = ss + pp + (s_along - p_along) ** 2
    c1 = math.sqrt(ss * pp)
    cross = hinge[0] * (py * sz - pz * sy) + hinge[1] * (pz * sx - px * sz) + hinge[2] * (px * sy - py * sx)
    return c0, c1, math.atan2(cross, px * sx + py * sy + pz * sz)


@kernel
def longest_reach(root, middle, hinge, point):
    """The greatest distance root-point that bending allows, in metres."""
    c0, c1, _ = bend_range(root, middle, hinge, point)
    return math.sqrt(max(0.0, c0 + 2.0 * c1))


@kernel
def bend_to(distance, upper, spine_count, point_index, point, turn, positions, rotations):
    """Turn the lower segments about the hinge until ``point`` lies ``distance`` from the limb's root, or nearest.

    ``upper`` is the limb's upper segment, ``point_index`` its root point; the side to which the limb bends is
    that of its hinge axis (the x axis of the upper segment), which is defined at full stretch too.
    """
    root, middle = positions[point_index], positions[point_index + 1]
    hinge = rotations[upper, :, 0]
    c0, c1, angle = bend_range(root, middle, hinge, point)
    if c1 < 1e-9:
        return
    cosine = min(max((c0 - distance * distance) / (2.0 * c1), -1.0), 1.0)
    wanted = math.acos(cosine)
    if -0.85 * math.pi < angle < 0.0:
        wanted = -wanted
    step = angle - wanted
    rotation_vector_to_matrix(step * hinge[0], step * hinge[1], step * hinge[2], turn)
    turn_part(turn, upper + 1, spine_count, middle, positions, rotations)


@kernel
def aim_at(target, point, segment, spine_count, pivot, turn, positions, rotations):
    """Turn ``segment`` about ``pivot`` so that ``point`` lies in the direction of ``target`` (all (3,))."""
    ax, ay, az = point[0] - pivot[0], point[1] - pivot[1], point[2] - pivot[2]
    bx, by, bz = target[0] - pivot[0], target[1] - pivot[1], target[2] - pivot[2]
    a, b = math.sqrt(ax * ax + ay * ay + az * az), math.sqrt(bx * bx + by * by + bz * bz)
    if a < 1e-9 or b < 1e-9:
        return
    shortest_arc(ax / a, ay / a, az / a, bx / b, by / b, bz / b, turn)
    turn_part(turn, segment, spine_count, pivot, positions, rotations)


@kernel
def swivel_to(target, point, held, segment, spine_count, pivot, turn, positions, rotations):
    """Turn a limb about the axis from its root through the ``held`` point so that ``point`` nears ``target``.

    The second of two priorities on one limb (K05 figure 11): phi = atan2(a.(r x q), r.q), the exact optimum on the
    circle; faded where point or target lies within 8 cm of the axis, where it would whirl (METHOD 6).
    """
    ax, ay, az = held[0] - pivot[0], held[1] - pivot[1], held[2] - pivot[2]
    length = math.sqrt(ax * ax + ay * ay + az * az)
    if length < 1e-9:
        return
    ax, ay, az = ax / length, ay / length, az / length
    rx, ry, rz = point[0] - pivot[0], point[1] - pivot[1], point[2] - pivot[2]
    qx, qy, qz = target[0] - pivot[0], target[1] - pivot[1], target[2] - pivot[2]
    along = rx * ax + ry * ay + rz * az
    rx, ry, rz = rx - along * ax, ry - along * ay, rz - along * az
    along = qx * ax + qy * ay + qz * az
    qx, qy, qz = qx - along * ax, qy - along * ay, qz - along * az
    sine = ax * (ry * qz - rz * qy) + ay * (rz * qx - rx * qz) + az * (rx * qy - ry * qx)
    angle = math.atan2(sine, rx * qx + ry * qy + rz * qz)
    lever = math.sqrt((rx * rx + ry * ry + rz * rz) * (qx * qx + qy * qy + qz * qz))
    t = min(lever / SWIVEL_LEVER, 1.0)
    angle *= t * t * (3.0 - 2.0 * t)
    rotation_vector_to_matrix(angle * ax, angle * ay, angle * az, turn)
    turn_part(turn, segment, spine_count, pivot, positions, rotations)
