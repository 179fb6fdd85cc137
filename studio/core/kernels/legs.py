"""Legs placed on the ankles that the ground asks for."""

import math

import numpy as np

from studio.core.kernels import layout as at
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.feet import smoothstep
from studio.core.kernels.limb import place_limb, soft_reach
from studio.core.kernels.realize import place_hip, place_toes
from studio.core.kernels.rotation import multiply, orthonormalize, quaternion_to_matrix, shortest_arc, turn_columns

KNEE_GUARD = 0.0004
"""Square metres (distance of the knee from its leg's line times that of its place) below which a held knee lets go."""


@allocating_kernel
def hip_heights(channels, measures, rotations, ankles, comforts, states, out_drops):
    """How far the root must come down at each frame, (F,) metres, for standing feet to be in reach (K05 section 7).

    The heights h2, h3 of the paper against h1, the root as it is.
    ``rotations`` (F, S, 3, 3); ``ankles`` (2, F, 3) targets relative to the root as it is; ``comforts`` (2, F) part
    of its length to which each leg stretches freely; ``states`` (2, F).
    """
    hip, root = np.empty(3), np.zeros(3)
    for frame in range(channels.shape[0]):
        out_drops[frame] = 0.0
        row = measures[frame if measures.shape[0] > 1 else 0]
        for side in range(2):
            if states[side, frame] == 0:
                continue
            place_hip(channels[frame], row, side, 0.0, root, rotations[frame, 0], hip)
            length = row[at.M_LEG + 2 * side] + row[at.M_LEG + 2 * side + 1]
            reach = length * comforts[side, frame]
            x, y = ankles[side, frame, 0] - hip[0], ankles[side, frame, 1] - hip[1]
            below = math.sqrt(max(0.0, reach * reach - x * x - y * y))
            drop = -(ankles[side, frame, 2] - hip[2]) - below
            out_drops[frame] = max(out_drops[frame], drop)


@kernel
def place_leg(channels, measures, side, comfort, ankle, foot, toe, work, positions, rotations):
    """One leg of one frame: hip from the root, ankle at its target, foot and toe as given (METHOD 6, limb_to).

    The knee always bends forward: captures hyperextend it by a few degrees and then it snaps. A target beyond the
    leg's comfort is neared as far as ``soft_reach`` says; the root has come down for feet that stand.
    ``ankle`` (3,), ``foot``, ``toe`` (3, 3) world; ``work`` (3, 3, 3) scratch; writes into the frame's arrays. An
    ``ankle`` of 7 numbers goes on with where the knee is to be and how firmly (0 to 1) it is held there.
    """
    spine_count = (measures.shape[0] - at.M_SPINE) // 3
    point, segment = spine_count + 13 + 5 * side, spine_count + 10 + 4 * side
    hip = positions[point]
    place_hip(channels, measures, side, 0.0, positions[0], rotations[0], hip)
    q = at.LIMB_FRAME + 4 * (2 + side)
    quaternion_to_matrix(channels[q : q + 4], work[0])
    multiply(rotations[0], work[0], work[1])
    upper, lower = measures[at.M_LEG + 2 * side], measures[at.M_LEG + 2 * side + 1]
    length = upper + lower
    x, y, z = ankle[0] - hip[0], ankle[1] - hip[1], ankle[2] - hip[2]
    distance = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    frame = work[1]
    shortest_arc(frame[0, 2], frame[1, 2], frame[2, 2], x / distance, y / distance, z / distance, work[0])
    aimed = work[2]
    multiply(work[0], frame, aimed)
    orthonormalize(aimed)
    if ankle.shape[0] > 3 and ankle[6] > 0.0:
        off_plane = channels[at.LIMB_OFF_PLANE + 2 + side] * length
        swivel_knee(hip, ankle, upper, lower, min(distance, length), off_plane, aimed)
    t = at.LIMB_TWIST + 2 * (2 + side)
    place_limb(
        hip,
        aimed,
        max(length * soft_reach(distance / length, comfort), abs(upper - lower) + 1e-6),
        upper,
        lower,
        channels[at.LIMB_OFF_PLANE + 2 + side] * length,
        1.0,
        channels[t : t + 2],
        work[0],
        positions[point + 1 : point + 3],
        rotations[segment],
        rotations[segment + 1],
    )
    for row in range(3):
        for column in range(3):
            rotations[segment + 2, row, column] = foot[row, column]
            rotations[segment + 3, row, column] = toe[row, column]
    place_toes(measures, side, point + 2, segment + 2, positions, rotations)


@kernel
def swivel_knee(hip, ankle, upper, lower, distance, off_plane, frame):
    """Turn a leg's ``frame`` (3, 3) about its z axis until the knee faces its place, as firmly as it is held there.

    ``ankle`` (7,) as in ``place_leg``. Hardly at all where the knee is on the line of hip and ankle, or its place is.
    """
    z = (upper * upper - lower * lower + distance * distance) / (2.0 * distance)
    radius = math.sqrt(max(0.0, upper * upper - z * z))
    x = min(max(off_plane, -radius), radius)
    y = math.sqrt(max(0.0, radius * radius - x * x))
    wanted_x, wanted_y = 0.0, 0.0
    for axis in range(3):
        wanted_x += frame[axis, 0] * (ankle[3 + axis] - hip[axis])
        wanted_y += frame[axis, 1] * (ankle[3 + axis] - hip[axis])
    away = radius * math.hypot(wanted_x, wanted_y)
    angle = math.atan2(wanted_y, wanted_x) - math.atan2(y, x)
    angle -= 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))
    turn_columns(frame, ankle[6] * smoothstep(min(away / KNEE_GUARD, 1.0)) * angle)
