"""Second-order terms (Hessians) of the rows' errors (METHOD 9)."""

import math

from studio.core.kernels.algebra.vectors import offset_between
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.search.joints import ROOT_TRANSLATION

OBJECTIVE_ROW, EQUALITY_ROW, INEQUALITY_ROW = 0, 1, 2
"""Roles of rows: objective, equality of a higher level, inequality."""
FULL_HESSIAN_ROWS = 6
"""Greatest number of objective rows for which all second derivatives are computed; for more, only those on the
diagonal.
"""
LINK_NUMBERS = 6
"""Number of columns of a direction's row of scratch before those of its pairs with other directions."""
ALLOWED_DRIFT = 2e-3
"""Greatest second-order drift in metres of a held row by one step, which is restored afterwards."""
MAX_STEP_LENGTH = 1.5
"""Greatest step length, 1 being a Newton step."""
LEAST_CURVATURE = 0.3
"""Least curvature assumed along a step, as a fraction of that at its start."""


@kernel
def set_point_error(point_error, x, y, z, span, point, segment):
    """Write a ``POINT_ERROR``: the error (x, y, z) in metres of a ``point`` (3,) of ``segment``, or of a limb that
    begins at the point.

    ``span`` is 0 for a point, the limb's length in metres if the limb has to shorten, and minus that if it has to
    extend; ``segment`` is -1 for none.
    """
    point_error.error[0], point_error.error[1], point_error.error[2], point_error.span = x, y, z, span
    point_error.point[0], point_error.point[1], point_error.point[2], point_error.segment = (
        point[0],
        point[1],
        point[2],
        segment,
    )


@kernel
def directional_derivatives(point_error, rates, joints, positions):
    """(e . v, e . H(x, x), (J x)^2, |a|) of a point error e while joints move at the ``rates`` x (N, 3) (METHOD (23)).

    With v, a the velocity and acceleration of the point, e . H is -e . a; for a limb, plus |e| / ``span`` times the
    squared velocity across it.
    """
    segment = point_error.segment
    vx = vy = vz = ax = ay = az = wx = wy = wz = 0.0
    for k in range(joints.shape[0]):
        gx, gy, gz = rates[k, 0], rates[k, 1], rates[k, 2]
        if joints[k].segment == ROOT_TRANSLATION:
            vx, vy, vz = vx + gx, vy + gy, vz + gz
        elif joints[k].first <= segment < joints[k].past:
            position, pivot = point_error.point, positions[joints[k].pivot]
            rx, ry, rz = position[0] - pivot[0], position[1] - pivot[1], position[2] - pivot[2]
            ux, uy, uz = gy * rz - gz * ry, gz * rx - gx * rz, gx * ry - gy * rx
            sx, sy, sz = gx + 2.0 * wx, gy + 2.0 * wy, gz + 2.0 * wz
            ax, ay, az = ax + sy * uz - sz * uy, ay + sz * ux - sx * uz, az + sx * uy - sy * ux
            vx, vy, vz, wx, wy, wz = vx + ux, vy + uy, vz + uz, wx + gx, wy + gy, wz + gz
    ex, ey, ez, span = point_error.error[0], point_error.error[1], point_error.error[2], point_error.span
    gets_nearer = ex * vx + ey * vy + ez * vz
    second_order = -(ex * ax + ey * ay + ez * az)
    squared = vx * vx + vy * vy + vz * vz
    if span != 0.0:
        size = max(math.sqrt(ex * ex + ey * ey + ez * ez), 1e-12)
        along = gets_nearer * gets_nearer / (size * size)
        second_order += size / span * (squared - along)
        squared = along
    w = point_error.weight
    return w * gets_nearer, w * second_order, w * squared, math.sqrt(ax * ax + ay * ay + az * az)


