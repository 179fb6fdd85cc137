"""Acceleration peaks of solved poses relative to those of the motion (METHOD (36)).

``peaks`` (F, N + 1), in rad/s2 at each frame, has for each of the N joints of the search the angular acceleration of
its rotation away from the motion, for the root's translation that of a bone that follows the root, and in the last
column the greatest angular acceleration of the joints of limbs with constraints. Limbs whose bones rotate in the world
with accelerations well below ``allowed_peak`` (1,) are skipped.
"""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    relative_rotation,
    rotation_from_matrix,
)
from studio.core.kernels.body.parts import limb_parts
from studio.core.kernels.body_indices import SEGMENTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel, small_kernel
from studio.core.kernels.search.joints import ROOT_TRANSLATION
from studio.core.kernels.tasks.goals import RADIAN_LENGTH

ADDED_PEAK_FRACTION, TOTAL_PEAK_FRACTION = 1.2, 2.0
"""Fractions of the source's greatest peak: greatest peak that each joint of the search may add, and greatest peak of
limbs in all, before anything is smoothed.
"""
CALM_PEAK_FRACTION = 0.45 * TOTAL_PEAK_FRACTION
"""Greatest world acceleration of the bones of a skipped limb, as a fraction of the source's peak. A joint has at most
the sum of its bones' accelerations, which then is below ``TOTAL_PEAK_FRACTION``.
"""


_STRAIGHT = 0.9
"""Cosine of an angle above which the angle is computed by the series of its sine."""


@small_kernel
def small_rotation_vector(rotation):
    """Rotation vector (x, y, z) in radians of a rotation well below half a turn; faster than ``rotation_vector``."""
    x, y, z = 0.5 * (rotation[7] - rotation[5]), 0.5 * (rotation[2] - rotation[6]), 0.5 * (rotation[3] - rotation[1])
    cosine = 0.5 * (rotation[0] + rotation[4] + rotation[8] - 1.0)
    squared = x * x + y * y + z * z
    if cosine > _STRAIGHT:
        scale = 1.0 + squared * (1.0 / 6.0 + squared * (3.0 / 40.0 + squared * (15.0 / 336.0)))
    else:
        scale = math.atan2(math.sqrt(squared), cosine) / max(math.sqrt(squared), 1e-9)
    return scale * x, scale * y, scale * z


@kernel
def update_acceleration_peaks(frame, clip):
    """Write the acceleration peaks of the frame before ``frame``, whose neighbours are solved."""
    if frame < 2:
        return
    easing, motion, turned = clip.easing, clip.motion, 0.0
    middle, per_second = frame - 1, easing.rate[0] * easing.rate[0]
    write_searched_peaks(middle, clip.constraints.chain.joints, easing.states, per_second, easing.peaks)
    calm = CALM_PEAK_FRACTION * easing.allowed_peak[0] / per_second
    for limb in range(4):
        if easing.limbs[limb] and not is_calm(limb, middle, calm * calm, motion.positions, motion.rotations):
            turned = max(turned, limb_acceleration(limb, middle, motion.rotations))
    easing.peaks[middle, -1] = per_second * turned


@kernel
def write_smoothed_peaks(joints, states, limbs, rotations, rate, out_peaks):
    """Write the acceleration peaks (F, N + 1) of all frames, from the states and the rotations of the limbs' joints.

    ``rotations`` (F, 16, 3, 3) are those of joints in their parents, four a limb; ``rate`` in frames a second.
    """
    for frame in range(1, rotations.shape[0] - 1):
        write_searched_peaks(frame, joints, states, rate * rate, out_peaks)
        most = 0.0
        for limb in range(4):
            for joint in range(4 * limb, 4 * limb + 3):
                if limbs[limb]:
                    before, now = (
                        rotation_from_matrix(rotations[frame - 1, joint]),
                        rotation_from_matrix(rotations[frame, joint]),
                    )
                    most = max(
                        most, angular_acceleration(before, now, rotation_from_matrix(rotations[frame + 1, joint]))
                    )
        out_peaks[frame, -1] = rate * rate * most


