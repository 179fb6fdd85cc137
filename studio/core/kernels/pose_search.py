"""Exact nearest-neighbour search for a pose and a hit among all frames of a motion library (METHOD (39)).

A pose is a row of 64 float32: 20 joints as √w x (20), √w y (20) relative to their centroid, √w z (20) above the ground,
then |row|², the centroid (2), and one unused number. The distance of two poses modulo a rotation about Z and a
horizontal shift is D² = |a|² + |b|² - 2 √(A² + B²) - 2 Z with A = Σ w (x x' + y y'), B = Σ w (y x' - x y'), Z = Σ w z
z' (Kovar et al. 2002). Since D is the least distance over a group of isometries, it satisfies the triangle inequality:
every frame of a block whose frames lie within r of its middle frame is at least D - r away, with D the distance of that
middle frame.
"""

import math
from typing import NamedTuple

import numpy as np

from studio.core.kernels.compiling import kernel, pack, small_kernel, summing_kernel
from studio.core.kernels.records import Array

POSE_JOINTS, Y, Z, SQUARE, POSE_CENTRE, POSE_WIDTH = 20, 20, 40, 60, 61, 64
"""Number of joints of a pose, and the first columns of the parts of its row."""
FLOAT32_ERROR = 4e-6
"""Greatest error of D² in float32, metres squared, and of the cosine and sine of the rotation."""
MAX_FLOAT32_HIT_ERROR = 0.05
"""Greatest error in metres of a hit position from a float32 rotation for which that rotation may reject a frame."""
COST_COLUMN, POSTURE_COLUMN, REACH_COLUMN, ROTATION_COLUMN = 0, 1, 2, 3
"""Columns of ``SearchHits.costs``: total cost, posture and hit distances (m), rotation of the frame onto the query
(rad).
"""
CLIP_COLUMN, FRAME_COLUMN, CONTACT_COLUMN = 0, 1, 2
"""Columns of ``SearchHits.places``: clip, first frame to play, and row of the path at which the limb hits."""


class FrameTable(NamedTuple):
    """Searched motion library: F frames of C clips, grouped into B blocks of consecutive frames."""

    rows: Array
    """(F, 64) all poses."""
    paths: Array
    """(T, 3) all paths of hit points, each in the space of its clip."""
    clips: Array
    """(C, 4) actor, limb, first row and count of the path of the hit point."""
    blocks: Array
    """(B, 3) clip, first row and count."""
    middles: Array
    """(B, 64) pose of the middle frame of each block."""
    radii: Array
    """(B,) pose distance in metres from the middle frame of each block to its farthest frame."""
    rings: Array
    """(B, 4) bounds, over the frames of each block, of a hit's horizontal distance from the pose's centroid and of its
    height.
    """


class SearchQuery(NamedTuple):
    """Query pose, target and weights, for A actors."""

    poses: Array
    """(A, 64)."""
    targets: Array
    """(A, 4, 3) by actor and limb, metres, relative to the centroid of the pose."""
    posture_weight: float
    reach_weight: float


RING_NEAREST, RING_FARTHEST, RING_LOWEST, RING_HIGHEST = range(4)
"""Columns of a ring: bounds of the horizontal distance and the height of a block's path, metres."""


class SearchHits(NamedTuple):
    """The N clips with the least cost, sorted by cost."""

    costs: Array
    """(N, 4), inf where there are no more."""
    places: Array
    """(N, 3), -1 where there are no more."""


