"""Trunk, clavicles, neck and root towards what limbs cannot reach: one damped step for all constraints at once.

Each constraint gives rows: a point p that the chain carries, a direction v and an error e along it. A limb that
may move acts as a link of variable length, so it gives one row, its deficit along the line to the target; any
other point gives three. With levers a_ik = (p_i - o_k) x v_i about joint k and weights w the step is
x_k = sum_i w_ik a_ik y_i, where M y = e and M_ji = sum_k w_ik a_jk . a_ik (METHOD 6, "reach step").
Rows stand in order of priority and are eliminated in that order without exchange, so what a lower row adds is
taken into account by every higher one.
"""

import math

from numba import njit

from studio.core.kernels.body import move_all, turn_part
from studio.core.kernels.rotation import rotation_vector_to_matrix

LONGEST_ERROR = 0.3
"""Metres of error answered in one step."""
ROOT_WEIGHT = 0.15
"""Mobility of the root's translation beside one vertebra's rotation (square metres)."""
CLAVICLE_WEIGHT = 4.0
"""Mobility of a clavicle beside one vertebra (METHOD 6)."""
SINGULAR = 1e-4
"""Pivot below which a row is taken to be spoken for by those above it."""
VERTEBRA_LIMIT = 0.5
CLAVICLE_LIMIT = 0.35


@njit(cache=True, nogil=True)
def carries(joint, carrier, spine_count):
    """Whether turning ``joint`` moves a point on ``carrier``.

    Joints: spine 0..K-1, then left and right clavicle, neck, head. Carriers: spine 0..K-1, then left and right
    arm, neck, head, legs.
    """
    if carrier == spine_count + 4:
        return False
    if joint < spine_count:
        return 0 < joint <= carrier
    if joint == spine_count + 2:
        return carrier == spine_count + 2 or carrier == spine_count + 3
    return joint == carrier


@njit(cache=True, nogil=True)
def mobility(joint, chain, spine_count):
    """Weight of ``joint`` in a constraint's chain (limb, end segment, clavicle or neck, trunk, root)."""
    if joint < spine_count:
        return chain[3]
    if joint < spine_count + 2:
        return CLAVICLE_WEIGHT * chain[2]
    if joint == spine_count + 2:
        return max(chain[0], chain[2])
    return max(chain[0], chain[1])


@njit(cache=True, nogil=True)
def pivot_of(joint, spine_count):
    """(point index, segment index) about which and which ``joint`` turns."""
    if joint < spine_count:
        return joint, joint
    if joint < spine_count + 2:
        side = joint - spine_count
        return spine_count + 3 + 5 * side, spine_count + 2 + 4 * side
    return joint - 2, joint - 2


@njit(cache=True, nogil=True)
def trunk_step(rows, row_codes, row_count, chains, damping, matrix, turned, turn, pose):
    """One step of all free joints and of the root, shorter the greater ``damping``; True when anything could move.

    ``rows`` (R, 7) point, direction, error; ``row_codes`` (R, 2) constraint, carrier; ``chains`` (C, 5);
    ``matrix`` (R, R + 1) scratch; ``turned`` (K + 4, 3) how far each joint has turned so far, updated.
    """
    positions = pose[0]
    spine_count = positions.shape[0] - 23
    for i in range(row_count):
        for j in range(row_count):
            matrix[j, i] = coupling(rows, row_codes, j, i, chains, spine_count, positions)
        matrix[i, row_count] = min(max(rows[i, 6], -LONGEST_ERROR), LONGEST_ERROR)
    if not eliminate(matrix, row_count, damping):
        return False
    answer = matrix[:, row_count]
    for joint in range(1, spine_count + 4):
        turn_joint(joint, rows, row_codes, row_count, chains, answer, turned, turn, pose)
    move_root(rows, row_codes, row_count, chains, answer, positions)
    return True


