"""Strict priorities over the whole body: each level is solved with all levels above it held.

One step asks every row at once. A row is a direction in which a point (or the centre of mass, or a turn) is to move
and by how much; with J_rk how joint k moves row r and w_rk the mobility that the row's constraint gives it, the step
is x_k = sum_r w_rk J_rk y_r where M y = e and M_qr = sum_k w_rk J_qk . J_rk. Rows stand in order of priority and are
eliminated in that order without exchange: what lower rows add is taken into account by every higher one, and a row
that those above have used up is damped away (METHOD 10, "one block Cholesky over stacked levels").
"""

import math

from numba import njit

from studio.core.kernels.body import move_all, turn_part
from studio.core.kernels.joints import ROOT
from studio.core.kernels.rotation import rotation_vector_to_matrix

LONGEST_ERROR = 0.3
"""Metres (or radians) of error answered in one step."""
HELD_DAMPING = 1e-7
SINGULAR = 1e-4
"""Pivot below which a row is taken to be spoken for by those above it."""


@njit(cache=True, nogil=True)
def take_step(rows, errors, owners, held_count, row_count, mobilities, joints, damping, limits, turned, scratch, pose):
    """Turn all joints and move the root towards what the rows ask; False when nothing can move.

    ``rows`` (R, N, 3), ``errors`` (R,), ``owners`` (R,) constraint of each row (C for the feet's own); the first
    ``held_count`` belong to higher levels; ``mobilities`` (C + 1, N); ``joints`` (N, 4); ``limits`` (N,) radians that
    each joint may turn in all, ``turned`` (N, 3) what it has turned so far; ``scratch`` the tuple (matrix, turn).
    """
    matrix, turn = scratch
    positions, rotations = pose
    count = joints.shape[0]
    movable = False
    for i in range(row_count):
        weights = mobilities[owners[i]]
        for j in range(row_count):
            total = 0.0
            for k in range(count):
                if weights[k] != 0.0:
                    total += weights[k] * (
                        rows[i, k, 0] * rows[j, k, 0] + rows[i, k, 1] * rows[j, k, 1] + rows[i, k, 2] * rows[j, k, 2]
                    )
            matrix[j, i] = total
        movable = movable or (i >= held_count and matrix[i, i] > 1e-9)
        matrix[i, row_count] = min(max(errors[i], -LONGEST_ERROR), LONGEST_ERROR)
    if not movable:
        return False
    eliminate(matrix, held_count, row_count, damping)
    spine_count = positions.shape[0] - 23
    for k in range(count):
        x, y, z = 0.0, 0.0, 0.0
        for i in range(row_count):
            share = mobilities[owners[i], k] * matrix[i, row_count]
            x, y, z = x + share * rows[i, k, 0], y + share * rows[i, k, 1], z + share * rows[i, k, 2]
        if x == 0.0 and y == 0.0 and z == 0.0:
            continue
        if joints[k, 0] == ROOT:
            move_all(x, y, z, positions)
        else:
            limited_turn(x, y, z, limits[k], turned[k], turn)
            turn_part(turn, joints[k, 0], spine_count, positions[joints[k, 1]], positions, rotations)
    return True


@njit(cache=True, nogil=True)
def eliminate(matrix, held_count, count, damping):
    """Solve matrix (n, n + 1) in place by elimination in order; the answer stands in the last column."""
    for i in range(count):
        pivot = matrix[i, i] + (HELD_DAMPING if i < held_count else damping)
        inverse = pivot / (pivot * pivot + SINGULAR * SINGULAR)
        matrix[i, i] = inverse
        for j in range(i + 1, count):
            factor = matrix[j, i] * inverse
            if factor != 0.0:
                for column in range(i + 1, count + 1):
                    matrix[j, column] -= factor * matrix[i, column]
    for i in range(count - 1, -1, -1):
        value = matrix[i, count]
        for j in range(i + 1, count):
            value -= matrix[i, j] * matrix[j, count]
        matrix[i, count] = value * matrix[i, i]


@njit(cache=True, nogil=True)
def limited_turn(x, y, z, limit, turned, out_turn):
    """The rotation (3, 3) of a rotation vector, as far as ``limit`` radians in all allow; ``turned`` (3,) adds up."""
    wx, wy, wz = turned[0] + x, turned[1] + y, turned[2] + z
    total = math.sqrt(wx * wx + wy * wy + wz * wz)
    if total > limit:
        wx, wy, wz = wx * limit / total, wy * limit / total, wz * limit / total
    rotation_vector_to_matrix(wx - turned[0], wy - turned[1], wz - turned[2], out_turn)
    turned[0], turned[1], turned[2] = wx, wy, wz
