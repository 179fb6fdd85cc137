"""The centre of mass of a posed body, and how joints move it."""

from numba import njit

from studio.core.kernels.joints import ROOT, pivot_point

LEGS_FOLLOW = 0.854
"""Part of the mass that follows the root while the ankles stay where they are (METHOD 7)."""


@njit(cache=True, nogil=True)
def segment_centres(masses, positions, out_centres):
    """Centre of every segment, (S, 3), from ``masses`` (S, 2): share of the body's mass, place along the segment."""
    spine_count = positions.shape[0] - 23
    for segment in range(masses.shape[0]):
        point = pivot_point(segment, spine_count)
        place = masses[segment, 1]
        for axis in range(3):
            begin = positions[point, axis]
            out_centres[segment, axis] = begin + place * (positions[point + 1, axis] - begin)


@njit(cache=True, nogil=True)
def centre_of_mass(masses, centres, out_point):
    """Centre of mass (3,) from the segments' ``centres`` (S, 3)."""
    out_point[:] = 0.0
    for segment in range(masses.shape[0]):
        for axis in range(3):
            out_point[axis] += masses[segment, 0] * centres[segment, axis]


@njit(cache=True, nogil=True)
def add_balance_row(axis, masses, centres, joints, positions, row):
    """Add to ``row`` (N, 3) how joints move the centre of mass along a world axis: m (c - o) x v.

    The ankles stay where they are, so legs count neither for the pelvis' turn nor wholly for the root's travel.
    """
    spine_count = positions.shape[0] - 23
    for joint in range(joints.shape[0]):
        if joints[joint, 0] == ROOT:
            row[joint, axis] += LEGS_FOLLOW
            continue
        origin = joints[joint, 1]
        past = min(joints[joint, 3], spine_count + 10) if joints[joint, 0] == 0 else joints[joint, 3]
        x, y, z = 0.0, 0.0, 0.0
        for segment in range(joints[joint, 2], past):
            share = masses[segment, 0]
            x += share * (centres[segment, 0] - positions[origin, 0])
            y += share * (centres[segment, 1] - positions[origin, 1])
            z += share * (centres[segment, 2] - positions[origin, 2])
        if axis == 0:
            row[joint, 1] += z
            row[joint, 2] -= y
        elif axis == 1:
            row[joint, 0] -= z
            row[joint, 2] += x
        else:
            row[joint, 0] += y
            row[joint, 1] -= x
