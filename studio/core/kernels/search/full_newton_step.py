"""Newton step in all joints at once, for residuals that steps along the rows' directions leave (METHOD 9).

It is used for levels without equality rows that leave the root at rest. Where a target is out of reach, every free
joint comes to rest perpendicular to the gradient or at its limit, and steps along one or two directions a row approach
that rest ever more slowly. Here half the sum of squared errors is minimised with its Hessian over all joints that the
rows free: D = 3 N unknowns.

Beyond its soft limit the radial component of a joint's rotation is scaled by the root of its damping. A gradient that
pushes the joint outwards adds push / margin to its radial stiffness and push / angle to its tangential stiffness, which
is the curvature of the limit itself (Coleman and Li 1996), so that a limit is met, and left, in a few steps. A weak
spring, in proportion to the residual, draws each joint back to the motion: it determines rotations that move nothing
towards the target. Each step is damped by the remaining gradient, so that it is long where the problem is
well-conditioned (Li, Fukushima, Qi and Yamashita 2004).
"""

import math

from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.limits.limited_step import LEAST_DAMPING
from studio.core.kernels.search.joints import SOFT_JOINT_LIMIT, scale_along_axis

SPRING_STRENGTH = 0.01
"""Strength of the springs that draw joints to the motion, relative to the residual."""
SPRING_DAMPING = 5.0
"""Factor of the springs' stiffness in the damping: without it, unconstrained components would return to the motion in
one step.
"""
PUSH_CURVATURE = 3.0
"""Factor of the curvature of a link under compression, relative to tension: without it a chain that is too long for its
target could buckle to any side, and stays unbuckled.
"""
LIMIT_BARRIER = 5e-4
"""Strength of the barrier before joint limits, metres times radians, for each metre of residual."""


@kernel
def full_newton_step(count, rows, chain, segment_rotations, state, step, damped, positions):
    """Write the Newton step over all joints into ``step`` (N, 3), for a level without equality rows.

    Returns the directional derivative of half the sum of squared errors along the step. The records are those that
    ``null_space_step`` has filled, with damped rows; ``damped`` is scratch. METHOD (24).
    """
    joints, damping = chain.joints, rows.damping
    system, solution = damped.system, damped.step
    for i in range(system.shape[0]):
        for j in range(system.shape[1]):
            system[i, j] = 0.0
    write_joint_weights(count, rows.weight_rows, chain.weights, damped.weights)
    residual = add_hessian(count, rows, chain, damped, positions)
    for k in range(joints.shape[0]):
        if damping[k].fraction < 1.0:
            damp_system(k, damping[k].fraction, damping[k].axis, system)
    add_normal_equations(count, rows, chain.weights, damped)
    add_spring_gradient(SPRING_STRENGTH * residual, damping, segment_rotations, state, joints, damped)
    slope = add_limit_barrier(LIMIT_BARRIER * residual, damping, state, chain, damped)
    along = solve_damped(slope + LEAST_DAMPING, SPRING_STRENGTH * residual, damped)
    for k in range(joints.shape[0]):
        for axis in range(3):
            step[k, axis] = solution[3 * k + axis]
        if damping[k].fraction < 1.0:
            scale_along_axis(damping[k].fraction, damping[k].axis, step[k])
    return along


@kernel
def write_joint_weights(count, weight_rows, weights, out_own):
    """Write the weight (D,) of every unknown: the greatest weight of its joint over the objective rows."""
    for k in range(weights.shape[1]):
        most = 0.0
        for row in range(count):
            most = max(most, weights[weight_rows[row], k])
        out_own[3 * k] = out_own[3 * k + 1] = out_own[3 * k + 2] = most


@kernel
def add_hessian(count, rows, chain, damped, positions):
    """Add the second derivatives of all objective rows to the system; returns the root of the sum of squared errors."""
    errors, weight_rows, point_errors = rows.errors, rows.weight_rows, rows.point_errors
    squared = 0.0
    for q in range(count):
        squared += errors[q] * errors[q]
        point_error = point_errors[q]
        if point_error.segment < 0.0:
            continue
        strength = point_error.weight
        if point_error.span != 0.0:
            long = math.sqrt(point_error.error[0] ** 2 + point_error.error[1] ** 2 + point_error.error[2] ** 2)
            strength = math.sqrt(point_error.weight) * abs(errors[q]) / max(long, 1e-12)
        add_task_hessian(strength, point_error, chain.weights[weight_rows[q]], chain.joints, damped, positions)
    return math.sqrt(squared)


