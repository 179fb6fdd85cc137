"""What pulls at the body, and how the pull changes to the second order while joints turn (METHOD 6)."""

import math

from studio.core.kernels.algebra.vectors import between
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.search.joints import ROOT

ASK, HOLD, BOUND = 0, 1, 2
"""Roles of rows: a bound is one that holds once it is reached."""
FEW = 6
"""Rows that ask, up to which the second derivatives of every pair are looked at, and not of each alone."""
OWN = 6
"""Numbers of a way before those of its pairs."""
DRIFT = 2e-3
"""Metres by which a step may bend away what is held, before that is mended."""
FURTHEST = 1.5
"""Part of a step that is gone at most."""
LEAST_CURVE = 0.3
"""Part of a step's curvature that is taken to be left where more of the step is gone."""


@kernel
def note_pull(pull, x, y, z, span, point, carrier):
    """Note an error (x, y, z) of a ``point`` (3,) of segment ``carrier``, or of a limb of length ``span`` from there.

    ``span`` is 0 for a point, below 0 for a limb that is to be longer; ``carrier`` is -1 where nothing is noted.
    """
    pull.error[0], pull.error[1], pull.error[2], pull.span = x, y, z, span
    pull.point[0], pull.point[1], pull.point[2], pull.carrier = point[0], point[1], point[2], carrier


@kernel
def bent_away(pull, rates, joints, positions):
    """(e . v, e . H(x, x), (J x)^2, |a|) of an error e while joints turn at ``rates`` x (N, 3) (METHOD (23)).

    With v, a the velocity and acceleration of the pulled point, e . H is -e . a, and for a limb of length ``span``
    + |e| / span times v^2 across it (to be shortened, or - to be lengthened).
    """
    carrier = pull.carrier
    vx = vy = vz = ax = ay = az = wx = wy = wz = 0.0
    for k in range(joints.shape[0]):
        gx, gy, gz = rates[k, 0], rates[k, 1], rates[k, 2]
        if joints[k].segment == ROOT:
            vx, vy, vz = vx + gx, vy + gy, vz + gz
        elif joints[k].first <= carrier < joints[k].past:
            place, pivot = pull.point, positions[joints[k].pivot]
            rx, ry, rz = place[0] - pivot[0], place[1] - pivot[1], place[2] - pivot[2]
            ux, uy, uz = gy * rz - gz * ry, gz * rx - gx * rz, gx * ry - gy * rx
            sx, sy, sz = gx + 2.0 * wx, gy + 2.0 * wy, gz + 2.0 * wz
            ax, ay, az = ax + sy * uz - sz * uy, ay + sz * ux - sx * uz, az + sx * uy - sy * ux
            vx, vy, vz, wx, wy, wz = vx + ux, vy + uy, vz + uz, wx + gx, wy + gy, wz + gz
    ex, ey, ez, span = pull.error[0], pull.error[1], pull.error[2], pull.span
    gets_nearer = ex * vx + ey * vy + ez * vz
    bent = -(ex * ax + ey * ay + ez * az)
    squared = vx * vx + vy * vy + vz * vz
    if span != 0.0:
        size = max(math.sqrt(ex * ex + ey * ey + ez * ez), 1e-12)
        along = gets_nearer * gets_nearer / (size * size)
        bent += size / span * (squared - along)
        squared = along
    w = pull.weight
    return w * gets_nearer, w * bent, w * squared, math.sqrt(ax * ax + ay * ay + az * az)


@kernel
def bend(push, pull, held, count, joints, equations, positions):
    """Add ``push`` times the second derivatives e . H(x_i, x_j) of one pull to the normal ``equations``, for every pair
    of their steps ``held`` to ``count``, in one pass over the joints.

    The link d from a joint to the next turns at W, the sum of what they and all before turn: e . H gains
    (e . d) W_i . W_j - (e . W_i)(d . W_j), the positive part of it, so that the equations stay positive and no step
    goes where nothing is to be had.

    METHOD (23).
    """
    ways, scratch = equations.steps, equations.levers
    own, carrier = count - held, pull.carrier
    ux, uy, uz = pull.error[0], pull.error[1], pull.error[2]
    size = max(math.sqrt(ux * ux + uy * uy + uz * uz), 1e-12)
    unit = ux / size, uy / size, uz / size
    for i in range(own):
        for column in range(OWN + own):
            scratch[i, column] = 0.0
    before = -1
    for k in range(joints.shape[0]):
        if joints[k].segment == ROOT:
            for i in range(own):
                for axis in range(3):
                    scratch[i, axis] += ways[held + i, k, axis]
        elif joints[k].first <= carrier < joints[k].past and moves(k, held, count, ways):
            origin = joints[k].pivot
            if before >= 0:
                bend_link(size, unit, between(positions[before], positions[origin]), own, scratch)
            for i in range(own):
                for axis in range(3):
                    scratch[i, 3 + axis] += ways[held + i, k, axis]
            before = origin
    if before >= 0:
        bend_link(size, unit, between(positions[before], pull.point), own, scratch)
    weight = push * pull.weight
    stretch = weight * size / pull.span if pull.span > 0.0 else 0.0
    add_bends(weight, stretch, unit, own, scratch, equations.normal)


