"""Newton's step in every joint at once, for what a step along the rows' own ways does not finish (METHOD 6).

For levels that have nothing to hold, and leave the root where it is. Where a target is out of reach, every free joint
comes to rest across from what pulls it or at its limit, and a way or two a row nears that rest ever more slowly. Here
half the sum of squared errors, with the second derivatives of what pulls, is brought to its least over all joints that
the rows free: D = 3 N unknowns.

A joint beyond the free part of its limit counts radially in units of the root of what its brake leaves; what pushes it
outwards adds push / room to its stiffness there and push / angle across, which is the curvature of the limit itself
(Coleman and Li 1996), so that a limit is met in a few steps, and left as easily. A weak spring, as strong as the miss,
draws each joint back to the motion: it alone decides about turns that move nothing towards the target. Each step is
damped by the slope that is left, so that it is bold where it is sure (Li, Fukushima, Qi and Yamashita 2004).
"""

import math

from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limits.within_limits import LEAST_DAMPING
from studio.core.kernels.search.joints import FREE_PART, brake

SPRING = 0.01
"""Strength of the spring that draws joints back to the motion, beside the pull of what is missed."""
STIFFENED = 5.0
"""How much stiffer than they are the springs are taken to be: a step that nothing else resists would go all the way."""
FOLDED = 3.0
"""By how much more what pulls a link back is counted than what pulls it on: a chain that is too long for its target
might buckle to any side, and stays on its ridge.
"""
SOFTNESS = 5e-4
"""Metres times radians: how strongly a limit pushes back before it is met, for each metre that is missed."""


@kernel
def refine_step(count, rows, chain, carried, turned, step, damped, positions):
    """Write Newton's step over all joints into ``step`` (N, 3), where nothing but what asks is to be looked at.

    The slope along it of what is brought to its least.

    Records as ``kernels.search.priorities.find_step``, which comes first, leaves them: rows as their brakes have them;
    ``carried`` and ``turned`` those and the state of the search, ``damped`` scratch.

    METHOD (24).
    """
    joints, brakes = chain.joints, rows.brakes
    system, way = damped.system, damped.step
    for i in range(system.shape[0]):
        for j in range(system.shape[1]):
            system[i, j] = 0.0
    note_own(count, rows.owners, chain.mobilities, damped.mobilities)
    missed = add_pulls(count, rows, chain, damped, positions)
    for k in range(joints.shape[0]):
        if brakes[k].part < 1.0:
            brake_system(k, brakes[k].part, brakes[k].axis, system)
    add_asks(count, rows, chain.mobilities, damped)
    draw_back(SPRING * missed, brakes, carried, turned, joints, damped)
    slope = press_on_limits(SOFTNESS * missed, brakes, turned, chain, damped)
    along = solve_damped(slope + LEAST_DAMPING, SPRING * missed, damped)
    for k in range(joints.shape[0]):
        for axis in range(3):
            step[k, axis] = way[3 * k + axis]
        if brakes[k].part < 1.0:
            brake(brakes[k].part, brakes[k].axis, step[k])
    return along


@kernel
def note_own(count, owners, mobilities, out_own):
    """Mobility (D,) of every unknown: the most that any row that asks gives it."""
    for k in range(mobilities.shape[1]):
        most = 0.0
        for row in range(count):
            most = max(most, mobilities[owners[row], k])
        out_own[3 * k] = out_own[3 * k + 1] = out_own[3 * k + 2] = most


@kernel
def add_pulls(count, rows, chain, damped, positions):
    """Second derivatives of all that asks; the root of the sum of squared errors."""
    errors, owners, pulls = rows.errors, rows.owners, rows.pulls
    squared = 0.0
    for q in range(count):
        squared += errors[q] * errors[q]
        pull = pulls[q]
        if pull.carrier < 0.0:
            continue
        strength = pull.weight
        if pull.span != 0.0:
            long = math.sqrt(pull.error[0] ** 2 + pull.error[1] ** 2 + pull.error[2] ** 2)
            strength = math.sqrt(pull.weight) * abs(errors[q]) / max(long, 1e-12)
        add_pull(strength, pull, chain.mobilities[owners[q]], chain.joints, damped, positions)
    return math.sqrt(squared)


