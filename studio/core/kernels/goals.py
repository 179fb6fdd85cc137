"""What each constraint asks of one frame: places and rotations between the unsolved pose and the target.

Kinds: see the constants. Arrays of C constraints, each with up to two ends (points of the body):
``ends`` (C, 2, 3) point, segment, limb (-1 none) of each end, point -1 where there is none; ``offsets`` (C, 2, 3).
"""

import math

from numba import njit

from studio.core.kernels.body import body_point

POSITION = 0
ORIENTATION = 1
DISTANCE = 2
BALANCE = 3
"""Kinds as the solver knows them; every other kind is put in terms of these."""


@njit(cache=True, nogil=True)
def end_place(ends, offsets, c, end, pose, out_point):
    """Where one end of a constraint is now, (3,)."""
    body_point(ends[c, end, 0], ends[c, end, 1], offsets[c, end], pose[0], pose[1], out_point)


@njit(cache=True, nogil=True)
def ease_goal(start, target, share, out_goal):
    """Goal (3,) between where a point is and where it is to be (METHOD 5: interpolate the target)."""
    for axis in range(3):
        out_goal[axis] = start[axis] + share * (target[axis] - start[axis])


@njit(cache=True, nogil=True)
def part_to(first, second, distance, shares, out_goals):
    """Goals (2, 3) of two points that are to be ``distance`` apart, moved along their line by their shares.

    Written without a direction, so that distance zero needs none (METHOD 5).
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