@kernel
def add_row_hessian(push, point_error, equality_count, count, joints, equations, positions):
    """Add ``push`` times the second derivatives e . H(x_i, x_j) of one point error to the normal ``equations``.

    All pairs of the directions ``equality_count`` to ``count`` are added, in one pass over the joints. The link d from
    a joint to the next rotates at W, the sum of its own and all earlier rates: e . H gains (e . d) W_i . W_j - (e .
    W_i)(d . W_j). Its positive part is taken, so that the equations stay positive. METHOD (23).
    """
    directions, scratch = equations.directions, equations.scratch
    own, segment = count - equality_count, point_error.segment
    ux, uy, uz = point_error.error[0], point_error.error[1], point_error.error[2]
    size = max(math.sqrt(ux * ux + uy * uy + uz * uz), 1e-12)
    unit = ux / size, uy / size, uz / size
    for i in range(own):
        for column in range(LINK_NUMBERS + own):
            scratch[i, column] = 0.0
    before = -1
    for k in range(joints.shape[0]):
        if joints[k].segment == ROOT_TRANSLATION:
            for i in range(own):
                for axis in range(3):
                    scratch[i, axis] += directions[equality_count + i, k, axis]
        elif joints[k].first <= segment < joints[k].past and moves_joint(k, equality_count, count, directions):
            origin = joints[k].pivot
            if before >= 0:
                add_link_term(size, unit, offset_between(positions[before], positions[origin]), own, scratch)
            for i in range(own):
                for axis in range(3):
                    scratch[i, 3 + axis] += directions[equality_count + i, k, axis]
            before = origin
    if before >= 0:
        add_link_term(size, unit, offset_between(positions[before], point_error.point), own, scratch)
    weight = push * point_error.weight
    stretch = weight * size / point_error.span if point_error.span > 0.0 else 0.0
    add_projected_hessian(weight, stretch, unit, own, scratch, equations.normal)


@kernel
def add_projected_hessian(weight, stretch, unit, own, scratch, normal):
    """Add ``weight`` times the second derivatives in ``scratch`` to the ``normal`` equations (n, n + 1).

    For a limb that is too short, also ``stretch`` times the product of the velocities across ``unit``.
    """
    ux, uy, uz = unit
    for i in range(own):
        for j in range(i if own > FULL_HESSIAN_ROWS else 0, i + 1):
            second_order = weight * scratch[i, LINK_NUMBERS + j]
            if stretch > 0.0:
                vx, vy, vz = scratch[i, 0], scratch[i, 1], scratch[i, 2]
                wx, wy, wz = scratch[j, 0], scratch[j, 1], scratch[j, 2]
                along = (ux * vx + uy * vy + uz * vz) * (ux * wx + uy * wy + uz * wz)
                second_order += stretch * (vx * wx + vy * wy + vz * wz - along)
            normal[i, j] += second_order
            if j < i:
                normal[j, i] += second_order


@small_kernel
def moves_joint(joint, equality_count, count, directions):
    """True if any of the ``directions`` moves the joint."""
    for i in range(equality_count, count):
        if directions[i, joint, 0] != 0.0 or directions[i, joint, 1] != 0.0 or directions[i, joint, 2] != 0.0:
            return True
    return False


@kernel
def add_link_term(error, unit, link, own, scratch):
    """Add one ``link`` (x, y, z) to the velocities and second derivatives in ``scratch``.

    The error is ``error`` metres along ``unit``.
    """
    dx, dy, dz = link
    size, both, side, (sx, sy, sz), (tx, ty, tz) = positive_second_order_term(error, unit, link)
    for i in range(own):
        displacement = scratch[i]
        x, y, z = displacement[3], displacement[4], displacement[5]
        displacement[0], displacement[1], displacement[2] = (
            displacement[0] + y * dz - z * dy,
            displacement[1] + z * dx - x * dz,
            displacement[2] + x * dy - y * dx,
        )
        along, aside = both * (x * sx + y * sy + z * sz), side * (x * tx + y * ty + z * tz)
        for j in range(i if own > FULL_HESSIAN_ROWS else 0, i + 1):
            ox, oy, oz = scratch[j, 3], scratch[j, 4], scratch[j, 5]
            displacement[LINK_NUMBERS + j] += size * (x * ox + y * oy + z * oz)
            displacement[LINK_NUMBERS + j] += aside * (ox * tx + oy * ty + oz * tz) - along * (
                ox * sx + oy * sy + oz * sz
            )