@njit(cache=True, nogil=True)
def coupling(rows, row_codes, j, i, chains, spine_count, positions):
    """M_ji: how far row j moves along its direction for a unit of row i's y."""
    total = 0.0
    chain = chains[row_codes[i, 0]]
    for joint in range(1, spine_count + 4):
        if not (carries(joint, row_codes[i, 1], spine_count) and carries(joint, row_codes[j, 1], spine_count)):
            continue
        weight = mobility(joint, chain, spine_count)
        if weight == 0.0:
            continue
        point, _ = pivot_of(joint, spine_count)
        ax, ay, az = lever(rows[i], positions[point])
        bx, by, bz = lever(rows[j], positions[point])
        total += weight * (ax * bx + ay * by + az * bz)
    straight = rows[i, 3] * rows[j, 3] + rows[i, 4] * rows[j, 4] + rows[i, 5] * rows[j, 5]
    return total + ROOT_WEIGHT * chain[4] * straight


@njit(cache=True, nogil=True)
def lever(row, origin):
    """(p - o) x v."""
    x, y, z = row[0] - origin[0], row[1] - origin[1], row[2] - origin[2]
    return y * row[5] - z * row[4], z * row[3] - x * row[5], x * row[4] - y * row[3]


@njit(cache=True, nogil=True)
def eliminate(matrix, count, damping):
    """Solve matrix (n, n + 1) in place by elimination in order; the answer stands in the last column.

    A pivot that the rows above have used up is damped away: p / (p^2 + s^2), so its row gives in and they do not.
    """
    movable = False
    for i in range(count):
        movable = movable or matrix[i, i] > 1e-9
        pivot = matrix[i, i] + damping
        inverse = pivot / (pivot * pivot + SINGULAR * SINGULAR)
        for j in range(i + 1, count):
            factor = matrix[j, i] * inverse
            for column in range(i, count + 1):
                matrix[j, column] -= factor * matrix[i, column]
    for i in range(count - 1, -1, -1):
        pivot = matrix[i, i] + damping
        value = matrix[i, count]
        for j in range(i + 1, count):
            value -= matrix[i, j] * matrix[j, count]
        matrix[i, count] = value * pivot / (pivot * pivot + SINGULAR * SINGULAR)
    return movable


@njit(cache=True, nogil=True)
def turn_joint(joint, rows, row_codes, row_count, chains, answer, turned, turn, pose):
    """Turn one joint by its share of the step, within what it may turn in all."""
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    point, segment = pivot_of(joint, spine_count)
    wx, wy, wz = 0.0, 0.0, 0.0
    for i in range(row_count):
        if carries(joint, row_codes[i, 1], spine_count):
            share = mobility(joint, chains[row_codes[i, 0]], spine_count) * answer[i]
            if share != 0.0:
                ax, ay, az = lever(rows[i], positions[point])
                wx, wy, wz = wx + share * ax, wy + share * ay, wz + share * az
    if wx == 0.0 and wy == 0.0 and wz == 0.0:
        return
    limit = VERTEBRA_LIMIT if joint < spine_count else CLAVICLE_LIMIT
    x, y, z = turned[joint, 0] + wx, turned[joint, 1] + wy, turned[joint, 2] + wz
    total = math.sqrt(x * x + y * y + z * z)
    if total > limit:
        x, y, z = x * limit / total, y * limit / total, z * limit / total
    wx, wy, wz = x - turned[joint, 0], y - turned[joint, 1], z - turned[joint, 2]
    turned[joint, 0], turned[joint, 1], turned[joint, 2] = x, y, z
    rotation_vector_to_matrix(wx, wy, wz, turn)
    turn_part(turn, segment, spine_count, positions[point], positions, rotations)


@njit(cache=True, nogil=True)
def move_root(rows, row_codes, row_count, chains, answer, positions):
    """Translate the whole body by its share of the step."""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(row_count):
        share = ROOT_WEIGHT * chains[row_codes[i, 0], 4] * answer[i]
        x, y, z = x + share * rows[i, 3], y + share * rows[i, 4], z + share * rows[i, 5]
    move_all(x, y, z, positions)
