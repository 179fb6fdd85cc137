"""Feet that stand: soles locked level, ankles and toes kept at one place through each contact (METHOD 4).

States of a foot at a frame: bit 1 the heel stands, bit 2 the toe stands. ``soles`` (F or 1, 6) are the measures of one
foot: ankle to toe joint in foot axes (3), ankle above the sole, heel behind the ankle, length of the toe.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation import matrix_to_rotation_vector, multiply, rotation_vector_to_matrix
from studio.core.kernels.algebra.turns import NO_TURN, product, put_turn, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_matrix
from studio.core.kernels.compiling import allocating_kernel, kernel, small_kernel

HEEL = 1
TOE = 2
FLAT = 3
STEEP = -0.7
"""Vertical part of a foot's forward axis below which it stands on tucked toes."""
ASIDE = 0.35
"""Vertical part of a foot's left axis from which it lies on its side, wholly at twice that."""
SOLE_DOWN = 0.5
"""Vertical part of its upward axis from which it stands on its sole."""
SMALLEST = 1.02
"""Parts of its least size through a contact up to which a growing body's places count: those it reaches always."""


@kernel
def smoothstep(t):
    """Quintic ease 6t^5 - 15t^4 + 10t^3 of t in [0, 1]: level, without velocity or acceleration at both ends.

    METHOD (6).
    """
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)


@kernel
def free_feet(planted, reach, out_free):
    """0 in frames that are ``planted`` (F,), eased to 1 within ``reach`` frames before and after, (F,) (METHOD (6))."""
    count = planted.shape[0]
    last = -math.inf
    for frame in range(count):
        last = frame if planted[frame] else last
        out_free[frame] = frame - last
    next_one = math.inf
    for frame in range(count - 1, -1, -1):
        next_one = frame if planted[frame] else next_one
        out_free[frame] = smoothstep(min(min(out_free[frame], next_one - frame) / reach, 1.0))


@kernel
def fill_gaps(values, known):
    """Values (F, 3) where not ``known`` (F,): eased from the known before to the known after, held at the ends.

    METHOD (6).
    """
    count = known.shape[0]
    last = -1
    for frame in range(count):
        if not known[frame]:
            continue
        for gap in range(last + 1, frame):
            share = 1.0 if last < 0 else smoothstep((gap - last) / (frame - last))
            for axis in range(3):
                begin = values[last, axis] if last >= 0 else values[frame, axis]
                values[gap, axis] = begin + share * (values[frame, axis] - begin)
        last = frame
    for gap in range(last + 1, count):
        for axis in range(3):
            values[gap, axis] = values[last, axis] if last >= 0 else 0.0


@kernel
def ease_gaps(values, known, reach):
    """``fill_gaps``, but for ``reach`` frames beside what is known values go on as fast as they did there, ever less.

    So what is corrected comes to rest, and starts from it, without a jolt: a correction that stood still at once would
    leave the motion its own speed one frame away from where it has none.

    METHOD (6).
    """
    fill_gaps(values, known)
    count, frame = known.shape[0], 0
    while frame < count:
        if known[frame]:
            frame += 1
            continue
        end = frame
        while end < count and not known[end]:
            end += 1
        span = min(reach, end - frame + 1.0)
        for side in range(2):
            edge, inner = (frame - 1, frame - 2) if side == 0 else (end, end + 1)
            if min(edge, inner) < 0 or max(edge, inner) >= count or not known[inner]:
                continue
            for gap in range(frame, end):
                steps = abs(gap - edge)
                if steps < span:
                    share = steps * (1.0 - smoothstep(steps / span))
                    for axis in range(3):
                        values[gap, axis] += share * (values[edge, axis] - values[inner, axis])
        frame = end


