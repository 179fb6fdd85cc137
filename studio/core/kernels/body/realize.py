"""From channels to a posed body: the morphology-independent motion takes the measures of one body (METHOD 3)."""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.eases import smoothstep
from studio.core.kernels.algebra.turns import (
    along,
    product,
    put_beside,
    put_turn,
    shortest,
    sine_and_cosine,
    turn_in,
    turn_of,
)
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.limbs.limb import folded, place_limb, soft_fold
from studio.core.kernels.records import Array, Limb, Pose

NARROWED = 0.003
"""Part of a clavicle by which it goes inwards farther than the actor's before it is half held back."""


class Girdles(NamedTuple):
    """Of the actor, beside those of the body that is posed."""

    lengths: Array
    """(F or 1,) of the actor's clavicles in parts of the body's, both in parts of the shoulders' breadth, 1 at most."""
    rests: Array
    """(2, 3) directions of the actor's clavicles at rest, in the thorax."""
    hips: Array
    """(F or 1,) breadth of the actor's hips in parts of the body's, both in parts of the legs' length, 1 at most."""
    lines: Array
    """(F, 2) how its feet lie across, as ``NormalizedMotion.across`` has them."""
    limbs: Array
    """(4,) parts of its arms and legs that are upper arm and thigh."""


class Girdle(NamedTuple):
    """``Girdles`` in one frame."""

    length: float
    rests: Array
    hips: float
    line: Array
    limbs: Array


@allocating_kernel
def realize_frames(channels, places, measures, actor, play, out_positions, out_rotations):
    """Pose a body at every frame (METHOD 3; eq. 2 of K05).

    ``channels`` (F, 89 + 4 K_motion); ``places`` (K_motion,) along the trunk; ``measures`` (F or 1, 57 + 3 K);
    ``actor`` has Girdles; ``play`` 1 keeps the actor's stray of hips and head, 0 drops it. Out: (F, K + 23, 3)
    metres, (F, K + 18, 3, 3), motion space.
    """
    spine_from, spine_share = sample_spine(places, measures[0])
    realize_each(channels, measures, actor, spine_from, spine_share, play, out_positions, out_rotations)


