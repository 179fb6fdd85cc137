"""Displacement that a chain's joints can reach, and targets moved to within it (METHOD (32)).

For a target out of reach, joints at their limits would whirl about from one frame to the next.
"""

import math

from studio.core.kernels.body_indices import HIP_POINT, POINTS_BESIDE_SPINE, POINTS_PER_LIMB
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limbs.limb import soft_extension
from studio.core.kernels.limits.root_reach_limit import root_reach_of
from studio.core.kernels.search.joints import ROOT_TRANSLATION, SOFT_JOINT_LIMIT
from studio.core.kernels.tasks.goals import interpolate_point

ROOT_DETOUR = 0.25
"""Distance in metres that a root may move sideways around the limit of a stretched leg."""
REACHABLE_SOFTNESS = 0.02
"""Least range in metres over which a displacement saturates: a chain that contributes a few millimetres must not do so
suddenly.
"""


@kernel
def reachable_distance(c, x, y, z, point, segment, problem):
    """Displacement in metres along the unit (x, y, z) that all joints of task ``c`` together can give ``point`` (3,) of
    ``segment``; inf with a free root.

    A joint that sees the point at an angle a from the direction, and rotates by b at most, displaces it by r (cos(a -
    b) - cos a). Where the direction points at the joint, the contribution fades like sin^2 a, because any axis would
    do; several joints together contribute more.
    """
    chain, body, pose = problem.chain, problem.body, problem.start
    weights, joints, limits = chain.weights, chain.joints, chain.limits
    total = 0.0
    for k in range(joints.shape[0]):
        if weights[c, k] <= 0.0:
            continue
        if joints[k].segment == ROOT_TRANSLATION:
            total += root_travel(x, y, z, body, pose)
        elif joints[k].first <= segment < joints[k].past:
            origin = pose.positions[joints[k].pivot]
            rx, ry, rz = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
            long = max(math.sqrt(rx * rx + ry * ry + rz * rz), 1e-9)
            cosine, most = min(max((rx * x + ry * y + rz * z) / long, -1.0), 1.0), 2.0 * math.atan(limits[k])
            brought = math.cos(max(math.acos(cosine) - most, 0.0)) - cosine
            total += long * (1.25 - 0.25 * cosine) * min(brought, 2.0 * most * (1.0 - cosine * cosine))
    return total


@kernel
def has_single_joint(c, segment, chain):
    """True if exactly one joint of task ``c`` moves ``segment``, and not the root."""
    weights, joints, found = chain.weights, chain.joints, 0
    for k in range(joints.shape[0]):
        if weights[c, k] > 0.0 and (
            joints[k].segment == ROOT_TRANSLATION or joints[k].first <= segment < joints[k].past
        ):
            found += 2 if joints[k].segment == ROOT_TRANSLATION else 1
    return found == 1


@kernel
def root_travel(x, y, z, body, pose):
    """Approximate distance in metres by which the root can move along the unit (x, y, z) before a planted foot is out
    of reach.
    """
    ankles, total = body.legs.ankles, 0.0
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    for side in range(2):
        if body.root_reaches[side] == math.inf:
            continue
        hip, ankle = pose.positions[spine_count + HIP_POINT + POINTS_PER_LIMB * side], ankles[side]
        length, _ = root_reach_of(side, body, pose)
        hx, hy, hz = hip[0] - ankle[0], hip[1] - ankle[1], hip[2] - ankle[2]
        along = hx * x + hy * y + hz * z
        over = length * length - hx * hx - hy * hy - hz * hz
        straight = max(math.sqrt(max(along * along + over, 0.0)) - along, 0.0)
        total += 1.0 / (straight * straight + ROOT_DETOUR * ROOT_DETOUR) ** 2
    return 1.0 / math.sqrt(math.sqrt(total)) if total > 0.0 else math.inf


@kernel
def soft_reachable_distance(distance_to_go, reachable):
    """Part of ``distance_to_go`` that is requested of joints that can reach ``reachable``: softly no more than that
    (METHOD (32)).
    """
    if reachable == math.inf or distance_to_go <= SOFT_JOINT_LIMIT * reachable:
        return distance_to_go
    if reachable <= 1e-6:
        return 0.0
    return reachable * soft_extension(
        distance_to_go / max(reachable, REACHABLE_SOFTNESS),
        SOFT_JOINT_LIMIT * max(1.0 - REACHABLE_SOFTNESS / reachable, 0.0),
    )


@kernel
def update_unreachable_fraction(c, row, problem):
    """Write into ``slack`` of a task the fraction of the way from its first point to the goal that is not requested of
    the joints.

    The way begins at the point's unsolved position.
    """
    position, point = row.goal_positions[0], row.start_position
    x, y, z = position[0] - point[0], position[1] - point[1], position[2] - point[2]
    distance_to_go = math.sqrt(x * x + y * y + z * z)
    row.slack[0] = 0.0
    if distance_to_go > 1e-9:
        reachable = reachable_distance(
            c, x / distance_to_go, y / distance_to_go, z / distance_to_go, point, row.segments[0], problem
        )
        row.slack[0] = 1.0 - soft_reachable_distance(distance_to_go, reachable) / distance_to_go


@kernel
def reachable_target(row):
    """Target position (x, y, z) of a task's first point, moved to within the reach of the joints."""
    return interpolate_point(row.goal_positions[0], row.start_position, row.slack[0])
