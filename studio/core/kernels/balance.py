"""The centre of mass, and how joints move it (METHOD 7)."""

from studio.core.kernels.compiling import kernel
from studio.core.kernels.joints import ROOT, pivot_point

LEGS_FOLLOW = 0.854
"""Part of the mass that follows the root while the ankles stay where they are (METHOD 7)."""


@kernel
def centre_of_mass(masses, positions, out_sums, out_point):
    """Centre of mass (3,) from ``masses`` (S, 2): share of the body's mass, place along the segment.

    ``out_sums`` (S + 1, 4) becomes moment and share of all segments before each: those of a range are a difference.
    """
    spine_count, whole = positions.shape[0] - 23, masses.shape[0]
    for column in range(4):
        out_sums[0, column] = 0.0
    for segment in range(whole):
        point = pivot_point(segment, spine_count)
        share, place = masses[segment, 0], masses[segment, 1]
        for axis in range(3):
            begin = positions[point, axis]
            centre = begin + place * (positions[point + 1, axis] - begin)
            out_sums[segment + 1, axis] = out_sums[segment, axis] + share * centre
        out_sums[segment + 1, 3] = out_sums[segment, 3] + share
    out_point[0], out_point[1], out_point[2] = out_sums[whole, 0], out_sums[whole, 1], out_sums[whole, 2]


@kernel
def set_balance_rows(axes, sums, joints, positions, rows):
    """How joints move the centre of mass along ``axes`` (2 or 3) world axes, m (c - o) x v, into ``rows`` (axes, N, 3).

    ``sums`` as from ``centre_of_mass``. The ankles stay where they are, so legs count neither for the pelvis' turn nor
    wholly for the root's travel.
    """
    spine_count = positions.shape[0] - 23
    for joint in range(joints.shape[0]):
        for axis in range(axes):
            rows[axis, joint, 0] = rows[axis, joint, 1] = rows[axis, joint, 2] = 0.0
        if joints[joint, 0] == ROOT:
            for axis in range(axes):
                rows[axis, joint, axis] = LEGS_FOLLOW
            continue
        origin, first = positions[joints[joint, 1]], sums[joints[joint, 2]]
        past = sums[min(joints[joint, 3], spine_count + 10) if joints[joint, 0] == 0 else joints[joint, 3]]
        share = past[3] - first[3]
        x = past[0] - first[0] - share * origin[0]
        y = past[1] - first[1] - share * origin[1]
        z = past[2] - first[2] - share * origin[2]
        rows[0, joint, 1], rows[0, joint, 2] = z, -y
        rows[1, joint, 0], rows[1, joint, 2] = -z, x
        if axes > 2:
            rows[2, joint, 0], rows[2, joint, 1] = y, -x
