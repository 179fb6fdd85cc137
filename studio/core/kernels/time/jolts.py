"""How sharply what was solved changes its way from frame to frame, beside what the motion itself does (METHOD (36)).

Of joints that a search turns it is the angular acceleration of their turns away from the motion, of its root that which
a bone would have that follows; of limbs that constraints are about that of their own joints. ``jolts`` (F, 3) has the
greatest of each at each frame, in radians a second squared. Bones of a limb that turn in the world well below the
``peak`` (1,) of the unsolved motion are not looked at closer.
"""

import math

from studio.core.kernels.algebra.turns import inverse, product, turn_between, turn_in
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.search.joints import ROOT
from studio.core.kernels.tasks.goals import TURN_ARM

ADDED, WHOLE = 1.2, 2.0
"""Parts of the source's peak that joints of a search may add, and that limbs may turn with in all, for nobody to look
closer.
"""
CALM = 0.45 * WHOLE
"""Part of the source's peak up to which bones of a limb may turn in the world for its joints to be below ``WHOLE``: a
joint has at most what both of its bones have together.
"""


_STRAIGHT = 0.9
"""Cosine of a turn up to which its angle is the series of its sine's."""


@small_kernel
def small_vector(turn):
    """Rotation vector (3 numbers, radians) of a turn that is well below half a turn.

    ``rotation_vector`` says the same more slowly: a sixth of what a frame with one reachable limb costs.
    """
    x, y, z = 0.5 * (turn[7] - turn[5]), 0.5 * (turn[2] - turn[6]), 0.5 * (turn[3] - turn[1])
    cosine = 0.5 * (turn[0] + turn[4] + turn[8] - 1.0)
    squared = x * x + y * y + z * z
    if cosine > _STRAIGHT:
        scale = 1.0 + squared * (1.0 / 6.0 + squared * (3.0 / 40.0 + squared * (15.0 / 336.0)))
    else:
        scale = math.atan2(math.sqrt(squared), cosine) / max(math.sqrt(squared), 1e-9)
    return scale * x, scale * y, scale * z


@kernel
def note_jolts(frame, clip):
    """Note the frame before ``frame``, whose state and pose are there as are those of the two before."""
    if frame < 2:
        return
    easing, motion, turned = clip.easing, clip.motion, 0.0
    middle, per_second = frame - 1, easing.rate[0] * easing.rate[0]
    note_searched(middle, clip.asked.chain.joints, easing.states, per_second, easing.jolts)
    calm = CALM * easing.peak[0] / per_second
    for limb in range(4):
        if easing.limbs[limb] and not is_calm(limb, middle, calm * calm, motion.positions, motion.rotations):
            turned = max(turned, limb_jolt(limb, middle, motion.rotations))
    easing.jolts[middle, 2] = per_second * turned


@kernel
def note_eased_jolts(joints, states, limbs, turns, rate, out_jolts):
    """The same of all frames by their states and the ``turns`` (F, 16, 3, 3) of their limbs' joints, four a limb."""
    for middle in range(1, turns.shape[0] - 1):
        note_searched(middle, joints, states, rate * rate, out_jolts)
        most = 0.0
        for limb in range(4):
            for joint in range(4 * limb, 4 * limb + 3):
                if limbs[limb]:
                    before, now = turn_in(turns[middle - 1, joint]), turn_in(turns[middle, joint])
                    most = max(most, change_of_pace(before, now, turn_in(turns[middle + 1, joint])))
        out_jolts[middle, 2] = rate * rate * most


@kernel
def note_searched(middle, joints, states, per_second, out_jolts):
    """Note one frame's jolts of the root and of the other joints of a search."""
    out_jolts[middle, 0] = out_jolts[middle, 1] = 0.0
    for joint in range(joints.shape[0]):
        squared = 0.0
        for axis in range(3):
            way = states[middle + 1, joint, axis] - 2.0 * states[middle, joint, axis] + states[middle - 1, joint, axis]
            squared += way * way
        column, scale = (0, 1.0 / TURN_ARM) if joints[joint].segment == ROOT else (1, 2.0)
        out_jolts[middle, column] = max(out_jolts[middle, column], per_second * scale * math.sqrt(squared))