@kernel
def add_pull(strength, pull, mobilities, joints, damped, positions):
    """``strength`` times the second derivatives of one pull (``kernels.tasks.second_order``), on joints that may
    answer it.

    METHOD (24).
    """
    system, levers = damped.system, damped.levers
    carrier = pull.carrier
    for k in range(joints.shape[0]):
        acts = mobilities[k] > 0.0 and joints[k].first <= carrier < joints[k].past
        for axis in range(3):
            levers[k, axis] = pull.point[axis] - positions[joints[k].pivot, axis] if acts else 0.0
    x, y, z = strength * pull.error[0], strength * pull.error[1], strength * pull.error[2]
    add_bends(x, y, z, joints, levers, system)
    if pull.span <= 0.0:  # what is to be longer might slide to any side, and is not to
        return
    long = max(math.sqrt(x * x + y * y + z * z), 1e-12)
    x, y, z = x / long, y / long, z / long
    row = damped.step
    for axis in range(3):  # a limb swings about its far end: what its root does across it makes it longer
        px, py, pz = (1.0 if axis == 0 else 0.0), (1.0 if axis == 1 else 0.0), (1.0 if axis == 2 else 0.0)
        along = x if axis == 0 else (y if axis == 1 else z)
        px, py, pz = px - along * x, py - along * y, pz - along * z
        for k in range(joints.shape[0]):
            lx, ly, lz = levers[k, 0], levers[k, 1], levers[k, 2]
            row[3 * k], row[3 * k + 1], row[3 * k + 2] = ly * pz - lz * py, lz * px - lx * pz, lx * py - ly * px
        add_outer(long / pull.span, row, system)


@kernel
def add_bends(x, y, z, joints, levers, system):
    """Add -l . d2p for a force l = (x, y, z) on what joints move with ``levers`` (N, 3) r.

    The link d from a joint to the next turns at W, the sum of what they and all before turn: -l . (W x (W x d)) =
    (l . d) W^2 - (l . W)(d . W). Of a link that is pulled back less and less of what is negative in that is taken.
    """
    for j in range(joints.shape[0]):
        after, least = -1, 1 << 30
        for k in range(joints.shape[0]):
            if joints[j].segment < joints[k].segment < least and is_lever(levers[k]):
                after, least = k, joints[k].segment
        dx, dy, dz = levers[j, 0], levers[j, 1], levers[j, 2]
        if after >= 0:
            dx, dy, dz = dx - levers[after, 0], dy - levers[after, 1], dz - levers[after, 2]
        if not is_lever(levers[j]):
            continue
        along = x * dx + y * dy + z * dz
        if along <= 0.0:
            for a in range(3):
                system[3 * j + a, 3 * j + a] -= FOLDED * along
        size, both, side, sx, sy, sz, tx, ty, tz = link_bend(x, y, z, dx, dy, dz)
        for i in range(joints.shape[0]):
            if not (joints[i].first <= joints[j].segment < joints[i].past and is_lever(levers[i])):
                continue
            for k in range(joints.shape[0]):
                if not (joints[k].first <= joints[j].segment < joints[k].past and is_lever(levers[k])):
                    continue
                for a in range(3):
                    s = both * (sx if a == 0 else (sy if a == 1 else sz))
                    t = side * (tx if a == 0 else (ty if a == 1 else tz))
                    system[3 * i + a, 3 * k] += t * tx - s * sx
                    system[3 * i + a, 3 * k + 1] += t * ty - s * sy
                    system[3 * i + a, 3 * k + 2] += t * tz - s * sz
                    system[3 * i + a, 3 * k + a] += size


@small_kernel
def link_bend(ex, ey, ez, dx, dy, dz):
    """(e . d) 1 - (d e^T + e d^T) / 2 as (k, b, a, s, t) of k 1 - b s s^T + a t t^T.

    At an angle of cosine c it has the values c across both, (c + 1) / 2 along t = d/|d| - e/|e| and (c - 1) / 2 along
    s = d/|d| + e/|e|, times |d||e|. Below c = 0 the first is left out and the last fades.
    """
    e, d = math.sqrt(ex * ex + ey * ey + ez * ez), math.sqrt(dx * dx + dy * dy + dz * dz)
    size, u, v = e * d, 1.0 / max(d, 1e-12), 1.0 / max(e, 1e-12)
    cosine = (ex * dx + ey * dy + ez * dz) * u * v
    on = max(cosine, 0.0)
    both = size * (on + 0.5 * (1.0 - on) * (1.0 + min(cosine, 0.0))) / (2.0 * (1.0 + on))
    side = 0.25 * size * min((1.0 + cosine) / max(1.0 - cosine, 1e-12), 1.0)
    return (
        size * on, both, side,
        dx * u + ex * v, dy * u + ey * v, dz * u + ez * v,
        dx * u - ex * v, dy * u - ey * v, dz * u - ez * v,
    )  # fmt: skip


@kernel
def is_lever(lever):
    """Whether a joint moves anything: one that may not answer has no lever."""
    return lever[0] != 0.0 or lever[1] != 0.0 or lever[2] != 0.0


@kernel
def add_outer(scale, row, system):
    """Add ``scale`` times a row (D,) times itself."""
    size = system.shape[0]
    for i in range(size):
        share = scale * row[i]
        if share != 0.0:
            for j in range(size):
                system[i, j] += share * row[j]


