"""Moving parts of a posed body: everything distal to a segment is one contiguous range of points and segments."""

from studio.core.kernels.algebra.rotation import add_rotated
from studio.core.kernels.algebra.turns import product, put_beside, put_turn, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point
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
def body_point(point, segment, offset, positions, rotations, out_point):
    """Where a point fixed to a segment is: (3,) = positions[point] + rotations[segment] @ offset."""
    add_rotated(positions[point], rotations[segment], offset[0], offset[1], offset[2], out_point)


@kernel
def copy_pose(start, pose):
    """``pose`` becomes ``start``."""
    for point in range(pose.positions.shape[0]):
        copy_point(start.positions[point], pose.positions[point])
    for segment in range(pose.rotations.shape[0]):
        copy_matrix(start.rotations[segment], pose.rotations[segment])
