"""Limits of the joints of limbs, and limbs that are brought back within them (METHOD 6, (25) to (28)).

``limits`` (4,), a record a limb, none where joints are free, holds for all frames, of shoulder or hip and of wrist or
ankle: ``axes`` (2, 3, 3) of the joint at the middle of its range in the segment that carries it (z along the bone),
``radii`` (2, 4) how far the bone swings from there about x, about -x, y and -y, ``twists`` (2, 2) the middle and the
half of the range of its turn about itself, ``well`` (2, 4) cosines of three quarters of the least radius and of half
the range, cosine and sine of its middle; and of elbow or knee ``bends`` (2,), ``aslant`` and ``turns`` (2,), in
radians. For one frame: what the unsolved pose has of all these, ``own_swings`` (2, 2), ``own_parts`` (2,) of the
limit, ``own_twists`` (2,), ``own_bend``, ``own_slant``, ``own_turn``; ``caps`` (2, 3) the parts of its limits that
swing, twist and twist back may take now, ``agreed`` (2, 3) those that stay for all of a search, ``fresh`` whether these
are not noted yet, and both as they were when the level began; ``sure``, less than 1 where a goal could be met by either
way round; ``tip_turns`` whether wrist or ankle has turned; ``lets_go`` the part of what hand or foot are beyond by
which they are drawn back, 0 for a foot that stands, which no limit turns; ``acts`` whether a limit has moved the limb,
and ``blocks`` the task whose goal the limits keep it from, -1 for none. The unsolved pose is never limited: where it is
beyond, the limit is as far as it goes.
"""

import math

import numpy as np

from studio.core.kernels.algebra.turns import inverse, product, turn_by, turn_in
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.body.parts import limb_parts, turn_part
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.swing_twist import (
    bend_of,
    into,
    part_of_range,
    part_of_swing,
    swing_and_twist,
    swing_slope,
    turned_about,
    twist_slope,
)

_REAL = np.float64
LIMITED = np.dtype(
    [
        ("axes", _REAL, (2, 3, 3)),
        ("radii", _REAL, (2, 4)),
        ("twists", _REAL, (2, 2)),
        ("well", _REAL, (2, 4)),
        ("bends", _REAL, (2,)),
        ("aslant", _REAL),
        ("turns", _REAL, (2,)),
        ("own_swings", _REAL, (2, 2)),
        ("own_parts", _REAL, (2,)),
        ("own_twists", _REAL, (2,)),
        ("own_bend", _REAL),
        ("own_slant", _REAL),
        ("own_turn", _REAL),
        ("caps", _REAL, (2, 3)),
        ("agreed", _REAL, (2, 3)),
        ("kept_caps", _REAL, (2, 3)),
        ("kept_fresh", np.int64),
        ("sure", _REAL),
        ("tip_turns", np.int64),
        ("lets_go", _REAL),
        ("fresh", np.int64),
        ("acts", np.int64),
        ("blocks", np.int64),
    ],
    align=True,
)
BRAKED = 0.95
"""Part of its limit from which on a joint gives way ever more, so that it never stops at once."""
SWIVELLED, SWIVELLED_TO = 0.75, 0.92
"""Parts of its limit between which a limb swivels back, if that leaves its point in place."""
WALK = 10
"""Steps of a swivel towards a secondary task's goal."""
BRAKING = 0.1
"""Part of a secondary task's swivel that brakes take before it counts as braked."""
UNTWISTED = 0.3
"""Part of a swing's limit beyond it by which the motion's own twist is the best."""
FADE = 0.7
"""Radians short of a half turn, beyond any limit, within which a goal fades: it could be met by either way round."""


@kernel
def swing_of(row, joint, parent, child):
    """``swing_and_twist`` of a segment's rotation ``child`` in its joint."""
    axes = row.axes[joint]
    x = into(parent, axes, child[0, 0], child[1, 0], child[2, 0])
    z = into(parent, axes, child[0, 2], child[1, 2], child[2, 2])
    return swing_and_twist(x, z)


@kernel
def soft(value, own, free, most):
    """``value`` up to ``free``, from there ever less, never ``most``; both are at least what the motion has, ``own``.

    f + (m - f)(1 - exp(-(v - f)/(m - f))) (27).
    """
    free, most = max(free, own), max(most, own)
    if value <= free:
        return value
    room = most - free
    return free + room * (1.0 - math.exp((free - value) / room)) if room > 1e-9 else free


