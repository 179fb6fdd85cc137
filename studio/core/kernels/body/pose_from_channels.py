"""Poses of a body from the channels of a motion, which are independent of any body, and the body's measures (METHOD
3).
"""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels import channel_columns as channel
from studio.core.kernels import measure_columns as measure
from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    rotation_from_matrix,
    rotation_from_quaternion,
    rotation_with_z_axis,
    shortest_rotation,
    sine_and_cosine,
    write_rotation,
    write_transformed_point,
)
from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.body_indices import (
    CLAVICLE_SEGMENT,
    COLLAR_POINT,
    FOOT_SEGMENT,
    HIP_POINT,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    THIGH_SEGMENT,
    TOE_POINT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.limbs.limb import match_bone_lines, place_limb, soft_flexion
from studio.core.kernels.records import Array, LimbShape, Pose

CLAVICLE_REACH_SOFTNESS = 0.003
"""Fraction of a clavicle's length by which its lateral reach falls short of the actor's when half of the lack is
corrected.
"""


class ActorProportions(NamedTuple):
    """Proportions of the captured actor relative to the posed body, in all frames."""

    clavicle_ratios: Array
    """(F or 1,) ratio of clavicle lengths, actor to body, both relative to the breadth of the shoulders; 1 at most."""
    clavicle_rests: Array
    """(2, 3) rest directions of the actor's clavicles in the thorax."""
    hip_ratios: Array
    """(F or 1,) ratio of hip breadths, actor to body, both relative to the length of the legs; 1 at most."""
    foot_lines: Array
    """(F, 2) lateral direction across the feet, as in ``NormalizedMotion.across``."""
    upper_bone_fractions: Array
    """(4,) upper bone of each of the actor's limbs as a fraction of the limb."""


class FrameProportions(NamedTuple):
    """Proportions of the captured actor relative to the posed body, in one frame."""

    clavicle_ratio: float
    """Ratio of clavicle lengths, actor to body."""
    clavicle_rests: Array
    """(2, 3) rest directions of the actor's clavicles in the thorax."""
    hip_ratio: float
    """Ratio of hip breadths, actor to body."""
    foot_line: Array
    """(2,) lateral horizontal direction across the feet."""
    upper_bone_fractions: Array
    """(4,) upper bone of each of the actor's limbs as a fraction of the limb."""


@allocating_kernel
def realize_frames(channels, positions, measures, actor, play, out_positions, out_rotations):
    """Write the poses of a body in every frame of a motion (METHOD 3; eq. 2 of K05), in the motion's space.

    ``channels`` (F, 89 + 4 K_motion); ``positions`` (K_motion,) of the motion's spine segments along the trunk, 0 to 1;
    ``measures`` (F or 1, 57 + 3 K); ``actor`` an ``ActorProportions`` record. With ``play`` 1 the recorded shifts of
    hips and head are kept, with 0 they are dropped. Writes points (F, K + 23, 3) in metres and segment rotations (F, K
    + 18, 3, 3).
    """
    spine_indices, spine_fractions = spine_sampling(positions, measures[0])
    realize_all_frames(channels, measures, actor, spine_indices, spine_fractions, play, out_positions, out_rotations)


@kernel
def realize_all_frames(channels, measures, actor, spine_indices, spine_fractions, play, out_positions, out_rotations):
    """Write the poses of all frames for a spine sampled by ``spine_indices`` and ``spine_fractions``, the result of
    ``spine_sampling``.
    """
    for frame in range(channels.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        pose = Pose(out_positions[frame], out_rotations[frame])
        length, hips = (
            actor.clavicle_ratios[frame % actor.clavicle_ratios.shape[0]],
            actor.hip_ratios[frame % actor.hip_ratios.shape[0]],
        )
        proportions = FrameProportions(
            length, actor.clavicle_rests, hips, actor.foot_lines[frame], actor.upper_bone_fractions
        )
        realize_frame(channels[frame], row, proportions, spine_indices, spine_fractions, play, pose)


@allocating_kernel
def spine_sampling(positions, measures):
    """Index (K,) of the motion's spine segment at or below each of a body's K segments, and the interpolation factor
    (K,) to the next.

    Pelvis maps to pelvis and thorax to thorax; segments between are sampled by their position along the trunk, so that
    arms hang in the same way on any number of vertebrae. ``positions`` (K_motion,) run from 0 to 1.
    """
    count, last = (measures.shape[0] - measure.SPINE) // 3, positions.shape[0] - 1
    own, index, share = np.zeros(count), np.zeros(count, np.int64), np.zeros(count)
    for k in range(1, count):
        m = measure.SPINE + 3 * (k - 1)
        own[k] = own[k - 1] + math.sqrt(measures[m] ** 2 + measures[m + 1] ** 2 + measures[m + 2] ** 2)
    for k in range(count):
        position = own[k] / own[count - 1]
        while index[k] < last and positions[index[k] + 1] <= position + 1e-9:
            index[k] += 1
        begin = positions[index[k]]
        span = positions[index[k] + 1] - begin if index[k] < last else 1.0
        fraction = min(max((position - begin) / span, 0.0), 1.0)
        share[k] = fraction if fraction >= 1e-6 else 0.0
    return index, share


@kernel
def realize_frame(channels, measures, proportions, spine_indices, spine_fractions, play, pose):
    """Write the ``pose`` of a body in one frame; ``proportions`` is the actor's ``FrameProportions``."""
    root, pelvis, neck_base, thorax = realize_trunk(
        channels, measures, proportions, spine_indices, spine_fractions, pose
    )
    realize_head(channels, measures, play, neck_base, thorax, pose)
    for side in range(2):
        realize_arm(channels, measures, proportions, side, neck_base, thorax, pose)
        realize_leg(channels, measures, proportions.upper_bone_fractions, side, play, root, pelvis, pose)


@small_kernel
def realize_trunk(channels, measures, proportions, spine_indices, spine_fractions, pose):
    """Pose pelvis and spine (METHOD 3.1, 3.2). Returns the position and rotation of the pelvis, then those of the neck
    base.

    The rotation at the neck base is that of the thorax. The pelvis segment rotates less where hips are wider than the
    actor's (``proportions``), which keeps them above the planted feet; trunk and legs do not follow that reduction.
    """
    upright = pelvis_rotation(channels)
    pelvis = (
        upright if proportions.hip_ratio == 1.0 else level_hips(upright, proportions.hip_ratio, proportions.foot_line)
    )
    leg, m = mean_leg_length(measures), measure.HIP_OFFSET
    middle = (
        channels[channel.HIPS] * leg,
        channels[channel.HIPS + 1] * leg,
        channels[channel.HIPS + 2] * leg + 0.5 * (measures[measure.ANKLE_HEIGHT] + measures[measure.ANKLE_HEIGHT + 1]),
    )
    root = write_transformed_point(
        middle,
        pelvis,
        -0.5 * (measures[m] + measures[m + 3]),
        -0.5 * (measures[m + 1] + measures[m + 4]),
        -0.5 * (measures[m + 2] + measures[m + 5]),
        pose.positions[0],
    )
    position, rotation = root, pelvis
    for k in range(spine_indices.shape[0]):
        if k > 0:
            rotation = compose(upright, spine_rotation(channels, spine_indices[k], spine_fractions[k]))
        write_rotation(rotation, pose.rotations[k])
        m = measure.SPINE + 3 * k
        position = write_transformed_point(
            position, rotation, measures[m], measures[m + 1], measures[m + 2], pose.positions[k + 1]
        )
    return root, upright, position, rotation


@small_kernel
def level_hips(pelvis, share, line):
    """Rotation of the pelvis with its hip axis nearer to the horizontal direction ``line`` (2,) between the feet.

    The tilt and yaw of the axis relative to ``line`` are multiplied by ``share``. The scaling fades where the feet are
    turned away from the line, or lie on their sides.
    """
    own = 1.0 / max(math.hypot(line[0], line[1]), 1e-9)
    x, y = own * line[0], own * line[1]
    faces = min(max(line[0] * pelvis[1] + line[1] * pelvis[4], 0.0), 1.0)  # one foot that does is enough
    fraction = 1.0 - (1.0 - share) * smoothstep(faces)
    if fraction == 1.0:
        return pelvis
    ahead, up = fraction * (x * pelvis[4] - y * pelvis[1]), fraction * pelvis[7]
    along = math.sqrt(1.0 - ahead * ahead - up * up)
    return compose(
        shortest_rotation(pelvis[1], pelvis[4], pelvis[7], along * x - ahead * y, along * y + ahead * x, up), pelvis
    )


@small_kernel
def mean_leg_length(measures):
    """Mean length of both legs from hip to ankle, metres."""
    return 0.5 * (
        measures[measure.LEG] + measures[measure.LEG + 1] + measures[measure.LEG + 2] + measures[measure.LEG + 3]
    )


@small_kernel
def pelvis_rotation(channels):
    """World rotation tuple of the pelvis: the heading times the pelvis relative to the heading."""
    a = rotation_from_quaternion(channels, channel.PELVIS)
    s, c = sine_and_cosine(channels[channel.YAW])
    return (
        c * a[0] - s * a[3], c * a[1] - s * a[4], c * a[2] - s * a[5],
        s * a[0] + c * a[3], s * a[1] + c * a[4], s * a[2] + c * a[5],
        a[6], a[7], a[8],
    )  # fmt: skip


@small_kernel
def spine_rotation(channels, index, fraction):
    """Rotation tuple of a spine segment relative to the pelvis, between the motion's segments ``index`` and ``index`` +
    1.

    It is the normalised blend of both quaternions, with ``fraction`` the weight of the second.
    """
    a = channel.SPINE + 4 * (index - 1)
    ax, ay, az, aw = 0.0, 0.0, 0.0, 1.0
    if index > 0:
        ax, ay, az, aw = channels[a], channels[a + 1], channels[a + 2], channels[a + 3]
    if fraction > 0.0:
        b = a + 4
        bx, by, bz, bw = channels[b], channels[b + 1], channels[b + 2], channels[b + 3]
        flip = -1.0 if ax * bx + ay * by + az * bz + aw * bw < 0.0 else 1.0
        keep, take = 1.0 - fraction, flip * fraction
        ax, ay, az, aw = (
            keep * ax + take * bx,
            keep * ay + take * by,
            keep * az + take * bz,
            keep * aw + take * bw,
        )
    scale = 1.0 / math.sqrt(ax * ax + ay * ay + az * az + aw * aw)
    return rotation_from_quaternion((ax * scale, ay * scale, az * scale, aw * scale), 0)


@small_kernel
def realize_head(channels, measures, play, neck_base, thorax, pose):
    """Pose neck and head (METHOD 3.3).

    The neck is rotated from the body's own rest direction, because rest directions differ between skeletons and the
    motion carries rotations only.
    """
    neck, m = (measures.shape[0] - measure.SPINE) // 3, measure.NECK_REST
    parent = compose(thorax, rotation_from_quaternion(channels, channel.NECK))
    rotation = compose(parent, rotation_with_z_axis(measures[m], measures[m + 1], measures[m + 2]))
    write_rotation(rotation, pose.rotations[neck])
    length = measures[measure.NECK]
    stray, c = play * length, channel.HEAD_SHIFT
    x, y, z = stray * channels[c], stray * channels[c + 1], stray * channels[c + 2]
    joint = write_transformed_point(neck_base, rotation, x, y, length + z, pose.positions[neck + 1])
    rotation = compose(parent, rotation_from_quaternion(channels, channel.HEAD))
    write_rotation(rotation, pose.rotations[neck + 1])
    write_transformed_point(joint, rotation, 0.0, 0.0, measures[measure.HEAD], pose.positions[neck + 2])


@small_kernel
def scaled_rotation(channels, column, fraction):
    """Rotation of a quaternion in four channels from ``column`` on, with its angle multiplied by ``fraction``."""
    x, y, z, w = channels[column], channels[column + 1], channels[column + 2], channels[column + 3]
    size = math.sqrt(x * x + y * y + z * z)
    angle = fraction * math.atan2(size, abs(w))
    scale = math.copysign(math.sin(angle) / max(size, 1e-12), w)
    return rotation_from_quaternion((scale * x, scale * y, scale * z, math.cos(angle)), 0)


@small_kernel
def clavicle_rotation(channels, measures, proportions, side):
    """Rotation of a clavicle in the thorax: the actor's rotation from rest applied to the body's own rest, scaled for
    longer clavicles.

    Its lateral reach is never less than the actor's, whatever its rest. The same rotation takes more breadth from a
    clavicle that rises at rest than from one that falls, and shoulders that meet tear the skin.
    """
    length = proportions.clavicle_ratio
    m, column, out = measure.CLAVICLE_REST + 3 * side, channel.CLAVICLE + 4 * side, 1.0 - 2.0 * side
    own = rotation_from_quaternion(channels, column)
    rotation = own if length == 1.0 else scaled_rotation(channels, column, length)
    rotation = compose(rotation, rotation_with_z_axis(measures[m], measures[m + 1], measures[m + 2]))
    rest = proportions.clavicle_rests[side]
    lost = out * (rest[1] - (own[3] * rest[0] + own[4] * rest[1] + own[5] * rest[2]))
    reach = out * rotation[5]
    beyond = out * measures[m + 1] - length * max(lost, 0.0) - reach
    if beyond <= 0.0:
        return rotation
    held = reach + beyond * beyond / (beyond + CLAVICLE_REACH_SOFTNESS)
    drawn = math.sqrt((1.0 - held * held) / (1.0 - reach * reach))
    return compose(
        shortest_rotation(rotation[2], rotation[5], rotation[8], drawn * rotation[2], out * held, drawn * rotation[8]),
        rotation,
    )


@small_kernel
def realize_arm(channels, measures, proportions, side, neck_base, thorax, pose):
    """Pose clavicle, arm and hand of one side (METHOD 3.3, 3.4).

    The arm's parent axes are the thorax rotated by the actor's clavicle rotation. ``proportions`` is the actor's
    ``FrameProportions``.
    """
    spine_count = (measures.shape[0] - measure.SPINE) // 3
    point, segment = (
        spine_count + COLLAR_POINT + POINTS_PER_LIMB * side,
        spine_count + CLAVICLE_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    parent = compose(thorax, rotation_from_quaternion(channels, channel.CLAVICLE + 4 * side))
    m = measure.COLLAR_BASE + 3 * side
    collar = write_transformed_point(
        neck_base, thorax, measures[m], measures[m + 1], measures[m + 2], pose.positions[point]
    )
    rotation = compose(thorax, clavicle_rotation(channels, measures, proportions, side))
    write_rotation(rotation, pose.rotations[segment])
    write_transformed_point(collar, rotation, 0.0, 0.0, measures[measure.CLAVICLE + side], pose.positions[point + 1])
    m = measure.ARM + 2 * side
    bones, fraction = (measures[m], measures[m + 1]), proportions.upper_bone_fractions[side]
    wrist, forearm = realize_limb(side, channels, bones, fraction, parent, point + 1, segment + 1, pose)
    hand = compose(forearm, rotation_from_quaternion(channels, channel.HAND + 4 * side))
    write_rotation(hand, pose.rotations[segment + 3])
    m = measure.HAND + 3 * side
    write_transformed_point(wrist, hand, measures[m], measures[m + 1], measures[m + 2], pose.positions[point + 4])


@small_kernel
def realize_leg(channels, measures, limbs, side, play, root, pelvis, pose):
    """Pose leg, foot and toe of one side (METHOD 3.4, 3.5).

    Leg and foot are relative to ``pelvis``, the pelvis rotation of the actor. ``limbs`` (4,) are the actor's upper
    bones as fractions of the limbs.
    """
    spine_count = (measures.shape[0] - measure.SPINE) // 3
    point, segment = (
        spine_count + HIP_POINT + POINTS_PER_LIMB * side,
        spine_count + THIGH_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    write_hip(channels, measures, side, play, root, rotation_from_matrix(pose.rotations[0]), pose.positions[point])
    bones = measures[measure.LEG + 2 * side], measures[measure.LEG + 2 * side + 1]
    ankle, _ = realize_limb(2 + side, channels, bones, limbs[2 + side], pelvis, point, segment, pose)
    foot = compose(pelvis, rotation_from_quaternion(channels, channel.FOOT + 4 * side))
    toe = compose(foot, rotation_from_quaternion(channels, channel.TOE + 4 * side))
    write_foot(side, measures, ankle, foot, toe, pose)


@small_kernel
def realize_limb(limb, channels, bones, fraction, parent, point, segment, pose):
    """Pose both bones of an arm (limb 0, 1) or leg (2, 3) from its root ``point`` on; returns the position of its end
    and the rotation of its lower bone.

    ``bones`` are the lengths of both bones in metres; ``fraction`` is the actor's upper bone relative to the limb.
    """
    length, reach = bones[0] + bones[1], 1.0 - channels[channel.LIMB_SLACK + limb]
    twist = channel.LIMB_TWIST + 2 * limb
    shape = LimbShape(
        bones,
        soft_flexion(reach * length, bones),
        channels[channel.LIMB_OFF_PLANE + limb] * length,
        channels[channel.LIMB_BEND + limb],
        (channels[twist], channels[twist + 1]),
    )
    frame = match_bone_lines(
        compose(parent, rotation_from_quaternion(channels, channel.LIMB_FRAME + 4 * limb)), shape, fraction, reach
    )
    return place_limb(point, segment, frame, shape, pose)


@small_kernel
def write_hip(channels, measures, side, play, root, pelvis, out_hip):
    """Write the world position of a hip joint into ``out_hip`` (3,) and return it.

    With ``play`` 1 it includes the actor's recorded hip shift, with 0 it does not.
    """
    m, c, stray = measure.HIP_OFFSET + 3 * side, channel.HIP_SHIFT + 3 * side, play * mean_leg_length(measures)
    return write_transformed_point(
        root,
        pelvis,
        measures[m] + stray * channels[c],
        measures[m + 1] + stray * channels[c + 1],
        measures[m + 2] + stray * channels[c + 2],
        out_hip,
    )


@small_kernel
def write_foot(side, measures, ankle, foot, toe, pose):
    """Pose foot and toe from the position of the ``ankle`` and their world rotations."""
    spine_count = (measures.shape[0] - measure.SPINE) // 3
    point, segment = (
        spine_count + TOE_POINT + POINTS_PER_LIMB * side,
        spine_count + FOOT_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    write_rotation(foot, pose.rotations[segment])
    write_rotation(toe, pose.rotations[segment + 1])
    m = measure.FOOT + 3 * side
    joint = write_transformed_point(ankle, foot, measures[m], measures[m + 1], measures[m + 2], pose.positions[point])
    m = measure.TOE + 3 * side
    write_transformed_point(joint, toe, measures[m], measures[m + 1], measures[m + 2], pose.positions[point + 1])
