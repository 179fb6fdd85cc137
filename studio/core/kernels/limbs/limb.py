"""Arms and legs as links of variable length: the analytic heart of the method (METHOD 3)."""

import math

from studio.core.kernels.algebra.turns import product, put_beside, put_turn, sine_and_cosine, turn_by
from studio.core.kernels.compiling import kernel, small_kernel

COMFORT = 0.97
OWN_COMFORT = 0.5 * (1.0 + COMFORT)
"""Part of its length up to which a limb stretches freely (METHOD (11)): where trunk or root help, or a leg is in the
air; and where nothing helps, or the leg stands.
"""
LEANS = math.radians(10.0)
"""By which the bones of a bent limb may lie otherwise than the actor's, where they share its length otherwise, before
its line turns; and twice that is how far they do at most.
"""
_TANGENT = math.tan(LEANS)
STRETCHED = 0.9999
"""Part of its length to which a limb stretches at most: a straight one has no bend of its own."""


@small_kernel
def place_limb(point, segment, frame, limb, pose):
    """Write both segments of a limb, from ``segment`` on, and where they end, from its root ``point`` and its ``frame``
    (K05 section 8; METHOD 3.4, (5)).

    ``frame`` the turn (``kernels.algebra.turns``) whose z axis points to the extremity; ``limb`` and ``pose`` as in
    ``kernels.records``. Returns the extremity's place and the lower bone's turn.
    """
    x, y, z, d = middle_of(limb)
    place = pose.positions[point]
    root = place[0], place[1], place[2]
    put_beside(root, frame, x, y, z, pose.positions[point + 1])
    put_turn(bone_turn(frame, x, y, z, limb.twists[0]), pose.rotations[segment])
    last = bone_turn(frame, -x, -y, d - z, limb.twists[1])
    put_turn(last, pose.rotations[segment + 1])
    return put_beside(root, frame, 0.0, 0.0, d, pose.positions[point + 2]), last


@small_kernel
def middle_of(limb):
    """Place (x, y, z) of the middle joint in the limb's frame, and the distance of its extremity, which is not 0."""
    upper, lower = limb.bones
    d = max(limb.reach, 1e-6)
    z = (upper * upper - lower * lower + d * d) / (2.0 * d)
    radius = math.sqrt(max(0.0, upper * upper - z * z))
    x = min(max(limb.off_plane, -radius), radius)
    return x, limb.bend * math.sqrt(max(0.0, radius * radius - x * x)), z, d


@small_kernel
def bone_turn(frame, x, y, z, twist):
    """Turn of a bone along (x, y, z) in the axes of ``frame``: the shortest way there, then twisted about the bone.

    SA of METHOD (1) from z to v takes x to x - x . v / (1 + z . v) h with h = z + v, and y likewise; where they oppose
    it is half a turn about y.
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
def soft_reach(needed, comfort):
    """Part of its length to which a limb stretches when ``needed`` is asked: all of it up to ``comfort``, then
    a + (1 - a)(1 - exp(-(d - a)/(1 - a))), so that the middle joint never snaps straight (METHOD 6, (11)).
    """
    if needed <= comfort:
        return needed
    room = 1.0 - comfort
    return comfort + room * (1.0 - math.exp(-(needed - comfort) / room))


@kernel
def soft_fold(reach, bones):
    """Metres from its root at which a limb ends that is to end at d, ``reach``: with bones that differ by a in length
    a (1 + exp(d / a - 2)) below 2 a, so that the middle joint never snaps shut (METHOD 3.4).
    """
    apart = abs(bones[0] - bones[1])
    if apart == 0.0 or reach >= 2.0 * apart:
        return reach
    return apart * (1.0 + math.exp(reach / apart - 2.0))


@kernel
def no_nearer(reach, bones):
    """Metres from its root to which a limb's end comes that is brought to ``reach``: where that is nearer than any
    ``soft_fold``, softly no nearer than bones differ.
    """
    least, apart = soft_fold(0.0, bones), abs(bones[0] - bones[1])
    if reach >= least:
        return max(reach, 1e-6)
    return apart + (least - apart) * math.exp((reach - least) / (least - apart))


@small_kernel
def folded(frame, limb, part, reach):
    """The ``frame`` of a ``limb`` so turned in the plane of its bones that they lie nearly as the actor's.

    Of the actor's limb the upper bone is a ``part``, and it reaches ``reach`` of its length. Bones that share theirs
    otherwise lie otherwise on the same line, and folded to the least the longer one lies on it: a knee that is drawn
    up hung down. So beyond some degrees of that the line turns, not the bones.
    """
    x, y, z, d = middle_of(limb)
    across, length = math.sqrt(x * x + y * y), limb.bones[0] + limb.bones[1]
    if across < 1e-9 * length or abs(limb.bones[0] - part * length) < 1e-9 * length:
        return frame
    own = (2.0 * part - 1.0 + reach * reach) / (2.0 * max(reach, 1e-6))  # how far along its line the actor's knee is
    radius = math.sqrt(max(part * part - own * own, 0.0))
    rest, end = reach - own, d - z
    # The turn of each bone from the actor's, as a complex number.
    upper_x, upper_y = own * z + radius * across, radius * z - own * across
    lower_x, lower_y = rest * end + radius * across, radius * end - rest * across
    if abs(upper_y) <= _TANGENT * upper_x and abs(lower_y) <= _TANGENT * lower_x:
        return frame
    off = 0.5 * (math.atan2(upper_y, upper_x) - math.atan2(lower_y, lower_x))
    beyond = max(abs(off) - LEANS, 0.0)
    turn = math.copysign(beyond * beyond / (beyond + LEANS), off) / across
    return product(frame, turn_by(-turn * y, turn * x, 0.0))