@kernel
def add_task_hessian(strength, point_error, weights, joints, damped, positions):
    """Add ``strength`` times the second derivatives of one ``POINT_ERROR`` by the joints' rotations to the system.
    METHOD (24).
    """
    system, levers = damped.system, damped.lever_arms
    segment = point_error.segment
    for k in range(joints.shape[0]):
        acts = weights[k] > 0.0 and joints[k].first <= segment < joints[k].past
        for axis in range(3):
            levers[k, axis] = point_error.point[axis] - positions[joints[k].pivot, axis] if acts else 0.0
    x, y, z = strength * point_error.error[0], strength * point_error.error[1], strength * point_error.error[2]
    add_link_hessians(x, y, z, joints, levers, system)
    if point_error.span <= 0.0:  # what is to be longer might slide to any side, and is not to
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
        add_outer_product(long / point_error.span, row, system)


@kernel
def add_link_hessians(x, y, z, joints, levers, system):
    """Add the Hessian -l . d2p of a force l = (x, y, z) on a point p that joints move with ``levers`` (N, 3).

    The link d from a joint to the next rotates at W, the sum of its own and all earlier rates: -l . (W x (W x d)) = (l
    . d) W^2 - (l . W)(d . W). The negative part of a link under compression fades.
    """
    for j in range(joints.shape[0]):
        after, least = -1, 1 << 30
        for k in range(joints.shape[0]):
            if joints[j].segment < joints[k].segment < least and has_lever(levers[k]):
                after, least = k, joints[k].segment
        dx, dy, dz = levers[j, 0], levers[j, 1], levers[j, 2]
        if after >= 0:
            dx, dy, dz = dx - levers[after, 0], dy - levers[after, 1], dz - levers[after, 2]
        if not has_lever(levers[j]):
            continue
        along = x * dx + y * dy + z * dz
        if along <= 0.0:
            for a in range(3):
                system[3 * j + a, 3 * j + a] -= PUSH_CURVATURE * along
        size, both, side, sx, sy, sz, tx, ty, tz = positive_link_hessian(x, y, z, dx, dy, dz)
        for i in range(joints.shape[0]):
            if not (joints[i].first <= joints[j].segment < joints[i].past and has_lever(levers[i])):
                continue
            for k in range(joints.shape[0]):
                if not (joints[k].first <= joints[j].segment < joints[k].past and has_lever(levers[k])):
                    continue
                for a in range(3):
                    s = both * (sx if a == 0 else (sy if a == 1 else sz))
                    t = side * (tx if a == 0 else (ty if a == 1 else tz))
                    system[3 * i + a, 3 * k] += t * tx - s * sx
                    system[3 * i + a, 3 * k + 1] += t * ty - s * sy
                    system[3 * i + a, 3 * k + 2] += t * tz - s * sz
                    system[3 * i + a, 3 * k + a] += size


