"""What pulls at the body, and how the pull changes to the second order while joints turn."""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.joints import ROOT

ASK, HOLD, BOUND = 0, 1, 2
"""Roles of rows: a bound is one that holds once it is reached."""
DRIFT = 2e-3
"""Metres by which a step may bend away what is held, before that is mended."""


@kernel
def note_pull(pull, x, y, z, span, point, carrier):
    """Note an error (x, y, z) of a ``point`` (3,) of segment ``carrier``, or of a limb of length ``span`` from there.

    ``span`` is 0 for a point, below 0 for a limb that is to be longer; ``carrier`` is -1 where nothing is noted.
    """
    pull[0], pull[1], pull[2], pull[3] = x, y, z, span
    pull[4], pull[5], pull[6], pull[7] = point[0], point[1], point[2], carrier


@kernel
def bent_away(pull, rates, joints, positions):
    """(e . v, e . H(x, x), (J x)^2, |a|) of an error e while joints turn at ``rates`` x (N, 3).

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
def part_of_step(held, count, roles, pulls, way, joints, positions):
    """The part of a step after which its own errors are least to the second order, and what is held stays in place.

    1 at most; what is held may bend away by ``DRIFT``.
    """
    slope = curve = worst = 0.0
    for row in range(count):
        if pulls[row, 7] < 0.0 or (row < held and roles[row] == BOUND):
            continue
        nearer, bent, squared, swerve = bent_away(pulls[row], way, joints, positions)
        if row >= held:
            slope, curve = slope + nearer, curve + squared + bent
        else:
            worst = max(worst, swerve)
    part = 1.0 if worst < 2.0 * DRIFT else math.sqrt(2.0 * DRIFT / worst)
    return min(part, slope / curve) if 0.0 < slope < curve else part
