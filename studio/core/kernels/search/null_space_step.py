"""Strictly prioritised step of all joints: each level is solved in the null space of the levels above it.

A row is a direction in which a point (or the centre of mass, or a rotation) has to move, and an error; J_rk is its
derivative by joint k, w_rk the weight of that joint in the task's chain, and M_qr = sum_k w_rk J_qk . J_rk. Equality
rows, of higher levels, come first: y_h = M_hh^-1 e_h keeps them. An objective row moves joints along its null-space
projected direction x_r = w_r J_r less the part that equality rows take back, so that to first order no held row
changes. Along these directions a Newton step on half the sum of squared errors is taken: (A^T A + H) y = A^T e with
A_qr = J_q . x_r and H_qr = sum_c e_c . d2(x_q, x_r), the second-order terms (``second_order.add_row_hessian``). The
Gauss-Newton step, without H, swings where a target is out of reach; and one damping for all directions is too much for
some of them and too little for others (METHOD (23)).

Inequality rows, such as the root's reach of planted feet, are inactive while the step keeps them. The most violated one
is activated first, then those that the step violates now; one with a multiplier of the wrong sign is removed.
"""

import math

import numpy as np

from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel, small_kernel, summing_kernel
from studio.core.kernels.limits.root_reach_limit import limit_root_step
from studio.core.kernels.search.joints import ROOT_TRANSLATION, SOFT_JOINT_LIMIT, scale_along_axis
from studio.core.kernels.tasks.second_order import INEQUALITY_ROW, add_row_hessian

MAX_ROW_ERROR = 0.3
"""Greatest error of a row in one step, in metres or radians; greater ones are clamped."""
MAX_STEP_DISPLACEMENT = 0.25
"""Greatest displacement of a step in metres; a radian counts as half a metre."""
SINGULAR_PIVOT_FRACTION = 3e-4
"""Fraction of an equality row's pivot that remains after elimination, below which the row counts as dependent on the
rows before it.
"""
DEPENDENT_PIVOT_FRACTION = 0.2
"""Fraction of an objective row's pivot that remains after elimination, below which the row counts as dependent, while
errors are large.
"""
HALF_DAMPING_ERROR = 0.05
"""Error in metres at which the damping is halved: Newton steps near the goal are not damped."""
ACTIVE_SET_ITERATIONS = 4
"""Greatest number of changes of the active set."""
LIMIT_CURVATURE = 0.5
"""Factor of the curvature of joint limits in the objective."""
STATE_ROUNDING = 1.5 * 2.0**18
"""Constant whose addition and subtraction round a number to multiples of 2^-34, 6e-11 radians or metres."""
LIMIT_APPROACH, LIMIT_MARGIN = 0.3, 3e-5
"""Least fraction of the margin to its limit that a step leaves to a joint, and least fraction of the limit that always
remains.
"""


@kernel
def null_space_step(equality_count, count, damping, rows, chain, equations, positions):
    """Write two steps (N, 3): that which keeps the equality rows, and that of the objective rows in the equalities'
    null space.

    They become the last but one and the last of ``equations.directions``. Of the ``count`` rows the first
    ``equality_count`` are held. ``damping`` is the fraction of the regular damping. Returns the derivative of half the
    sum of squared errors along the objective step. Records are those of ``kernels.records``.
    """
    active, flat, roles = equations.active, equations.flat, rows.roles
    damp_jacobian(count, rows.jacobian, rows.damping)
    multiply_rows(count, flat.jacobian, rows.weight_rows, chain.weights, flat.weighted, equations.gram)
    for i in range(count):
        active[i] = roles[i] != INEQUALITY_ROW
    slope = 0.0
    for _ in range(ACTIVE_SET_ITERATIONS):
        slope = solve_active_set(equality_count, count, damping, rows, chain, equations, positions)
        if not deactivate_bound(equality_count, roles, equations) and not add_violated_bound(
            equality_count, count, rows.errors, rows.margins, equations
        ):
            break
    return slope


