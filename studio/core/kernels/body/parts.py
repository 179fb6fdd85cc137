"""Moving parts of a posed body: everything distal to a segment is one contiguous range of points and segments."""

from typing import NamedTuple

from studio.core.kernels.algebra.turns import Turn, beside, product, put_beside, put_turn, turn_in
from studio.core.kernels.algebra.vectors import Place, between, copy_matrix, copy_point, plus
from studio.core.kernels.compiling import kernel, small_kernel


@kernel
def distal_range(segment, spine_count):
    """(first segment, past last, first point, past last) that turn with ``segment`` about its proximal point."""
    if segment < spine_count:
        if segment == 0:
            return 0, spine_count + 18, 1, spine_count + 23
        return segment, spine_count + 10, segment + 1, spine_count + 13
    place = segment - spine_count
    if place < 2:
        return segment, spine_count + 2, segment + 1, spine_count + 3
    chain, bone = (place - 2) // 4, (place - 2) % 4
    first_point = spine_count + 3 + 5 * chain + bone + 1
    return segment, segment + 4 - bone, first_point, first_point + 4 - bone


@kernel
def limb_parts(limb, spine_count):
    """(carrier, upper segment, root point) of a limb: clavicle, upper arm and shoulder, or pelvis, thigh and hip."""
    side = limb % 2
    if limb >= 2:
        return 0, spine_count + 10 + 4 * side, spine_count + 13 + 5 * side
    return spine_count + 2 + 4 * side, spine_count + 3 + 4 * side, spine_count + 4 + 5 * side


@kernel
def turn_part(turn, segment, spine_count, pivot, positions, rotations):
    """Turn ``segment`` and what hangs on it by ``turn`` (``kernels.algebra.turns``, world) about ``pivot`` (3,), in
    place.
    """
    first, past, first_point, past_point = distal_range(segment, spine_count)
    x, y, z = pivot[0], pivot[1], pivot[2]
    for point in range(first_point, past_point):
        place = positions[point]
        put_beside((x, y, z), turn, place[0] - x, place[1] - y, place[2] - z, place)
    for other in range(first, past):
        put_turn(product(turn, turn_in(rotations[other])), rotations[other])


@kernel
def move_all(x, y, z, positions):
    """Translate every point of a frame (P, 3), in place."""
    for point in range(positions.shape[0]):
        positions[point, 0] += x
        positions[point, 1] += y
        positions[point, 2] += z


@small_kernel
def body_point(point, segment, offset, positions, rotations):
    """Where a point fixed to a segment is: (x, y, z) = positions[point] + rotations[segment] @ offset."""
    return beside(positions[point], turn_in(rotations[segment]), offset[0], offset[1], offset[2])


class LimbEnd(NamedTuple):
    """How hand, or foot and toe, lie in the world."""

    turn: Turn
    toe_turn: Turn
    tip: Place
    """Metres from wrist or ankle to where the hand ends or the toe begins."""
    toe_tip: Place


@small_kernel
def lift_end(limb, pose):
    """Note how hand, or foot and toe, of a limb lie in the world."""
    positions, rotations = pose.positions, pose.rotations
    _, upper, root = limb_parts(limb, positions.shape[0] - 23)
    end, toe, joint = upper + 2, upper + (3 if limb >= 2 else 2), root + 2
    last = joint + (2 if limb >= 2 else 1)
    tip, toe_tip = between(positions[joint], positions[joint + 1]), between(positions[joint], positions[last])
    return LimbEnd(turn_in(rotations[end]), turn_in(rotations[toe]), tip, toe_tip)


@small_kernel
def put_end(limb, lifted, pose):
    """Lay hand, or foot and toe, on wrist or ankle as ``lift_end`` found them."""
    positions, rotations = pose.positions, pose.rotations
    _, upper, root = limb_parts(limb, positions.shape[0] - 23)
    joint = positions[root + 2]
    put_turn(lifted.turn, rotations[upper + 2])
    copy_point(plus(joint, lifted.tip), positions[root + 3])
    if limb >= 2:
        put_turn(lifted.toe_turn, rotations[upper + 3])
        copy_point(plus(joint, lifted.toe_tip), positions[root + 4])


@kernel
def copy_pose(start, pose):
    """``pose`` becomes ``start``."""
    for point in range(pose.positions.shape[0]):
        copy_point(start.positions[point], pose.positions[point])
    for segment in range(pose.rotations.shape[0]):
        copy_matrix(start.rotations[segment], pose.rotations[segment])
