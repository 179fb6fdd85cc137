"""Arms and legs as links of variable length: the analytic heart of the method."""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.rotation import add_rotated, multiply, shortest_arc, turn_columns


@kernel
def place_limb(root, frame, distance, upper, lower, off_plane, bend, twist, scratch, out_points, out_upper, out_lower):
    """Middle joint and both segments of a limb from its frame and its length (K05 section 8; METHOD 3.4).

    ``root`` (3,), ``frame`` (3, 3) world, z towards the extremity; ``off_plane`` metres; ``twist`` (2,) radians.
    ``out_points`` (2, 3) middle joint and extremity; ``out_upper``, ``out_lower`` (3, 3) world rotations.
    """
    d = max(distance, 1e-6)
    z = (upper * upper - lower * lower + d * d) / (2.0 * d)
    radius = math.sqrt(max(0.0, upper * upper - z * z))
    x = min(max(off_plane, -radius), radius)
    y = bend * math.sqrt(max(0.0, radius * radius - x * x))
    add_rotated(root, frame, x, y, z, out_points[0])
    add_rotated(root, frame, 0.0, 0.0, d, out_points[1])
    length = math.sqrt(x * x + y * y + z * z)
    shortest_arc(0.0, 0.0, 1.0, x / length, y / length, z / length, scratch)
    multiply(frame, scratch, out_upper)
    turn_columns(out_upper, twist[0])
    length = math.sqrt(x * x + y * y + (d - z) * (d - z))
    shortest_arc(0.0, 0.0, 1.0, -x / length, -y / length, (d - z) / length, scratch)
    multiply(frame, scratch, out_lower)
    turn_columns(out_lower, twist[1])


@kernel
def soft_reach(needed, comfort):
    """Part of its length to which a limb stretches when ``needed`` is asked: all of it up to ``comfort``, then
    a + (1 - a)(1 - exp(-(d - a)/(1 - a))), so that the middle joint never snaps straight (METHOD 6).
    """
    if needed <= comfort:
        return needed
    room = 1.0 - comfort
    return comfort + room * (1.0 - math.exp(-(needed - comfort) / room))