@summing_kernel
def multiply_rows(count, jacobian, weight_rows, joint_weights, weighted, gram):
    """Write rows (R, 3 N) times joint weights into ``weighted``, and the Gram matrix (R, R) of elements J_q . w_r J_r
    into ``gram``.

    w_r are the joint weights of row r.
    """
    for i in range(count):
        weights, row, out_row = joint_weights[weight_rows[i]], jacobian[i], weighted[i]
        for k in range(weights.shape[0]):
            x, y, z = np.uint64(3 * k), np.uint64(3 * k + 1), np.uint64(3 * k + 2)
            out_row[x], out_row[y], out_row[z] = weights[k] * row[x], weights[k] * row[y], weights[k] * row[z]
        j = 0
        while j < i and weight_rows[j] == weight_rows[i]:
            gram[j, i] = gram[i, j]
            j += 1
        while j + 1 < count:
            here, there = jacobian[j], jacobian[j + 1]
            one = two = 0.0
            for number in range(out_row.shape[0]):
                one += here[number] * out_row[number]
                two += there[number] * out_row[number]
            gram[j, i], gram[j + 1, i] = one, two
            j += 2
        if j < count:
            here, one = jacobian[j], 0.0
            for number in range(out_row.shape[0]):
                one += here[number] * out_row[number]
            gram[j, i] = one


@kernel
def damp_jacobian(count, jacobian, damping):
    """Multiply the columns of the Jacobian by the root of the joints' damping near their limits; the step is multiplied
    by it again.
    """
    for k in range(damping.shape[0]):
        if damping[k].fraction < 1.0:
            for row in range(count):
                scale_along_axis(damping[k].fraction, damping[k].axis, jacobian[row, k])


@kernel
def solve_active_set(equality_count, count, damping, rows, chain, equations, positions):
    """Solve both steps with the present active set of inequalities; returns the directional derivative along the
    objective step.
    """
    errors, brakes = rows.errors, rows.damping
    system, active, coefficients, directions = (
        equations.equalities,
        equations.active,
        equations.coefficients,
        equations.directions,
    )
    weighted, flat = equations.flat.weighted, equations.flat.directions
    last = directions.shape[0] - 1
    active_count = solve_equalities(equality_count, count, errors, equations)
    for j in range(equality_count, count):
        project_direction(equality_count, j, active_count, system, active, weighted, flat)
        damp_direction(brakes, directions[j])
    slope = solve_objective(equality_count, count, active_count, damping, rows, chain, equations, positions)
    for number in range(flat.shape[1]):
        flat[last, number] = flat[last - 1, number] = 0.0
    for j in range(equality_count, count):
        coefficient = coefficients[j]
        for number in range(flat.shape[1]):
            flat[last, number] += coefficient * flat[j, number]
    rank = 0
    for i in range(equality_count):
        coefficients[i] = 0.0
        if active[i]:
            coefficient = system[rank, active_count]
            for number in range(flat.shape[1]):
                flat[last - 1, number] += coefficient * weighted[i, number]
            coefficients[i] = coefficient
            for j in range(equality_count, count):
                coefficients[i] -= system[rank, active_count + 1 + j - equality_count] * coefficients[j]
            rank += 1
    damp_direction(brakes, directions[last - 1])
    return slope


@small_kernel
def damp_direction(damping, direction):
    """Scale a direction (N, 3) by the root of the joints' damping, in place."""
    for k in range(damping.shape[0]):
        if damping[k].fraction < 1.0:
            scale_along_axis(damping[k].fraction, damping[k].axis, direction[k])


@kernel
def solve_equalities(equality_count, count, errors, equations):
    """Solve the active equality rows h, for their errors and for the objective rows a; returns the number of active
    rows.

    ``equations.equalities`` becomes M_hh^-1 [e_h | M_ha]. METHOD (21).
    """
    gram, system, active = equations.gram, equations.equalities, equations.active
    active_count = 0
    for i in range(equality_count):
        if not active[i]:
            continue
        column = 0
        for j in range(equality_count):
            if active[j]:
                system[active_count, column] = gram[i, j]
                column += 1
        system[active_count, column] = min(max(errors[i], -MAX_ROW_ERROR), MAX_ROW_ERROR)
        for j in range(equality_count, count):
            system[active_count, column + 1 + j - equality_count] = gram[i, j]
        active_count += 1
    columns, rank = active_count + 1 + count - equality_count, 0
    for i in range(equality_count):
        if active[i]:
            system[rank, columns] = gram[i, i]
            rank += 1
    eliminate(system, active_count, columns)
    return active_count


