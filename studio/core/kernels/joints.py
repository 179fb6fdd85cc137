"""The joints that a search may turn, and how each moves points of the body.

``joints`` (N, 4) holds, for each joint that any constraint's chain frees, the segment it turns, the point about which
it turns, and the first and past the last of the segments that turn with it; segment -1 is the root's translation.
"""

import numpy as np
from numba import njit

from studio.core.kernels.body import distal_range

ROOT = -1


@njit(cache=True, nogil=True)
def pivot_point(segment, spine_count):
    """The point about which ``segment`` turns."""
    if segment < spine_count + 2:
        return segment
    chain, bone = (segment - spine_count - 2) // 4, (segment - spine_count - 2) % 4
    return spine_count + 3 + 5 * chain + bone


@njit(cache=True, nogil=True)
def joint_table(segments, spine_count):
    """``joints`` (N, 4) for the given segments (N,), ROOT for the root's translation."""
    table = np.empty((segments.shape[0], 4), np.int64)
    for joint in range(segments.shape[0]):
        segment = segments[joint]
        table[joint, 0] = segment
        table[joint, 1] = 0 if segment == ROOT else pivot_point(segment, spine_count)
        first, past, _, _ = distal_range(max(segment, 0), spine_count)
        table[joint, 2], table[joint, 3] = first, past
    return table


@njit(cache=True, nogil=True)
def add_point_row(point, vx, vy, vz, carrier, joints, positions, row):
    """Add to ``row`` (N, 3) how joints move a point of segment ``carrier`` along a direction: (p - o) x v."""
    for joint in range(joints.shape[0]):
        if joints[joint, 0] == ROOT:
            row[joint, 0] += vx
            row[joint, 1] += vy
            row[joint, 2] += vz
        elif joints[joint, 2] <= carrier < joints[joint, 3]:
            origin = joints[joint, 1]
            x = point[0] - positions[origin, 0]
            y = point[1] - positions[origin, 1]
            z = point[2] - positions[origin, 2]
            row[joint, 0] += y * vz - z * vy
            row[joint, 1] += z * vx - x * vz
            row[joint, 2] += x * vy - y * vx


@njit(cache=True, nogil=True)
def add_turn_row(axis, arm, carrier, joints, row):
    """Add to ``row`` (N, 3) how joints turn segment ``carrier`` about a world axis, in ``arm`` metres a radian."""
    for joint in range(joints.shape[0]):
        if joints[joint, 0] != ROOT and joints[joint, 2] <= carrier < joints[joint, 3]:
            row[joint, axis] += arm