@small_kernel
def positive_link_hessian(ex, ey, ez, dx, dy, dz):
    """Positive part of a link's Hessian (e . d) 1 - (d e^T + e d^T) / 2, as the coefficients (k, b, a, s, t) of k 1 - b
    s s^T + a t t^T.

    At an angle of cosine c it has the eigenvalues c across both, (c + 1) / 2 along t = d/|d| - e/|e| and (c - 1) / 2
    along s = d/|d| + e/|e|, times |d||e|. Below c = 0 the first is dropped and the last fades.
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
def has_lever(lever):
    """True if a joint moves the point: a joint without weight has no lever."""
    return lever[0] != 0.0 or lever[1] != 0.0 or lever[2] != 0.0


@kernel
def add_outer_product(scale, row, system):
    """Add ``scale`` times the outer product of ``row`` (D,) with itself to the system."""
    size = system.shape[0]
    for i in range(size):
        fraction = scale * row[i]
        if fraction != 0.0:
            for j in range(size):
                system[i, j] += fraction * row[j]


@kernel
def damp_system(k, fraction, axis, system):
    """Scale the unknowns of joint ``k`` by ``fraction`` along the unit ``axis``, in the rows and columns of the
    system.
    """
    size = system.shape[0]
    for i in range(size):
        along = (fraction - 1.0) * (
            axis[0] * system[i, 3 * k] + axis[1] * system[i, 3 * k + 1] + axis[2] * system[i, 3 * k + 2]
        )
        for a in range(3):
            system[i, 3 * k + a] += along * axis[a]
    for j in range(size):
        along = (fraction - 1.0) * (
            axis[0] * system[3 * k, j] + axis[1] * system[3 * k + 1, j] + axis[2] * system[3 * k + 2, j]
        )
        for a in range(3):
            system[3 * k + a, j] += along * axis[a]


@kernel
def add_normal_equations(count, rows, weights, damped):
    """Add A^T A and A^T e of the objective rows to the system, over the joints with weight."""
    jacobian, errors, weight_rows = rows.jacobian, rows.errors, rows.weight_rows
    system, row = damped.system, damped.step
    size = system.shape[0]
    for q in range(count):
        for k in range(jacobian.shape[1]):
            acts = weights[weight_rows[q], k] > 0.0
            for axis in range(3):
                row[3 * k + axis] = jacobian[q, k, axis] if acts else 0.0
        add_outer_product(1.0, row, system)
        for i in range(size):
            system[i, size] += errors[q] * row[i]


@kernel
def add_spring_gradient(spring, damping, segment_rotations, state, joints, damped):
    """Add the gradient of the springs that draw joints back to the motion to the right side of the system."""
    system, own, force = damped.system, damped.weights, damped.lever_arms
    size = system.shape[0]
    for k in range(joints.shape[0]):
        if own[3 * k] == 0.0:
            continue
        rotation = segment_rotations[joints[k].parent]
        for axis in range(3):
            x, y, z = state[k, 0], state[k, 1], state[k, 2]
            force[k, axis] = 2.0 * (rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2] * z)
        if damping[k].fraction < 1.0:
            scale_along_axis(damping[k].fraction, damping[k].axis, force[k])
        for axis in range(3):
            system[3 * k + axis, size] -= spring / own[3 * k] * force[k, axis]


@kernel
def add_limit_barrier(softness, damping, state, chain, damped):
    """Add the barrier of joint limits, and the stiffness of joints pressed against them, to the system.

    Returns the length of the remaining gradient in metres. The barrier is ``softness`` / (radians left to the limit),
    so that limits are met softly. METHOD (24).
    """
    limits, system, own = chain.limits, damped.system, damped.weights
    size = system.shape[0]
    squared = 0.0
    for k in range(damping.shape[0]):
        if own[3 * k] == 0.0:
            continue
        x, y, z = system[3 * k, size], system[3 * k + 1, size], system[3 * k + 2, size]
        if damping[k].fraction < 1.0:
            ax, ay, az, fraction = damping[k].axis[0], damping[k].axis[1], damping[k].axis[2], damping[k].fraction
            margin = 2.0 * (1.0 - SOFT_JOINT_LIMIT) * limits[k]
            back = softness * (1.0 - fraction * fraction) / (fraction * fraction * margin)
            press = max(ax * x + ay * y + az * z, 0.0) / fraction * (1.0 - damping[k].fraction)
            for a in range(3):
                system[3 * k + a, size] -= back * fraction * damping[k].axis[a]
            x, y, z = x - press * fraction * ax, y - press * fraction * ay, z - press * fraction * az
            across = press / (2.0 * math.sqrt(state[k, 0] ** 2 + state[k, 1] ** 2 + state[k, 2] ** 2))
            radial = max(press, back) / margin - across
            for a in range(3):
                system[3 * k + a, 3 * k + a] += across
                for b in range(3):
                    system[3 * k + a, 3 * k + b] += radial * damping[k].axis[a] * damping[k].axis[b]
        squared += own[3 * k] * (x * x + y * y + z * z)
    return math.sqrt(squared)


@kernel
def solve_damped(damping, spring, damped):
    """Solve the damped system for the step, into ``damped.step`` (METHOD (24)); returns the product of the step and the
    right side.

    Modified Cholesky elimination: pivots stay positive and factors bounded, whatever the curvature (Gill, Murray and
    Wright 1981, 4.4.2.2).
    """
    system, own, solution = damped.system, damped.weights, damped.step
    size = system.shape[0]
    bound = 0.0
    for i in range(size):
        root = math.sqrt(own[i])
        for j in range(size):
            system[i, j] *= root * math.sqrt(own[j])
        system[i, size] *= root
        system[i, i] += damping + SPRING_DAMPING * spring
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
            value -= system[i, j] * solution[j]
        solution[i] = value / system[i, i]
    product = 0.0
    for i in range(size):
        product += system[i, size] * system[i, size] / system[i, i]
        solution[i] *= math.sqrt(own[i])
    return product
