"""Arms and legs as two bones between a root and an end at variable distance, in closed form (METHOD 3)."""

import math

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    rotation_from_vector,
    sine_and_cosine,
    write_rotation,
    write_transformed_point,
)
from studio.core.kernels.compiling import kernel, small_kernel

SOFT_IK_THRESHOLD = 0.97
"""Fraction of its length up to which a limb extends freely (METHOD (11)) if trunk or root may help it, or if it is a
leg in the air.
"""
SOLE_SOFT_IK_THRESHOLD = 0.5 * (1.0 + SOFT_IK_THRESHOLD)
"""Fraction of its length up to which a limb extends freely (METHOD (11)) if nothing else helps it, or if it is a
standing leg.
"""
BONE_LINE_TOLERANCE = math.radians(10.0)
"""Angle in radians between a bone of a bent limb and the actor's, due to different bone ratios, up to which the limb's
frame is not rotated. Beyond it the frame rotates, so that twice this angle is never exceeded.
"""
_TANGENT = math.tan(BONE_LINE_TOLERANCE)
MAX_EXTENSION = 0.9999
"""Greatest extension of a limb as a fraction of its length: a straight limb has no bend direction."""


@small_kernel
def place_limb(point, segment, frame, limb, pose):
    """Write the pose of both bones of a limb and the position of its end, given its ``frame`` and the position of its
    root (K05 section 8; METHOD 3.4, (5)).

    ``point`` and ``segment`` are the indices of the root and of the upper bone; the z axis of ``frame`` points to the
    end; ``limb`` is a ``LimbShape``, ``pose`` a ``Pose``. Returns the position of the end and the rotation of the lower
    bone.
    """
    x, y, z, d = middle_joint(limb)
    position = pose.positions[point]
    root = position[0], position[1], position[2]
    write_transformed_point(root, frame, x, y, z, pose.positions[point + 1])
    write_rotation(bone_rotation(frame, x, y, z, limb.twists[0]), pose.rotations[segment])
    last = bone_rotation(frame, -x, -y, d - z, limb.twists[1])
    write_rotation(last, pose.rotations[segment + 1])
    return write_transformed_point(root, frame, 0.0, 0.0, d, pose.positions[point + 2]), last


@small_kernel
def middle_joint(limb):
    """(x, y, z, d): position of elbow or knee in the limb's frame, and the distance of the limb's end from its root,
    metres.
    """
    upper, lower = limb.bones
    d = max(limb.reach, 1e-6)
    z = (upper * upper - lower * lower + d * d) / (2.0 * d)
    radius = math.sqrt(max(0.0, upper * upper - z * z))
    x = min(max(limb.off_plane, -radius), radius)
    return x, limb.bend * math.sqrt(max(0.0, radius * radius - x * x)), z, d


@small_kernel
def bone_rotation(frame, x, y, z, twist):
    """Rotation of a bone along (x, y, z) in the axes of ``frame``: the shortest arc from z, then ``twist`` about the
    bone.

    SA of METHOD (1) from z to v takes x to x - x . v / (1 + z . v) h with h = z + v, and y likewise; from the opposite
    direction it is half a turn about y.
    """
    across = x * x + y * y
    length = math.sqrt(across + z * z)
    rise = length + z if z > 0.0 else across / (length - z)
    opposed = rise < 1e-200 * length
    k, side = (0.0, -1.0) if opposed else (1.0 / rise, 1.0)
    inverse = 1.0 / length
    hx = inverse * (frame[0] * x + frame[1] * y + frame[2] * rise)
    hy = inverse * (frame[3] * x + frame[4] * y + frame[5] * rise)
    hz = inverse * (frame[6] * x + frame[7] * y + frame[8] * rise)
    ax, bx = side * frame[0] - k * x * hx, frame[1] - k * y * hx
    ay, by = side * frame[3] - k * x * hy, frame[4] - k * y * hy
    az, bz = side * frame[6] - k * x * hz, frame[7] - k * y * hz
    sine, cosine = sine_and_cosine(twist)
    return (
        cosine * ax + sine * bx, cosine * bx - sine * ax, hx - frame[2],
        cosine * ay + sine * by, cosine * by - sine * ay, hy - frame[5],
        cosine * az + sine * bz, cosine * bz - sine * az, hz - frame[8],
    )  # fmt: skip


@kernel
def soft_extension(needed, soft_threshold):
    """Extension of a limb, as a fraction of its length, for a target at distance d = ``needed``, in the same unit
    (METHOD 5, (11)).

    It is d up to the threshold a, then a + (1 - a)(1 - exp(-(d - a)/(1 - a))), so that the middle joint never snaps
    straight.
    """
    if needed <= soft_threshold:
        return needed
    margin = 1.0 - soft_threshold
    return soft_threshold + margin * (1.0 - math.exp(-(needed - soft_threshold) / margin))


@kernel
def soft_flexion(reach, bones):
    """Distance in metres of a limb's end from its root for a target at distance d = ``reach``.

    With bones that differ by a in length it is a (1 + exp(d / a - 2)) for d below 2 a, so that it stays above a, at
    which the middle joint would fold in one frame (METHOD 3.4).
    """
    apart = abs(bones[0] - bones[1])
    if apart == 0.0 or reach >= 2.0 * apart:
        return reach
    return apart * (1.0 + math.exp(reach / apart - 2.0))


@kernel
def soft_minimum_reach(reach, bones):
    """Distance in metres of a limb's end from its root for a target at ``reach``, which may be too near.

    For targets nearer than ``soft_flexion(0, bones)`` it decreases softly towards the difference of the bones' lengths.
    """
    least, apart = soft_flexion(0.0, bones), abs(bones[0] - bones[1])
    if reach >= least:
        return max(reach, 1e-6)
    return apart + (least - apart) * math.exp((reach - least) / (least - apart))


@small_kernel
def match_bone_lines(frame, limb, fraction, reach):
    """Frame of a ``limb``, rotated in its bending plane so that its bones keep the actor's directions despite another
    ratio of their lengths.

    ``fraction`` is the actor's upper bone relative to the limb, ``reach`` the limb's extension. Without this the longer
    bone of a folded limb would lie on the limb's line, so that a raised knee would hang down. The rotation is limited
    to some degrees.
    """
    x, y, z, d = middle_joint(limb)
    across, length = math.sqrt(x * x + y * y), limb.bones[0] + limb.bones[1]
    if across < 1e-9 * length or abs(limb.bones[0] - fraction * length) < 1e-9 * length:
        return frame
    own = (2.0 * fraction - 1.0 + reach * reach) / (
        2.0 * max(reach, 1e-6)
    )  # how far along its line the actor's knee is
    radius = math.sqrt(max(fraction * fraction - own * own, 0.0))
    rest, end = reach - own, d - z
    # The turn of each bone from the actor's, as a complex number.
    upper_x, upper_y = own * z + radius * across, radius * z - own * across
    lower_x, lower_y = rest * end + radius * across, radius * end - rest * across
    if abs(upper_y) <= _TANGENT * upper_x and abs(lower_y) <= _TANGENT * lower_x:
        return frame
    off = 0.5 * (math.atan2(upper_y, upper_x) - math.atan2(lower_y, lower_x))
    beyond = max(abs(off) - BONE_LINE_TOLERANCE, 0.0)
    rotation = math.copysign(beyond * beyond / (beyond + BONE_LINE_TOLERANCE), off) / across
    return compose(frame, rotation_from_vector(-rotation * y, rotation * x, 0.0))
