"""From channels to a posed body: the morphology-independent motion takes the measures of one body."""

import math

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limb import place_limb
from studio.core.kernels.rotation import add_rotated, frame_along, multiply, quaternion_to_matrix


@allocating_kernel
def realize_frames(channels, measures, spine_from, spine_share, play, out_positions, out_rotations):
    """Pose a body at every frame (METHOD 3; eq. 2 of K05).

    ``channels`` (F, 89 + 4 K_motion); ``measures`` (F or 1, 57 + 3 K); ``spine_from`` (K,) and ``spine_share``
    (K,) say between which of the motion's spine segments each segment of the body lies; ``play`` 1 keeps the
    actor's stray of hips and head, 0 drops it. Out: (F, K + 23, 3) metres, (F, K + 18, 3, 3), motion space.
    """
    work = np.empty((4, 3, 3))
    for frame in range(channels.shape[0]):
        row = frame if measures.shape[0] > 1 else 0
        realize_frame(frame, row, channels, measures, spine_from, spine_share, play, work, out_positions, out_rotations)


@kernel
def realize_frame(frame, row, channels, measures, spine_from, spine_share, play, work, out_positions, out_rotations):
    """One frame of ``realize_frames`` with the measures of ``row``; ``work`` (4, 3, 3) is scratch."""
    channel, measure, points, turns = channels[frame], measures[row], out_positions[frame], out_rotations[frame]
    scratch, carriers = work[0], work[2:4]
    realize_trunk(channel, measure, spine_from, spine_share, play, scratch, carriers, points, turns)
    for limb in range(4):
        carrier = carriers[limb] if limb < 2 else turns[0]
        realize_limb(channel, measure, limb, play, carrier, scratch, work[1], points, turns)


@kernel
def realize_trunk(channels, measures, spine_from, spine_share, play, scratch, carriers, out_positions, out_rotations):
    """Root, spine, neck, head and clavicles of one frame (METHOD 3.1 to 3.3).

    Neck and clavicles turn away from their own rest in the thorax, because bodies (and captures) draw them along
    other lines: what a motion carries over is the turn, not the line. ``carriers`` (2, 3, 3) becomes the thorax
    carried along by each clavicle, in which arms lie.
    """
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    place_root(channels, measures, scratch, out_positions, out_rotations)
    for k in range(spine_count):
        if k > 0:
            spine_rotation(channels, spine_from[k], spine_share[k], scratch)
            multiply(out_rotations[0], scratch, out_rotations[k])
        place_offset(measures, at.M_SPINE + 3 * k, out_positions[k], out_rotations[k], out_positions[k + 1])
    thorax, neck = spine_count - 1, spine_count
    carrier = carriers[0]
    m, length = at.M_NECK_REST, measures[at.M_NECK]
    turn_from_rest(channels, at.NECK, measures, m, out_rotations[thorax], scratch, carrier, out_rotations[neck])
    stray = play * length
    add_rotated(
        out_positions[neck],
        out_rotations[neck],
        stray * channels[at.HEAD_PLAY],
        stray * channels[at.HEAD_PLAY + 1],
        length + stray * channels[at.HEAD_PLAY + 2],
        out_positions[neck + 1],
    )
    quaternion_to_matrix(channels[at.HEAD : at.HEAD + 4], scratch)
    multiply(carrier, scratch, out_rotations[neck + 1])
    head, along = out_rotations[neck + 1], measures[at.M_HEAD]
    add_rotated(out_positions[neck + 1], head, 0.0, 0.0, along, out_positions[neck + 2])
    for side in range(2):
        point, segment = spine_count + 3 + 5 * side, spine_count + 2 + 4 * side
        m, q = at.M_CLAVICLE_REST + 3 * side, at.CLAVICLE + 4 * side
        base = at.M_COLLAR_BASE + 3 * side
        place_offset(measures, base, out_positions[neck], out_rotations[thorax], out_positions[point])
        thorax_turn, clavicle = out_rotations[thorax], out_rotations[segment]
        turn_from_rest(channels, q, measures, m, thorax_turn, scratch, carriers[side], clavicle)
        along = measures[at.M_CLAVICLE + side]
        add_rotated(out_positions[point], clavicle, 0.0, 0.0, along, out_positions[point + 1])


@kernel
def place_root(channels, measures, scratch, out_positions, out_rotations):
    """Rotation and place of the pelvis of one frame: the middle of the hips stands where the channels say."""
    leg = 0.5 * (measures[at.M_LEG] + measures[at.M_LEG + 1] + measures[at.M_LEG + 2] + measures[at.M_LEG + 3])
    quaternion_to_matrix(channels[at.PELVIS : at.PELVIS + 4], scratch)
    c, s = math.cos(channels[at.YAW]), math.sin(channels[at.YAW])
    for column in range(3):
        out_rotations[0, 0, column] = c * scratch[0, column] - s * scratch[1, column]
        out_rotations[0, 1, column] = s * scratch[0, column] + c * scratch[1, column]
        out_rotations[0, 2, column] = scratch[2, column]
    m = at.M_HIP_OFFSET
    for axis in range(3):
        out_positions[0, axis] = channels[at.HIPS + axis] * leg
        for column in range(3):
            middle = 0.5 * (measures[m + column] + measures[m + 3 + column])
            out_positions[0, axis] -= out_rotations[0, axis, column] * middle
    out_positions[0, 2] += 0.5 * (measures[at.M_ANKLE_HEIGHT] + measures[at.M_ANKLE_HEIGHT + 1])


