"""Exact search for the pose and the hit that come nearest, among all frames of a motion library (METHOD (39)).

A pose is a row of 64 float32: 20 joints as √w x (20), √w y (20) about their middle, √w z (20) above the ground, then
|row|², the middle (2), and a place that is not used. The distance of two poses modulo a turn about Z and a shift is
D² = |a|² + |b|² - 2 √(A² + B²) - 2 Z with A = Σ w (x x' + y y'), B = Σ w (y x' - x y'), Z = Σ w z z' (Kovar et al.
2002). It is the least distance over a group of isometries, so it keeps the triangle inequality: a block of frames that
all lie within r of the one in its middle is no nearer than D - r.
"""

import math

import numpy as np

from studio.core.kernels.compiling import kernel, small_kernel, summing_kernel

JOINTS, Y, Z, SQUARE, MIDDLE, WIDTH = 20, 20, 40, 60, 61, 64
"""Joints of a pose, and where each part of its row begins."""
ROUNDING = 4e-6
"""Metres squared by which D² may be wrong in float32."""
COST, POSTURE, REACH, TURN = 0, 1, 2, 3
"""Columns of what is found: the whole cost, both distances (m), and the turn of the frame onto the query (rad)."""
CLIP, FRAME, CONTACT = 0, 1, 2
"""Columns of where it is found: clip, row of the frame from which to play, row of the path at which it hits."""


@kernel
def judge_blocks(blocks, rows, paths, clips, middles, out_radii, out_rings):
    """What bounds the cost of the frames of each block: see ``bound_blocks``; ``blocks`` (B, 3) clip, first, count."""
    for block in range(blocks.shape[0]):
        start, count = clips[blocks[block, 0], 2], clips[blocks[block, 0], 3]
        widest, ring = 0.0, out_rings[block]
        ring[0], ring[1], ring[2], ring[3] = math.inf, 0.0, math.inf, -math.inf
        for frame in range(blocks[block, 1], blocks[block, 1] + blocks[block, 2]):
            square, _ = pose_distance(middles[block], rows[frame])
            widest = max(widest, square)
            for row in range(start, start + count):
                x, y = paths[row, 0] - rows[frame, MIDDLE], paths[row, 1] - rows[frame, MIDDLE + 1]
                away = math.sqrt(x * x + y * y)
                ring[0], ring[1] = min(ring[0], away - 1e-6), max(ring[1], away + 1e-6)
                ring[2], ring[3] = min(ring[2], paths[row, 2]), max(ring[3], paths[row, 2])
        out_radii[block] = math.sqrt(widest) + 1e-6


@summing_kernel
def bound_blocks(middles, radii, rings, block_clips, clips, allowed, queries, targets, weights, out_bounds):
    """The least cost (B,) that any frame of each block may have; inf where its clip is not allowed.

    ``middles`` (B, 64) the pose in the middle of each block, ``radii`` (B,) metres; ``rings`` (B, 4) between which
    distances from the middle of a pose and between which heights the hit lies; ``block_clips`` (B,) which clip;
    ``clips`` (C, 4) actor, limb, first row and count of the path of the hit point; ``allowed`` (C,); ``queries``
    (A, 64); ``targets`` (A, 4, 3) by actor and limb, about the middle of the query; ``weights`` (2,).
    """
    for block in range(middles.shape[0]):
        clip = block_clips[block]
        if not allowed[clip]:
            out_bounds[block] = math.inf
            continue
        query = queries[clips[clip, 0]]
        posture = max(math.sqrt(least_square(query, middles[block])) - radii[block], 0.0)
        target = targets[clips[clip, 0], clips[clip, 1]]
        out_bounds[block] = weights[0] * posture + weights[1] * beyond(target, rings[block])


@summing_kernel
def least_square(query, pose):
    """D² of two rows (64,) in float32, less what rounding may have added."""
    a, b, h = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    for k in range(JOINTS):
        a += query[k] * pose[k] + query[Y + k] * pose[Y + k]
        b += query[Y + k] * pose[k] - query[k] * pose[Y + k]
        h += query[Z + k] * pose[Z + k]
    return max(pose[SQUARE] + query[SQUARE] - np.float32(2.0) * (math.sqrt(a * a + b * b) + h) - ROUNDING, 0.0)


@small_kernel
def beyond(target, ring):
    """Metres from ``target`` (3,) to what a path can reach by turning: between distances and heights ``ring`` (4,)."""
    across = math.sqrt(target[0] * target[0] + target[1] * target[1])
    beside = max(ring[0] - across, across - ring[1], 0.0)
    above = max(ring[2] - target[2], target[2] - ring[3], 0.0)
    return math.sqrt(beside * beside + above * above)


