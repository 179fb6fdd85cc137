"""Balance tasks: the centre of mass, its goal and its Jacobian (METHOD 11)."""

import math

import numpy as np

from studio.core.kernels.algebra.vectors import copy_point, length_in_axes, offset_between
from studio.core.kernels.body_indices import (
    HIP_POINT,
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    THIGH_SEGMENT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.kernels.tasks.goals import end_position, interpolate_point

KNEE_OFFSET = 0.3
"""Least offset of a knee from the line hip-ankle assumed in the Jacobian, as a fraction of the leg's length: a straight
knee would shoot forward.
"""
ARM_MEETS_GOAL = 0.005
"""Distance in metres of an arm from its goal below which the arm counts as meeting it."""


@kernel
def set_balance_goal(row, target, mass_fractions, start):
    """Set the goal of a balance task between the centre of mass in ``start`` and its ``target``, by activation.

    Axes in which the target is NaN are unconstrained.
    """
    copy_point(centre_of_mass(mass_fractions, start.positions), row.start_position)
    for axis in range(3):
        displacement = 0.0 if math.isnan(target[axis]) else target[axis] - row.start_position[axis]
        row.goal_positions[0, axis] = row.start_position[axis] + row.activation * displacement


@kernel
def follow_balance(row, pose):
    """Set the goal of a balance task from the point of the own body that it follows."""
    copy_point(interpolate_point(row.start_position, end_position(row, 1, pose), row.activation), row.goal_positions[0])
    copy_point(row.goal_positions[0], row.goal_positions[1])


@kernel
def balance_residual(row, mass_fractions, pose):
    """Distance in metres from the centre of mass to the goal of a balance task; horizontal unless its height counts."""
    return length_in_axes(
        offset_between(row.goal_positions[0], centre_of_mass(mass_fractions, pose.positions)), row.axes
    )


@kernel
def pin_balance(row, mass_fractions, pose):
    """Set the goal of a balance task to the centre of mass in ``pose``."""
    copy_point(centre_of_mass(mass_fractions, pose.positions), row.goal_positions[0])
    copy_point(row.goal_positions[0], row.goal_positions[1])


@kernel
def centre_of_mass(mass_fractions, positions):
    """Centre of mass (x, y, z) from the ``mass_fractions`` (P,) of the body's points."""
    x = y = z = 0.0
    for point in range(mass_fractions.shape[0]):
        fraction, position = mass_fractions[point], positions[point]
        x, y, z = x + fraction * position[0], y + fraction * position[1], z + fraction * position[2]
    return x, y, z


@kernel
def accumulate_masses(masses, positions, out_sums):
    """Write the prefix sums (S + 1, 4) of first moments (3) and masses over the segments.

    ``masses`` (S, 2): fraction of the body's mass, position of the centre along the segment. The difference of two rows
    is the moment and mass of the segments between; the last row is the centre of mass, and 1.
    """
    count = masses.shape[0]
    out_sums[0, 0] = out_sums[0, 1] = out_sums[0, 2] = out_sums[0, 3] = 0.0
    add_masses(0, count - 16, 0, masses, positions, out_sums)
    for limb in range(4):
        first = count - 16 + 4 * limb
        add_masses(first, first + 4, first + 1 + limb, masses, positions, out_sums)


@small_kernel
def add_masses(first, past, point, masses, positions, out_sums):
    """Add moments and masses of consecutive segments to ``out_sums``; the first segment begins at ``point``."""
    x, y, z, whole = out_sums[first, 0], out_sums[first, 1], out_sums[first, 2], out_sums[first, 3]
    for number in range(past - first):
        segment = np.uint64(first + number)
        near, far = positions[np.uint64(point + number)], positions[np.uint64(point + number + 1)]
        mass = masses[segment]
        farther = mass[0] * mass[1]
        nearer = mass[0] - farther
        x += nearer * near[0] + farther * far[0]
        y += nearer * near[1] + farther * far[1]
        z += nearer * near[2] + farther * far[2]
        whole += mass[0]
        sums = out_sums[np.uint64(first + number + 1)]
        sums[0], sums[1], sums[2], sums[3] = x, y, z, whole


@kernel
def write_balance_jacobian(axes, masses, sums, joints, positions, rows):
    """Write the Jacobian m (c - o) x v of the centre of mass along the first ``axes`` (2 or 3) world axes into ``rows``
    (axes, N, 3).

    ``sums`` is the result of ``accumulate_masses``. Ankles stay fixed, so that legs follow the root's displacement by
    ``add_leg_jacobian``; they do not follow the pelvis' rotation.
    """
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    for joint in range(joints.shape[0]):
        if joints[joint].segment == ROOT_TRANSLATION:
            whole = sums[spine_count + 10, 3]
            write_components(rows[0, joint], whole, 0.0, 0.0)
            write_components(rows[1, joint], 0.0, whole, 0.0)
            if axes > 2:
                write_components(rows[2, joint], 0.0, 0.0, whole)
            for side in range(2):
                add_leg_jacobian(side, axes, KNEE_OFFSET, masses, positions, rows[:, joint])
            continue
        origin, first = positions[joints[joint].pivot], sums[joints[joint].first]
        past = sums[min(joints[joint].past, spine_count + 10) if joints[joint].segment == 0 else joints[joint].past]
        fraction = past[3] - first[3]
        x = past[0] - first[0] - fraction * origin[0]
        y = past[1] - first[1] - fraction * origin[1]
        z = past[2] - first[2] - fraction * origin[2]
        write_components(rows[0, joint], 0.0, z, -y)
        write_components(rows[1, joint], -z, 0.0, x)
        if axes > 2:
            write_components(rows[2, joint], y, -x, 0.0)


@kernel
def add_leg_jacobian(side, axes, least_bend, masses, positions, out_levers):
    """Add the derivative (axes, 3) of a leg's moment by its hip's displacement, with a fixed ankle, to ``out_levers``.

    The knee moves by J u, J^T v = (1 - z/d) (v - (n.v) n) + (z/d) (n.v) n + (z/r^2) (1 - z/d) (e.v) n + (n.v) e / d for
    the unit n to the ankle, d away, and the knee z along it and off it by e, r long. METHOD (35).
    """
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    thigh, hip = (
        spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side,
        spine_count + HIP_POINT + POINTS_PER_LIMB * side,
    )
    kx = positions[hip + 1, 0] - positions[hip, 0]
    ky = positions[hip + 1, 1] - positions[hip, 1]
    kz = positions[hip + 1, 2] - positions[hip, 2]
    nx = positions[hip + 2, 0] - positions[hip, 0]
    ny = positions[hip + 2, 1] - positions[hip, 1]
    nz = positions[hip + 2, 2] - positions[hip, 2]
    d = max(math.sqrt(nx * nx + ny * ny + nz * nz), 1e-6)
    per = 1.0 / d
    nx, ny, nz = per * nx, per * ny, per * nz
    z = kx * nx + ky * ny + kz * nz
    ex, ey, ez = kx - z * nx, ky - z * ny, kz - z * nz
    fraction, squared = per * z, ex * ex + ey * ey + ez * ez + (least_bend * d) ** 2
    knee = masses[thigh, 0] * masses[thigh, 1] + masses[thigh + 1, 0] * (1.0 - masses[thigh + 1, 1])
    stays = masses[thigh, 0] * (1.0 - masses[thigh, 1]) + knee * (1.0 - fraction)
    bends, forward, to_ankle = knee * z / squared * (1.0 - fraction), per * knee, knee * (2.0 * fraction - 1.0)
    go, off = to_ankle * nx + bends * ex, forward * nx
    add_components(out_levers[0], stays + go * nx + off * ex, go * ny + off * ey, go * nz + off * ez)
    go, off = to_ankle * ny + bends * ey, forward * ny
    add_components(out_levers[1], go * nx + off * ex, stays + go * ny + off * ey, go * nz + off * ez)
    if axes > 2:
        go, off = to_ankle * nz + bends * ez, forward * nz
        add_components(out_levers[2], go * nx + off * ex, go * ny + off * ey, stays + go * nz + off * ez)


@kernel
def add_arm_jacobian(side, axes, goal, reach, sums, joints, positions, rows):
    """Correct the Jacobian of ``write_balance_jacobian`` for an arm that aims at a ``goal`` (3,), which it would meet
    at ``reach`` metres.

    The arm's mass, at a fraction f of the l metres to the wrist, does not move with its shoulder's displacement u: it
    moves by (1 - f l / d) u across the direction to a goal d away, and along it by u, or by (1 - f) u where the goal is
    met. METHOD (34).
    """
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    upper, root = (
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
    )
    mass = sums[upper + 3, 3] - sums[upper, 3]
    shoulder, wrist = positions[root], positions[root + 2]
    x, y, z = goal[0] - shoulder[0], goal[1] - shoulder[1], goal[2] - shoulder[2]
    span = max(math.sqrt(x * x + y * y + z * z), 1e-6)
    per = 1.0 / span
    x, y, z = per * x, per * y, per * z
    mx = sums[upper + 3, 0] - sums[upper, 0] - mass * shoulder[0]
    my = sums[upper + 3, 1] - sums[upper, 1] - mass * shoulder[1]
    mz = sums[upper + 3, 2] - sums[upper, 2] - mass * shoulder[2]
    lx, ly, lz = wrist[0] - shoulder[0], wrist[1] - shoulder[1], wrist[2] - shoulder[2]
    length = max(math.sqrt(lx * lx + ly * ly + lz * lz), 1e-6)
    moment = (mx * x + my * y + mz * z) / length
    across = -moment * min(length / span, 1.0)
    along = -moment * (1.0 - min(max(span - reach, 0.0) / ARM_MEETS_GOAL, 1.0)) - across
    xx, xy, xz = across + along * x * x, along * x * y, along * x * z
    yy, yz, zz = across + along * y * y, along * y * z, across + along * z * z
    for joint in range(joints.shape[0]):
        if joints[joint].segment == ROOT_TRANSLATION:
            add_components(rows[0, joint], xx, xy, xz)
            add_components(rows[1, joint], xy, yy, yz)
            if axes > 2:
                add_components(rows[2, joint], xz, yz, zz)
        elif joints[joint].first <= upper < joints[joint].past:
            origin = positions[joints[joint].pivot]
            ox, oy, oz = shoulder[0] - origin[0], shoulder[1] - origin[1], shoulder[2] - origin[2]
            add_components(rows[0, joint], oy * xz - oz * xy, oz * xx - ox * xz - mz, ox * xy - oy * xx + my)
            add_components(rows[1, joint], oy * yz - oz * yy + mz, oz * xy - ox * yz, ox * yy - oy * xy - mx)
            if axes > 2:
                add_components(rows[2, joint], oy * zz - oz * yz - my, oz * xz - ox * zz + mx, ox * yz - oy * xz)


@small_kernel
def write_components(row, x, y, z):
    """Write the derivative (x, y, z) by one joint into ``row`` (3,)."""
    row[0], row[1], row[2] = x, y, z


@small_kernel
def add_components(row, x, y, z):
    """Add (x, y, z) to the derivative by one joint, ``row`` (3,)."""
    row[0], row[1], row[2] = row[0] + x, row[1] + y, row[2] + z