@kernel
def realize_each(channels, measures, actor, spine_from, spine_share, play, out_positions, out_rotations):
    """``realize_frames`` with its spine sampled."""
    for frame in range(channels.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        pose = Pose(out_positions[frame], out_rotations[frame])
        length, hips = actor.lengths[frame % actor.lengths.shape[0]], actor.hips[frame % actor.hips.shape[0]]
        girdle = Girdle(length, actor.rests, hips, actor.lines[frame], actor.limbs)
        realize_frame(channels[frame], row, girdle, spine_from, spine_share, play, pose)


@allocating_kernel
def sample_spine(places, measures):
    """For each of a body's K spine segments: after which of the motion's it lies, and how far to the next (0 to 1).

    The pelvis takes the pelvis and the thorax the thorax; what lies between is sampled by its place along the
    trunk, so arms hang the same however many vertebrae a body has. ``places`` (K_motion,) from 0 to 1.
    """
    count, last = (measures.shape[0] - at.M_SPINE) // 3, places.shape[0] - 1
    own, index, share = np.zeros(count), np.zeros(count, np.int64), np.zeros(count)
    for k in range(1, count):
        m = at.M_SPINE + 3 * (k - 1)
        own[k] = own[k - 1] + math.sqrt(measures[m] ** 2 + measures[m + 1] ** 2 + measures[m + 2] ** 2)
    for k in range(count):
        place = own[k] / own[count - 1]
        while index[k] < last and places[index[k] + 1] <= place + 1e-9:
            index[k] += 1
        begin = places[index[k]]
        span = places[index[k] + 1] - begin if index[k] < last else 1.0
        part = min(max((place - begin) / span, 0.0), 1.0)
        share[k] = part if part >= 1e-6 else 0.0
    return index, share


@kernel
def realize_frame(channels, measures, girdle, spine_from, spine_share, play, pose):
    """One frame of ``realize_frames``; ``girdle`` the actor's Girdle."""
    root, pelvis, neck_base, thorax = realize_trunk(channels, measures, girdle, spine_from, spine_share, pose)
    realize_head(channels, measures, play, neck_base, thorax, pose)
    for side in range(2):
        realize_arm(channels, measures, girdle, side, neck_base, thorax, pose)
        realize_leg(channels, measures, girdle.limbs, side, play, root, pelvis, pose)


@small_kernel
def realize_trunk(channels, measures, girdle, spine_from, spine_share, pose):
    """Pelvis and spine (METHOD 3.1, 3.2); place and turn of the pelvis and, at the neck base, of the thorax.

    The pelvis itself turns by less where hips are wider than the actor's, of which its ``girdle`` says, so that they
    stay as near over feet that stand; trunk and legs do not turn with it.
    """
    upright = pelvis_turn(channels)
    pelvis = upright if girdle.hips == 1.0 else levelled(upright, girdle.hips, girdle.line)
    leg, m = mean_leg(measures), at.M_HIP_OFFSET
    middle = (
        channels[at.HIPS] * leg,
        channels[at.HIPS + 1] * leg,
        channels[at.HIPS + 2] * leg + 0.5 * (measures[at.M_ANKLE_HEIGHT] + measures[at.M_ANKLE_HEIGHT + 1]),
    )
    root = put_beside(
        middle,
        pelvis,
        -0.5 * (measures[m] + measures[m + 3]),
        -0.5 * (measures[m + 1] + measures[m + 4]),
        -0.5 * (measures[m + 2] + measures[m + 5]),
        pose.positions[0],
    )
    place, turn = root, pelvis
    for k in range(spine_from.shape[0]):
        if k > 0:
            turn = product(upright, spine_turn(channels, spine_from[k], spine_share[k]))
        put_turn(turn, pose.rotations[k])
        m = at.M_SPINE + 3 * k
        place = put_beside(place, turn, measures[m], measures[m + 1], measures[m + 2], pose.positions[k + 1])
    return root, upright, place, turn


@small_kernel
def levelled(pelvis, share, line):
    """A pelvis whose line of hips turns and rises but by a ``share`` beside the level ``line`` (2,) across its feet.

    It does so the less, the more its feet are turned from it, or lie on their sides.
    """
    own = 1.0 / max(math.hypot(line[0], line[1]), 1e-9)
    x, y = own * line[0], own * line[1]
    faces = min(max(line[0] * pelvis[1] + line[1] * pelvis[4], 0.0), 1.0)  # one foot that does is enough
    part = 1.0 - (1.0 - share) * smoothstep(faces)
    if part == 1.0:
        return pelvis
    ahead, up = part * (x * pelvis[4] - y * pelvis[1]), part * pelvis[7]
    along = math.sqrt(1.0 - ahead * ahead - up * up)
    return product(shortest(pelvis[1], pelvis[4], pelvis[7], along * x - ahead * y, along * y + ahead * x, up), pelvis)


@small_kernel
def mean_leg(measures):
    """Metres from hip to ankle, the mean of both legs."""
    return 0.5 * (measures[at.M_LEG] + measures[at.M_LEG + 1] + measures[at.M_LEG + 2] + measures[at.M_LEG + 3])


@small_kernel
def pelvis_turn(channels):
    """The heading, and the pelvis relative to it."""
    a = turn_of(channels, at.PELVIS)
    s, c = sine_and_cosine(channels[at.YAW])
    return (
        c * a[0] - s * a[3], c * a[1] - s * a[4], c * a[2] - s * a[5],
        s * a[0] + c * a[3], s * a[1] + c * a[4], s * a[2] + c * a[5],
        a[6], a[7], a[8],
    )  # fmt: skip


@small_kernel
def spine_turn(channels, index, share):
    """Turn of a spine segment relative to the pelvis: normalised blend of two neighbours' quaternions."""
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
    return turn_of((ax * scale, ay * scale, az * scale, aw * scale), 0)


@small_kernel
def realize_head(channels, measures, play, neck_base, thorax, pose):
    """Neck and head (METHOD 3.3). The neck turns away from its own rest in the thorax, because bodies (and captures)
    draw it along other lines: what a motion carries over is the turn, not the line. So do clavicles.
    """
    neck, m = (measures.shape[0] - at.M_SPINE) // 3, at.M_NECK_REST
    carrier = product(thorax, turn_of(channels, at.NECK))
    turn = product(carrier, along(measures[m], measures[m + 1], measures[m + 2]))
    put_turn(turn, pose.rotations[neck])
    length = measures[at.M_NECK]
    stray, c = play * length, at.HEAD_PLAY
    x, y, z = stray * channels[c], stray * channels[c + 1], stray * channels[c + 2]
    joint = put_beside(neck_base, turn, x, y, length + z, pose.positions[neck + 1])
    turn = product(carrier, turn_of(channels, at.HEAD))
    put_turn(turn, pose.rotations[neck + 1])
    put_beside(joint, turn, 0.0, 0.0, measures[at.M_HEAD], pose.positions[neck + 2])


@small_kernel
def part_of_turn(channels, column, share):
    """A ``share`` of the shorter turn whose quaternion stands in four columns of a frame."""
    x, y, z, w = channels[column], channels[column + 1], channels[column + 2], channels[column + 3]
    size = math.sqrt(x * x + y * y + z * z)
    angle = share * math.atan2(size, abs(w))
    scale = math.copysign(math.sin(angle) / max(size, 1e-12), w)
    return turn_of((scale * x, scale * y, scale * z, math.cos(angle)), 0)


@small_kernel
def clavicle_turn(channels, measures, girdle, side):
    """Of a clavicle in the thorax: from the body's own rest as the actor's from the actor's, longer ones by less.

    Outwards it reaches no less than the actor's, however it lies at rest: the same turn takes more of the breadth of
    the shoulders from a clavicle that rises at rest than from one that falls, and shoulders that meet tear the skin.
    """
    length = girdle.length
    m, column, out = at.M_CLAVICLE_REST + 3 * side, at.CLAVICLE + 4 * side, 1.0 - 2.0 * side
    own = turn_of(channels, column)
    turn = own if length == 1.0 else part_of_turn(channels, column, length)
    turn = product(turn, along(measures[m], measures[m + 1], measures[m + 2]))
    rest = girdle.rests[side]
    lost = out * (rest[1] - (own[3] * rest[0] + own[4] * rest[1] + own[5] * rest[2]))
    reach = out * turn[5]
    beyond = out * measures[m + 1] - length * max(lost, 0.0) - reach
    if beyond <= 0.0:
        return turn
    held = reach + beyond * beyond / (beyond + NARROWED)
    drawn = math.sqrt((1.0 - held * held) / (1.0 - reach * reach))
    return product(shortest(turn[2], turn[5], turn[8], drawn * turn[2], out * held, drawn * turn[8]), turn)


@small_kernel
def realize_arm(channels, measures, girdle, side, neck_base, thorax, pose):
    """Clavicle, arm and hand (METHOD 3.3, 3.4); the arm lies in the thorax carried along by the actor's clavicle.

    ``girdle`` is the actor's.
    """
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    point, segment = spine_count + 3 + 5 * side, spine_count + 2 + 4 * side
    carrier = product(thorax, turn_of(channels, at.CLAVICLE + 4 * side))
    m = at.M_COLLAR_BASE + 3 * side
    collar = put_beside(neck_base, thorax, measures[m], measures[m + 1], measures[m + 2], pose.positions[point])
    turn = product(thorax, clavicle_turn(channels, measures, girdle, side))
    put_turn(turn, pose.rotations[segment])
    put_beside(collar, turn, 0.0, 0.0, measures[at.M_CLAVICLE + side], pose.positions[point + 1])
    m = at.M_ARM + 2 * side
    bones, part = (measures[m], measures[m + 1]), girdle.limbs[side]
    wrist, forearm = realize_limb(side, channels, bones, part, carrier, point + 1, segment + 1, pose)
    hand = product(forearm, turn_of(channels, at.HAND + 4 * side))
    put_turn(hand, pose.rotations[segment + 3])
    m = at.M_HAND + 3 * side
    put_beside(wrist, hand, measures[m], measures[m + 1], measures[m + 2], pose.positions[point + 4])


@small_kernel
def realize_leg(channels, measures, limbs, side, play, root, pelvis, pose):
    """Leg, foot and toe (METHOD 3.4, 3.5); leg and foot lie in the ``pelvis`` as the actor turns it.

    ``limbs`` (4,) parts of the actor's that are upper bones.
    """
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    point, segment = spine_count + 13 + 5 * side, spine_count + 10 + 4 * side
    put_hip(channels, measures, side, play, root, turn_in(pose.rotations[0]), pose.positions[point])
    bones = measures[at.M_LEG + 2 * side], measures[at.M_LEG + 2 * side + 1]
    ankle, _ = realize_limb(2 + side, channels, bones, limbs[2 + side], pelvis, point, segment, pose)
    foot = product(pelvis, turn_of(channels, at.FOOT + 4 * side))
    toe = product(foot, turn_of(channels, at.TOE + 4 * side))
    put_foot(side, measures, ankle, foot, toe, pose)


@small_kernel
def realize_limb(limb, channels, bones, part, carrier, point, segment, pose):
    """Both bones of arm (limb 0, 1) or leg (2, 3) from its root ``point`` on; place and turn at their end.

    ``bones`` are their lengths; of the actor's limb the upper one is a ``part``.
    """
    length, reach = bones[0] + bones[1], 1.0 - channels[at.LIMB_SLACK + limb]
    twist = at.LIMB_TWIST + 2 * limb
    shape = Limb(
        bones,
        soft_fold(reach * length, bones),
        channels[at.LIMB_OFF_PLANE + limb] * length,
        channels[at.LIMB_BEND + limb],
        (channels[twist], channels[twist + 1]),
    )
    frame = folded(product(carrier, turn_of(channels, at.LIMB_FRAME + 4 * limb)), shape, part, reach)
    return place_limb(point, segment, frame, shape, pose)


@small_kernel
def put_hip(channels, measures, side, play, root, pelvis, out_hip):
    """Write the hip joint (3,): its place in the pelvis and, for the actor, its stray from there; that place."""
    m, c, stray = at.M_HIP_OFFSET + 3 * side, at.HIP_PLAY + 3 * side, play * mean_leg(measures)
    return put_beside(
        root,
        pelvis,
        measures[m] + stray * channels[c],
        measures[m + 1] + stray * channels[c + 1],
        measures[m + 2] + stray * channels[c + 2],
        out_hip,
    )


@small_kernel
def put_foot(side, measures, ankle, foot, toe, pose):
    """Foot and toe by their turns, from where the ankle is on."""
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    point, segment = spine_count + 16 + 5 * side, spine_count + 12 + 4 * side
    put_turn(foot, pose.rotations[segment])
    put_turn(toe, pose.rotations[segment + 1])
    m = at.M_FOOT + 3 * side
    joint = put_beside(ankle, foot, measures[m], measures[m + 1], measures[m + 2], pose.positions[point])
    m = at.M_TOE + 3 * side
    put_beside(joint, toe, measures[m], measures[m + 1], measures[m + 2], pose.positions[point + 1])
