"""Ankles of standing feet, anchored through each contact (METHOD 5).

``states`` (F,) and ``soles`` (F or 1, 6) as in ``kernels.support.sole``.
"""

import math

import numpy as np

from studio.core.kernels.algebra.medians import geometric_median
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.support.gap_interpolation import interpolate_gaps_smoothly
from studio.core.kernels.support.sole import HEEL_STANDS, TOE_STANDS, pivot_offsets, sole_height, tip_offset

SMALLEST_SIZE = 1.02
"""Size of a growing body, relative to its least in a contact, up to which positions count: those it always reaches."""


TURN_VARIANCE = 0.01
"""Variance of a sole's heading in square radians at which its pivot is halfway from heel or ball to its still point."""


@allocating_kernel
def anchor_ankles(ankles, feet, states, soles, ground, pitches, reach, out_ankles):
    """Write ankle targets (F, 3): anchored through every contact, with interpolated corrections in between (METHOD 5).

    ``ankles`` (F, 3) as retargeted, ``feet`` (F, 3, 3) corrected; ``ground`` (F,) height under the foot; ``pitches``
    (F,) of toes that stand on their tips. Each contact has one anchor: the heel's median position in its longest run
    (the toe's, if no heel stands). Every other pivot is where the foot is when the contact passes from heel to ball or
    tip, or back, so that nothing jumps. A foot that turns does so about the point of its sole that moves least. A foot
    that grows is anchored where it is while it is small.
    """
    count = states.shape[0]
    shift = np.zeros((count, 3))
    known = states != 0
    begin = 0
    while begin < count:
        if not known[begin]:
            begin += 1
            continue
        end = begin
        while end < count and known[end]:
            end += 1
        anchor_contact((begin, end), ankles, feet, states, soles, ground, pitches, out_ankles)
        for frame in range(begin, end):
            for axis in range(3):
                shift[frame, axis] = out_ankles[frame, axis] - ankles[frame, axis]
        begin = end
    interpolate_gaps_smoothly(shift, known, reach)
    for frame in range(count):
        for axis in range(3):
            out_ankles[frame, axis] = ankles[frame, axis] + shift[frame, axis]


@allocating_kernel
def anchor_contact(span, ankles, feet, states, soles, ground, pitches, out_ankles):
    """Write ankle targets of one contact, a ``span`` of frames (begin, end excluded): each step keeps one pivot of the
    sole in place, and the whole path is anchored.

    METHOD (6).
    """
    begin, end = span
    count = end - begin
    pivots, offsets = np.empty(count, np.int64), np.zeros((count, 3, 3))
    for row in range(count):
        frame = begin + row
        sole = soles[frame if soles.shape[0] > 1 else 0]
        pivot_offsets(feet[frame], sole, offsets[row])
        rise = tip_offset(feet[frame], sole, pitches[frame], offsets[row])
        before = frame - 1 if row else frame
        pivots[row] = 2 if pitches[frame] > 0.0 or pitches[before] > 0.0 else 1
        if states[frame] & states[before] & HEEL_STANDS:
            pivots[row] = 0
        out_ankles[frame, 2] = ground[frame] + rise + sole_height(feet[frame], offsets[row, 1, 2], sole)
    row = 1
    out_ankles[begin, :2] = ankles[begin, :2]
    while row < count:
        past = row
        while past < count and pivots[past] == pivots[row]:
            past += 1
        ends = ankles[begin + row - 1 : begin + past, :2] + offsets[row - 1 : past, pivots[row], :2]
        lengths = offsets[row - 1 : past, 1, :2] - offsets[row - 1 : past, 0, :2]
        along = still_point(ends, lengths, pivots[row]) if pivots[row] < 2 else 0.0
        for step in range(row, past):
            for axis in range(2):
                moved = offsets[step - 1, pivots[row], axis] - offsets[step, pivots[row], axis]
                moved += along * (lengths[step - row, axis] - lengths[step - row + 1, axis])
                out_ankles[begin + step, axis] = out_ankles[begin + step - 1, axis] + moved
        row = past
    anchor_path(span, ankles, states, soles, out_ankles)


@allocating_kernel
def anchor_path(span, ankles, states, soles, out_ankles):
    """Move the ankle targets of one contact, in place, to the geometric median of the ``ankles`` (F, 3) in its longest
    run of heel (or toe) contact.
    """
    begin, end = span
    first, last = longest_run(states, HEEL_STANDS, begin, end)
    if last == first:
        first, last = longest_run(states, TOE_STANDS, begin, end)
    apart, count, least = np.zeros((last - first, 2)), 0, math.inf
    for frame in range(first, last):
        least = min(least, soles[frame if soles.shape[0] > 1 else 0, 0])
    for frame in range(first, last):
        if soles[frame if soles.shape[0] > 1 else 0, 0] - least > (SMALLEST_SIZE - 1.0) * abs(least):
            continue
        for axis in range(2):
            apart[count, axis] = ankles[frame, axis] - out_ankles[frame, axis]
        count += 1
    anchor = geometric_median(apart[:count])
    for frame in range(begin, end):
        for axis in range(2):
            out_ankles[frame, axis] += anchor[axis]


@allocating_kernel
def still_point(ends, soles, ball):
    """Position of the point of least motion of a sole that turns, from its ``ends`` (F, 2) metres: the fraction of its
    length, positive towards the toes; 0 for a sole that keeps its heading.

    ``soles`` (F, 2) horizontal vectors from heel to ball, metres; ``ends`` are balls if ``ball`` is 1, heels if 0.
    """
    count = ends.shape[0]
    headings = np.empty((count, 2))
    for row in range(count):
        length = max(math.hypot(soles[row, 0], soles[row, 1]), 1e-9)
        for axis in range(2):
            headings[row, axis] = soles[row, axis] / length
    size, turned, moved = 0.0, 0.0, 0.0
    for row in range(count):
        size += math.hypot(soles[row, 0], soles[row, 1]) / count
    for axis in range(2):
        heading, middle = headings[:, axis].mean(), ends[:, axis].mean()
        for row in range(count):
            turned += (headings[row, axis] - heading) ** 2 / count
            moved += (headings[row, axis] - heading) * (ends[row, axis] - middle) / count
    if turned == 0.0 or size < 1e-9:
        return 0.0
    turns = turned * turned / (turned * turned + TURN_VARIANCE * TURN_VARIANCE)
    return turns * min(max(-moved / (turned * size), -1.0 * ball), 1.0 - ball)


@kernel
def longest_run(states, bit, begin, end):
    """Frames (first, last excluded) of the longest run in [begin, end) whose states have ``bit``; equal if there is
    none.
    """
    best_first, best_last, first = begin, begin, begin
    for frame in range(begin, end):
        if states[frame] & bit:
            if frame + 1 - first > best_last - best_first:
                best_first, best_last = first, frame + 1
        else:
            first = frame + 1
    return best_first, best_last