@kernel
def write_searched_peaks(frame, joints, states, per_second, out_peaks):
    """Write one frame's acceleration peaks of the joints of the search; ``per_second`` is the squared frame rate."""
    for joint in range(joints.shape[0]):
        squared = 0.0
        for axis in range(3):
            displacement = (
                states[frame + 1, joint, axis] - 2.0 * states[frame, joint, axis] + states[frame - 1, joint, axis]
            )
            squared += displacement * displacement
        scale = 1.0 / RADIAN_LENGTH if joints[joint].segment == ROOT_TRANSLATION else 2.0
        out_peaks[frame, joint] = per_second * scale * math.sqrt(squared)


@kernel
def segment_peaks(parents, rotations, rate, out_peaks):
    """Write the greatest angular speed (rad/s) and acceleration (rad/s2) of every segment over poses (F, S, 3, 3), into
    (S, 2).

    They are relative to the segment's parent, or to the world for a segment without one (-1).
    """
    for segment in range(parents.shape[0]):
        parent, fastest, most = parents[segment], 0.0, 0.0
        now = rotation_at(0, parent, segment, rotations)
        pace = (0.0, 0.0, 0.0)
        for frame in range(1, rotations.shape[0]):
            before, now = now, rotation_at(frame, parent, segment, rotations)
            last, pace = pace, small_rotation_vector(compose(inverse_rotation(before), now))
            fastest = max(fastest, pace[0] ** 2 + pace[1] ** 2 + pace[2] ** 2)
            if frame > 1:
                most = max(most, (pace[0] - last[0]) ** 2 + (pace[1] - last[1]) ** 2 + (pace[2] - last[2]) ** 2)
        out_peaks[segment, 0], out_peaks[segment, 1] = rate * math.sqrt(fastest), rate * rate * math.sqrt(most)


@small_kernel
def rotation_at(frame, parent, segment, rotations):
    """Rotation tuple of a segment at a frame in the axes of its parent, or of the world if ``parent`` is -1."""
    if parent < 0:
        return rotation_from_matrix(rotations[frame, segment])
    return relative_rotation(rotations[frame, parent], rotations[frame, segment])


@kernel
def is_calm(limb, frame, most, positions, rotations):
    """True if the squared world angular accelerations of a limb's bones and of its hand or foot are at most ``most``.

    In radians a frame squared, by the second differences of the bones' directions.
    """
    _, upper, root = limb_parts(limb, rotations.shape[1] - SEGMENTS_BESIDE_SPINE)
    for bone in range(3):
        squared = length = 0.0
        for axis in range(3):
            displacement = positions[frame, root + bone + 1, axis] - positions[frame, root + bone, axis]
            before = positions[frame - 1, root + bone + 1, axis] - positions[frame - 1, root + bone, axis]
            after = positions[frame + 1, root + bone + 1, axis] - positions[frame + 1, root + bone, axis]
            length += displacement * displacement
            squared += (after - 2.0 * displacement + before) ** 2
        if squared > most * length:
            return False
    squared, end = 0.0, upper + 2
    for axis in range(3):
        displacement = rotations[frame, end, axis, 0]
        squared += (rotations[frame + 1, end, axis, 0] - 2.0 * displacement + rotations[frame - 1, end, axis, 0]) ** 2
    return squared <= most


@kernel
def limb_acceleration(limb, frame, rotations):
    """Greatest angular acceleration of a limb's joints at one frame, in radians a frame squared."""
    before, upper, _ = limb_parts(limb, rotations.shape[1] - SEGMENTS_BESIDE_SPINE)
    most = 0.0
    for bone in range(3):
        most = max(most, joint_acceleration(frame, before, upper + bone, rotations))
        before = upper + bone
    return most


@kernel
def joint_acceleration(frame, parent, segment, rotations):
    """Angular acceleration of a segment relative to its parent at one frame, in radians a frame squared."""
    return angular_acceleration(
        relative_rotation(rotations[frame - 1, parent], rotations[frame - 1, segment]),
        relative_rotation(rotations[frame, parent], rotations[frame, segment]),
        relative_rotation(rotations[frame + 1, parent], rotations[frame + 1, segment]),
    )


@small_kernel
def angular_acceleration(before, now, after):
    """Angular acceleration of a joint from its rotation in three frames, in radians a frame squared."""
    first = small_rotation_vector(compose(inverse_rotation(before), now))
    then = small_rotation_vector(compose(inverse_rotation(now), after))
    return math.sqrt((then[0] - first[0]) ** 2 + (then[1] - first[1]) ** 2 + (then[2] - first[2]) ** 2)