@kernel
def write_block_bounds(blocks, rows, paths, clips, middles, out_radii, out_rings):
    """Write the bounds of each block's frames: ``radii`` and ``rings`` of a ``FrameTable``."""
    for block in range(blocks.shape[0]):
        start, count = clips[blocks[block, 0], 2], clips[blocks[block, 0], 3]
        widest, ring = 0.0, out_rings[block]
        ring[RING_NEAREST], ring[RING_FARTHEST], ring[RING_LOWEST], ring[RING_HIGHEST] = (
            math.inf,
            0.0,
            math.inf,
            -math.inf,
        )
        for frame in range(blocks[block, 1], blocks[block, 1] + blocks[block, 2]):
            square, _ = pose_distance(middles[block], rows[frame])
            widest = max(widest, square)
            for row in range(start, start + count):
                x, y = paths[row, 0] - rows[frame, POSE_CENTRE], paths[row, 1] - rows[frame, POSE_CENTRE + 1]
                away = math.sqrt(x * x + y * y)
                ring[RING_NEAREST], ring[RING_FARTHEST] = (
                    min(ring[RING_NEAREST], away - 1e-6),
                    max(ring[RING_FARTHEST], away + 1e-6),
                )
                ring[RING_LOWEST], ring[RING_HIGHEST] = (
                    min(ring[RING_LOWEST], paths[row, 2]),
                    max(ring[RING_HIGHEST], paths[row, 2]),
                )
        out_radii[block] = math.sqrt(widest) + 1e-6


@summing_kernel
def write_block_cost_bounds(table, allowed, query, out_bounds):
    """Write a lower bound (B,) of the cost of each block's frames; inf where its clip is not ``allowed`` (C,)."""
    clips, blocks = table.clips, table.blocks
    for block in range(blocks.shape[0]):
        clip = blocks[block, 0]
        if not allowed[clip]:
            out_bounds[block] = math.inf
            continue
        pose, target = query.poses[clips[clip, 0]], query.targets[clips[clip, 0], clips[clip, 1]]
        posture = max(math.sqrt(least_square(pose, table.middles[block])) - table.radii[block], 0.0)
        reach = distance_to_ring(target, table.rings[block])
        out_bounds[block] = query.posture_weight * posture + query.reach_weight * reach


@small_kernel
def least_square(query, pose):
    """Lower bound of D² of two rows (64,) in float32."""
    return rotated_distance_terms(query, pose)[2]


@summing_kernel
def rotated_distance_terms(query, pose):
    """Terms A and B of the squared distance of two rows (64,) as a function of their relative rotation, and a lower
    bound of it, in float32.
    """
    a, b, h = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    for k in range(POSE_JOINTS):
        a += query[k] * pose[k] + query[Y + k] * pose[Y + k]
        b += query[Y + k] * pose[k] - query[k] * pose[Y + k]
        h += query[Z + k] * pose[Z + k]
    square = pose[SQUARE] + query[SQUARE] - np.float32(2.0) * (math.sqrt(a * a + b * b) + h) - FLOAT32_ERROR
    return a, b, max(square, 0.0)


@small_kernel
def distance_to_ring(target, ring):
    """Distance in metres from ``target`` (3,) to a ``ring``: all positions that a path reaches by rotation about the
    vertical.
    """
    across = math.sqrt(target[0] * target[0] + target[1] * target[1])
    beside = max(ring[RING_NEAREST] - across, across - ring[RING_FARTHEST], 0.0)
    above = max(ring[RING_LOWEST] - target[2], target[2] - ring[RING_HIGHEST], 0.0)
    return math.sqrt(beside * beside + above * above)


@kernel
def search_blocks(first, bounds, table, query, found):
    """Write the best frame of each of the N clips with the least cost into ``found``, a ``SearchHits`` record.

    Blocks ``first`` (n,) are searched before the others, and their ``bounds`` (B,) are set to inf.
    """
    last = found.costs.shape[0] - 1
    for n in range(last + 1):
        found.costs[n, COST_COLUMN] = math.inf
        for column in range(3):
            found.places[n, column] = -1
    known = pack(table), pack(query), pack(found)
    for n in range(first.shape[0]):
        block = first[n]
        if bounds[block] < found.costs[last, COST_COLUMN]:
            search_block(block, *known)
        bounds[block] = math.inf
    for block in range(table.blocks.shape[0]):
        if bounds[block] < found.costs[last, COST_COLUMN]:
            search_block(block, *known)


