"""Legs placed on the ankle targets of the grounding (METHOD 5)."""

import math

import numpy as np

from studio.core.kernels import channel_columns as channel
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.rotation_tuples import (
    aim_z_axis,
    compose,
    rotation_from_matrix,
    rotation_from_quaternion,
    twist_about_z,
    write_transformed_point,
)
from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.body.pose_from_channels import write_foot, write_hip
from studio.core.kernels.body_indices import (
    ANKLE_POINT,
    FOOT_SEGMENT,
    HIP_POINT,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    THIGH_SEGMENT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.limbs.limb import middle_joint, place_limb, soft_extension, soft_minimum_reach
from studio.core.kernels.records import LimbShape

KNEE_TARGET_COLUMN, KNEE_TARGET_ACTIVE_COLUMN = 3, 6
"""Columns of an ankle target with 7 numbers: first column of the position (3,) that the knee faces, and the column that
is 1 where that position is active.
"""
KNEE_TARGET_LEVER = 0.0004
"""Product in square metres, of the distances of the knee and of its target from the line hip-ankle, below which the
knee target fades.
"""
KNEE_TARGET_DISTANCE = 0.5
"""Distance in leg lengths from the line hip-ankle at which the knee target of a foot in the air is put."""


@allocating_kernel
def required_root_lowering(channels, measures, rotations, ankles, soft_thresholds, states, out_drops):
    """Write the root lowering (F,) in metres that brings the ankles of planted feet into reach (K05 section 7; METHOD
    (9)).

    ``rotations`` (F, S, 3, 3); ``ankles`` (2, F, 3) targets relative to the root; ``soft_thresholds`` (2, F) fraction
    of its length to which each leg extends freely; ``states`` (2, F) of the feet, 0 in the air.
    """
    hip, root = np.empty(3), np.zeros(3)
    for frame in range(channels.shape[0]):
        out_drops[frame] = 0.0
        row = measures[frame if measures.shape[0] > 1 else 0]
        for side in range(2):
            if states[side, frame] == 0:
                continue
            write_hip(channels[frame], row, side, 0.0, root, rotation_from_matrix(rotations[frame, 0]), hip)
            length = row[measure.LEG + 2 * side] + row[measure.LEG + 2 * side + 1]
            reach = length * soft_thresholds[side, frame]
            x, y = ankles[side, frame, 0] - hip[0], ankles[side, frame, 1] - hip[1]
            below = math.sqrt(max(0.0, reach * reach - x * x - y * y))
            drop = -(ankles[side, frame, 2] - hip[2]) - below
            out_drops[frame] = max(out_drops[frame], drop)


@kernel
def smooth_lowering(drops, window, out_peaks, out_drops):
    """Smooth upper envelope of ``drops`` (F,) and 0: the moving maximum, averaged over the same support by ``window``.

    The window (2 n + 1,) adds up to 1; beyond its ends a motion is continued by its end values. METHOD (9).
    """
    count, half = drops.shape[0], window.shape[0] // 2
    for frame in range(count):
        out_peaks[frame] = 0.0
        for other in range(max(frame - half, 0), min(frame + half + 1, count)):
            out_peaks[frame] = max(out_peaks[frame], drops[other])
    for frame in range(count):
        out_drops[frame] = 0.0
        for step in range(2 * half + 1):
            other = min(max(frame + step - half, 0), count - 1)
            out_drops[frame] += window[step] * out_peaks[other]


@kernel
def place_leg(side, measures, legs, pose):
    """Place one leg of one frame: hip on the pelvis, ankle at its target, foot and toe with their target rotations
    (METHOD 8, limb_to).

    The knee always bends forward: captures hyperextend it by a few degrees, and it would snap. A target beyond the
    soft-IK threshold is approached by ``soft_extension``; for standing feet the root has been lowered before. ``legs``
    are the ``LegTargets`` and ``pose`` the ``Pose`` of one frame. An ankle target with 7 numbers includes a knee target
    (``KNEE_TARGET_COLUMN``).
    """
    spine_count = (measures.shape[0] - measure.SPINE) // 3
    _, frame, limb = aim_leg(side, measures, legs, pose)
    end, _ = place_limb(
        spine_count + HIP_POINT + POINTS_PER_LIMB * side,
        spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side,
        frame,
        limb,
        pose,
    )
    write_foot(side, measures, end, rotation_from_matrix(legs.feet[side]), rotation_from_matrix(legs.toes[side]), pose)


@small_kernel
def aim_leg(side, measures, legs, pose):
    """Place the hip on the pelvis. Returns its position, the frame of the leg aimed at its ankle target, and the
    ``LimbShape``.
    """
    channels, ankle = legs.channels, legs.ankles[side]
    point = (measures.shape[0] - measure.SPINE) // 3 + 13 + 5 * side
    pelvis = rotation_from_matrix(pose.rotations[0])
    hip = write_hip(channels, measures, side, 0.0, pose.positions[0], pelvis, pose.positions[point])
    frame, reach, off_plane = leg_frame(channels, measures, side, legs.soft_thresholds[side], ankle, hip, pelvis)
    upper, lower = measures[measure.LEG + 2 * side], measures[measure.LEG + 2 * side + 1]
    if ankle.shape[0] > 3 and ankle[KNEE_TARGET_ACTIVE_COLUMN] > 0.0:
        frame = twist_about_z(frame, knee_swivel(hip, ankle, upper, lower, reach, off_plane, frame))
    t = channel.LIMB_TWIST + 2 * (2 + side)
    return hip, frame, LimbShape((upper, lower), reach, off_plane, 1.0, (channels[t], channels[t + 1]))


@kernel
def place_leg_points(side, measures, legs, before, pose):
    """Place only the points of a leg on its ankle target, without rotations.

    ``before`` (P, 3) has the offsets of the foot's points from its ankle.
    """
    positions, point = pose.positions, (measures.shape[0] - measure.SPINE) // 3 + 13 + 5 * side
    hip, frame, limb = aim_leg(side, measures, legs, pose)
    x, y, z, distance = middle_joint(limb)
    write_transformed_point(hip, frame, x, y, z, positions[point + 1])
    write_transformed_point(hip, frame, 0.0, 0.0, distance, positions[point + 2])
    for bone in range(3, 5):
        for axis in range(3):
            positions[point + bone, axis] = positions[point + 2, axis] + (
                before[point + bone, axis] - before[point + 2, axis]
            )


@kernel
def leg_frame(channels, measures, side, soft_threshold, ankle, hip, pelvis):
    """(frame, reach, off-plane offset) of a leg aimed from its ``hip`` (3,) at its ``ankle`` target (METHOD (4), (11)).

    ``reach`` is the distance from hip to ankle, the offset that of the knee from the leg's plane, both in metres.
    """
    upper, lower = measures[measure.LEG + 2 * side], measures[measure.LEG + 2 * side + 1]
    length = upper + lower
    x, y, z = ankle[0] - hip[0], ankle[1] - hip[1], ankle[2] - hip[2]
    distance = math.sqrt(x * x + y * y + z * z)
    frame = compose(pelvis, rotation_from_quaternion(channels, channel.LIMB_FRAME + 4 * (2 + side)))
    if distance > 1e-9:
        per = 1.0 / distance
        frame = aim_z_axis(frame, per * x, per * y, per * z)
    reach = soft_minimum_reach(length * soft_extension(distance / length, soft_threshold), (upper, lower))
    off_plane, own = (
        channels[channel.LIMB_OFF_PLANE + 2 + side] * length,
        length * (1.0 - channels[channel.LIMB_SLACK + 2 + side]),
    )
    if reach > own:  # straighter: the knee keeps its side, where at one place it would turn right round
        off_plane *= knee_radius(upper, lower, reach) / max(knee_radius(upper, lower, own), 1e-9)
    return frame, reach, off_plane


@small_kernel
def knee_radius(upper, lower, distance):
    """Distance in metres of a knee from the line of hip and ankle, which are ``distance`` apart (METHOD (5))."""
    distance = max(distance, 1e-6)
    z = (upper * upper - lower * lower + distance * distance) / (2.0 * distance)
    return math.sqrt(max(0.0, upper * upper - z * z))


@allocating_kernel
def knee_swivels(channels, measures, side, soft_thresholds, ankles, hips, pelvises, out_angles):
    """Write the swivel angles (F,) in radians about the line hip-ankle that turn a knee to its target in ``ankles`` (F,
    7).

    ``soft_thresholds`` (F,); ``hips`` (F, 3); ``pelvises`` (F, 3, 3).
    """
    for frame in range(channels.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        rotation, reach, off_plane = leg_frame(
            channels[frame],
            row,
            side,
            soft_thresholds[frame],
            ankles[frame],
            hips[frame],
            rotation_from_matrix(pelvises[frame]),
        )
        upper, lower = row[measure.LEG + 2 * side], row[measure.LEG + 2 * side + 1]
        out_angles[frame] = knee_swivel(hips[frame], ankles[frame], upper, lower, reach, off_plane, rotation)


@allocating_kernel
def write_knee_targets(channels, measures, side, soft_thresholds, angles, hips, pelvises, ankles):
    """Write the knee targets into ``ankles`` (F, 7) that swivel knees by ``angles`` (F,) in radians: inverse of
    ``knee_swivels``.
    """
    for frame in range(channels.shape[0]):
        ankle, hip = ankles[frame], hips[frame]
        ankle[KNEE_TARGET_ACTIVE_COLUMN] = 0.0
        if angles[frame] == 0.0:
            continue
        row = measures[frame if measures.shape[0] > 1 else 0]
        rotation, reach, off_plane = leg_frame(
            channels[frame], row, side, soft_thresholds[frame], ankle, hip, rotation_from_matrix(pelvises[frame])
        )
        upper, lower = row[measure.LEG + 2 * side], row[measure.LEG + 2 * side + 1]
        x, y, _ = unswivelled_knee(upper, lower, reach, off_plane)
        angle = math.atan2(y, x) + angles[frame]
        c, s = (
            KNEE_TARGET_DISTANCE * (upper + lower) * math.cos(angle),
            KNEE_TARGET_DISTANCE * (upper + lower) * math.sin(angle),
        )
        for axis in range(3):
            ankle[KNEE_TARGET_COLUMN + axis] = hip[axis] + c * rotation[3 * axis] + s * rotation[3 * axis + 1]
        ankle[KNEE_TARGET_ACTIVE_COLUMN] = 1.0


@small_kernel
def unswivelled_knee(upper, lower, distance, off_plane):
    """(x, y, radius) of a leg's knee without swivel, in metres in the leg's frame (METHOD (5)).

    x and y are the knee's position across the line hip-ankle, ``radius`` its distance from the line.
    """
    radius = knee_radius(upper, lower, distance)
    x = min(max(off_plane, -radius), radius)
    return x, math.sqrt(max(0.0, radius * radius - x * x)), radius


@kernel
def is_leg_placed(side, measures, legs, pose):
    """True if the leg already has the pose that ``place_leg`` would give it."""
    channels, ankle = legs.channels, legs.ankles[side]
    spine_count = (measures.shape[0] - measure.SPINE) // 3
    point, segment = (
        spine_count + ANKLE_POINT + POINTS_PER_LIMB * side,
        spine_count + FOOT_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    upper, lower = measures[measure.LEG + 2 * side], measures[measure.LEG + 2 * side + 1]
    stretch = 1.0 - channels[channel.LIMB_SLACK + 2 + side]
    if channels[channel.LIMB_BEND + 2 + side] != 1.0 or stretch > legs.soft_thresholds[side]:
        return False
    if stretch * (upper + lower) < abs(upper - lower) + 1e-6 or (
        ankle.shape[0] > 3 and ankle[KNEE_TARGET_ACTIVE_COLUMN] > 0.0
    ):
        return False
    return (
        same_point(ankle, pose.positions[point])
        and same_matrix(legs.feet[side], pose.rotations[segment])
        and same_matrix(legs.toes[side], pose.rotations[segment + 1])
    )


@small_kernel
def same_point(a, b):
    """True if two points (3,) are equal."""
    return a[0] == b[0] and a[1] == b[1] and a[2] == b[2]


@small_kernel
def same_matrix(a, b):
    """True if two matrices (3, 3) are equal."""
    return same_point(a[0], b[0]) and same_point(a[1], b[1]) and same_point(a[2], b[2])


@kernel
def knee_swivel(hip, ankle, upper, lower, distance, off_plane, frame):
    """Swivel in radians of a leg's ``frame`` about its z axis that turns the knee to its target (METHOD (4)).

    ``ankle`` (7,) is the ankle target with its knee target. The swivel fades where the knee, or the target, is near the
    line hip-ankle.
    """
    x, y, radius = unswivelled_knee(upper, lower, distance, off_plane)
    wanted_x, wanted_y = 0.0, 0.0
    for axis in range(3):
        wanted_x += frame[3 * axis] * (ankle[KNEE_TARGET_COLUMN + axis] - hip[axis])
        wanted_y += frame[3 * axis + 1] * (ankle[KNEE_TARGET_COLUMN + axis] - hip[axis])
    away = radius * math.hypot(wanted_x, wanted_y)
    angle = math.atan2(wanted_y, wanted_x) - math.atan2(y, x)
    angle -= 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))
    return smoothstep(min(away / KNEE_TARGET_LEVER, 1.0)) * angle