@kernel
def add_bends(weight, stretch, unit, own, scratch, normal):
    """Add what ``bend`` found in ``scratch`` to the ``normal`` equations (n, n + 1), and by how much a limb that is too
    short bends across its line, the ``unit``: ``stretch`` times the velocities' product.
    """
    ux, uy, uz = unit
    for i in range(own):
        for j in range(i if own > FEW else 0, i + 1):
            bent = weight * scratch[i, OWN + j]
            if stretch > 0.0:
                vx, vy, vz = scratch[i, 0], scratch[i, 1], scratch[i, 2]
                wx, wy, wz = scratch[j, 0], scratch[j, 1], scratch[j, 2]
                along = (ux * vx + uy * vy + uz * vz) * (ux * wx + uy * wy + uz * wz)
                bent += stretch * (vx * wx + vy * wy + vz * wz - along)
            normal[i, j] += bent
            if j < i:
                normal[j, i] += bent


@small_kernel
def moves(joint, held, count, ways):
    """Whether any way turns a joint: one that only levels below may turn does not part a link in two."""
    for i in range(held, count):
        if ways[i, joint, 0] != 0.0 or ways[i, joint, 1] != 0.0 or ways[i, joint, 2] != 0.0:
            return True
    return False


@kernel
def bend_link(error, unit, link, own, scratch):
    """One ``link`` (x, y, z) of ``bend``, pulled by ``error`` metres along the ``unit``: its far end joins the
    velocities, and what bends.
    """
    dx, dy, dz = link
    size, both, side, (sx, sy, sz), (tx, ty, tz) = positive_bend(error, unit, link)
    for i in range(own):
        way = scratch[i]
        x, y, z = way[3], way[4], way[5]
        way[0], way[1], way[2] = way[0] + y * dz - z * dy, way[1] + z * dx - x * dz, way[2] + x * dy - y * dx
        along, aside = both * (x * sx + y * sy + z * sz), side * (x * tx + y * ty + z * tz)
        for j in range(i if own > FEW else 0, i + 1):
            ox, oy, oz = scratch[j, 3], scratch[j, 4], scratch[j, 5]
            way[OWN + j] += size * (x * ox + y * oy + z * oz)
            way[OWN + j] += aside * (ox * tx + oy * ty + oz * tz) - along * (ox * sx + oy * sy + oz * sz)


@small_kernel
def positive_bend(error, unit, link):
    """The positive part of (e . d) 1 - (d e^T + e d^T) / 2, as (k, b, a, s, t) of k 1 - b s s^T + a t t^T, for an
    ``error`` e along the ``unit`` and d the ``link``.

    At an angle of cosine c it has the values c across both, (c + 1) / 2 along t = d/|d| - e/|e| and (c - 1) / 2 along
    s = d/|d| + e/|e|, times |d||e|. METHOD (23).
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
def part_of_step(held, count, slope, roles, pulls, way, joints, positions):
    """The part of a step after which its own errors are least to the second order, and what is held stays in place.

    Along the step an error goes as e - p a + p^2 b / 2, so that with Newton's ``slope`` s the sum of squares has

        g(p) = s (1 - p) + 3/2 p^2 sum (e a)(e b) / e^2 - p^3 / 2 sum (e b)^2 / e^2

    left of it: one of Newton's steps from p = 1. What is held may bend away by ``DRIFT``.

    METHOD (23).
    """
    third = fourth = worst = 0.0
    for row in range(count):
        if pulls[row].carrier < 0.0 or (row < held and roles[row] == BOUND):
            continue
        nearer, bent, _, swerve = bent_away(pulls[row], way, joints, positions)
        if row < held:
            worst = max(worst, swerve)
            continue
        size = pulls[row].weight * max(
            pulls[row].error[0] ** 2 + pulls[row].error[1] ** 2 + pulls[row].error[2] ** 2, 1e-24
        )
        third, fourth = third + nearer * bent / size, fourth + bent * bent / size
    slope = max(slope, 1e-15)
    third, fourth = third / slope, fourth / slope
    part = 1.0 + (1.5 * third - 0.5 * fourth) / max(1.0 - 3.0 * third + 1.5 * fourth, LEAST_CURVE)
    part = min(max(part, 0.0), FURTHEST)
    return min(part, math.sqrt(2.0 * DRIFT / worst)) if worst > 0.0 else part


@kernel
def begin_row(task_rows, count, owner, error):
    """Start an empty row that asks."""
    note_row(task_rows, count, owner, error)
    row = task_rows.jacobian[count]
    for joint in range(row.shape[0]):
        row[joint, 0] = row[joint, 1] = row[joint, 2] = 0.0


@small_kernel
def note_row(task_rows, count, owner, error):
    """Start a row that asks, but for its levers."""
    task_rows.pulls[count].carrier, task_rows.pulls[count].weight = -1, 1.0
    task_rows.errors[count], task_rows.owners[count] = error, owner
    task_rows.roles[count], task_rows.rooms[count] = ASK, 0.0