@kernel
def soft_part(part, own, free, most):
    """``soft`` on either side of nought."""
    return soft(part, own, free, most) if part >= 0.0 else -soft(-part, -own, free, most)


@kernel
def surely(angle, edge):
    """1 where an angle beyond a limit at ``edge`` is far from half a turn, fading to 0 there."""
    share = min(max(math.pi - angle, 0.0) / max(min(FADE, math.pi - edge), 1e-6), 1.0)
    return share * share * (3.0 - 2.0 * share)


@kernel
def note_own(limb, joints, limits, pose):
    """Note what the unsolved ``pose`` has of one limb: of its root, and if ``joints`` is 2 of wrist or ankle."""
    row, rotations = limits[limb], pose.rotations
    carrier, upper, _ = limb_parts(limb, rotations.shape[0] - 18)
    for joint in range(joints):
        parent = rotations[carrier if joint == 0 else upper + 1]
        x, y, twist = swing_of(row, joint, parent, rotations[upper + 2 * joint])
        row.own_swings[joint, 0], row.own_swings[joint, 1], row.own_twists[joint] = x, y, twist
        row.own_parts[joint] = part_of_swing(row.radii[joint], x, y)
        note_caps(row, joint, (x, y, twist))
        copy_point(row.caps[joint], row.agreed[joint])
    row.own_bend, row.own_slant, row.own_turn = bend_of(rotations[upper], rotations[upper + 1])
    row.acts, row.blocks, row.fresh = 0, -1, 1


@kernel
def keep_caps(limits):
    """Note how far joints may go, should the level that begins be given up."""
    for limb in range(limits.shape[0]):
        row = limits[limb]
        row.kept_fresh = row.fresh
        for joint in range(2):
            copy_point(row.agreed[joint], row.kept_caps[joint])


@kernel
def restore_caps(limits):
    """Joints may go as far as when the level began."""
    for limb in range(limits.shape[0]):
        row = limits[limb]
        row.fresh = row.kept_fresh
        for joint in range(2):
            copy_point(row.kept_caps[joint], row.agreed[joint])


@kernel
def is_well_within(limb, joint, limits, rotations):
    """Whether a joint is so far within its limits that nobody need look closer."""
    row = limits[limb]
    carrier, upper, _ = limb_parts(limb, rotations.shape[0] - 18)
    parent, child = rotations[carrier if joint == 0 else upper + 1], rotations[upper + 2 * joint]
    axes, well = row.axes[joint], row.well[joint]
    z = into(parent, axes, child[0, 2], child[1, 2], child[2, 2])
    if z[2] < well[0]:
        return False
    x = into(parent, axes, child[0, 0], child[1, 0], child[2, 0])
    cosine, sine = x[0] + z[2] * x[0] - z[0] * x[2], x[1] - (z[1] * x[2] - z[2] * x[1])
    return bool(well[2] * cosine + well[3] * sine > well[1] * (1.0 + z[2]))


@kernel
def note_caps(row, joint, swing):
    """Note how far a joint goes that wants to be at ``swing_and_twist``: as far as that up to ``BRAKED``, then softly.

    METHOD (27).
    """
    own, own_turn = (
        row.own_parts[joint],
        part_of_range(row.twists[joint, 0], row.twists[joint, 1], row.own_twists[joint]),
    )
    part = part_of_swing(row.radii[joint], swing[0], swing[1])
    turn = part_of_range(row.twists[joint, 0], row.twists[joint, 1], swing[2])
    row.caps[joint, 0] = max(soft(part, own, BRAKED, 1.0), max(own, BRAKED))
    row.caps[joint, 1] = max(soft(turn, own_turn, BRAKED, 1.0), max(own_turn, BRAKED))
    row.caps[joint, 2] = max(soft(-turn, -own_turn, BRAKED, 1.0), max(-own_turn, BRAKED))


