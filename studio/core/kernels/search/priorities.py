"""Strict priorities over the whole body: each level is solved with all levels above it held.

A row is a direction in which a point (or the centre of mass, or a turn) is to move and by how much; J_rk is how joint k
moves row r, w_rk the mobility that the row's constraint gives it, and M_qr = sum_k w_rk J_qk . J_rk. Rows that are
held come first: y_h = M_hh^-1 e_h keeps them. A row that asks moves joints along x_r = w_r J_r less what held rows
take back, so that to the first order nothing that is held moves. Among those ways Newton's step on half the sum of
squared errors is taken: (A^T A + H) y = A^T e with A_qr = J_q . x_r and H_qr = sum_c e_c . d2(x_q, x_r), the second
derivatives of what is pulled (``pulls.bend``). Gauss' step, without H, swings where nothing gets nearer; and one
damping for all ways is too much for some of them and too little for others (METHOD (23)).

Some held rows are bounds, as what planted feet allow the root: they let go as long as the step keeps them. The one
that it would break most holds first, then what the step breaks now; what pushes the wrong way lets go again.
"""

import math

import numpy as np

from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.compiling import kernel, small_kernel, summing_kernel
from studio.core.kernels.limits.root_reach import keep_feet_in_reach
from studio.core.kernels.search.joints import FREE_PART, ROOT, brake
from studio.core.kernels.tasks.second_order import BOUND, bend

LONGEST_ERROR = 0.3
"""Metres (or radians) of error answered in one step."""
LONGEST_STEP = 0.25
"""Metres, a radian counting half a one, that a step moves anything."""
SINGULAR = 3e-4
"""Part of itself that must be left of the pivot of a held row, or it is taken to be spoken for by others."""
SPOKEN_FOR = 0.2
"""The same of a row that asks, while its errors are large."""
EASED = 0.05
"""Metres of error at which that is asked for by half: Newton's steps near the goal are not damped."""
ATTEMPTS = 4
"""Times that a step is found, at most, until no bound is broken and none pushes the wrong way."""
PRESSING = 0.5
"""Part of its curvature with which a limit answers."""
ROUNDING = 1.5 * 2.0**18
"""Added to a number and taken away again it leaves multiples of 2^-34, 6e-11 radians or metres, of it."""
CLOSER, CLOSEST = 0.3, 3e-5
"""Part of its room before a limit that a step leaves a joint, and part of the limit that always stays."""


@kernel
def find_step(held, count, damping, rows, chain, equations, positions):
    """How all joints are to turn and the root to move: the way (N, 3) that keeps what is held, and that which is asked.

    They are the last but one and the last of the steps of ``equations``. The slope of half the sum of squared errors
    along that which is asked.

    ``damping`` the part of what damps steps that hardly bring anything; ``rows`` those of which the first ``held`` hold
    and those until ``count`` ask; records as in ``kernels.records``.
    """
    active, flat, roles = equations.active, equations.flat, rows.roles
    stiffen_rows(count, rows.jacobian, rows.brakes)
    multiply_rows(count, flat.jacobian, rows.owners, chain.mobilities, flat.weighted, equations.gram)
    for i in range(count):
        active[i] = roles[i] != BOUND
    slope = 0.0
    for _ in range(ATTEMPTS):
        slope = solve_rows(held, count, damping, rows, chain, equations, positions)
        if not let_go(held, roles, equations) and not catch_bound(held, count, rows.errors, rows.rooms, equations):
            break
    return slope


@summing_kernel
def multiply_rows(count, jacobian, owners, mobilities, weighted, gram):
    """Rows (R, 3 N) by the mobilities of their owners into ``weighted``, and M (R, R) with M_qr = J_q . w_r J_r."""
    for i in range(count):
        shares, row, out_row = mobilities[owners[i]], jacobian[i], weighted[i]
        for k in range(shares.shape[0]):
            x, y, z = np.uint64(3 * k), np.uint64(3 * k + 1), np.uint64(3 * k + 2)
            out_row[x], out_row[y], out_row[z] = shares[k] * row[x], shares[k] * row[y], shares[k] * row[z]
        j = 0
        while j < i and owners[j] == owners[i]:
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
def stiffen_rows(count, jacobian, brakes):
    """A joint near its limit answers less: the root of what its brake leaves goes into the rows, the root again into
    the step.
    """
    for k in range(brakes.shape[0]):
        if brakes[k].part < 1.0:
            for row in range(count):
                brake(brakes[k].part, brakes[k].axis, jacobian[row, k])


