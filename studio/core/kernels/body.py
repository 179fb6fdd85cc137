"""Moving parts of a posed body: everything distal to a segment is one contiguous range of points and segments."""

from studio.core.kernels.compiling import kernel
from studio.core.kernels.rotation import add_rotated


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
    """Turn ``segment`` and all that hangs on it by ``turn`` (3, 3, world) about ``pivot`` (3,), in place."""
    first, past, first_point, past_point = distal_range(segment, spine_count)
    for point in range(first_point, past_point):
        x = positions[point, 0] - pivot[0]
        y = positions[point, 1] - pivot[1]
        z = positions[point, 2] - pivot[2]
        add_rotated(pivot, turn, x, y, z, positions[point])
    for other in range(first, past):
        for column in range(3):
            x, y, z = rotations[other, 0, column], rotations[other, 1, column], rotations[other, 2, column]
            for axis in range(3):
                rotations[other, axis, column] = turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z


@kernel
def move_all(x, y, z, positions):
    """Translate every point of a frame (P, 3), in place."""
    for point in range(positions.shape[0]):
        positions[point, 0] += x
        positions[point, 1] += y
        positions[point, 2] += z


@kernel
def body_point(point, segment, offset, positions, rotations, out_point):
    """Where a point fixed to a segment is: (3,) = positions[point] + rotations[segment] @ offset."""
    add_rotated(positions[point], rotations[segment], offset[0], offset[1], offset[2], out_point)
