"""Turns of limbs' joints as angles about the middles of their limits, and back (METHOD (25) to (28) and (37)).

``turns`` (F, 16, 3, 3) of joints in what carries them and ``angles`` (F, 16, 3), four a limb: shoulder or hip and wrist
or ankle by swing and twist, elbow or knee by bend, slant and turn, toes by a rotation vector; ``limits`` (4,) as in
``kernels.limits.joint_limits``; ``limbs`` (4,) which of them are meant.
"""

import math

from studio.core.kernels.algebra.turns import (
    inverse,
    product,
    put_turn,
    rotation_vector,
    turn_between,
    turn_by,
    turn_in,
)
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.swing_twist import half_turns_off, part_of_swing, swing_and_twist


@kernel
def note_limb_turns(carriers, segments, rotations, out_turns):
    """Turns of ``segments`` (16,) in what carries them, of poses' rotations (F, S, 3, 3)."""
    for frame in range(rotations.shape[0]):
        for joint in range(segments.shape[0]):
            turn = turn_between(rotations[frame, carriers[joint]], rotations[frame, segments[joint]])
            put_turn(turn, out_turns[frame, joint])


@kernel
def note_angles(limbs, turns, limits, out_angles):
    """Angles of turns."""
    for frame in range(turns.shape[0]):
        for limb in range(4):
            for joint in range(4 * limb, 4 * limb + 4):
                if limbs[limb]:
                    note_joint(joint % 4, turns[frame, joint], limits[limb], out_angles[frame, joint])


@kernel
def note_joint(joint, turn, row, out_angles):
    """The angles (3,) of one joint."""
    if joint == 3:
        copy_point(rotation_vector(turn_in(turn)), out_angles)
    else:
        out_angles[0], out_angles[1], out_angles[2] = limited_angles(joint, turn_in(turn), row)


@kernel
def limited_angles(joint, turn, row):
    """The three angles of a joint that has limits."""
    if joint == 1:
        bend, slant = math.atan2(-turn[5], turn[8]), math.asin(min(max(turn[2], -1.0), 1.0))
        bend -= 0.5 * (row.bends[0] + row.bends[1])
        return half_turns_off(bend), slant, half_turns_off(math.atan2(-turn[1], turn[0]) - row.turns[0])
    turn = product(inverse(turn_in(row.axes[joint // 2])), turn)
    x, y, twist = swing_and_twist((turn[0], turn[3], turn[6]), (turn[2], turn[5], turn[8]))
    return x, y, half_turns_off(twist - row.twists[joint // 2, 0])


@kernel
def note_turns(limbs, angles, limits, out_turns):
    """Turns of angles."""
    for frame in range(angles.shape[0]):
        for limb in range(4):
            for joint in range(4 * limb, 4 * limb + 4):
                if limbs[limb]:
                    put_turn(turn_of_angles(joint % 4, angles[frame, joint], limits[limb]), out_turns[frame, joint])


@kernel
def turn_of_angles(joint, angles, row):
    """The turn of one joint."""
    x, y, z = angles[0], angles[1], angles[2]
    if joint == 3:
        return turn_by(x, y, z)
    if joint == 1:
        bend, turn = x + 0.5 * (row.bends[0] + row.bends[1]), z + row.turns[0]
        return product(turn_by(bend, 0.0, 0.0), product(turn_by(0.0, y, 0.0), turn_by(0.0, 0.0, turn)))
    twist = turn_by(0.0, 0.0, z + row.twists[joint // 2, 0])
    return product(turn_in(row.axes[joint // 2]), product(turn_by(x, y, 0.0), twist))


@kernel
def keep_within(limbs, own, limits, angles):
    """Bring angles back, in place, to where limits or the motion's ``own`` let them be."""
    for frame in range(angles.shape[0]):
        for limb in range(4):
            row = limits[limb]
            for joint in range(4 * limb, 4 * limb + 3):
                if limbs[limb]:
                    keep_joint_within(joint % 4, own[frame, joint], row, angles[frame, joint])


@kernel
def keep_joint_within(joint, own, row, angles):
    """The same of one joint."""
    if joint == 1:
        angles[0] = within(angles[0], own[0], 0.5 * (row.bends[1] - row.bends[0]))
        angles[1] = within(angles[1], own[1], row.aslant)
        angles[2] = within(angles[2], own[2], row.turns[1])
        return
    radii = row.radii[joint // 2]
    most = max(1.0, part_of_swing(radii, own[0], own[1]))
    share = min(most / max(part_of_swing(radii, angles[0], angles[1]), 1e-9), 1.0)
    angles[0], angles[1] = share * angles[0], share * angles[1]
    angles[2] = within(angles[2], own[2], row.twists[joint // 2, 1])


@kernel
def within(angle, own, half):
    """An angle no further from nought than ``half`` a range, or than the motion's ``own``."""
    most = max(half, abs(own))
    return min(max(angle, -most), most)
