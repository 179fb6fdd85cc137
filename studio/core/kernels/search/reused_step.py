"""A step near the goal by what the last one eliminated: levers hardly change there, and only errors are looked at anew.

The rows, those that bound, and what was eliminated are as ``kernels.search.priorities.find_step`` leaves them.
"""

from studio.core.kernels.compiling import kernel, summing_kernel
from studio.core.kernels.search.priorities import brake_way, length_of
from studio.core.kernels.tasks.second_order import BOUND, FURTHEST


@kernel
def is_kept(held, rows, equations):
    """Whether no bound that the last step did not look at is broken now."""
    errors, roles, active = rows.errors, rows.roles, equations.active
    kept = True
    for i in range(held):
        kept = kept and (active[i] or roles[i] != BOUND or errors[i] <= 0.0)
    return kept


@kernel
def step_again(held, count, rows, chain, equations):
    """``find_step`` with what the last one eliminated, for what is missed now: near the goal levers hardly change.

    How far anything is to move, in metres.
    """
    jacobian, weighted, flat = equations.flat.jacobian, equations.flat.weighted, equations.flat.steps
    errors, roles, brakes = rows.errors, rows.roles, rows.brakes
    system, normal, active = equations.held, equations.normal, equations.active
    answer, steps, levers = equations.answer, equations.steps, equations.levers
    last, kept, own = steps.shape[0] - 1, 0, count - held
    for i in range(held):
        if active[i]:
            value = max(errors[i], 0.0) if roles[i] == BOUND else errors[i]
            for h in range(kept):
                value -= system[h, kept] * system[h, h] * answer[h]
            answer[kept] = value
            kept += 1
    for number in range(flat.shape[1]):
        flat[last, number] = flat[last - 1, number] = 0.0
    place = kept
    for i in range(held - 1, -1, -1):
        if active[i]:
            place -= 1
            value = answer[place]
            for h in range(place + 1, kept):
                value -= system[place, h] * answer[h]
            answer[place] = value * system[place, place]
            for number in range(flat.shape[1]):
                flat[last - 1, number] += answer[place] * weighted[i, number]
    brake_way(brakes, steps[last - 1])
    for i in range(own):
        normal[i, own] = 0.0
    for q in range(own):
        levers[q, own] = errors[held + q] - product_of(jacobian[held + q], flat[last - 1])
        for i in range(own):
            levers[q, i] = product_of(jacobian[held + q], flat[held + i])
            normal[i, own] += levers[q, own] * levers[q, i]
    for i in range(own):
        for j in range(i + 1, own):
            normal[j, own] -= normal[j, i] / normal[i, i] * normal[i, own]
    for i in range(own - 1, -1, -1):
        value = normal[i, own]
        for j in range(i + 1, own):
            value -= normal[i, j] * answer[j]
        answer[i] = value / normal[i, i]
    part = part_as_now(own, levers, answer)
    for i in range(own):
        for number in range(flat.shape[1]):
            flat[last, number] += part * answer[i] * flat[held + i, number]
    return max(length_of(chain.joints, steps[last - 1]), length_of(chain.joints, steps[last]))


@kernel
def part_as_now(own, levers, answer):
    """The part of an ``answer`` (n,) that misses least of ``levers`` (n, n + 1) as they are now, errors last."""
    made = squared = 0.0
    for q in range(own):
        along = 0.0
        for i in range(own):
            along += levers[q, i] * answer[i]
        made, squared = made + along * levers[q, own], squared + along * along
    return min(max(made / max(squared, 1e-24), 0.0), FURTHEST)


@summing_kernel
def product_of(a, b):
    """The sum of products of two rows of numbers."""
    total = 0.0
    for number in range(a.shape[0]):
        total += a[number] * b[number]
    return total