@kernel
def brake_system(k, part, axis, system):
    """Shorten the unknowns of one joint to ``part`` of themselves along its unit ``axis``, on both sides."""
    size = system.shape[0]
    for i in range(size):
        along = (part - 1.0) * (
            axis[0] * system[i, 3 * k] + axis[1] * system[i, 3 * k + 1] + axis[2] * system[i, 3 * k + 2]
        )
        for a in range(3):
            system[i, 3 * k + a] += along * axis[a]
    for j in range(size):
        along = (part - 1.0) * (
            axis[0] * system[3 * k, j] + axis[1] * system[3 * k + 1, j] + axis[2] * system[3 * k + 2, j]
        )
        for a in range(3):
            system[3 * k + a, j] += along * axis[a]


@kernel
def add_asks(count, rows, mobilities, damped):
    """A^T A and A^T e of the rows that ask, on joints that may answer each."""
    jacobian, errors, owners = rows.jacobian, rows.errors, rows.owners
    system, row = damped.system, damped.step
    size = system.shape[0]
    for q in range(count):
        for k in range(jacobian.shape[1]):
            acts = mobilities[owners[q], k] > 0.0
            for axis in range(3):
                row[3 * k + axis] = jacobian[q, k, axis] if acts else 0.0
        add_outer(1.0, row, system)
        for i in range(size):
            system[i, size] += errors[q] * row[i]


@kernel
def draw_back(spring, brakes, carried, turned, joints, damped):
    """The pull of the springs that draw joints to where the motion has them."""
    system, own, force = damped.system, damped.mobilities, damped.levers
    size = system.shape[0]
    for k in range(joints.shape[0]):
        if own[3 * k] == 0.0:
            continue
        turn = carried[joints[k].carrier]
        for axis in range(3):
            x, y, z = turned[k, 0], turned[k, 1], turned[k, 2]
            force[k, axis] = 2.0 * (turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z)
        if brakes[k].part < 1.0:
            brake(brakes[k].part, brakes[k].axis, force[k])
        for axis in range(3):
            system[3 * k + axis, size] -= spring / own[3 * k] * force[k, axis]


@kernel
def press_on_limits(softness, brakes, turned, chain, damped):
    """Let limits press back, and stiffen joints by what presses them on; the size of the slope that is left, in metres.

    A limit pushes with ``softness`` / (radians that are left to it), so that it is met softly.

    METHOD (24).
    """
    limits, system, own = chain.limits, damped.system, damped.mobilities
    size = system.shape[0]
    squared = 0.0
    for k in range(brakes.shape[0]):
        if own[3 * k] == 0.0:
            continue
        x, y, z = system[3 * k, size], system[3 * k + 1, size], system[3 * k + 2, size]
        if brakes[k].part < 1.0:
            ax, ay, az, part = brakes[k].axis[0], brakes[k].axis[1], brakes[k].axis[2], brakes[k].part
            room = 2.0 * (1.0 - FREE_PART) * limits[k]
            back = softness * (1.0 - part * part) / (part * part * room)
            press = max(ax * x + ay * y + az * z, 0.0) / part * (1.0 - brakes[k].part)
            for a in range(3):
                system[3 * k + a, size] -= back * part * brakes[k].axis[a]
            x, y, z = x - press * part * ax, y - press * part * ay, z - press * part * az
            across = press / (2.0 * math.sqrt(turned[k, 0] ** 2 + turned[k, 1] ** 2 + turned[k, 2] ** 2))
            radial = max(press, back) / room - across
            for a in range(3):
                system[3 * k + a, 3 * k + a] += across
                for b in range(3):
                    system[3 * k + a, 3 * k + b] += radial * brakes[k].axis[a] * brakes[k].axis[b]
        squared += own[3 * k] * (x * x + y * y + z * z)
    return math.sqrt(squared)


@kernel
def solve_damped(damping, spring, damped):
    """Solve for the step of the own joints, in units of their mobility, into ``damped.step`` (METHOD (24)); its product
    with the right side.

    Elimination whose pivots stay positive and whose factors stay bounded, whatever the curvature (Gill, Murray and
    Wright 1981, 4.4.2.2).
    """
    system, own, way = damped.system, damped.mobilities, damped.step
    size = system.shape[0]
    bound = 0.0
    for i in range(size):
        root = math.sqrt(own[i])
        for j in range(size):
            system[i, j] *= root * math.sqrt(own[j])
        system[i, size] *= root
        system[i, i] += damping + STIFFENED * spring
        bound = max(bound, abs(system[i, i]))
    for i in range(size):
        most = 0.0
        for j in range(i + 1, size):
            most = max(most, abs(system[i, j]))
        pivot = max(system[i, i], damping, most * most / bound)
        system[i, i] = pivot
        for j in range(i + 1, size):
            factor = system[i, j] / pivot
            if factor != 0.0:
                for column in range(j, size + 1):
                    system[j, column] -= factor * system[i, column]
    for i in range(size - 1, -1, -1):
        value = system[i, size]
        for j in range(i + 1, size):
            value -= system[i, j] * way[j]
        way[i] = value / system[i, i]
    product = 0.0
    for i in range(size):
        product += system[i, size] * system[i, size] / system[i, i]
        way[i] *= math.sqrt(own[i])
    return product
