"""Reach of one limb to a point: bend elbow or knee to the right distance, aim from shoulder or hip, then swivel.

A limb with a point fixed anywhere below its middle joint is a link of variable length: the distance from its root to
the point depends on the bend alone, the direction on the aim alone. Both have closed forms.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    IDENTITY,
    compose,
    rotation_about_axis,
    rotation_from_matrix,
    shortest_rotation,
    sine_and_cosine,
    write_rotation,
    write_transformed_point,
)
from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.body.parts import distal_range, rotate_part
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel, small_kernel

SWIVEL_FADE_LEVER = 2.0 * 0.08 * 0.08
"""Product in square metres, of the distances of point and target from the swivel's axis, above which a swivel is not
faded.
"""
SWIVEL_FADE_ANGLE = 0.5 * math.pi
"""Swivel in radians up to which it is not faded. Near half a turn both directions of rotation are equally short."""
HYPEREXTENSION_ANGLE = 0.85 * math.pi
"""Bend in radians, backwards, beyond which a limb counts as overstretched rather than bent backwards."""
COS_HYPEREXTENSION_ANGLE = math.cos(HYPEREXTENSION_ANGLE)
"""Cosine of ``HYPEREXTENSION_ANGLE``."""


@small_kernel
def distance_coefficients(root, middle, hinge, point):
    """Coefficients (c0, c1 cos b, c1 sin b) of the squared distance c0 - 2 c1 cos b from root to point, at the present
    bend b (METHOD (15)).

    ``hinge`` (3,) is the unit axis through ``middle`` about which ``point`` rotates. The bend is 0 when the point is
    folded over the root and pi when stretched away from it.
    """
    hx, hy, hz = hinge[0], hinge[1], hinge[2]
    sx, sy, sz = root[0] - middle[0], root[1] - middle[1], root[2] - middle[2]
    px, py, pz = point[0] - middle[0], point[1] - middle[1], point[2] - middle[2]
    s_along, p_along = sx * hx + sy * hy + sz * hz, px * hx + py * hy + pz * hz
    sx, sy, sz = sx - s_along * hx, sy - s_along * hy, sz - s_along * hz
    px, py, pz = px - p_along * hx, py - p_along * hy, pz - p_along * hz
    squared = sx * sx + sy * sy + sz * sz + px * px + py * py + pz * pz + (s_along - p_along) ** 2
    cross = hx * (py * sz - pz * sy) + hy * (pz * sx - px * sz) + hz * (px * sy - py * sx)
    return squared, px * sx + py * sy + pz * sz, cross


@kernel
def bend_coefficients(root, middle, hinge, point):
    """(c0, c1, b, side): coefficients of the squared distance c0 - 2 c1 cos b from root to point, present bend b in
    radians, and bend direction (METHOD (15)).

    ``side`` is -1 for a backward bend, else 1.
    """
    c0, cosine, sine = distance_coefficients(root, middle, hinge, point)
    angle = math.atan2(sine, cosine)
    side = -1.0 if -HYPEREXTENSION_ANGLE < angle < 0.0 else 1.0
    angle = abs(angle) if angle > -HYPEREXTENSION_ANGLE else angle + 2.0 * math.pi
    return c0, math.sqrt(cosine * cosine + sine * sine), angle, side


@kernel
def distance_range(root, middle, hinge, point):
    """(least, greatest) distance of ``point`` from ``root`` over all bends, in metres (METHOD (15))."""
    c0, cosine, sine = distance_coefficients(root, middle, hinge, point)
    twice = 2.0 * math.sqrt(cosine * cosine + sine * sine)
    return math.sqrt(max(0.0, c0 - twice)), math.sqrt(max(0.0, c0 + twice))


@kernel
def bend_and_aim(target, distance, upper, point_index, point, positions, rotations):
    """Bend a limb until ``point``, below its middle joint, is ``distance`` metres from its root, or as near to that as
    possible, then aim the point at ``target``.

    ``target`` and ``point`` are (3,); ``upper`` is the limb's upper segment, ``point_index`` the index of its root
    point.
    """
    root, middle = positions[point_index], positions[point_index + 1]
    rx, ry, rz, mx, my, mz = root[0], root[1], root[2], middle[0], middle[1], middle[2]
    bend = bend_to_distance(distance, rotations[upper], root, middle, point)
    x, y, z = point[0] - mx, point[1] - my, point[2] - mz
    aim = aim_rotation(
        mx + bend[0] * x + bend[1] * y + bend[2] * z - rx,
        my + bend[3] * x + bend[4] * y + bend[5] * z - ry,
        mz + bend[6] * x + bend[7] * y + bend[8] * z - rz,
        target,
        root,
    )
    write_rotation(compose(aim, rotation_from_matrix(rotations[upper])), rotations[upper])
    bent, rotation = write_transformed_point((rx, ry, rz), aim, mx - rx, my - ry, mz - rz, middle), compose(aim, bend)
    first, past, first_point, past_point = distal_range(upper + 1, positions.shape[0] - POINTS_BESIDE_SPINE)
    for other in range(first_point, past_point):
        position = positions[other]
        write_transformed_point(bent, rotation, position[0] - mx, position[1] - my, position[2] - mz, position)
    for segment in range(first, past):
        write_rotation(compose(rotation, rotation_from_matrix(rotations[segment])), rotations[segment])


@small_kernel
def bend_to_distance(distance, rotation, root, middle, point):
    """Rotation tuple about the hinge at ``middle`` that brings ``point`` to ``distance`` metres from ``root``, or as
    near to that as possible.

    The bend direction follows the hinge axis, the x axis of the upper segment's ``rotation`` (3, 3), which is defined
    at full extension too. METHOD (15).
    """
    hinge = rotation[0, 0], rotation[1, 0], rotation[2, 0]
    c0, cosine, sine = distance_coefficients(root, middle, hinge, point)
    c1 = math.sqrt(cosine * cosine + sine * sine)
    if c1 < 1e-9:
        return IDENTITY
    per = 1.0 / c1
    cosine, sine = per * cosine, per * sine
    goal = min(max(0.5 * per * (c0 - distance * distance), -1.0), 1.0)
    side = math.sqrt(1.0 - goal * goal)
    if sine < 0.0 and cosine > COS_HYPEREXTENSION_ANGLE:
        side = -side
    return rotation_about_axis(hinge, cosine * goal + sine * side, sine * goal - cosine * side)


@kernel
def aim_at(target, point, segment, spine_count, pivot, positions, rotations):
    """Rotate ``segment`` about ``pivot`` until ``point`` lies in the direction of ``target`` (all (3,))."""
    rotation = aim_rotation(point[0] - pivot[0], point[1] - pivot[1], point[2] - pivot[2], target, pivot)
    rotate_part(rotation, segment, spine_count, pivot, positions, rotations)


@small_kernel
def aim_rotation(x, y, z, target, pivot):
    """Rotation tuple of the shortest rotation about ``pivot`` from the offset (x, y, z) to the direction of
    ``target``.
    """
    bx, by, bz = target[0] - pivot[0], target[1] - pivot[1], target[2] - pivot[2]
    a, b = math.sqrt(x * x + y * y + z * z), math.sqrt(bx * bx + by * by + bz * bz)
    if a < 1e-9 or b < 1e-9:
        return IDENTITY
    a, b = 1.0 / a, 1.0 / b
    return shortest_rotation(a * x, a * y, a * z, b * bx, b * by, b * bz)


@kernel
def swivel_to(target, point, held, segment, spine_count, pivot, positions, rotations):
    """Rotate a limb about the axis from its root through the ``held`` point until ``point`` is nearest to ``target``.

    METHOD (16).
    """
    axis, sine, cosine = swivel_rotation(target, point, held, pivot)
    rotate_part(rotation_about_axis(axis, cosine, sine), segment, spine_count, pivot, positions, rotations)


@kernel
def swivel_rotation(target, point, held, pivot):
    """(axis, sine, cosine) of the swivel about the axis from ``pivot`` through ``held`` that brings ``point`` nearest
    to ``target``.

    It is the exact optimum on the circle, phi = atan2(a.(r x q), r.q), and serves the second of two priorities on one
    limb (K05 figure 11). It fades where point or target lies near the axis, and beyond a quarter turn, so that a target
    that passes behind the axis does not whirl the limb round from one frame to the next (METHOD 8, (17)).
    """
    ax, ay, az = held[0] - pivot[0], held[1] - pivot[1], held[2] - pivot[2]
    length = math.sqrt(ax * ax + ay * ay + az * az)
    if length < 1e-9:
        return (0.0, 0.0, 1.0), 0.0, 1.0
    ax, ay, az = ax / length, ay / length, az / length
    rx, ry, rz = point[0] - pivot[0], point[1] - pivot[1], point[2] - pivot[2]
    qx, qy, qz = target[0] - pivot[0], target[1] - pivot[1], target[2] - pivot[2]
    along = rx * ax + ry * ay + rz * az
    rx, ry, rz = rx - along * ax, ry - along * ay, rz - along * az
    along = qx * ax + qy * ay + qz * az
    qx, qy, qz = qx - along * ax, qy - along * ay, qz - along * az
    sine = ax * (ry * qz - rz * qy) + ay * (rz * qx - rx * qz) + az * (rx * qy - ry * qx)
    cosine = rx * qx + ry * qy + rz * qz
    lever = math.sqrt(sine * sine + cosine * cosine)
    if lever < SWIVEL_FADE_LEVER or cosine < 0.0:
        angle = math.atan2(sine, cosine)
        fraction = smoothstep(min((math.pi - abs(angle)) / (math.pi - SWIVEL_FADE_ANGLE), 1.0))
        sine, cosine = sine_and_cosine(fraction * smoothstep(min(lever / SWIVEL_FADE_LEVER, 1.0)) * angle)
    else:
        sine, cosine = sine / lever, cosine / lever
    return (ax, ay, az), sine, cosine
