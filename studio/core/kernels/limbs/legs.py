"""Legs placed on the ankles that the ground asks for (METHOD 4)."""

import math

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.algebra.eases import smoothstep
from studio.core.kernels.algebra.turns import aimed, product, put_beside, turn_in, turn_of, twisted
from studio.core.kernels.body.realize import put_foot, put_hip
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel
from studio.core.kernels.limbs.limb import middle_of, no_nearer, place_limb, soft_reach
from studio.core.kernels.records import Limb

KNEE, KNEE_FIRM = 3, 6
"""The numbers of an ankle of 7 with the place (3,) that its knee faces, and with 1 where it does."""
KNEE_GUARD = 0.0004
"""Square metres (distance of the knee from its leg's line times that of its place) below which a held knee lets go."""
FACED = 0.5
"""Parts of its length away from a leg's line at which the place lies that a knee in the air faces."""


@allocating_kernel
def hip_heights(channels, measures, rotations, ankles, comforts, states, out_drops):
    """How far the root must come down at each frame, (F,) metres, for standing feet to be in reach (K05 section 7).

    The heights h2, h3 of the paper against h1, the root as it is.
    ``rotations`` (F, S, 3, 3); ``ankles`` (2, F, 3) targets relative to the root as it is; ``comforts`` (2, F) part
    of its length to which each leg stretches freely; ``states`` (2, F).

    METHOD (9).
    """
    hip, root = np.empty(3), np.zeros(3)
    for frame in range(channels.shape[0]):
        out_drops[frame] = 0.0
        row = measures[frame if measures.shape[0] > 1 else 0]
        for side in range(2):
            if states[side, frame] == 0:
                continue
            put_hip(channels[frame], row, side, 0.0, root, turn_in(rotations[frame, 0]), hip)
            length = row[at.M_LEG + 2 * side] + row[at.M_LEG + 2 * side + 1]
            reach = length * comforts[side, frame]
            x, y = ankles[side, frame, 0] - hip[0], ankles[side, frame, 1] - hip[1]
            below = math.sqrt(max(0.0, reach * reach - x * x - y * y))
            drop = -(ankles[side, frame, 2] - hip[2]) - below
            out_drops[frame] = max(out_drops[frame], drop)


@kernel
def lower_smoothly(drops, window, out_peaks, out_drops):
    """At least ``drops`` (F,) and 0 everywhere: the greatest around, averaged over the same support by ``window``.

    The window (2 n + 1,) adds up to 1; beyond its ends a motion goes on as it is there. METHOD (9).
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
    """One leg of one frame: hip from the root, ankle at its target, foot and toe as given (METHOD 6, limb_to).

    The knee always bends forward: captures hyperextend it by a few degrees and then it snaps. A target beyond the
    leg's comfort is neared as far as ``soft_reach`` says; the root has come down for feet that stand.
    ``legs`` and ``pose`` of one frame as in ``kernels.records``. An ankle may have 7 numbers (``KNEE``).
    """
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    _, frame, limb = aim_leg(side, measures, legs, pose)
    end, _ = place_limb(spine_count + 13 + 5 * side, spine_count + 10 + 4 * side, frame, limb, pose)
    put_foot(side, measures, end, turn_in(legs.feet[side]), turn_in(legs.toes[side]), pose)


@small_kernel
def aim_leg(side, measures, legs, pose):
    """Put the hip on the pelvis; its place, the leg's frame, and how the leg lies in that."""
    channels, ankle = legs.channels, legs.ankles[side]
    point = (measures.shape[0] - at.M_SPINE) // 3 + 13 + 5 * side
    pelvis = turn_in(pose.rotations[0])
    hip = put_hip(channels, measures, side, 0.0, pose.positions[0], pelvis, pose.positions[point])
    frame, reach, off_plane = leg_line(channels, measures, side, legs.comforts[side], ankle, hip, pelvis)
    upper, lower = measures[at.M_LEG + 2 * side], measures[at.M_LEG + 2 * side + 1]
    if ankle.shape[0] > 3 and ankle[KNEE_FIRM] > 0.0:
        frame = twisted(frame, knee_swivel(hip, ankle, upper, lower, reach, off_plane, frame))
    t = at.LIMB_TWIST + 2 * (2 + side)
    return hip, frame, Limb((upper, lower), reach, off_plane, 1.0, (channels[t], channels[t + 1]))


@kernel
def place_leg_points(side, measures, legs, before, pose):
    """The points alone of ``place_leg``; ``before`` (P, 3) has the foot beside its ankle as it is to be."""
    positions, point = pose.positions, (measures.shape[0] - at.M_SPINE) // 3 + 13 + 5 * side
    hip, frame, limb = aim_leg(side, measures, legs, pose)
    x, y, z, distance = middle_of(limb)
    put_beside(hip, frame, x, y, z, positions[point + 1])
    put_beside(hip, frame, 0.0, 0.0, distance, positions[point + 2])
    for bone in range(3, 5):
        for axis in range(3):
            positions[point + bone, axis] = positions[point + 2, axis] + (
                before[point + bone, axis] - before[point + 2, axis]
            )