@kernel
def twisted_back(row, joint, swing):
    """``swing_and_twist`` with a twist within its range, and the more of the motion's own the further out it is.

    Opposite to the middle of its range a twist might come back by either way round, and so might every twist there is
    where the bone lies opposite to the middle of its swings: in both places there is none but the motion's own.
    """
    x, y, twist = swing
    middle, half = row.twists[joint, 0], row.twists[joint, 1]
    part, turn, own = part_of_swing(row.radii[joint], x, y), part_of_range(middle, half, twist), row.own_twists[joint]
    own_turn = part_of_range(middle, half, own)
    least, most = min(own_turn, -1.0), max(own_turn, 1.0)
    kept = min(max(turn, least), most)
    if kept == turn and part <= max(BRAKED, row.own_parts[joint]):
        return swing
    share = eased_off(abs(turn - kept) * half / (math.pi - half * abs(kept))) if kept != turn else 1.0
    share *= eased_off((part - max(BRAKED, row.own_parts[joint])) / UNTWISTED)
    return x, y, middle + half * (own_turn + share * (kept - own_turn))


@kernel
def eased_off(share):
    """1 at 0 and below, 0 at 1 and beyond, smoothly between."""
    share = min(max(share, 0.0), 1.0)
    return 1.0 - share * share * (3.0 - 2.0 * share)


@kernel
def drawn_back(row, joint, swing):
    """``swing_and_twist`` (3,) no further than ``note_caps`` says, and how sure that is."""
    x, y, twist = swing
    own_x, own_y, own_part = row.own_swings[joint, 0], row.own_swings[joint, 1], row.own_parts[joint]
    part = part_of_swing(row.radii[joint], x, y)
    kept = min(part, row.caps[joint, 0])
    middle, half = row.twists[joint, 0], row.twists[joint, 1]
    turn = part_of_range(middle, half, twist)
    kept_turn = min(max(turn, -row.caps[joint, 2]), row.caps[joint, 1])
    if kept == part and kept_turn == turn:
        return x, y, twist, 1.0
    share = 1.0
    if kept != part:
        angle = math.sqrt(x * x + y * y)
        share = surely(angle, max(1.0, own_part) * angle / part)
        x, y = own_x + share * (kept / part * x - own_x), own_y + share * (kept / part * y - own_y)
    return x, y, middle + half * kept_turn, share


@kernel
def braked_swivel(row, parent, upper, ax, ay, az, asked):
    """How much of a swivel by ``asked`` about a world axis there is until the limits, which brake it ever more.

    Walked in ``WALK`` steps from where the limb is: drawn back from beyond, it would come back by either way round. So
    it would be where half a turn is asked: one that is braked fades there.
    """
    axes, radii, well = row.axes[0], row.radii[0], row.well[0]
    middle, half = row.twists[0, 0], row.twists[0, 1]
    own = part_of_range(middle, half, row.own_twists[0])
    x0 = into(parent, axes, upper[0, 0], upper[1, 0], upper[2, 0])
    z0 = into(parent, axes, upper[0, 2], upper[1, 2], upper[2, 2])
    a = into(parent, axes, ax, ay, az)
    angle, x, z = 0.0, x0, z0
    for _ in range(WALK):
        left = 1.0
        cosine, sine = x[0] + z[2] * x[0] - z[0] * x[2], x[1] - (z[1] * x[2] - z[2] * x[1])
        if z[2] < well[0] or well[2] * cosine + well[3] * sine <= well[1] * (1.0 + z[2]):
            sx, sy, twist = swing_and_twist(x, z)
            turn = part_of_range(middle, half, twist)
            part = part_of_swing(radii, sx, sy)
            out, on = swing_slope(radii, z, sx, sy, part), twist_slope(z)
            if asked * (a[0] * out[0] + a[1] * out[1] + a[2] * out[2]) > 0.0:
                left = min(left, left_of(part, row.own_parts[0]))
            if asked * turn * (a[0] * on[0] + a[1] * on[1] + a[2] * on[2]) > 0.0:
                left = min(left, left_of(abs(turn), own if turn > 0.0 else -own))
        angle += left * asked / WALK
        x, z = turned_about(a, angle, x0), turned_about(a, angle, z0)
    braked = min(1.0 - angle / asked, BRAKING) / BRAKING if asked != 0.0 else 0.0
    return angle * (1.0 - braked * (1.0 - surely(abs(asked), 0.0)))


@kernel
def left_of(part, own):
    """What brakes leave of a turn that goes towards a limit: 1 up to ``SWIVELLED``, 0 from ``SWIVELLED_TO`` on."""
    free, most = max(SWIVELLED, own), max(SWIVELLED_TO, own)
    return min(max((most - part) / max(most - free, 1e-3), 0.0), 1.0)