@kernel
def solve_rows(held, count, damping, rows, chain, equations, positions):
    """``find_step`` with the active rows."""
    errors, brakes = rows.errors, rows.brakes
    system, active, answer, steps = equations.held, equations.active, equations.answer, equations.steps
    weighted, flat = equations.flat.weighted, equations.flat.steps
    last = steps.shape[0] - 1
    kept = solve_held(held, count, errors, equations)
    for j in range(held, count):
        way_of(held, j, kept, system, active, weighted, flat)
        brake_way(brakes, steps[j])
    slope = solve_own(held, count, kept, damping, rows, chain, equations, positions)
    for number in range(flat.shape[1]):
        flat[last, number] = flat[last - 1, number] = 0.0
    for j in range(held, count):
        share = answer[j]
        for number in range(flat.shape[1]):
            flat[last, number] += share * flat[j, number]
    place = 0
    for i in range(held):
        answer[i] = 0.0
        if active[i]:
            share = system[place, kept]
            for number in range(flat.shape[1]):
                flat[last - 1, number] += share * weighted[i, number]
            answer[i] = share
            for j in range(held, count):
                answer[i] -= system[place, kept + 1 + j - held] * answer[j]
            place += 1
    brake_way(brakes, steps[last - 1])
    return slope


@small_kernel
def brake_way(brakes, way):
    """Shorten a way (N, 3) by the root of what the brakes leave."""
    for k in range(brakes.shape[0]):
        if brakes[k].part < 1.0:
            brake(brakes[k].part, brakes[k].axis, way[k])


@kernel
def solve_held(held, count, errors, equations):
    """What keeps the active held rows: ``system`` becomes M_hh^-1 [e_h | M_ha] for the rows a that ask; how many.

    METHOD (21).
    """
    gram, system, active = equations.gram, equations.held, equations.active
    kept = 0
    for i in range(held):
        if not active[i]:
            continue
        column = 0
        for j in range(held):
            if active[j]:
                system[kept, column] = gram[i, j]
                column += 1
        system[kept, column] = min(max(errors[i], -LONGEST_ERROR), LONGEST_ERROR)
        for j in range(held, count):
            system[kept, column + 1 + j - held] = gram[i, j]
        kept += 1
    columns, place = kept + 1 + count - held, 0
    for i in range(held):
        if active[i]:
            system[place, columns] = gram[i, i]
            place += 1
    eliminate(system, kept, columns)
    return kept


@kernel
def eliminate(system, count, columns):
    """Solve the symmetric ``system`` (n, columns + 1) in place by elimination in order for all of its right sides.

    The last column is what each pivot was before. What is below the diagonal is not looked at.
    """
    for i in range(count):
        pivot, floor = system[i, i], SINGULAR * system[i, columns]
        inverse = pivot / (pivot * pivot + floor * floor + 1e-24)
        system[i, i] = inverse
        for j in range(i + 1, count):
            factor = system[i, j] * inverse
            if factor != 0.0:
                take_off(factor, system[i], j, columns, system[j])
    for i in range(count - 1, -1, -1):
        for column in range(count, columns):
            system[i, column] *= system[i, i]
        for j in range(i):
            take_off(system[j, i], system[i], count, columns, system[j])


@small_kernel
def take_off(factor, numbers, first, past, out_numbers):
    """Take ``factor`` times some numbers off others, from the ``first`` on; without a sign they go several at once."""
    for place in range(np.uint64(first), np.uint64(past)):
        out_numbers[place] -= factor * numbers[place]


@kernel
def way_of(held, j, kept, system, active, weighted, flat):
    """Along which (3 N) a row that asks moves the joints: its own levers less what held rows take back.

    METHOD (22).
    """
    for number in range(flat.shape[1]):
        flat[j, number] = weighted[j, number]
    place = 0
    for i in range(held):
        if active[i]:
            share = system[place, kept + 1 + j - held]
            for number in range(flat.shape[1]):
                flat[j, number] -= share * weighted[i, number]
            place += 1


@kernel
def solve_own(held, count, kept, damping, rows, chain, equations, positions):
    """Newton's step among the ways of the rows that ask, into ``answer`` (METHOD (23)); the slope along it."""
    errors, joints, limits = rows.errors, chain.joints, chain.limits
    gram, system, normal, active = equations.gram, equations.held, equations.normal, equations.active
    answer, levers = equations.answer, equations.levers
    own = count - held
    worst = 1e-9
    for i in range(own):
        answer[held + i] = min(max(errors[held + i], -LONGEST_ERROR), LONGEST_ERROR)
        worst = max(worst, abs(answer[held + i]))
        for j in range(own):
            levers[i, j] = gram[held + i, held + j]
        place = 0
        for h in range(held):
            if active[h]:
                lever = gram[held + i, h]
                answer[held + i] -= lever * system[place, kept]
                for j in range(own):
                    levers[i, j] -= lever * system[place, kept + 1 + j]
                place += 1
    for i in range(own):
        normal[i, own] = 0.0
        for q in range(own):
            normal[i, own] += levers[q, i] * answer[held + q]
        for j in range(own):
            along = 0.0
            for q in range(own):
                along += levers[q, i] * levers[q, j]
            normal[i, j] = along
    add_curvature(held, count, kept, rows, joints, equations, positions)
    far_off = worst / (worst + EASED)
    press_on_limits(far_off, held, count, rows, limits, equations.steps, normal)
    return solve_positive(normal, own, gram, damping * far_off, answer, held)