@kernel
def eliminate(system, count, columns):
    """Solve the symmetric ``system`` (n, columns + 1) in place for all right sides, by elimination in order of
    priority.

    The last column has the pivots before elimination. Entries below the diagonal are not read.
    """
    for i in range(count):
        pivot, floor = system[i, i], SINGULAR_PIVOT_FRACTION * system[i, columns]
        inverse = pivot / (pivot * pivot + floor * floor + 1e-24)
        system[i, i] = inverse
        for j in range(i + 1, count):
            factor = system[i, j] * inverse
            if factor != 0.0:
                subtract_multiple(factor, system[i], j, columns, system[j])
    for i in range(count - 1, -1, -1):
        for column in range(count, columns):
            system[i, column] *= system[i, i]
        for j in range(i):
            subtract_multiple(system[j, i], system[i], count, columns, system[j])


@small_kernel
def subtract_multiple(factor, numbers, first, past, out_numbers):
    """Subtract ``factor`` times ``numbers`` from ``out_numbers``, at indices ``first`` to ``past``; unsigned indices
    vectorise.
    """
    for rank in range(np.uint64(first), np.uint64(past)):
        out_numbers[rank] -= factor * numbers[rank]


@kernel
def project_direction(equality_count, j, active_count, system, active, weighted, flat):
    """Write the null-space projected direction (3 N) of objective row ``j``. METHOD (22)."""
    for number in range(flat.shape[1]):
        flat[j, number] = weighted[j, number]
    rank = 0
    for i in range(equality_count):
        if active[i]:
            coefficient = system[rank, active_count + 1 + j - equality_count]
            for number in range(flat.shape[1]):
                flat[j, number] -= coefficient * weighted[i, number]
            rank += 1


@kernel
def solve_objective(equality_count, count, active_count, damping, rows, chain, equations, positions):
    """Write the coefficients of the Newton step along the projected objective rows into ``coefficients`` (METHOD (23)).

    Returns the derivative of half the sum of squared errors along the step.
    """
    errors, joints, limits = rows.errors, chain.joints, chain.limits
    gram, system, normal, active = equations.gram, equations.equalities, equations.normal, equations.active
    coefficients, scratch = equations.coefficients, equations.scratch
    own = count - equality_count
    worst = 1e-9
    for i in range(own):
        coefficients[equality_count + i] = min(max(errors[equality_count + i], -MAX_ROW_ERROR), MAX_ROW_ERROR)
        worst = max(worst, abs(coefficients[equality_count + i]))
        for j in range(own):
            scratch[i, j] = gram[equality_count + i, equality_count + j]
        rank = 0
        for h in range(equality_count):
            if active[h]:
                lever = gram[equality_count + i, h]
                coefficients[equality_count + i] -= lever * system[rank, active_count]
                for j in range(own):
                    scratch[i, j] -= lever * system[rank, active_count + 1 + j]
                rank += 1
    for i in range(own):
        normal[i, own] = 0.0
        for q in range(own):
            normal[i, own] += scratch[q, i] * coefficients[equality_count + q]
        for j in range(own):
            along = 0.0
            for q in range(own):
                along += scratch[q, i] * scratch[q, j]
            normal[i, j] = along
    add_second_order_terms(equality_count, count, active_count, rows, joints, equations, positions)
    far_off = worst / (worst + HALF_DAMPING_ERROR)
    add_limit_curvature(far_off, equality_count, count, rows, limits, equations.directions, normal)
    return solve_positive(normal, own, gram, damping * far_off, coefficients, equality_count)


@kernel
def add_limit_curvature(far_off, equality_count, count, rows, limits, directions, normal):
    """Add the curvature, multiplier / remaining angle, of limits that joints are pressed against to the normal
    equations (METHOD (24)).

    Far from the goal it prevents steps from oscillating along the limit; near the goal it is left out.
    """
    jacobian, errors, damping = rows.jacobian, rows.errors, rows.damping
    for k in range(damping.shape[0]):
        if damping[k].fraction >= 1.0:
            continue
        x, y, z, root = damping[k].axis[0], damping[k].axis[1], damping[k].axis[2], damping[k].fraction
        push = 0.0
        for q in range(equality_count, count):
            clamped_error = min(max(errors[q], -MAX_ROW_ERROR), MAX_ROW_ERROR)
            push += clamped_error * (x * jacobian[q, k, 0] + y * jacobian[q, k, 1] + z * jacobian[q, k, 2])
        if push <= 0.0:
            continue
        across = far_off * LIMIT_CURVATURE * push * (1.0 - root * root) / (max(root, 1e-6) * 2.0 * limits[k])
        for i in range(equality_count, count):
            direction = directions[i, k]
            along = x * direction[0] + y * direction[1] + z * direction[2]
            ax, ay, az = direction[0] - along * x, direction[1] - along * y, direction[2] - along * z
            for j in range(equality_count, count):
                normal[i - equality_count, j - equality_count] += across * (
                    ax * directions[j, k, 0] + ay * directions[j, k, 1] + az * directions[j, k, 2]
                )


