"""How far the joints of a chain can bring a point, and places on the way to those that are farther (METHOD (32)).

Where a place is out of reach, joints at their limits would whirl about for it from one frame to the next.
"""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb import soft_reach
from studio.core.kernels.limits.root_reach import root_reach_of
from studio.core.kernels.search.joints import FREE_PART, ROOT
from studio.core.kernels.tasks.goals import ease_goal

AROUND = 0.25
"""Metres that a root may go round what a leg that is stretched allows it."""
SPREAD = 0.02
"""Metres of what is asked over which at least that is brought: what brings a few millimetres must not be done at once.
"""


@kernel
def reachable_way(c, x, y, z, point, carrier, problem):
    """Metres by which all joints of constraint ``c`` together bring a ``point`` (3,) of segment ``carrier`` along the
    unit (x, y, z); inf where the root goes free.

    One that sees the point at an angle a from the way, and turns by b at most, brings it r (cos(a - b) - cos a). Where
    the way leads to the joint any axis would do; there it fades like sin^2 a, and what several do together is more.
    """
    chain, body, pose = problem.chain, problem.body, problem.start
    mobilities, joints, limits = chain.mobilities, chain.joints, chain.limits
    total = 0.0
    for k in range(joints.shape[0]):
        if mobilities[c, k] <= 0.0:
            continue
        if joints[k].segment == ROOT:
            total += travel_of(x, y, z, body, pose)
        elif joints[k].first <= carrier < joints[k].past:
            origin = pose.positions[joints[k].pivot]
            rx, ry, rz = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
            long = max(math.sqrt(rx * rx + ry * ry + rz * rz), 1e-9)
            cosine, most = min(max((rx * x + ry * y + rz * z) / long, -1.0), 1.0), 2.0 * math.atan(limits[k])
            brought = math.cos(max(math.acos(cosine) - most, 0.0)) - cosine
            total += long * (1.25 - 0.25 * cosine) * min(brought, 2.0 * most * (1.0 - cosine * cosine))
    return total


@kernel
def is_alone(c, carrier, chain):
    """Whether but one joint of constraint ``c`` moves the segment ``carrier``, and not the root."""
    mobilities, joints, found = chain.mobilities, chain.joints, 0
    for k in range(joints.shape[0]):
        if mobilities[c, k] > 0.0 and (joints[k].segment == ROOT or joints[k].first <= carrier < joints[k].past):
            found += 2 if joints[k].segment == ROOT else 1
    return found == 1


@kernel
def travel_of(x, y, z, body, pose):
    """About how far, in metres, the root can go along the unit (x, y, z) as far as its legs let it."""
    ankles, total = body.legs.ankles, 0.0
    spine_count = pose.positions.shape[0] - 23
    for side in range(2):
        if body.root_reaches[side] == math.inf:
            continue
        hip, ankle = pose.positions[spine_count + 13 + 5 * side], ankles[side]
        length, _ = root_reach_of(side, body, pose)
        hx, hy, hz = hip[0] - ankle[0], hip[1] - ankle[1], hip[2] - ankle[2]
        along = hx * x + hy * y + hz * z
        over = length * length - hx * hx - hy * hy - hz * hz
        straight = max(math.sqrt(max(along * along + over, 0.0)) - along, 0.0)
        total += 1.0 / (straight * straight + AROUND * AROUND) ** 2
    return 1.0 / math.sqrt(math.sqrt(total)) if total > 0.0 else math.inf


@kernel
def soft_way(way, able):
    """How much of a ``way`` is asked of joints that are ``able`` to go so far: softly no more (METHOD (32))."""
    if able == math.inf or way <= FREE_PART * able:
        return way
    if able <= 1e-6:
        return 0.0
    return able * soft_reach(way / max(able, SPREAD), FREE_PART * max(1.0 - SPREAD / able, 0.0))


@kernel
def note_reachable(c, row, problem):
    """Note in ``slack`` what of the way from ``begin``, its first point in the unsolved ``pose``, is not asked."""
    place, point = row.places[0], row.begin
    x, y, z = place[0] - point[0], place[1] - point[1], place[2] - point[2]
    way = math.sqrt(x * x + y * y + z * z)
    row.slack[0] = 0.0
    if way > 1e-9:
        able = reachable_way(c, x / way, y / way, z / way, point, row.segments[0], problem)
        row.slack[0] = 1.0 - soft_way(way, able) / way


@kernel
def reachable_place(row):
    """The place (x, y, z) on the way from ``begin`` to that of its first point that is asked of the joints."""
    return ease_goal(row.places[0], row.begin, row.slack[0])