@kernel
def search_block(block, table, query, found):
    """Insert the frames of one block into the results ``found`` if their cost is low enough."""
    costs, rows, last = found.costs, table.rows, found.costs.shape[0] - 1
    clip, begin = table.blocks[block, 0], table.blocks[block, 1]
    actor, limb, path = table.clips[clip, 0], table.clips[clip, 1], table.clips[clip, 2]
    pose, target = query.poses[actor], query.targets[actor, limb]
    ring, count = table.rings[block], table.clips[clip, 3]
    least = query.reach_weight * distance_to_ring(target, ring)
    for frame in range(begin, begin + table.blocks[block, 2]):
        a, b, square = rotated_distance_terms(pose, rows[frame])
        near, planar = query.posture_weight * math.sqrt(square), math.sqrt(np.float64(a) * a + np.float64(b) * b)
        if near + least >= costs[last, COST_COLUMN]:
            continue
        # By the turn in float32 most frames are seen to miss; it is off by no more than ROUNDING over its length.
        off = ring[RING_FARTHEST] * FLOAT32_ERROR / max(planar, 1e-12)
        if off < MAX_FLOAT32_HIT_ERROR:
            reach, _ = hit_distance(rows[frame], (a / planar, b / planar), target, table.paths, path, count)
            if near + query.reach_weight * (reach - off) >= costs[last, COST_COLUMN]:
                continue
        square, rotation = pose_distance(pose, rows[frame])
        posture = math.sqrt(square)
        facing = math.cos(rotation), math.sin(rotation)
        reach, contact = hit_distance(rows[frame], facing, target, table.paths, path, count)
        cost = query.posture_weight * posture + query.reach_weight * reach
        if cost < costs[last, COST_COLUMN]:
            insert_hit((cost, posture, reach, rotation), (clip, frame, contact), found)


@small_kernel
def pose_distance(query, pose):
    """Squared distance D², and the rotation about Z (rad) that brings ``pose`` (64,) nearest to ``query`` (64,)."""
    a, b, rest = 0.0, 0.0, 0.0
    for k in range(POSE_JOINTS):
        x, y, z = np.float64(pose[k]), np.float64(pose[Y + k]), np.float64(pose[Z + k])
        u, v, w = np.float64(query[k]), np.float64(query[Y + k]), np.float64(query[Z + k])
        a += u * x + v * y
        b += v * x - u * y
        rest += u * u + v * v + x * x + y * y + (w - z) * (w - z)
    return max(rest - 2.0 * math.sqrt(a * a + b * b), 0.0), math.atan2(b, a)


@small_kernel
def hit_distance(pose, facing, target, paths, start, count):
    """Least distance (m) of the path of a hit point to ``target`` (3,), and its row.

    The path is rotated with ``pose`` (64,), by the angle with cosine and sine ``facing``.
    """
    c, s = facing
    best, contact = math.inf, start
    for row in range(start, start + count):
        x, y = paths[row, 0] - pose[POSE_CENTRE], paths[row, 1] - pose[POSE_CENTRE + 1]
        dx, dy, dz = c * x - s * y - target[0], s * x + c * y - target[1], paths[row, 2] - target[2]
        square = dx * dx + dy * dy + dz * dz
        if square < best:
            best, contact = square, row
    return math.sqrt(best), contact


@kernel
def insert_hit(costs, index, found):
    """Insert a frame into the hits sorted by cost, at most one per clip, and drop the hit with the greatest cost."""
    row = found.costs.shape[0] - 1
    for n in range(found.costs.shape[0]):
        if found.places[n, CLIP_COLUMN] == index[CLIP_COLUMN]:
            row = n
            if found.costs[n, COST_COLUMN] <= costs[COST_COLUMN]:
                return
    while row > 0 and found.costs[row - 1, COST_COLUMN] > costs[COST_COLUMN]:
        for column in range(4):
            found.costs[row, column] = found.costs[row - 1, column]
        for column in range(3):
            found.places[row, column] = found.places[row - 1, column]
        row -= 1
    for column in range(4):
        found.costs[row, column] = costs[column]
    for column in range(3):
        found.places[row, column] = index[column]