@kernel
def add_second_order_terms(equality_count, count, active_count, rows, joints, equations, positions):
    """Add the positive second-order terms H of errors and of active inequalities to the normal equations.

    The multiplier of an inequality is mu = -M_hh^-1 M_ha e. Negative terms are left out, so that the equations stay
    positive. METHOD (23).
    """
    errors, roles, point_errors = rows.errors, rows.roles, rows.point_errors
    system, active = equations.equalities, equations.active
    rank = 0
    for q in range(count):
        push = 1.0
        if q < equality_count:
            if not active[q]:
                continue
            rank += 1
            if roles[q] != INEQUALITY_ROW:
                continue
            push = 0.0
            for j in range(equality_count, count):
                push -= system[rank - 1, active_count + 1 + j - equality_count] * min(
                    max(errors[j], -MAX_ROW_ERROR), MAX_ROW_ERROR
                )
        if push > 0.0 and point_errors[q].segment >= 0.0:
            add_row_hessian(push, point_errors[q], equality_count, count, joints, equations, positions)


@kernel
def solve_positive(normal, count, gram, damping, coefficients, first):
    """Solve the symmetric system (n, n + 1) by elimination into ``coefficients[first:]``; returns the product of
    solution and right side.

    Pivots are bounded below by those of dependent rows, and factors are bounded whatever the curvature (Gill, Murray
    and Wright 1981, 4.4.2.2).
    """
    bound = 1e-15
    for i in range(count):
        bound = max(bound, normal[i, i])
    for i in range(count):
        most = 0.0
        for j in range(i + 1, count):
            most = max(most, abs(normal[j, i]))
        floor = DEPENDENT_PIVOT_FRACTION * gram[first + i, first + i]
        pivot = max(normal[i, i], most * most / bound) + damping * floor * floor + 1e-15
        normal[i, i] = pivot
        for j in range(i + 1, count):
            factor = normal[j, i] / pivot
            if factor != 0.0:
                subtract_multiple(factor, normal[i], i + 1, count + 1, normal[j])
    for i in range(count - 1, -1, -1):
        value = normal[i, count]
        for j in range(i + 1, count):
            value -= normal[i, j] * coefficients[first + j]
        coefficients[first + i] = value / normal[i, i]
    product = 0.0
    for i in range(count):
        product += normal[i, count] * normal[i, count] / normal[i, i]
    return product


@kernel
def add_violated_bound(equality_count, count, errors, margins, equations):
    """Activate the inequality that the step violates most; True if any is violated.

    An inequality with a margin is soft: it decelerates over the margin, so that nothing stops from one frame to the
    next.
    """
    gram, active, coefficients = equations.gram, equations.active, equations.coefficients
    caught, most, braking = -1, 1e-9, 0.0
    for i in range(equality_count):
        if active[i]:
            continue
        after, margin = errors[i], min(margins[i], max(-errors[i], 0.0))
        for j in range(count):
            after -= gram[i, j] * coefficients[j]
        if after + margin > most:
            caught, most, braking = i, after + margin, margin
    if caught < 0:
        return False
    active[caught] = True
    if braking > 0.0:
        errors[caught] += braking * math.exp(-most / braking)
        margins[caught] = 0.0
    return True


@kernel
def deactivate_bound(equality_count, roles, equations):
    """Remove the inequality with the most negative multiplier from the active set; True if any is negative."""
    active, coefficients = equations.active, equations.coefficients
    found, least = -1, 0.0
    for i in range(equality_count):
        if active[i] and roles[i] == INEQUALITY_ROW and coefficients[i] < least:
            found, least = i, coefficients[i]
    if found >= 0:
        active[found] = False
    return found >= 0