@allocating_kernel
def level_soles(rotations, states, reach, out_rotations):
    """Foot rotations (F, 3, 3), level and of one heading through each stretch of frames that stands flat.

    The heading is the mean of the stretch; the correction eases from one stretch to the next (METHOD 4).
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    known = states == FLAT
    level, turn = np.zeros((3, 3)), np.empty((3, 3))
    level[2, 2] = 1.0
    frame = 0
    while frame < count:
        if not known[frame]:
            frame += 1
            continue
        end, along, across = frame, 0.0, 0.0
        while end < count and known[end]:
            along += rotations[end, 0, 0]
            across += rotations[end, 1, 0]
            end += 1
        set_heading(level, along, across)
        for standing in range(frame, end):
            copy_matrix(level, out_rotations[standing])
            if not is_inside(standing, known):
                multiply(level, rotations[standing].T, turn)
                matrix_to_rotation_vector(turn, corrections[standing])
        frame = end
    ease_gaps(corrections, known, reach)
    for frame in range(count):
        if not known[frame]:
            put_turn(corrected(corrections[frame], turn_in(rotations[frame])), out_rotations[frame])


@small_kernel
def corrected(correction, turn):
    """A turn turned on by the rotation vector ``correction`` (3,), itself where that is nought."""
    x, y, z = correction[0], correction[1], correction[2]
    return product(turn_by(x, y, z), turn) if x != 0.0 or y != 0.0 or z != 0.0 else turn


@allocating_kernel
def keep_pitch_on_ground(soles, states, reach, rotations):
    """Foot rotations (F, 3, 3), in place: no ball below the heel in a heel stand, none above it in a toe stand."""
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    turn, turned = np.empty((3, 3)), np.empty((3, 3))
    for frame in range(count):
        if states[frame] != HEEL and states[frame] != TOE:
            continue
        sole = soles[frame if soles.shape[0] > 1 else 0]
        length = math.sqrt(sole[0] * sole[0] + sole[1] * sole[1]) + sole[4]
        x, y = rotations[frame, 0, 0], rotations[frame, 1, 0]
        level = max(math.sqrt(x * x + y * y), 1e-9)
        copy_matrix(rotations[frame], turned)
        pitch = 0.0
        for _ in range(4):
            rise = ball_above_heel(turned, sole)
            if pitch == 0.0 and (rise >= 0.0) == (states[frame] == HEEL):
                break
            pitch += rise / length
            corrections[frame, 0], corrections[frame, 1] = -pitch * y / level, pitch * x / level
            rotation_vector_to_matrix(corrections[frame, 0], corrections[frame, 1], 0.0, turn)
            multiply(turn, rotations[frame], turned)
    ease_gaps(corrections, states != 0, reach)
    for frame in range(count):
        put_turn(corrected(corrections[frame], turn_in(rotations[frame])), rotations[frame])


@kernel
def ball_above_heel(rotation, sole):
    """How much higher the ball's sole is than the heel's, in metres; 0 for a level foot."""
    ball = rotation[2, 0] * sole[0] + rotation[2, 1] * sole[1] + rotation[2, 2] * sole[2] - sole[2]
    return ball - sole[3] + rotation[2, 0] * sole[4] + rotation[2, 2] * sole[3]


@kernel
def set_heading(matrix, along, across):
    """Write the level rotation (3, 3) whose x axis points (along, across) on the ground."""
    length = math.sqrt(along * along + across * across)
    c, s = (along / length, across / length) if length > 1e-9 else (1.0, 0.0)
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = c, -s, 0.0
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = s, c, 0.0
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = 0.0, 0.0, 1.0


@kernel
def lying_aside(rotation):
    """0 where a foot or toe (3, 3) stands, its sole down however it rolls, 1 where it lies on its side."""
    rolled = smoothstep(min(max(abs(rotation[2, 1]) / ASIDE - 1.0, 0.0), 1.0))
    return rolled * smoothstep(min(max((SOLE_DOWN - rotation[2, 2]) / ASIDE, 0.0), 1.0))


@small_kernel
def toe_heading(foot):
    """(along, across) the ground, of any length: where a standing toe looks, over a steep foot as its instep does."""
    if foot[2, 0] > STEEP:
        return foot[0, 0], foot[1, 0]
    return foot[2, 2] * foot[0, 0] - foot[2, 0] * foot[0, 2], foot[2, 2] * foot[1, 0] - foot[2, 0] * foot[1, 2]


@kernel
def point_down(matrix, pitch):
    """Turn a level rotation (3, 3), in place, about its left axis until its x axis points down by ``pitch``."""
    if pitch != 0.0:
        c, s = math.cos(pitch), math.sin(pitch)
        for axis in range(3):
            x, z = matrix[axis, 0], matrix[axis, 2]
            matrix[axis, 0], matrix[axis, 2] = c * x - s * z, s * x + c * z


@allocating_kernel
def level_toes(feet, toes, states, pitches, reach, out_toes):
    """Toe rotations (F, 3, 3) lying level while the toe stands, heading as the foot; eased in between (METHOD (6)).

    ``pitches`` (F,) in radians by which they point down, on their tips.

    A foot that stands steeply on its tucked toes heads where its instep looks; one that lies on its instep keeps them,
    and one that lies on its side but has their tip come down.
    ``feet`` (F, 3, 3) corrected, ``toes`` (F, 3, 3) relative to the foot; out in the world.
    """
    count = states.shape[0]
    corrections = np.zeros((count, 3))
    known, lies = (states & TOE) != 0, np.zeros(count, np.bool_)
    level, turn, local = np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    level[2, 2] = 1.0
    for frame in range(count):
        if known[frame]:
            foot = feet[frame]
            set_heading(level, *toe_heading(foot))
            share = smoothstep(min(max(1.0 + 2.0 * foot[2, 2], 0.0), 1.0))
            aside = lying_aside(foot)
            lies[frame] = share == 1.0 and aside == 0.0
            point_down(level, pitches[frame])
            if lies[frame]:
                copy_matrix(level, out_toes[frame])
            if not (lies[frame] and is_inside(frame, known)):
                multiply(foot.T, level, local)
                multiply(local, toes[frame].T, turn)
                matrix_to_rotation_vector(turn, corrections[frame])
                corrections[frame] *= share * (1.0 - aside)
                if share < 1.0 or aside > 0.0:
                    lay_tip(foot, toes[frame], pitches[frame], share + aside - share * aside, corrections[frame])
    ease_gaps(corrections, known, reach)
    for frame in range(count):
        if not lies[frame]:
            local_toe = corrected(corrections[frame], turn_in(toes[frame]))
            put_turn(product(turn_in(feet[frame]), local_toe), out_toes[frame])


@allocating_kernel
def lay_tip(foot, toe, pitch, share, correction):
    """Turn a ``toe`` (3, 3) relative to its foot by a ``share`` of the shortest way to pointing down by ``pitch``.

    ``correction`` (3,) the turn that it is to make, a rotation vector in the foot's axes, turned on in place.
    """
    turned = corrected(correction, turn_in(toe))
    x, y, z = 0.0, 0.0, 0.0
    for axis in range(3):
        x += foot[0, axis] * turned[3 * axis]
        y += foot[1, axis] * turned[3 * axis]
        z += foot[2, axis] * turned[3 * axis]
    level = max(math.sqrt(x * x + y * y), 1e-9)
    way = share * (math.atan2(z, level) + pitch) / level
    across = np.empty(3)
    for axis in range(3):
        across[axis] = way * (x * foot[1, axis] - y * foot[0, axis])
    turn = np.empty((3, 3))
    put_turn(corrected(across, corrected(correction, NO_TURN)), turn)
    matrix_to_rotation_vector(turn, correction)


@small_kernel
def is_inside(frame, known):
    """Whether both frames before and after one are ``known`` (F,), so that ``ease_gaps`` does not look at it."""
    return (
        1 < frame < known.shape[0] - 2
        and known[frame - 2]
        and known[frame - 1]
        and known[frame + 1]
        and known[frame + 2]
    )


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
    reach, count, least = np.zeros((last - first, 3)), 0, math.inf
    for frame in range(first, last):
        least = min(least, soles[frame if soles.shape[0] > 1 else 0, 0])
    offsets = np.zeros((3, 3))
    for frame in range(first, last):
        sole = soles[frame if soles.shape[0] > 1 else 0]
        if sole[0] - least > (SMALLEST - 1.0) * abs(least):
            continue
        to_pivots(feet[frame], sole, offsets)
        for axis in range(3):
            reach[count, axis] = offsets[0 if heel else 1, axis] + ankles[frame, axis]
        count += 1
    anchor = np.array([np.median(reach[:count, 0]), np.median(reach[:count, 1])])
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


@kernel
def to_toe(rotation, sole, out_offset):
    """Vector (3,) from ankle to toe joint in the world."""
    for axis in range(3):
        out_offset[axis] = rotation[axis, 0] * sole[0] + rotation[axis, 1] * sole[1] + rotation[axis, 2] * sole[2]


@kernel
def to_pivots(rotation, sole, out_offsets):
    """Vectors (2, 3) in the world from the ankle to what a foot rolls over: the heel's lower edge, the toe joint."""
    for axis in range(3):
        out_offsets[0, axis] = -rotation[axis, 0] * sole[4] - rotation[axis, 2] * sole[3]
    to_toe(rotation, sole, out_offsets[1])


