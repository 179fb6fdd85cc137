"""The joints that a search may turn: how each moves points of the body, and the body posed from their turns (METHOD 6).

``joints`` (N,) are records of ``JOINT``, of each joint that any constraint's chain frees; ``slots`` (S + 1,) is the
joint of each segment, of the root last, -1 for none.

The state of a search is ``turned`` (N, 3): for each joint the Gibbs vector (axis times tan(angle / 2)) of its turn away
from the motion, in the axes of the segment that carries it; for the root metres. What is left of each joint's mobility
(``BRAKE``) is 1 until ``FREE_PART`` of the limit and 0 at it, so that a limit is neared ever more slowly and nothing
stops at once.
"""

import math

import numpy as np

from studio.core.kernels.algebra.turns import beside, inverse, product, put_beside, put_turn, turn_in, turn_of_gibbs
from studio.core.kernels.algebra.vectors import ORIGIN, between
from studio.core.kernels.body.parts import distal_range
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.records import JOINT

ROOT = -1
FREE_PART = 0.7
"""Part of its limit that a joint turns freely; beyond it turns ever less."""


@kernel
def may_turn(row, segment, chain):
    """Whether ``row`` of the mobilities in ``chain`` (mobilities, joints, slots, limits) frees a segment's joint."""
    joint = chain.slots[segment]
    return joint >= 0 and chain.mobilities[row, joint] > 0.0


@kernel
def pivot_point(segment, spine_count):
    """The point about which ``segment`` turns."""
    if segment < spine_count + 2:
        return segment
    chain, bone = (segment - spine_count - 2) // 4, (segment - spine_count - 2) % 4
    return spine_count + 3 + 5 * chain + bone


@kernel
def carrier_of(segment, spine_count):
    """The segment that carries ``segment``; past the last one for root, pelvis and thighs (legs hang on ankles)."""
    if segment <= 0:
        return spine_count + 18
    if segment < spine_count + 2:
        return segment - 1
    chain, bone = (segment - spine_count - 2) // 4, (segment - spine_count - 2) % 4
    if bone > 0:
        return segment - 1
    return spine_count - 1 if chain < 2 else spine_count + 18


@allocating_kernel
def joint_table(segments, spine_count):
    """``joints`` (N,) for the given segments (N,), ROOT for the root's translation."""
    table = np.zeros(segments.shape[0], JOINT)
    for number in range(segments.shape[0]):
        joint, segment = table[number], segments[number]
        joint.segment = segment
        joint.pivot = 0 if segment == ROOT else pivot_point(segment, spine_count)
        first, past, _, _ = distal_range(max(segment, 0), spine_count)
        joint.first, joint.past = first, past
        joint.carrier = carrier_of(segment, spine_count)
    return table


@kernel
def add_point_row(point, vx, vy, vz, carrier, joints, positions, row):
    """Add to ``row`` (N, 3) how joints move a point of segment ``carrier`` along a direction: (p - o) x v."""
    for joint in range(joints.shape[0]):
        if joints[joint].segment == ROOT:
            row[joint, 0] += vx
            row[joint, 1] += vy
            row[joint, 2] += vz
        elif joints[joint].first <= carrier < joints[joint].past:
            origin = joints[joint].pivot
            x = point[0] - positions[origin, 0]
            y = point[1] - positions[origin, 1]
            z = point[2] - positions[origin, 2]
            row[joint, 0] += y * vz - z * vy
            row[joint, 1] += z * vx - x * vz
            row[joint, 2] += x * vy - y * vx


@kernel
def add_turn_row(axis, arm, carrier, joints, row):
    """Add to ``row`` (N, 3) how joints turn segment ``carrier`` about a world axis, in ``arm`` metres a radian."""
    for joint in range(joints.shape[0]):
        if joints[joint].segment != ROOT and joints[joint].first <= carrier < joints[joint].past:
            row[joint, axis] += arm


@kernel
def set_brakes(turned, joints, limits, carried, out_brakes):
    """``brakes`` of all joints as they are turned."""
    for k in range(joints.shape[0]):
        out_brakes[k].part = 1.0
        x, y, z = turned[k, 0], turned[k, 1], turned[k, 2]
        squared, freely = x * x + y * y + z * z, FREE_PART * limits[k]
        if joints[k].segment == ROOT or squared <= freely * freely:
            continue
        turn, size = carried[joints[k].carrier], math.sqrt(squared)
        x, y, z = x / size, y / size, z / size
        for axis in range(3):
            out_brakes[k].axis[axis] = turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z
        out_brakes[k].part = math.sqrt(max((limits[k] - size) / ((1.0 - FREE_PART) * limits[k]), 0.0))