@kernel
def press_on_limits(far_off, held, count, rows, limits, steps, normal):
    """Add what limits answer to joints that are pressed on them: push / angle across, their own curvature (24).

    Without it what may turn at a limit, but no further, sways along it from step to step; near the goal it is left out.
    """
    jacobian, errors, brakes = rows.jacobian, rows.errors, rows.brakes
    for k in range(brakes.shape[0]):
        if brakes[k].part >= 1.0:
            continue
        x, y, z, root = brakes[k].axis[0], brakes[k].axis[1], brakes[k].axis[2], brakes[k].part
        push = 0.0
        for q in range(held, count):
            pull = min(max(errors[q], -LONGEST_ERROR), LONGEST_ERROR)
            push += pull * (x * jacobian[q, k, 0] + y * jacobian[q, k, 1] + z * jacobian[q, k, 2])
        if push <= 0.0:
            continue
        across = far_off * PRESSING * push * (1.0 - root * root) / (max(root, 1e-6) * 2.0 * limits[k])
        for i in range(held, count):
            way = steps[i, k]
            along = x * way[0] + y * way[1] + z * way[2]
            ax, ay, az = way[0] - along * x, way[1] - along * y, way[2] - along * z
            for j in range(held, count):
                normal[i - held, j - held] += across * (ax * steps[j, k, 0] + ay * steps[j, k, 1] + az * steps[j, k, 2])


@kernel
def add_curvature(held, count, kept, rows, joints, equations, positions):
    """Add H to the normal equations: what pulls, and what bounds push back with, times how each way bends from it.

    A bound pushes with mu = -M_hh^-1 M_ha e (the multiplier of its Lagrangian). What would bend towards its goal is
    left out, so that the equations stay positive.

    METHOD (23).
    """
    errors, roles, pulls = rows.errors, rows.roles, rows.pulls
    system, active = equations.held, equations.active
    place = 0
    for q in range(count):
        push = 1.0
        if q < held:
            if not active[q]:
                continue
            place += 1
            if roles[q] != BOUND:
                continue
            push = 0.0
            for j in range(held, count):
                push -= system[place - 1, kept + 1 + j - held] * min(max(errors[j], -LONGEST_ERROR), LONGEST_ERROR)
        if push > 0.0 and pulls[q].carrier >= 0.0:
            bend(push, pulls[q], held, count, joints, equations, positions)


@kernel
def solve_positive(normal, count, gram, damping, answer, first):
    """Solve the symmetric (n, n + 1) by elimination; the answer goes to ``answer[first:]``. Its product with the right
    side.

    No pivot sinks below what is left of a row when it is spoken for, and factors stay bounded whatever the curvature
    (Gill, Murray and Wright 1981, 4.4.2.2).
    """
    bound = 1e-15
    for i in range(count):
        bound = max(bound, normal[i, i])
    for i in range(count):
        most = 0.0
        for j in range(i + 1, count):
            most = max(most, abs(normal[j, i]))
        floor = SPOKEN_FOR * gram[first + i, first + i]
        pivot = max(normal[i, i], most * most / bound) + damping * floor * floor + 1e-15
        normal[i, i] = pivot
        for j in range(i + 1, count):
            factor = normal[j, i] / pivot
            if factor != 0.0:
                take_off(factor, normal[i], i + 1, count + 1, normal[j])
    for i in range(count - 1, -1, -1):
        value = normal[i, count]
        for j in range(i + 1, count):
            value -= normal[i, j] * answer[first + j]
        answer[first + i] = value / normal[i, i]
    product = 0.0
    for i in range(count):
        product += normal[i, count] * normal[i, count] / normal[i, i]
    return product


@kernel
def catch_bound(held, count, errors, rooms, equations):
    """Make the bound active that the step would break most; whether there is one.

    A bound with room is soft: it brakes over that room, so that nothing stops from one frame to the next.
    """
    gram, active, answer = equations.gram, equations.active, equations.answer
    caught, most, braking = -1, 1e-9, 0.0
    for i in range(held):
        if active[i]:
            continue
        after, room = errors[i], min(rooms[i], max(-errors[i], 0.0))
        for j in range(count):
            after -= gram[i, j] * answer[j]
        if after + room > most:
            caught, most, braking = i, after + room, room
    if caught < 0:
        return False
    active[caught] = True
    if braking > 0.0:
        errors[caught] += braking * math.exp(-most / braking)
        rooms[caught] = 0.0
    return True