@kernel
def longest_displacement(joints, direction):
    """Greatest displacement in metres of a step (N, 3); a radian counts as half a metre."""
    longest = 0.0
    for k in range(joints.shape[0]):
        squared = direction[k, 0] ** 2 + direction[k, 1] ** 2 + direction[k, 2] ** 2
        longest = max(longest, squared if joints[k].segment == ROOT_TRANSLATION else 0.25 * squared)
    return math.sqrt(longest)


@kernel
def apply_step(least, step_scale, fraction, problem):
    """Apply the equality step and ``fraction`` of the objective step, within the reach of planted feet; returns the
    displacement in metres.

    ``step_scale`` scales both steps. Nothing moves if the displacement would be ``least`` or less.
    """
    chain, search, directions = problem.chain, problem.search, problem.search.equations.directions
    joint_of_segment, direction = chain.joint_of_segment, directions[directions.shape[0] - 1]
    for k in range(direction.shape[0]):
        for axis in range(3):
            direction[k, axis] = step_scale * (
                directions[directions.shape[0] - 2, k, axis] + fraction * direction[k, axis]
            )
    root = joint_of_segment[joint_of_segment.shape[0] - 1]
    if root >= 0:
        go = direction[root, 0], direction[root, 1], direction[root, 2]
        copy_point(
            limit_root_step(problem.body, problem.start, search.segment_rotations, search.state[root], go),
            direction[root],
        )
    return move_joints(least, chain, search.segment_rotations, direction, search.state)


@kernel
def move_joints(least, chain, segment_rotations, direction, state):
    """Add a step to the state of every joint, shortened if it is too long; returns its displacement in metres.

    Nothing moves, and 0 is returned, if the displacement would be ``least`` or less.
    """
    joints, limits = chain.joints, chain.limits
    longest = longest_displacement(joints, direction)
    scale = min(1.0, MAX_STEP_DISPLACEMENT / max(longest, 1e-9))
    if longest <= least:
        return 0.0
    for k in range(joints.shape[0]):
        x, y, z = scale * direction[k, 0], scale * direction[k, 1], scale * direction[k, 2]
        if joints[k].segment == ROOT_TRANSLATION:
            state[k, 0], state[k, 1], state[k, 2] = (
                round_state(state[k, 0] + x),
                round_state(state[k, 1] + y),
                round_state(state[k, 2] + z),
            )
        elif x != 0.0 or y != 0.0 or z != 0.0:
            compose_gibbs(x, y, z, segment_rotations[joints[k].parent], limits[k], state[k])
    return scale * longest


@kernel
def compose_gibbs(x, y, z, parent, limit, state):
    """Compose a small rotation t in world axes with a joint's Gibbs vector g, in place: (t + g + t x g) / (1 - t . g),
    limited.

    METHOD (20).
    """
    tx = 0.5 * (parent[0, 0] * x + parent[1, 0] * y + parent[2, 0] * z)
    ty = 0.5 * (parent[0, 1] * x + parent[1, 1] * y + parent[2, 1] * z)
    tz = 0.5 * (parent[0, 2] * x + parent[1, 2] * y + parent[2, 2] * z)
    gx, gy, gz = state[0], state[1], state[2]
    scale = 1.0 / max(1.0 - (tx * gx + ty * gy + tz * gz), 0.2)
    nx = scale * (tx + gx + ty * gz - tz * gy)
    ny = scale * (ty + gy + tz * gx - tx * gz)
    nz = scale * (tz + gz + tx * gy - ty * gx)
    squared, freely = nx * nx + ny * ny + nz * nz, SOFT_JOINT_LIMIT * limit
    scale = 1.0
    if squared > freely * freely:
        margin = limit - max(math.sqrt(gx * gx + gy * gy + gz * gz), freely)
        most = limit - max(LIMIT_APPROACH * margin, LIMIT_MARGIN * limit)
        scale = min(1.0, most / math.sqrt(squared))
    state[0], state[1], state[2] = round_state(scale * nx), round_state(scale * ny), round_state(scale * nz)


@small_kernel
def round_state(value):
    """``value`` rounded to a multiple of 2^-34, so that it does not depend on the order of a sum.

    The result of a level must not depend on the number of joints that other levels free, not even by rounding.
    """
    return (value + STATE_ROUNDING) - STATE_ROUNDING
