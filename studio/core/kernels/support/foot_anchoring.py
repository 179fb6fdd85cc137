"""Ankle targets of standing feet, anchored at one position through each contact (METHOD 5).

``states`` (F,) and ``soles`` (F or 1, 6) are those of ``kernels.support.sole``.
"""

import math

import numpy as np

from studio.core.kernels.algebra.medians import geometric_median
from studio.core.kernels.algebra.smooth_steps import smoothstep
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.support.gap_interpolation import fade_into_gaps
from studio.core.kernels.support.sole import HEEL_STANDS, TOE_STANDS, sole_height, stance_offsets, tip_offset

HEEL_PIVOT, BALL_PIVOT, TIP_PIVOT = range(3)
"""Pivots of a foot: points about which it rotates, in the order of the offsets that ``tip_offset`` writes."""
TIP_PIVOT_PITCH = 0.3
"""Downward pitch in radians of a toe from which it pivots on its tip alone; at a smaller pitch partly on the ball."""
SMALL_BODY_RATIO = 1.02
"""Greatest size of a growing body, relative to its least size in a contact, at which positions count for the anchor:
the body always reaches those.
"""


@allocating_kernel
def anchor_ankles(ankles, feet, states, soles, ground, pitches, reach, fade, out_ankles):
    """Write ankle targets (F, 3): anchored through every contact, with corrections that fade between contacts (METHOD
    5).

    ``ankles`` (F, 3) as retargeted, ``feet`` (F, 3, 3) corrected; ``ground`` (F,) height under the foot; ``pitches``
    (F,) downward pitches of toes that stand on their tips; ``reach`` and ``fade`` as ``reach`` and ``least`` of
    ``fade_into_gaps``. Each contact has one anchor: the median position of the heel's pad in its longest run (of the
    ball, if no heel stands). Every other pivot is at the foot's position when the contact passes from heel to ball, or
    back, so that nothing jumps; toes pass gradually from ball to tip as they pitch. A foot that grows is anchored at
    its position while it is small.
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
    fade_into_gaps(shift, known, ankles, reach, fade)
    for frame in range(count):
        for axis in range(3):
            out_ankles[frame, axis] = ankles[frame, axis] + shift[frame, axis]


@allocating_kernel
def anchor_contact(span, ankles, feet, states, soles, ground, pitches, out_ankles):
    """Write ankle targets of one contact, the frames ``span`` (begin, end excluded), from its anchor forwards and
    backwards.

    METHOD (6).
    """
    begin, end = span
    first, last = longest_run(states, HEEL_STANDS, begin, end)
    heel = last > first
    if not heel:
        first, last = longest_run(states, TOE_STANDS, begin, end)
    reach, count, least = np.zeros((last - first, 2)), 0, math.inf
    for frame in range(first, last):
        least = min(least, soles[frame if soles.shape[0] > 1 else 0, 0])
    offsets = np.zeros((3, 3))
    for frame in range(first, last):
        sole = soles[frame if soles.shape[0] > 1 else 0]
        if sole[0] - least > (SMALL_BODY_RATIO - 1.0) * abs(least):
            continue
        stance_offsets(feet[frame], sole, offsets)
        for axis in range(2):
            reach[count, axis] = offsets[HEEL_PIVOT if heel else BALL_PIVOT, axis] + ankles[frame, axis]
        count += 1
    anchor = geometric_median(reach[:count])
    pivots, shares = np.zeros((3, 2)), np.zeros(3)
    for sweep_direction in range(2):
        previous, before = HEEL_STANDS if heel else TOE_STANDS, 0.0
        for axis in range(2):
            pivots[HEEL_PIVOT if heel else BALL_PIVOT, axis] = anchor[axis]
        frame = first
        while begin <= frame < end:
            sole = soles[frame if soles.shape[0] > 1 else 0]
            stance_offsets(feet[frame], sole, offsets)
            rise = tip_offset(feet[frame], sole, pitches[frame], offsets)
            tip = smoothstep(min(pitches[frame] / TIP_PIVOT_PITCH, 1.0))
            shares[HEEL_PIVOT] = 1.0 if states[frame] & HEEL_STANDS and previous & HEEL_STANDS else 0.0
            shares[TIP_PIVOT] = (1.0 - shares[HEEL_PIVOT]) * 0.5 * (before + tip)
            shares[BALL_PIVOT] = 1.0 - shares[HEEL_PIVOT] - shares[TIP_PIVOT]
            for axis in range(2):
                out_ankles[frame, axis] = 0.0
                for pivot in range(3):
                    if shares[pivot] > 0.0:
                        out_ankles[frame, axis] += shares[pivot] * (pivots[pivot, axis] - offsets[pivot, axis])
                for pivot in range(3):
                    pivots[pivot, axis] = out_ankles[frame, axis] + offsets[pivot, axis]
            out_ankles[frame, 2] = ground[frame] + rise + sole_height(feet[frame], offsets[BALL_PIVOT, 2], sole)
            previous, before = states[frame], tip
            frame += 1 if sweep_direction == 0 else -1


@kernel
def longest_run(states, bit, begin, end):
    """(first, past last) frame of the longest run in [begin, end) whose states have ``bit``; equal if there is none."""
    best_first, best_last, first = begin, begin, begin
    for frame in range(begin, end):
        if states[frame] & bit:
            if frame + 1 - first > best_last - best_first:
                best_first, best_last = first, frame + 1
        else:
            first = frame + 1
    return best_first, best_last
