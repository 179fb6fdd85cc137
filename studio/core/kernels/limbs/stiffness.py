"""Limbs of which a chain makes the upper or the lower segment stiff: each takes its part of its change (METHOD (19)).

What both would do is noted when a level begins; after that the shoulder turns, and the elbow changes the distance, by
no more than their parts of it, and the rest of the chain is asked for what is left. A record of ``kernels.tasks.task``
that is ``stiff`` has for each end of upper and lower segment their ``parts`` (2, 2), the ``change`` (2, 2) in radians
and metres that they made, the ``most`` (2, 2) that they may, and the ``own`` (2,) distance that the motion's bend
gives.
"""

import math

from studio.core.kernels.algebra.turns import inverse, product, put_turn, rotation_vector, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, length
from studio.core.kernels.body.parts import turn_part
from studio.core.kernels.compiling import kernel
from studio.core.kernels.search.joints import carry_point
from studio.core.kernels.tasks.task import ACTIVE

LETS_GO = 32
"""Power of a weight by which its bound goes away towards 1: a part of 0.9 is still one of 0.93."""


@kernel
def free_stiff(level, tasks):
    """Let the stiff limbs of a level show what they would do; whether there are any."""
    found = False
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.stiff and row.rank == level and row.status == ACTIVE:
            found = True
            for end in range(2):
                for joint in range(2):
                    row.change[end, joint], row.most[end, joint] = 0.0, math.inf
    return found


@kernel
def stiffen(level, tasks):
    """From now on they may do their parts of what they did: p c / (1 - p^32) (METHOD (19))."""
    for c in range(tasks.shape[0]):
        row = tasks[c]
        if row.stiff and row.rank == level and row.status == ACTIVE:
            for end in range(2):
                for joint in range(2):
                    part = row.parts[end, joint]
                    if part < 1.0:
                        row.most[end, joint] = row.change[end, joint] * part / (1.0 - part**LETS_GO)


@kernel
def carry_leg(side, start, carried, pose):
    """A leg as the motion has it in its pelvis, its foot turned as in the motion: what is stiff goes with the hips."""
    spine_count = pose.positions.shape[0] - 23
    hip, thigh, pelvis = spine_count + 13 + 5 * side, spine_count + 10 + 4 * side, turn_in(carried[0])
    for bone in range(4):
        if bone < 2:
            put_turn(product(pelvis, turn_in(start.rotations[thigh + bone])), pose.rotations[thigh + bone])
            carry_point(hip + bone + 1, hip, pelvis, start, pose.positions)
        else:
            copy_matrix(start.rotations[thigh + bone], pose.rotations[thigh + bone])
            for axis in range(3):
                along = start.positions[hip + bone + 1, axis] - start.positions[hip + 2, axis]
                pose.positions[hip + bone + 1, axis] = pose.positions[hip + 2, axis] + along


@kernel
def stiff_span(row, end, now, wanted):
    """How far (metres) a stiff limb stretches that is ``now`` at the motion's own distance; noted."""
    row.own[end] = now
    most = row.most[end, 1]
    row.change[end, 1] = abs(wanted - now)
    return min(max(wanted, now - most), now + most)


@kernel
def turn_back(part, most, segment, pivot, before, pose):
    """Leave ``part`` of the turn that ``segment`` has made since that of ``before``, ``most`` radians; what it made."""
    x, y, z = rotation_vector(product(turn_in(pose.rotations[segment]), inverse(before)))
    angle = length((x, y, z))
    left = min(part * angle, most)
    if left < angle:
        scale = left / angle - 1.0
        less = turn_by(scale * x, scale * y, scale * z)
        turn_part(less, segment, pose.positions.shape[0] - 23, pose.positions[pivot], pose.positions, pose.rotations)
    return angle