@kernel
def place_offset(measures, m, origin, rotation, out_point):
    """Point (3,) at the measures ``m`` to ``m + 2`` from ``origin``, in the axes of ``rotation`` (3, 3)."""
    add_rotated(origin, rotation, measures[m], measures[m + 1], measures[m + 2], out_point)


@kernel
def turn_from_rest(channels, q, measures, m, thorax, scratch, out_carrier, out_rotation):
    """Neck or clavicle: the thorax carried along (3, 3), and the segment that lies in it along its rest (3, 3)."""
    quaternion_to_matrix(channels[q : q + 4], scratch)
    multiply(thorax, scratch, out_carrier)
    frame_along(measures[m], measures[m + 1], measures[m + 2], scratch)
    multiply(out_carrier, scratch, out_rotation)


@kernel
def spine_rotation(channels, index, share, out_matrix):
    """Orientation of a spine segment relative to the pelvis: normalised blend of two neighbours' quaternions."""
    a = at.SPINE + 4 * (index - 1)
    ax, ay, az, aw = 0.0, 0.0, 0.0, 1.0
    if index > 0:
        ax, ay, az, aw = channels[a], channels[a + 1], channels[a + 2], channels[a + 3]
    if share > 0.0:
        b = a + 4
        bx, by, bz, bw = channels[b], channels[b + 1], channels[b + 2], channels[b + 3]
        flip = -1.0 if ax * bx + ay * by + az * bz + aw * bw < 0.0 else 1.0
        keep, take = 1.0 - share, flip * share
        ax, ay, az, aw = (
            keep * ax + take * bx,
            keep * ay + take * by,
            keep * az + take * bz,
            keep * aw + take * bw,
        )
    scale = 1.0 / math.sqrt(ax * ax + ay * ay + az * az + aw * aw)
    quaternion_to_matrix((ax * scale, ay * scale, az * scale, aw * scale), out_matrix)


@kernel
def realize_limb(channels, measures, limb, play, carrier, scratch, work, out_positions, out_rotations):
    """One arm (limb 0, 1) or leg (2, 3) of one frame with its hand or foot (METHOD 3.3 to 3.5)."""
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    side, is_leg = limb % 2, limb >= 2
    if is_leg:
        point, segment, m = spine_count + 13 + 5 * side, spine_count + 10 + 4 * side, at.M_LEG + 2 * side
        place_hip(channels, measures, side, play, out_positions[0], out_rotations[0], out_positions[point])
    else:
        point, segment, m = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side, at.M_ARM + 2 * side
    upper, lower = measures[m], measures[m + 1]
    q, t = at.LIMB_FRAME + 4 * limb, at.LIMB_TWIST + 2 * limb
    quaternion_to_matrix(channels[q : q + 4], scratch)
    multiply(carrier, scratch, work)
    place_limb(
        out_positions[point],
        work,
        (1.0 - channels[at.LIMB_SLACK + limb]) * (upper + lower),
        upper,
        lower,
        channels[at.LIMB_OFF_PLANE + limb] * (upper + lower),
        channels[at.LIMB_BEND + limb],
        channels[t : t + 2],
        scratch,
        out_positions[point + 1 : point + 3],
        out_rotations[segment],
        out_rotations[segment + 1],
    )
    q = (at.FOOT if is_leg else at.HAND) + 4 * side
    quaternion_to_matrix(channels[q : q + 4], scratch)
    multiply(out_rotations[0 if is_leg else segment + 1], scratch, out_rotations[segment + 2])
    if is_leg:
        q = at.TOE + 4 * side
        quaternion_to_matrix(channels[q : q + 4], scratch)
        multiply(out_rotations[segment + 2], scratch, out_rotations[segment + 3])
        place_toes(measures, side, point + 2, segment + 2, out_positions, out_rotations)
    else:
        m = at.M_HAND + 3 * side
        add_rotated(
            out_positions[point + 2],
            out_rotations[segment + 2],
            measures[m],
            measures[m + 1],
            measures[m + 2],
            out_positions[point + 3],
        )


@kernel
def place_hip(channels, measures, side, play, root, pelvis, out_hip):
    """Hip joint (3,): its place in the pelvis and, for the actor, its stray from there."""
    leg = 0.5 * (measures[at.M_LEG] + measures[at.M_LEG + 1] + measures[at.M_LEG + 2] + measures[at.M_LEG + 3])
    m, c, stray = at.M_HIP_OFFSET + 3 * side, at.HIP_PLAY + 3 * side, play * leg
    add_rotated(
        root,
        pelvis,
        measures[m] + stray * channels[c],
        measures[m + 1] + stray * channels[c + 1],
        measures[m + 2] + stray * channels[c + 2],
        out_hip,
    )


@kernel
def place_toes(measures, side, ankle, foot, out_positions, out_rotations):
    """Toe joint and toe end from the ankle and the rotations of foot and toe, written into one frame's arrays."""
    m = at.M_FOOT + 3 * side
    add_rotated(
        out_positions[ankle],
        out_rotations[foot],
        measures[m],
        measures[m + 1],
        measures[m + 2],
        out_positions[ankle + 1],
    )
    m = at.M_TOE + 3 * side
    add_rotated(
        out_positions[ankle + 1],
        out_rotations[foot + 1],
        measures[m],
        measures[m + 1],
        measures[m + 2],
        out_positions[ankle + 2],
    )