@kernel
def keep_joint(limb, joint, anew, noting, limits, pose):
    """Draw shoulder or hip (``joint`` 0), or wrist or ankle (1) as far as its end does not stand, back within its
    limits; whether that was needed.

    ``anew``: from where a task has put it; ``noting`` how far it goes for that.
    """
    positions, rotations = pose
    row, part = limits[limb], 1.0
    carrier, segment, root = limb_parts(limb, positions.shape[0] - 23)
    if joint == 1:
        carrier, segment, root, part = segment + 1, segment + 2, root + 2, row.lets_go
        if part == 0.0:
            return False
    swing = swing_of(row, joint, rotations[carrier], rotations[segment])
    asked = twisted_back(row, joint, swing) if anew else swing
    if noting:
        note_caps(row, joint, asked)
    x, y, twist, sure = drawn_back(row, joint, asked)
    row.sure = min(row.sure, sure)
    if x == swing[0] and y == swing[1] and twist == swing[2]:
        return False
    axes = product(turn_in(rotations[carrier]), turn_in(row.axes[joint]))
    wanted = product(axes, product(turn_by(x, y, 0.0), turn_by(0.0, 0.0, twist)))
    turn_to(segment, positions[root], wanted, part, positions, rotations)
    row.acts = 1
    return True


@kernel
def keep_middle(limb, limits, pose):
    """Draw a forearm or shank that was turned for itself back to what elbow or knee can do."""
    _, upper, root = limb_parts(limb, pose.positions.shape[0] - 23)
    return keep_bend(limits[limb], upper, pose.positions[root + 1], pose)


@kernel
def keep_bend(row, upper, pivot, pose):
    """Draw one elbow or knee back within its limits; whether that was needed."""
    positions, rotations = pose
    bend, slant, turn = bend_of(rotations[upper], rotations[upper + 1])
    middle, half = 0.5 * (row.bends[0] + row.bends[1]), 0.5 * (row.bends[1] - row.bends[0])
    part, own_part = part_of_range(middle, half, bend), part_of_range(middle, half, row.own_bend)
    twist, own_twist = (
        part_of_range(row.turns[0], row.turns[1], turn),
        part_of_range(row.turns[0], row.turns[1], row.own_turn),
    )
    tilt, own_tilt = slant / row.aslant, row.own_slant / row.aslant
    kept, kept_twist = soft_part(part, own_part, BRAKED, 1.0), soft_part(twist, own_twist, BRAKED, 1.0)
    kept_tilt = soft_part(tilt, own_tilt, BRAKED, 1.0)
    if kept == part and kept_twist == twist and kept_tilt == tilt:
        return False
    share = surely(0.5 * math.pi + abs(slant), 0.5 * math.pi + row.aslant) if kept_tilt != tilt else 1.0
    bent = share * (surely(half * abs(part), half * max(1.0, abs(own_part))) if kept != part else 1.0)
    twisted = share * (
        surely(row.turns[1] * abs(twist), row.turns[1] * max(1.0, abs(own_twist))) if kept_twist != twist else 1.0
    )
    bend = middle + half * (own_part + bent * (kept - own_part))
    slant = row.aslant * (own_tilt + share * (kept_tilt - own_tilt))
    turn = row.turns[0] + row.turns[1] * (own_twist + twisted * (kept_twist - own_twist))
    bent = product(turn_by(bend, 0.0, 0.0), product(turn_by(0.0, slant, 0.0), turn_by(0.0, 0.0, turn)))
    turn_to(upper + 1, pivot, product(turn_in(rotations[upper]), bent), 1.0, positions, rotations)
    row.acts = 1
    return True


@kernel
def turn_to(segment, pivot, wanted, part, positions, rotations):
    """Turn a segment, and what hangs on it, about ``pivot`` by ``part`` of the way to the rotation ``wanted``.

    By a turn made exact: what a rotation lacks of one would be doubled every time.
    """
    turn = product(wanted, inverse(turn_in(rotations[segment])))
    x, y, z = turn[7] - turn[5], turn[2] - turn[6], turn[3] - turn[1]
    size = math.sqrt(x * x + y * y + z * z)
    angle = math.atan2(size, turn[0] + turn[4] + turn[8] - 1.0)
    scale = part * (angle / size if size > 1e-12 else 0.5)
    exact = turn_by(scale * x, scale * y, scale * z)
    turn_part(exact, segment, positions.shape[0] - 23, pivot, positions, rotations)
