"""What pulls at the body, and how the pull changes to the second order while joints turn (METHOD 6)."""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.joints import ROOT

ASK, HOLD, BOUND = 0, 1, 2
"""Roles of rows: a bound is one that holds once it is reached."""
FEW = 6
"""Rows that ask, up to which the second derivatives of every pair are looked at, and not of each alone."""
OWN = 12
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
    pull[0], pull[1], pull[2], pull[3] = x, y, z, span
    pull[4], pull[5], pull[6], pull[7] = point[0], point[1], point[2], carrier


@kernel
def bent_away(pull, rates, joints, positions):
    """(e . v, e . H(x, x), (J x)^2, |a|) of an error e while joints turn at ``rates`` x (N, 3) (METHOD (23)).

    With v, a the velocity and acceleration of the pulled point, e . H is -e . a, and for a limb of length ``span``
    + |e| / span times v^2 across it (to be shortened, or - to be lengthened).
    """
    carrier = int(pull[7])
    vx = vy = vz = ax = ay = az = wx = wy = wz = 0.0
    for k in range(joints.shape[0]):
        gx, gy, gz = rates[k, 0], rates[k, 1], rates[k, 2]
        if joints[k, 0] == ROOT:
            vx, vy, vz = vx + gx, vy + gy, vz + gz
        elif joints[k, 2] <= carrier < joints[k, 3]:
            origin = joints[k, 1]
            rx, ry, rz = pull[4] - positions[origin, 0], pull[5] - positions[origin, 1], pull[6] - positions[origin, 2]
            ux, uy, uz = gy * rz - gz * ry, gz * rx - gx * rz, gx * ry - gy * rx
            sx, sy, sz = gx + 2.0 * wx, gy + 2.0 * wy, gz + 2.0 * wz
            ax, ay, az = ax + sy * uz - sz * uy, ay + sz * ux - sx * uz, az + sx * uy - sy * ux
            vx, vy, vz, wx, wy, wz = vx + ux, vy + uy, vz + uz, wx + gx, wy + gy, wz + gz
    ex, ey, ez, span = pull[0], pull[1], pull[2], pull[3]
    gets_nearer = ex * vx + ey * vy + ez * vz
    bent = -(ex * ax + ey * ay + ez * az)
    squared = vx * vx + vy * vy + vz * vz
    if span != 0.0:
        size = max(math.sqrt(ex * ex + ey * ey + ez * ez), 1e-12)
        along = gets_nearer * gets_nearer / (size * size)
        bent += size / span * (squared - along)
        squared = along
    w = pull[8]
    return w * gets_nearer, w * bent, w * squared, math.sqrt(ax * ax + ay * ay + az * az)


@kernel
def bend(push, pull, held, count, ways, joints, newton, scratch, positions):
    """Add ``push`` times the second derivatives e . H(x_i, x_j) of one pull to ``newton`` (n, n + 1), for every pair of
    the ways ``held`` to ``count`` of (R, N, 3), in one pass over the joints; ``scratch`` (R, R + 12) is written over.

    With u = g x r and s = g + 2 w of a way at each joint, e . a_ij gains ((e x s_i) . u_j + (e x s_j) . u_i) / 2.
    What would bend towards the goal is left out, and a pair counts at most 0.9 of the mean of what each of the two
    bends away alone, so that the equations stay positive.

    METHOD (23).
    """
    own, carrier, weight = count - held, int(pull[7]), push * pull[8]
    ex, ey, ez, span = pull[0], pull[1], pull[2], pull[3]
    for i in range(own):
        for column in range(OWN + own):
            scratch[i, column] = 0.0
    for k in range(joints.shape[0]):
        if joints[k, 0] == ROOT:
            for i in range(own):
                for axis in range(3):
                    scratch[i, axis] += ways[held + i, k, axis]
        elif joints[k, 2] <= carrier < joints[k, 3]:
            origin = joints[k, 1]
            rx, ry, rz = pull[4] - positions[origin, 0], pull[5] - positions[origin, 1], pull[6] - positions[origin, 2]
            for i in range(own):
                turn_about(ways[held + i, k], rx, ry, rz, ex, ey, ez, scratch[i])
                for j in range(i + 1 if own <= FEW else 0):
                    scratch[i, OWN + j] += 0.5 * (along(scratch[i], scratch[j]) + along(scratch[j], scratch[i]))
                if own > FEW:
                    scratch[i, OWN + i] += along(scratch[i], scratch[i])
    squared = max(ex * ex + ey * ey + ez * ez, 1e-24)
    stretch = 0.0 if span == 0.0 else math.sqrt(squared) / span
    for i in range(own):
        for j in range(i if own > FEW else 0, i + 1):
            bent = -scratch[i, OWN + j]
            if span != 0.0:
                vx, vy, vz = scratch[i, 0], scratch[i, 1], scratch[i, 2]
                wx, wy, wz = scratch[j, 0], scratch[j, 1], scratch[j, 2]
                across = (ex * vx + ey * vy + ez * vz) * (ex * wx + ey * wy + ez * wz) / squared
                bent += stretch * (vx * wx + vy * wy + vz * wz - across)
            scratch[i, OWN + j] = weight * bent
        scratch[i, OWN + i] = max(scratch[i, OWN + i], 0.0)
        newton[i, i] += scratch[i, OWN + i]
        for j in range(i if own <= FEW else 0):
            most = 0.9 * math.sqrt(scratch[i, OWN + i] * scratch[j, OWN + j])
            pair = min(max(scratch[i, OWN + j], -most), most)
            newton[i, j] += pair
            newton[j, i] += pair


@kernel
def turn_about(rates, rx, ry, rz, ex, ey, ez, way):
    """One joint of a way at ``rates`` (3,), with lever r: its v and w so far, then u = g x r and e x (g + 2 w)."""
    gx, gy, gz = rates[0], rates[1], rates[2]
    sx, sy, sz = gx + 2.0 * way[3], gy + 2.0 * way[4], gz + 2.0 * way[5]
    way[3], way[4], way[5] = way[3] + gx, way[4] + gy, way[5] + gz
    way[6], way[7], way[8] = gy * rz - gz * ry, gz * rx - gx * rz, gx * ry - gy * rx
    way[9], way[10], way[11] = ey * sz - ez * sy, ez * sx - ex * sz, ex * sy - ey * sx
    way[0], way[1], way[2] = way[0] + way[6], way[1] + way[7], way[2] + way[8]


@kernel
def along(first, second):
    """(e x s) of the first way . u of the second, as ``turn_about`` left them."""
    return first[9] * second[6] + first[10] * second[7] + first[11] * second[8]


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
        if pulls[row, 7] < 0.0 or (row < held and roles[row] == BOUND):
            continue
        nearer, bent, _, swerve = bent_away(pulls[row], way, joints, positions)
        if row < held:
            worst = max(worst, swerve)
            continue
        size = pulls[row, 8] * max(pulls[row, 0] ** 2 + pulls[row, 1] ** 2 + pulls[row, 2] ** 2, 1e-24)
        third, fourth = third + nearer * bent / size, fourth + bent * bent / size
    slope = max(slope, 1e-15)
    third, fourth = third / slope, fourth / slope
    part = 1.0 + (1.5 * third - 0.5 * fourth) / max(1.0 - 3.0 * third + 1.5 * fourth, LEAST_CURVE)
    part = min(max(part, 0.0), FURTHEST)
    return min(part, math.sqrt(2.0 * DRIFT / worst)) if worst > 0.0 else part
