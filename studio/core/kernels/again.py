"""A step near the goal by what the last one eliminated: levers hardly change there, and only errors are looked at anew.

The rows, those that bound, and what was eliminated are as ``kernels.priorities.find_step`` leaves them.
"""

from studio.core.kernels.compiling import kernel, summing_kernel
from studio.core.kernels.priorities import brake_way, length_of
from studio.core.kernels.pulls import BOUND, FURTHEST


@kernel
def is_kept(held, ask, solving):
    """Whether no bound that the last step did not look at is broken now."""
    errors, roles, active = ask[1], ask[3], solving[3]
    kept = True
    for i in range(held):
        kept = kept and (active[i] or roles[i] != BOUND or errors[i] <= 0.0)
    return kept


@kernel
def step_again(held, count, ask, chain, solving):
    """``find_step`` with what the last one eliminated, for what is missed now: near the goal levers hardly change.

    How far anything is to move, in metres.
    """
    rows, errors, roles, brakes = solving[7][0], ask[1], ask[3], ask[4]
    _, system, newton, active, answer, ways, levers, (_, weighted, long) = solving
    last, kept, own = ways.shape[0] - 1, 0, count - held
    for i in range(held):
        if active[i]:
            value = max(errors[i], 0.0) if roles[i] == BOUND else errors[i]
            for h in range(kept):
                value -= system[h, kept] * system[h, h] * answer[h]
            answer[kept] = value
            kept += 1
    for number in range(long.shape[1]):
        long[last, number] = long[last - 1, number] = 0.0
    place = kept
    for i in range(held - 1, -1, -1):
        if active[i]:
            place -= 1
            value = answer[place]
            for h in range(place + 1, kept):
                value -= system[place, h] * answer[h]
            answer[place] = value * system[place, place]
            for number in range(long.shape[1]):
                long[last - 1, number] += answer[place] * weighted[i, number]
    brake_way(brakes, ways[last - 1])
    for i in range(own):
        newton[i, own] = 0.0
    for q in range(own):
        levers[q, own] = errors[held + q] - product_of(rows[held + q], long[last - 1])
        for i in range(own):
            levers[q, i] = product_of(rows[held + q], long[held + i])
            newton[i, own] += levers[q, own] * levers[q, i]
    for i in range(own):
        for j in range(i + 1, own):
            newton[j, own] -= newton[j, i] / newton[i, i] * newton[i, own]
    for i in range(own - 1, -1, -1):
        value = newton[i, own]
        for j in range(i + 1, own):
            value -= newton[i, j] * answer[j]
        answer[i] = value / newton[i, i]
    part = part_as_now(own, levers, answer)
    for i in range(own):
        for number in range(long.shape[1]):
            long[last, number] += part * answer[i] * long[held + i, number]
    return max(length_of(chain[1], ways[last - 1]), length_of(chain[1], ways[last]))


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