@kernel
def leg_line(channels, measures, side, comfort, ankle, hip, pelvis):
    """A leg's frame (a turn) aimed from its ``hip`` (3,) at its ankle, its reach in metres, its knee off the plane.

    METHOD (4), (11).
    """
    upper, lower = measures[at.M_LEG + 2 * side], measures[at.M_LEG + 2 * side + 1]
    length = upper + lower
    x, y, z = ankle[0] - hip[0], ankle[1] - hip[1], ankle[2] - hip[2]
    distance = math.sqrt(x * x + y * y + z * z)
    frame = product(pelvis, turn_of(channels, at.LIMB_FRAME + 4 * (2 + side)))
    if distance > 1e-9:
        per = 1.0 / distance
        frame = aimed(frame, per * x, per * y, per * z)
    reach = no_nearer(length * soft_reach(distance / length, comfort), (upper, lower))
    off_plane, own = (
        channels[at.LIMB_OFF_PLANE + 2 + side] * length,
        length * (1.0 - channels[at.LIMB_SLACK + 2 + side]),
    )
    if reach > own:  # straighter: the knee keeps its side, where at one place it would turn right round
        off_plane *= knee_radius(upper, lower, reach) / max(knee_radius(upper, lower, own), 1e-9)
    return frame, reach, off_plane


@small_kernel
def knee_radius(upper, lower, distance):
    """Metres from a knee to the line of its hip and ankle, which are ``distance`` apart (METHOD (5))."""
    distance = max(distance, 1e-6)
    z = (upper * upper - lower * lower + distance * distance) / (2.0 * distance)
    return math.sqrt(max(0.0, upper * upper - z * z))


@allocating_kernel
def knee_swivels(channels, measures, side, comforts, ankles, hips, pelvises, out_angles):
    """Radians (F,) by which a knee turns about the line of hip and ankle to face its place in ``ankles`` (F, 7).

    ``comforts`` (F,); ``hips`` (F, 3); ``pelvises`` (F, 3, 3).
    """
    for frame in range(channels.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        turn, reach, off_plane = leg_line(
            channels[frame], row, side, comforts[frame], ankles[frame], hips[frame], turn_in(pelvises[frame])
        )
        upper, lower = row[at.M_LEG + 2 * side], row[at.M_LEG + 2 * side + 1]
        out_angles[frame] = knee_swivel(hips[frame], ankles[frame], upper, lower, reach, off_plane, turn)


@allocating_kernel
def face_knees(channels, measures, side, comforts, angles, hips, pelvises, ankles):
    """Write into ``ankles`` (F, 7) places that knees turned by ``angles`` (F,) face: ``knee_swivels`` backwards."""
    for frame in range(channels.shape[0]):
        ankle, hip = ankles[frame], hips[frame]
        ankle[KNEE_FIRM] = 0.0
        if angles[frame] == 0.0:
            continue
        row = measures[frame if measures.shape[0] > 1 else 0]
        turn, reach, off_plane = leg_line(
            channels[frame], row, side, comforts[frame], ankle, hip, turn_in(pelvises[frame])
        )
        upper, lower = row[at.M_LEG + 2 * side], row[at.M_LEG + 2 * side + 1]
        x, y, _ = natural_knee(upper, lower, reach, off_plane)
        angle = math.atan2(y, x) + angles[frame]
        c, s = FACED * (upper + lower) * math.cos(angle), FACED * (upper + lower) * math.sin(angle)
        for axis in range(3):
            ankle[KNEE + axis] = hip[axis] + c * turn[3 * axis] + s * turn[3 * axis + 1]
        ankle[KNEE_FIRM] = 1.0


@small_kernel
def natural_knee(upper, lower, distance, off_plane):
    """Where a leg's knee is in its frame, across the line of hip and ankle, and how far from that line (METHOD (5))."""
    radius = knee_radius(upper, lower, distance)
    x = min(max(off_plane, -radius), radius)
    return x, math.sqrt(max(0.0, radius * radius - x * x)), radius


@kernel
def is_placed(side, measures, legs, pose):
    """Whether a leg as realised is already where ``place_leg`` would put it."""
    channels, ankle = legs.channels, legs.ankles[side]
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    point, segment = spine_count + 15 + 5 * side, spine_count + 12 + 4 * side
    upper, lower = measures[at.M_LEG + 2 * side], measures[at.M_LEG + 2 * side + 1]
    stretch = 1.0 - channels[at.LIMB_SLACK + 2 + side]
    if channels[at.LIMB_BEND + 2 + side] != 1.0 or stretch > legs.comforts[side]:
        return False
    if stretch * (upper + lower) < abs(upper - lower) + 1e-6 or (ankle.shape[0] > 3 and ankle[KNEE_FIRM] > 0.0):
        return False
    return (
        same_point(ankle, pose.positions[point])
        and same_turn(legs.feet[side], pose.rotations[segment])
        and same_turn(legs.toes[side], pose.rotations[segment + 1])
    )


@small_kernel
def same_point(a, b):
    """Whether two points (3,) are one."""
    return a[0] == b[0] and a[1] == b[1] and a[2] == b[2]


@small_kernel
def same_turn(a, b):
    """Whether two matrices (3, 3) are one."""
    return same_point(a[0], b[0]) and same_point(a[1], b[1]) and same_point(a[2], b[2])


@kernel
def knee_swivel(hip, ankle, upper, lower, distance, off_plane, frame):
    """Radians by which a leg's ``frame`` (a turn) turns about its z axis until the knee faces its place (METHOD (4)).

    ``ankle`` (7,) as in ``place_leg``. Hardly at all where the knee is on the line of hip and ankle, or its place is.
    """
    x, y, radius = natural_knee(upper, lower, distance, off_plane)
    wanted_x, wanted_y = 0.0, 0.0
    for axis in range(3):
        wanted_x += frame[3 * axis] * (ankle[KNEE + axis] - hip[axis])
        wanted_y += frame[3 * axis + 1] * (ankle[KNEE + axis] - hip[axis])
    away = radius * math.hypot(wanted_x, wanted_y)
    angle = math.atan2(wanted_y, wanted_x) - math.atan2(y, x)
    angle -= 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))
    return smoothstep(min(away / KNEE_GUARD, 1.0)) * angle