@small_kernel
def tip_rise(sole, pitch):
    """How much higher than in a flat foot the ball is over the tip of a toe that points down by ``pitch``."""
    return sole[5] * math.sin(pitch) - (sole[3] + sole[2]) * (1.0 - math.cos(pitch))


@kernel
def to_tip(rotation, sole, pitch, offsets):
    """``tip_rise`` of a foot.

    Writes the vector from the ankle to that tip into the last of ``offsets`` (3, 3), the others as from ``to_pivots``.
    """
    length, thick = sole[5], sole[3] + sole[2]
    c, s = math.cos(pitch), math.sin(pitch)
    along, across = toe_heading(rotation)
    ahead = (length * c - thick * s) / max(math.sqrt(along * along + across * across), 1e-9)
    offsets[2, 0] = offsets[1, 0] + ahead * along
    offsets[2, 1] = offsets[1, 1] + ahead * across
    rise = tip_rise(sole, pitch)
    offsets[2, 2] = offsets[1, 2] - thick - rise
    return rise


@kernel
def sole_height(rotation, toe_drop, sole):
    """Height of the ankle at which the lowest of heel and ball touches the ground.

    ``toe_drop`` z of the vector ankle to toe in the world.
    """
    heel = rotation[2, 0] * sole[4] + rotation[2, 2] * sole[3]
    ball = sole[3] + sole[2] - toe_drop
    return max(heel, ball)
