"""Two points of the body, or one and a place, so far apart."""

import math

from studio.core.kernels.algebra.vectors import copy_point, distance
from studio.core.kernels.compiling import kernel
from studio.core.kernels.tasks.goals import end_place


@kernel
def second_place(row, pose):
    """Where the other point of a distance is now, (x, y, z): on the body, or the place outside."""
    if row.points[1] >= 0:
        return end_place(row, 1, pose)
    return row.places[1, 0], row.places[1, 1], row.places[1, 2]


@kernel
def length_between(row, pose):
    """Metres between its ends."""
    return distance(end_place(row, 0, pose), second_place(row, pose))


@kernel
def begin_distance(row, target, wanted, start):
    """How far apart its ends are to be: by how much it acts, between the metres of ``start`` and those ``wanted``."""
    copy_point(target, row.places[1])
    now = length_between(row, start)
    row.distance = now + row.share * (wanted - now)


@kernel
def follow_distance(row, pose):
    """The goals of both ends as they are now."""
    part_to(end_place(row, 0, pose), second_place(row, pose), row.distance, row.shares, row.places)


@kernel
def part_to(first, second, distance, shares, out_goals):
    """Goals (2, 3) of two points that are to be ``distance`` apart, moved along their line by their shares.

    Written without a direction, so that distance zero needs none (METHOD 5, (13)).
    """
    x, y, z = second[0] - first[0], second[1] - first[1], second[2] - first[2]
    now = math.sqrt(x * x + y * y + z * z)
    step = 1.0 - distance / max(now, 1e-6)
    out_goals[0, 0], out_goals[0, 1], out_goals[0, 2] = (
        first[0] + shares[0] * step * x,
        first[1] + shares[0] * step * y,
        first[2] + shares[0] * step * z,
    )
    out_goals[1, 0], out_goals[1, 1], out_goals[1, 2] = (
        second[0] - shares[1] * step * x,
        second[1] - shares[1] * step * y,
        second[2] - shares[1] * step * z,
    )


@kernel
def miss_distance(row, pose):
    """Metres by which its ends are too near or too far apart."""
    return abs(length_between(row, pose) - row.distance)