@kernel
def brake(part, axis, vector):
    """Shorten ``vector`` (3,) to ``part`` of itself along a unit ``axis`` (3,)."""
    along = (part - 1.0) * (axis[0] * vector[0] + axis[1] * vector[1] + axis[2] * vector[2])
    vector[0] += along * axis[0]
    vector[1] += along * axis[1]
    vector[2] += along * axis[2]


@kernel
def carry(segment, parent, turned, slots, start, carried, pose):
    """The turn of one segment, by what carries it and by its own joint; noted in ``carried`` (S + 1, 3, 3)."""
    joint, turn = slots[segment], turn_in(carried[parent])
    if joint >= 0:
        x, y, z = turned[joint, 0], turned[joint, 1], turned[joint, 2]
        if x != 0.0 or y != 0.0 or z != 0.0:
            turn = product(turn, turn_of_gibbs(x, y, z))
    put_turn(turn, carried[segment])
    put_turn(product(turn, turn_in(start.rotations[segment])), pose.rotations[segment])
    return turn


@kernel
def carry_point(point, origin, turn, start, positions):
    """Put ``point`` where a segment that has made a ``turn`` carries it from ``origin``, another point of it."""
    before, past, here = start.positions[origin], start.positions[point], positions[origin]
    x, y, z = past[0] - before[0], past[1] - before[1], past[2] - before[2]
    put_beside((here[0], here[1], here[2]), turn, x, y, z, positions[point])


@kernel
def carry_arm(side, turned, slots, start, carried, pose):
    """Put an arm back as the motion has it in its clavicle, turned about its shoulder if that is free."""
    spine_count = pose.positions.shape[0] - 23
    shoulder, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
    turn = carry(upper, upper - 1, turned, slots, start, carried, pose)
    carry_point(shoulder + 1, shoulder, turn, start, pose.positions)
    for bone in range(1, 3):
        put_turn(product(turn, turn_in(start.rotations[upper + bone])), pose.rotations[upper + bone])
        carry_point(shoulder + bone + 1, shoulder, turn, start, pose.positions)


@kernel
def pose_limb(carrier, upper, root, first, turns, start, pose):
    """Put a limb where its segments' rotations in what carries each, ``turns[first:]`` (n, 3, 3), put it."""
    before = carrier
    for bone in range(3 if carrier > 0 else 4):
        segment, point = upper + bone, root + bone
        put_turn(product(turn_in(pose.rotations[before]), turn_in(turns[first + bone])), pose.rotations[segment])
        x, y, z = between(start.positions[point], start.positions[point + 1])
        x, y, z = beside(ORIGIN, inverse(turn_in(start.rotations[segment])), x, y, z)
        now = turn_in(pose.rotations[segment])
        put_beside(pose.positions[point], now, x, y, z, pose.positions[point + 1])
        before = segment


@kernel
def carry_trunk(turned, slots, start, carried, pose):
    """Root, spine, neck, head, clavicles and hips in one pass from root to tips; limbs are put back after.

    ``start`` is the motion's own pose, ``pose`` the one being written, both (positions (P, 3), rotations (S, 3, 3)).
    """
    positions = pose.positions
    spine_count = positions.shape[0] - 23
    root = slots[slots.shape[0] - 1]
    for axis in range(3):
        positions[0, axis] = start.positions[0, axis] + (turned[root, axis] if root >= 0 else 0.0)
    for segment in range(spine_count + 2):
        parent = segment - 1 if segment > 0 else spine_count + 18
        turn = carry(segment, parent, turned, slots, start, carried, pose)
        carry_point(segment + 1, segment, turn, start, positions)
    chest, pelvis = turn_in(carried[spine_count - 1]), turn_in(carried[0])
    for side in range(2):
        collar, clavicle = spine_count + 3 + 5 * side, spine_count + 2 + 4 * side
        carry_point(collar, spine_count, chest, start, positions)
        turn = carry(clavicle, spine_count - 1, turned, slots, start, carried, pose)
        carry_point(collar + 1, collar, turn, start, positions)
        carry_point(spine_count + 13 + 5 * side, 0, pelvis, start, positions)