@small_kernel
def positive_second_order_term(error, unit, link):
    """Positive part of the symmetric matrix (e . d) 1 - (d e^T + e d^T) / 2, as (k, b, a, s, t) of k 1 - b s s^T + a t
    t^T.

    e is ``error`` times ``unit``, d the ``link``. At an angle of cosine c it has the eigenvalues c across both, (c + 1)
    / 2 along t = d/|d| - e/|e| and (c - 1) / 2 along s = d/|d| + e/|e|, times |d||e|. METHOD (23).
    """
    (ux, uy, uz), (dx, dy, dz) = unit, link
    d = max(math.sqrt(dx * dx + dy * dy + dz * dz), 1e-12)
    size, per = error * d, 1.0 / d
    dx, dy, dz = per * dx, per * dy, per * dz
    cosine = ux * dx + uy * dy + uz * dz
    less, both, side = 0.0, 0.0, 0.25 * size
    if cosine > 0.0:
        less = size * cosine
        both = less / (2.0 + 2.0 * cosine)
    else:
        side *= (1.0 + cosine) / (1.0 - cosine)
    return less, both, side, (dx + ux, dy + uy, dz + uz), (dx - ux, dy - uy, dz - uz)


@kernel
def optimal_step_length(equality_count, count, slope, roles, point_errors, step, joints, positions):
    """Step length with the least squared errors to second order, short enough for held rows not to drift.

    Along the step an error is e - p a + p^2 b / 2, so that with the gradient ``slope`` s the sum of squares has the
    derivative

            g(p) = s (1 - p) + 3/2 p^2 sum (e a)(e b) / e^2 - p^3 / 2 sum (e b)^2 / e^2

    and one Newton step from p = 1 is taken. Held rows may drift by ``ALLOWED_DRIFT``. METHOD (23).
    """
    third = fourth = worst = 0.0
    for row in range(count):
        if point_errors[row].segment < 0.0 or (row < equality_count and roles[row] == INEQUALITY_ROW):
            continue
        nearer, second_order, _, swerve = directional_derivatives(point_errors[row], step, joints, positions)
        if row < equality_count:
            worst = max(worst, swerve)
            continue
        size = point_errors[row].weight * max(
            point_errors[row].error[0] ** 2 + point_errors[row].error[1] ** 2 + point_errors[row].error[2] ** 2, 1e-24
        )
        third, fourth = third + nearer * second_order / size, fourth + second_order * second_order / size
    slope = max(slope, 1e-15)
    third, fourth = third / slope, fourth / slope
    fraction = 1.0 + (1.5 * third - 0.5 * fourth) / max(1.0 - 3.0 * third + 1.5 * fourth, LEAST_CURVATURE)
    fraction = min(max(fraction, 0.0), MAX_STEP_LENGTH)
    return min(fraction, math.sqrt(2.0 * ALLOWED_DRIFT / worst)) if worst > 0.0 else fraction


@kernel
def begin_zero_row(task_rows, count, weight_row, error):
    """Set error and weight row of objective row ``count``, and set its Jacobian to zero."""
    begin_filled_row(task_rows, count, weight_row, error)
    row = task_rows.jacobian[count]
    for joint in range(row.shape[0]):
        row[joint, 0] = row[joint, 1] = row[joint, 2] = 0.0


@small_kernel
def begin_filled_row(task_rows, count, weight_row, error):
    """Set error and weight row of objective row ``count``; the caller writes its Jacobian."""
    task_rows.point_errors[count].segment, task_rows.point_errors[count].weight = -1, 1.0
    task_rows.errors[count], task_rows.weight_rows[count] = error, weight_row
    task_rows.roles[count], task_rows.margins[count] = OBJECTIVE_ROW, 0.0