@kernel
def search_blocks(first, bounds, blocks, rings, rows, paths, clips, queries, targets, weights, out_found, out_places):
    """The best frame of each of the N clips that cost least, in their order; what is too few ends in inf and -1.

    ``first`` (n,) blocks to begin with, whose ``bounds`` (B,) are then set to inf; ``blocks`` (B, 3) clip, first row
    and count; ``rows`` (F, 64) all poses; ``paths`` (T, 3) all paths of hit points, each in the space of its clip.
    Out: (N, 4) and (N, 3), by the columns above.
    """
    last = out_found.shape[0] - 1
    for n in range(last + 1):
        out_found[n, COST] = math.inf
        for column in range(3):
            out_places[n, column] = -1
    for n in range(first.shape[0]):
        block = first[n]
        if bounds[block] < out_found[last, COST]:
            search_block(
                blocks[block], rings[block], rows, paths, clips, queries, targets, weights, out_found, out_places
            )
        bounds[block] = math.inf
    for block in range(blocks.shape[0]):
        if bounds[block] < out_found[last, COST]:
            search_block(
                blocks[block], rings[block], rows, paths, clips, queries, targets, weights, out_found, out_places
            )


@kernel
def search_block(block, ring, rows, paths, clips, queries, targets, weights, out_found, out_places):
    """Put the frames of one block where they belong among what is found."""
    clip, last = block[0], out_found.shape[0] - 1
    query, target = queries[clips[clip, 0]], targets[clips[clip, 0], clips[clip, 1]]
    least = weights[1] * beyond(target, ring)
    for frame in range(block[1], block[1] + block[2]):
        near = math.sqrt(least_square(query, rows[frame]))
        if weights[0] * near + least >= out_found[last, COST]:
            continue
        square, turn = pose_distance(query, rows[frame])
        posture = math.sqrt(square)
        reach, contact = hit_distance(rows[frame], turn, target, paths, clips[clip, 2], clips[clip, 3])
        cost = weights[0] * posture + weights[1] * reach
        if cost < out_found[last, COST]:
            note(cost, posture, reach, turn, clip, frame, contact, out_found, out_places)


@small_kernel
def pose_distance(query, pose):
    """D², and the turn about Z (rad) of ``pose`` (64,) that brings it nearest to ``query`` (64,)."""
    a, b, rest = 0.0, 0.0, 0.0
    for k in range(JOINTS):
        x, y, z = np.float64(pose[k]), np.float64(pose[Y + k]), np.float64(pose[Z + k])
        u, v, w = np.float64(query[k]), np.float64(query[Y + k]), np.float64(query[Z + k])
        a += u * x + v * y
        b += v * x - u * y
        rest += u * u + v * v + x * x + y * y + (w - z) * (w - z)
    return max(rest - 2.0 * math.sqrt(a * a + b * b), 0.0), math.atan2(b, a)


@small_kernel
def hit_distance(pose, turn, target, paths, start, count):
    """How near (m) the path of a hit point comes to ``target`` (3,), turned with ``pose`` (64,), and in which row."""
    c, s = math.cos(turn), math.sin(turn)
    best, contact = math.inf, start
    for row in range(start, start + count):
        x, y = paths[row, 0] - pose[MIDDLE], paths[row, 1] - pose[MIDDLE + 1]
        dx, dy, dz = c * x - s * y - target[0], s * x + c * y - target[1], paths[row, 2] - target[2]
        square = dx * dx + dy * dy + dz * dz
        if square < best:
            best, contact = square, row
    return math.sqrt(best), contact


@kernel
def note(cost, posture, reach, turn, clip, frame, contact, out_found, out_places):
    """Keep a frame in the order of cost, one a clip; what was the last falls out."""
    place = out_found.shape[0] - 1
    for n in range(out_found.shape[0]):
        if out_places[n, CLIP] == clip:
            place = n
            if out_found[n, COST] <= cost:
                return
    while place > 0 and out_found[place - 1, COST] > cost:
        for column in range(4):
            out_found[place, column] = out_found[place - 1, column]
        for column in range(3):
            out_places[place, column] = out_places[place - 1, column]
        place -= 1
    out_found[place, COST], out_found[place, POSTURE] = cost, posture
    out_found[place, REACH], out_found[place, TURN] = reach, turn
    out_places[place, CLIP], out_places[place, FRAME], out_places[place, CONTACT] = clip, frame, contact