@kernel
def let_go(held, roles, equations):
    """Let the bound go that pushes the wrong way most; whether there is one."""
    active, answer = equations.active, equations.answer
    found, least = -1, 0.0
    for i in range(held):
        if active[i] and roles[i] == BOUND and answer[i] < least:
            found, least = i, answer[i]
    if found >= 0:
        active[found] = False
    return found >= 0


@kernel
def length_of(joints, way):
    """The longest way in metres that a step (N, 3) moves anything, a radian counting half a one."""
    longest = 0.0
    for k in range(joints.shape[0]):
        squared = way[k, 0] ** 2 + way[k, 1] ** 2 + way[k, 2] ** 2
        longest = max(longest, squared if joints[k].segment == ROOT else 0.25 * squared)
    return math.sqrt(longest)


@kernel
def go_on(least, ease, part, problem):
    """Go the way that keeps what is held and a part of the way to what is asked, as far as planted feet allow the root.

    ``ease`` the part of both that is gone. How far anything moves, in metres; nothing does where it would be ``least``.
    """
    chain, search, steps = problem.chain, problem.search, problem.search.equations.steps
    slots, way = chain.slots, steps[steps.shape[0] - 1]
    for k in range(way.shape[0]):
        for axis in range(3):
            way[k, axis] = ease * (steps[steps.shape[0] - 2, k, axis] + part * way[k, axis])
    root = slots[slots.shape[0] - 1]
    if root >= 0:
        go = way[root, 0], way[root, 1], way[root, 2]
        copy_point(keep_feet_in_reach(problem.body, problem.start, search.carried, search.state[root], go), way[root])
    return move_joints(least, chain, search.carried, way, search.state)


@kernel
def move_joints(least, chain, carried, way, turned):
    """Add a step to the state of every joint, less where that is too long, none if it is ``least`` metres at most.

    The longest way in metres.
    """
    joints, limits = chain.joints, chain.limits
    longest = length_of(joints, way)
    scale = min(1.0, LONGEST_STEP / max(longest, 1e-9))
    if longest <= least:
        return 0.0
    for k in range(joints.shape[0]):
        x, y, z = scale * way[k, 0], scale * way[k, 1], scale * way[k, 2]
        if joints[k].segment == ROOT:
            turned[k, 0], turned[k, 1], turned[k, 2] = (
                rounded(turned[k, 0] + x),
                rounded(turned[k, 1] + y),
                rounded(turned[k, 2] + z),
            )
        elif x != 0.0 or y != 0.0 or z != 0.0:
            turn_further(x, y, z, carried[joints[k].carrier], limits[k], turned[k])
    return scale * longest


@kernel
def turn_further(x, y, z, carrier, limit, turned):
    """Compose a small turn in world axes with a joint's Gibbs vector: g' = (t + g + t x g) / (1 - t . g), limited.

    METHOD (20).
    """
    tx = 0.5 * (carrier[0, 0] * x + carrier[1, 0] * y + carrier[2, 0] * z)
    ty = 0.5 * (carrier[0, 1] * x + carrier[1, 1] * y + carrier[2, 1] * z)
    tz = 0.5 * (carrier[0, 2] * x + carrier[1, 2] * y + carrier[2, 2] * z)
    gx, gy, gz = turned[0], turned[1], turned[2]
    scale = 1.0 / max(1.0 - (tx * gx + ty * gy + tz * gz), 0.2)
    nx = scale * (tx + gx + ty * gz - tz * gy)
    ny = scale * (ty + gy + tz * gx - tx * gz)
    nz = scale * (tz + gz + tx * gy - ty * gx)
    squared, freely = nx * nx + ny * ny + nz * nz, FREE_PART * limit
    scale = 1.0
    if squared > freely * freely:
        room = limit - max(math.sqrt(gx * gx + gy * gy + gz * gz), freely)
        most = limit - max(CLOSER * room, CLOSEST * limit)
        scale = min(1.0, most / math.sqrt(squared))
    turned[0], turned[1], turned[2] = rounded(scale * nx), rounded(scale * ny), rounded(scale * nz)


@small_kernel
def rounded(value):
    """A number to the next multiple of 2^-34, as sums in any order of their terms have it.

    What a level comes to must not depend on how many joints others free: where a hair decides it would show.
    """
    return (value + ROUNDING) - ROUNDING
