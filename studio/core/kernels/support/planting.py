"""Ankles of feet that stand, kept at one place through each contact (METHOD 4).

``states`` (F,) and ``soles`` (F or 1, 6) as in ``kernels.support.sole``.
"""

import math

import numpy as np

from studio.core.kernels.algebra.medians import geometric_median
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.support.gaps import ease_gaps
from studio.core.kernels.support.sole import HEEL, TOE, sole_height, to_pivots, to_tip

SMALLEST = 1.02
"""Parts of its least size through a contact up to which a growing body's places count: those it reaches always."""


@allocating_kernel
def plant_ankles(ankles, feet, states, soles, ground, pitches, reach, out_ankles):
    """Ankle targets (F, 3): anchored through every contact, displaced by an eased amount in between (METHOD 4).

    ``ankles`` (F, 3) as retargeted, ``feet`` (F, 3, 3) corrected; ``ground`` (F,) height under the foot; ``pitches``
    (F,) of toes that stand on their tips. One anchor an episode of contact: the heel's median place in its longest
    stretch on it (the toe's, if no heel stands); every other pivot is where the foot is when the contact passes from
    heel to ball or tip, or back, so nothing jumps. A foot that grows is anchored where it is while it is small.
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
        plant_episode((begin, end), ankles, feet, states, soles, ground, pitches, out_ankles)
        for frame in range(begin, end):
            for axis in range(3):
                shift[frame, axis] = out_ankles[frame, axis] - ankles[frame, axis]
        begin = end
    ease_gaps(shift, known, reach)
    for frame in range(count):
        for axis in range(3):
            out_ankles[frame, axis] = ankles[frame, axis] + shift[frame, axis]


@allocating_kernel
def plant_episode(span, ankles, feet, states, soles, ground, pitches, out_ankles):
    """Ankle targets of one unbroken contact, a ``span`` of frames (begin, end excluded), from its seed both ways.

    METHOD (6).
    """
    begin, end = span
    first, last = longest_stretch(states, HEEL, begin, end)
    heel = last > first
    if not heel:
        first, last = longest_stretch(states, TOE, begin, end)
    reach, count, least = np.zeros((last - first, 2)), 0, math.inf
    for frame in range(first, last):
        least = min(least, soles[frame if soles.shape[0] > 1 else 0, 0])
    offsets = np.zeros((3, 3))
    for frame in range(first, last):
        sole = soles[frame if soles.shape[0] > 1 else 0]
        if sole[0] - least > (SMALLEST - 1.0) * abs(least):
            continue
        to_pivots(feet[frame], sole, offsets)
        for axis in range(2):
            reach[count, axis] = offsets[0 if heel else 1, axis] + ankles[frame, axis]
        count += 1
    anchor = geometric_median(reach[:count])
    pivots = np.zeros((3, 2))
    for way in range(2):
        previous, pitched = HEEL if heel else TOE, False
        pivots[0 if heel else 1] = anchor
        frame = first
        while begin <= frame < end:
            sole = soles[frame if soles.shape[0] > 1 else 0]
            to_pivots(feet[frame], sole, offsets)
            rise = to_tip(feet[frame], sole, pitches[frame], offsets)
            stands = 2 if pitched or pitches[frame] > 0.0 else 1
            if states[frame] & HEEL and previous & HEEL:
                stands = 0
            for axis in range(2):
                out_ankles[frame, axis] = pivots[stands, axis] - offsets[stands, axis]
                for other in range(3):
                    if other != stands:
                        pivots[other, axis] = out_ankles[frame, axis] + offsets[other, axis]
            out_ankles[frame, 2] = ground[frame] + rise + sole_height(feet[frame], offsets[1, 2], sole)
            previous, pitched = states[frame], pitches[frame] > 0.0
            frame += 1 if way == 0 else -1


@kernel
def longest_stretch(states, bit, begin, end):
    """Frames (first, last excluded) of the longest run within [begin, end) whose states have ``bit``; equal if none."""
    best_first, best_last, first = begin, begin, begin
    for frame in range(begin, end):
        if states[frame] & bit:
            if frame + 1 - first > best_last - best_first:
                best_first, best_last = first, frame + 1
        else:
            first = frame + 1
    return best_first, best_last