@kernel
def note_peaks(carriers, rotations, rate, out_peaks):
    """Note the greatest pace, and change of pace, of every segment of poses (F, S, 3, 3), ``out_peaks`` (S, 2).

    In radians a second, and a second squared; of what has no carrier (-1) it is that in the world.
    """
    for segment in range(carriers.shape[0]):
        carrier, fastest, most = carriers[segment], 0.0, 0.0
        now = carried(0, carrier, segment, rotations)
        pace = (0.0, 0.0, 0.0)
        for frame in range(1, rotations.shape[0]):
            before, now = now, carried(frame, carrier, segment, rotations)
            last, pace = pace, small_vector(product(inverse(before), now))
            fastest = max(fastest, pace[0] ** 2 + pace[1] ** 2 + pace[2] ** 2)
            if frame > 1:
                most = max(most, (pace[0] - last[0]) ** 2 + (pace[1] - last[1]) ** 2 + (pace[2] - last[2]) ** 2)
        out_peaks[segment, 0], out_peaks[segment, 1] = rate * math.sqrt(fastest), rate * rate * math.sqrt(most)


@small_kernel
def carried(frame, carrier, segment, rotations):
    """Turn of a segment at a frame in the axes of its carrier, or in the world's."""
    if carrier < 0:
        return turn_in(rotations[frame, segment])
    return turn_between(rotations[frame, carrier], rotations[frame, segment])


@kernel
def is_calm(limb, middle, most, positions, rotations):
    """Whether the bones of a limb, and hand or foot about itself, turn in the world by less than the root of ``most``.

    In radians a frame squared, by the second differences of their directions.
    """
    _, upper, root = limb_parts(limb, rotations.shape[1] - 18)
    for bone in range(3):
        squared = length = 0.0
        for axis in range(3):
            way = positions[middle, root + bone + 1, axis] - positions[middle, root + bone, axis]
            before = positions[middle - 1, root + bone + 1, axis] - positions[middle - 1, root + bone, axis]
            after = positions[middle + 1, root + bone + 1, axis] - positions[middle + 1, root + bone, axis]
            length += way * way
            squared += (after - 2.0 * way + before) ** 2
        if squared > most * length:
            return False
    squared, end = 0.0, upper + 2
    for axis in range(3):
        way = rotations[middle, end, axis, 0]
        squared += (rotations[middle + 1, end, axis, 0] - 2.0 * way + rotations[middle - 1, end, axis, 0]) ** 2
    return squared <= most


@kernel
def limb_jolt(limb, middle, rotations):
    """The greatest change of pace of a limb's joints at one frame, in radians a frame squared."""
    before, upper, _ = limb_parts(limb, rotations.shape[1] - 18)
    most = 0.0
    for bone in range(3):
        most = max(most, joint_jolt(middle, before, upper + bone, rotations))
        before = upper + bone
    return most


@kernel
def joint_jolt(middle, carrier, segment, rotations):
    """``change_of_pace`` of a segment in what carries it."""
    return change_of_pace(
        turn_between(rotations[middle - 1, carrier], rotations[middle - 1, segment]),
        turn_between(rotations[middle, carrier], rotations[middle, segment]),
        turn_between(rotations[middle + 1, carrier], rotations[middle + 1, segment]),
    )


@small_kernel
def change_of_pace(before, now, after):
    """By how much the pace of a joint changes over three frames of its turn, in radians a frame squared."""
    first = small_vector(product(inverse(before), now))
    then = small_vector(product(inverse(now), after))
    return math.sqrt((then[0] - first[0]) ** 2 + (then[1] - first[1]) ** 2 + (then[2] - first[2]) ** 2)
