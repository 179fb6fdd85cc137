"""The centre of mass of a posed body, and how joints move it."""

from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.joints import ROOT, pivot_point

LEGS_FOLLOW = 0.854
"""Part of the mass that follows the root while the ankles stay where they are (METHOD 7)."""


@kernel
def segment_centres(masses, positions, out_centres):
    """Centre of every segment, (S, 3), from ``masses`` (S, 2): share of the body's mass, place along the segment."""
    spine_count = positions.shape[0] - 23
    for segment in range(masses.shape[0]):
        point = pivot_point(segment, spine_count)
        place = masses[segment, 1]
        for axis in range(3):
            begin = positions[point, axis]
            out_centres[segment, axis] = begin + place * (positions[point + 1, axis] - begin)


@allocating_kernel
def centre_of_mass(masses, centres, out_point):
    """Centre of mass (3,) from the segments' ``centres`` (S, 3)."""
    out_point[:] = 0.0
    for segment in range(masses.shape[0]):
        for axis in range(3):
            out_point[axis] += masses[segment, 0] * centres[segment, axis]


@allocating_kernel
def set_balance_rows(axes, masses, centres, joints, positions, rows):
    """How joints move the centre of mass along ``axes`` (2 or 3) world axes, m (c - o) x v, into ``rows`` (axes, N, 3).

    The ankles stay where they are, so legs count neither for the pelvis' turn nor wholly for the root's travel.
    """
    spine_count = positions.shape[0] - 23
    for joint in range(joints.shape[0]):
        for axis in range(axes):
            rows[axis, joint, 0] = rows[axis, joint, 1] = rows[axis, joint, 2] = 0.0
        if joints[joint, 0] == ROOT:
            for axis in range(axes):
                rows[axis, joint, axis] = LEGS_FOLLOW
            continue
        origin = joints[joint, 1]
        past = min(joints[joint, 3], spine_count + 10) if joints[joint, 0] == 0 else joints[joint, 3]
        x, y, z, whole = 0.0, 0.0, 0.0, 0.0
        for segment in range(joints[joint, 2], past):
            share = masses[segment, 0]
            whole += share
            x += share * centres[segment, 0]
            y += share * centres[segment, 1]
            z += share * centres[segment, 2]
        x, y, z = (
            x - whole * positions[origin, 0],
            y - whole * positions[origin, 1],
            z - whole * positions[origin, 2],
        )
        rows[0, joint, 1], rows[0, joint, 2] = z, -y
        rows[1, joint, 0], rows[1, joint, 2] = -z, x
        if axes > 2:
            rows[2, joint, 0], rows[2, joint, 1] = y, -x
