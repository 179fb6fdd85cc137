"""Joint limits of limbs, and clamping of limbs to them (METHOD 10, (25) to (28)).

``limits`` (4,) has one ``LIMB_LIMITS`` record for each limb, and is empty where joints are free. Clamping is soft: a
*cap* is the fraction of a limit that a clamped angle may reach. The unsolved pose is never limited: where it is beyond
a limit, its own angle is the limit.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation_tuples import (
    compose,
    inverse_rotation,
    rotation_from_matrix,
    rotation_from_vector,
)
from studio.core.kernels.algebra.vectors import copy_point
from studio.core.kernels.body.parts import limb_parts, rotate_part
from studio.core.kernels.body_indices import POINTS_BESIDE_SPINE, SEGMENTS_BESIDE_SPINE
from studio.core.kernels.compiling import kernel
from studio.core.kernels.limits.swing_twist import (
    bend_carrying_twist,
    direction_in_axes,
    range_fraction,
    rotate_about_axis,
    swing_and_twist,
    swing_fraction,
    swing_gradient,
    twist_gradient,
)

_REAL = np.float64
LIMB_LIMITS = np.dtype(
    [
        ("axes", _REAL, (2, 3, 3)),  # in the parent segment, z along the bone
        ("radii", _REAL, (2, 4)),  # greatest swing about x, -x, y and -y
        ("twists", _REAL, (2, 2)),  # middle and half of the twist's range
        ("inner_cosines", _REAL, (2, 4)),  # bounds of ``is_well_within``
        ("bends", _REAL, (2,)),  # least and greatest bend of elbow or knee
        ("aslant", _REAL),  # greatest slant of elbow or knee
        ("turns", _REAL, (2,)),  # middle and half of the range of the lower bone's twist
        ("own_swings", _REAL, (2, 2)),  # swing x and y of the unsolved pose
        ("own_fractions", _REAL, (2,)),  # unsolved swing, as a fraction of its limit
        ("own_twists", _REAL, (2,)),  # unsolved twist
        ("own_bend", _REAL),  # of elbow or knee in the unsolved pose
        ("own_slant", _REAL),
        ("own_turn", _REAL),
        ("caps", _REAL, (2, 3)),  # present caps of swing, twist and reverse twist
        ("agreed_caps", _REAL, (2, 3)),  # caps for the whole search
        ("kept_caps", _REAL, (2, 3)),  # ``agreed_caps`` when the level began
        ("kept_caps_unset", np.int64),  # ``caps_unset`` when the level began
        ("certainty", _REAL),  # below 1 if either direction of rotation could lead to the goal
        ("end_rotates", np.int64),  # 1 if wrist or ankle has rotated
        ("release", _REAL),  # fraction of its excess by which hand or foot is clamped, 0 for a planted foot
        ("caps_unset", np.int64),  # 1 until the caps of the search are known
        ("is_active", np.int64),  # 1 if a limit has moved the limb
        ("blocked_task", np.int64),  # task that limits keep from its goal, -1 none
    ],
    align=True,
)
"""Joint limits of a limb, and their state at one frame.

Fields of two are those of shoulder or hip, and of wrist or ankle. Angles are in radians; a joint's axes are those at
the middle of its range.
"""
SOFT_LIMIT_FRACTION = 0.95
"""Fraction of a joint's limit from which it is clamped softly, so that the joint never stops at once."""
SWIVEL_SOFT_LIMIT_FRACTION, SWIVEL_LIMIT_FRACTION = 0.75, 0.92
"""Fractions of a joint's limit at which the damping of a swivel begins, and at which the swivel stops."""
SWIVEL_STEPS = 10
"""Integration steps of a swivel towards a secondary task's goal."""
DAMPED_SWIVEL_FRACTION = 0.1
"""Fraction of a secondary task's swivel that damping has removed when the swivel counts as fully damped."""
UNTWIST_RANGE = 0.3
"""Excess of a swing, as a fraction of its limit, at which the clamped twist is replaced by the motion's own."""
HALF_TURN_FADE_ANGLE = 0.7
"""Angle in radians before half a turn, beyond any limit, within which a goal fades: either direction of rotation would
lead to it.
"""


@kernel
def swing_of(row, joint, parent, child):
    """(swing x, swing y, twist) in radians of the world rotation ``child`` of a segment, in the axes of its joint."""
    axes = row.axes[joint]
    x = direction_in_axes(parent, axes, child[0, 0], child[1, 0], child[2, 0])
    z = direction_in_axes(parent, axes, child[0, 2], child[1, 2], child[2, 2])
    return swing_and_twist(x, z)


@kernel
def soft_clamp_above(value, own, free, most):
    """``value`` up to the threshold f = ``free``, then f + (m - f)(1 - exp(-(v - f)/(m - f))), below m = ``most``
    (METHOD (27)).

    Threshold and limit are at least the motion's ``own`` value.
    """
    free, most = max(free, own), max(most, own)
    if value <= free:
        return value
    margin = most - free
    return free + margin * (1.0 - math.exp((free - value) / margin)) if margin > 1e-9 else free


@kernel
def soft_clamp_both(fraction, own, free, most):
    """``fraction`` clamped softly as by ``soft_clamp_above``, at both signs: threshold ``free``, limit ``most``,
    motion's value ``own``.
    """
    return (
        soft_clamp_above(fraction, own, free, most)
        if fraction >= 0.0
        else -soft_clamp_above(-fraction, -own, free, most)
    )


@kernel
def half_turn_certainty(angle, edge):
    """Weight in [0, 1] of a clamped angle beyond its limit ``edge`` (radians): it fades to 0 as the angle nears half a
    turn, where the nearer limit is ambiguous.
    """
    fraction = min(max(math.pi - angle, 0.0) / max(min(HALF_TURN_FADE_ANGLE, math.pi - edge), 1e-6), 1.0)
    return fraction * fraction * (3.0 - 2.0 * fraction)


@kernel
def note_unsolved_angles(limb, joints, limits, pose):
    """Write the joint angles of one limb in the unsolved ``pose`` into its ``LIMB_LIMITS`` record.

    With ``joints`` 1 those of shoulder or hip and elbow or knee, with 2 also those of wrist or ankle.
    """
    row, rotations = limits[limb], pose.rotations
    carrier, upper, _ = limb_parts(limb, rotations.shape[0] - SEGMENTS_BESIDE_SPINE)
    for joint in range(joints):
        parent = rotations[carrier if joint == 0 else upper + 1]
        x, y, twist = swing_of(row, joint, parent, rotations[upper + 2 * joint])
        row.own_swings[joint, 0], row.own_swings[joint, 1], row.own_twists[joint] = x, y, twist
        row.own_fractions[joint] = swing_fraction(row.radii[joint], x, y)
        update_caps(row, joint, (x, y, twist))
        copy_point(row.caps[joint], row.agreed_caps[joint])
    row.own_bend, row.own_slant, row.own_turn = bend_carrying_twist(rotations[upper], rotations[upper + 1])
    row.is_active, row.blocked_task, row.caps_unset = 0, -1, 1


@kernel
def save_caps(limits):
    """Save the soft upper bounds (caps) of all limbs at the start of a level."""
    for limb in range(limits.shape[0]):
        row = limits[limb]
        row.kept_caps_unset = row.caps_unset
        for joint in range(2):
            copy_point(row.agreed_caps[joint], row.kept_caps[joint])


@kernel
def restore_caps(limits):
    """Restore the soft upper bounds (caps) saved at the start of the level."""
    for limb in range(limits.shape[0]):
        row = limits[limb]
        row.caps_unset = row.kept_caps_unset
        for joint in range(2):
            copy_point(row.kept_caps[joint], row.agreed_caps[joint])


@kernel
def is_well_within(limb, joint, limits, rotations):
    """True if a joint is so far within its limits that no clamping has to be computed."""
    row = limits[limb]
    carrier, upper, _ = limb_parts(limb, rotations.shape[0] - SEGMENTS_BESIDE_SPINE)
    parent, child = rotations[carrier if joint == 0 else upper + 1], rotations[upper + 2 * joint]
    axes, well = row.axes[joint], row.inner_cosines[joint]
    z = direction_in_axes(parent, axes, child[0, 2], child[1, 2], child[2, 2])
    if z[2] < well[0]:
        return False
    x = direction_in_axes(parent, axes, child[0, 0], child[1, 0], child[2, 0])
    cosine, sine = x[0] + z[2] * x[0] - z[0] * x[2], x[1] - (z[1] * x[2] - z[2] * x[1])
    return bool(well[2] * cosine + well[3] * sine > well[1] * (1.0 + z[2]))


@kernel
def update_caps(row, joint, swing):
    """Update the soft upper bounds (caps) of a joint for a requested ``swing``: the swing itself up to
    ``SOFT_LIMIT_FRACTION``, then softly less (METHOD (27)).
    """
    own, own_turn = (
        row.own_fractions[joint],
        range_fraction(row.twists[joint, 0], row.twists[joint, 1], row.own_twists[joint]),
    )
    fraction = swing_fraction(row.radii[joint], swing[0], swing[1])
    rotation = range_fraction(row.twists[joint, 0], row.twists[joint, 1], swing[2])
    row.caps[joint, 0] = max(soft_clamp_above(fraction, own, SOFT_LIMIT_FRACTION, 1.0), max(own, SOFT_LIMIT_FRACTION))
    row.caps[joint, 1] = max(
        soft_clamp_above(rotation, own_turn, SOFT_LIMIT_FRACTION, 1.0), max(own_turn, SOFT_LIMIT_FRACTION)
    )
    row.caps[joint, 2] = max(
        soft_clamp_above(-rotation, -own_turn, SOFT_LIMIT_FRACTION, 1.0), max(-own_turn, SOFT_LIMIT_FRACTION)
    )


@kernel
def clamped_twist(row, joint, swing):
    """(swing x, swing y, twist) with the twist clamped to its range; the farther out it was, the more it is blended to
    the source motion's twist.

    Opposite to the middle of its range a twist could return in either direction, and so could any twist of a bone
    opposite to the middle of its swings: in both places the source motion's twist is used, which never flips.
    """
    x, y, twist = swing
    middle, half = row.twists[joint, 0], row.twists[joint, 1]
    fraction, rotation, own = (
        swing_fraction(row.radii[joint], x, y),
        range_fraction(middle, half, twist),
        row.own_twists[joint],
    )
    own_turn = range_fraction(middle, half, own)
    least, most = min(own_turn, -1.0), max(own_turn, 1.0)
    kept = min(max(rotation, least), most)
    if kept == rotation and fraction <= max(SOFT_LIMIT_FRACTION, row.own_fractions[joint]):
        return swing
    share = limit_fade(abs(rotation - kept) * half / (math.pi - half * abs(kept))) if kept != rotation else 1.0
    share *= limit_fade((fraction - max(SOFT_LIMIT_FRACTION, row.own_fractions[joint])) / UNTWIST_RANGE)
    return x, y, middle + half * (own_turn + share * (kept - own_turn))


@kernel
def limit_fade(fraction):
    """1 at 0 and below, 0 at 1 and beyond, smooth between."""
    fraction = min(max(fraction, 0.0), 1.0)
    return 1.0 - fraction * fraction * (3.0 - 2.0 * fraction)


@kernel
def clamped_to_caps(row, joint, swing):
    """(swing x, swing y, twist, certainty): angles clamped to the caps, and the weight by which the clamped swing is
    unambiguous.
    """
    x, y, twist = swing
    own_x, own_y, own_part = row.own_swings[joint, 0], row.own_swings[joint, 1], row.own_fractions[joint]
    fraction = swing_fraction(row.radii[joint], x, y)
    kept = min(fraction, row.caps[joint, 0])
    middle, half = row.twists[joint, 0], row.twists[joint, 1]
    rotation = range_fraction(middle, half, twist)
    kept_turn = min(max(rotation, -row.caps[joint, 2]), row.caps[joint, 1])
    if kept == fraction and kept_turn == rotation:
        return x, y, twist, 1.0
    share = 1.0
    if kept != fraction:
        angle = math.sqrt(x * x + y * y)
        share = half_turn_certainty(angle, max(1.0, own_part) * angle / fraction)
        x, y = own_x + share * (kept / fraction * x - own_x), own_y + share * (kept / fraction * y - own_y)
    return x, y, middle + half * kept_turn, share


@kernel
def damped_swivel(row, parent, upper, ax, ay, az, desired):
    """Angle in radians of a swivel of ``desired`` radians about the world axis (ax, ay, az), damped near the joint
    limits.

    It is integrated in ``SWIVEL_STEPS`` steps from the present pose: an angle clamped from beyond the limits could
    return in either direction. A damped swivel of half a turn fades for the same reason.
    """
    axes, radii, well = row.axes[0], row.radii[0], row.inner_cosines[0]
    middle, half = row.twists[0, 0], row.twists[0, 1]
    own = range_fraction(middle, half, row.own_twists[0])
    x0 = direction_in_axes(parent, axes, upper[0, 0], upper[1, 0], upper[2, 0])
    z0 = direction_in_axes(parent, axes, upper[0, 2], upper[1, 2], upper[2, 2])
    a = direction_in_axes(parent, axes, ax, ay, az)
    angle, x, z = 0.0, x0, z0
    for _ in range(SWIVEL_STEPS):
        remaining = 1.0
        cosine, sine = x[0] + z[2] * x[0] - z[0] * x[2], x[1] - (z[1] * x[2] - z[2] * x[1])
        if z[2] < well[0] or well[2] * cosine + well[3] * sine <= well[1] * (1.0 + z[2]):
            sx, sy, twist = swing_and_twist(x, z)
            rotation = range_fraction(middle, half, twist)
            fraction = swing_fraction(radii, sx, sy)
            out, on = swing_gradient(radii, z, sx, sy, fraction), twist_gradient(z)
            if desired * (a[0] * out[0] + a[1] * out[1] + a[2] * out[2]) > 0.0:
                remaining = min(remaining, remaining_freedom(fraction, row.own_fractions[0]))
            if desired * rotation * (a[0] * on[0] + a[1] * on[1] + a[2] * on[2]) > 0.0:
                remaining = min(remaining, remaining_freedom(abs(rotation), own if rotation > 0.0 else -own))
        angle += remaining * desired / SWIVEL_STEPS
        x, z = rotate_about_axis(a, angle, x0), rotate_about_axis(a, angle, z0)
    braked = min(1.0 - angle / desired, DAMPED_SWIVEL_FRACTION) / DAMPED_SWIVEL_FRACTION if desired != 0.0 else 0.0
    return angle * (1.0 - braked * (1.0 - half_turn_certainty(abs(desired), 0.0)))


@kernel
def remaining_freedom(fraction, own):
    """Damping factor of a rotation towards a limit, at ``fraction`` of its range: 1 up to
    ``SWIVEL_SOFT_LIMIT_FRACTION``, 0 from ``SWIVEL_LIMIT_FRACTION`` on.

    Both thresholds are at least ``own``, the fraction in the source motion.
    """
    free, most = max(SWIVEL_SOFT_LIMIT_FRACTION, own), max(SWIVEL_LIMIT_FRACTION, own)
    return min(max((most - fraction) / max(most - free, 1e-3), 0.0), 1.0)


@kernel
def clamp_joint(limb, joint, task_moved, updates_caps, limits, pose):
    """Clamp one joint of a limb to its limits; True if it moved. ``joint`` 0 is shoulder or hip, 1 wrist or ankle,
    which is not clamped if its foot is planted.

    ``task_moved`` is true if a task has moved the joint since it was last clamped; ``updates_caps`` to update its soft
    bounds (caps).
    """
    positions, rotations = pose
    row, fraction = limits[limb], 1.0
    parent, segment, root = limb_parts(limb, positions.shape[0] - POINTS_BESIDE_SPINE)
    if joint == 1:
        parent, segment, root, fraction = segment + 1, segment + 2, root + 2, row.release
        if fraction == 0.0:
            return False
    swing = swing_of(row, joint, rotations[parent], rotations[segment])
    desired = clamped_twist(row, joint, swing) if task_moved else swing
    if updates_caps:
        update_caps(row, joint, desired)
    x, y, twist, sure = clamped_to_caps(row, joint, desired)
    if joint == 0:  # a hand or foot falls back to the motion's own rotation; the goal of its limb stays
        row.certainty = min(row.certainty, sure)
    if x == swing[0] and y == swing[1] and twist == swing[2]:
        return False
    axes = compose(rotation_from_matrix(rotations[parent]), rotation_from_matrix(row.axes[joint]))
    required = compose(axes, compose(rotation_from_vector(x, y, 0.0), rotation_from_vector(0.0, 0.0, twist)))
    rotate_towards(segment, positions[root], required, fraction, positions, rotations)
    row.is_active = 1
    return True


@kernel
def clamp_elbow_or_knee(limb, limits, pose):
    """Clamp elbow or knee to its limits, after a task has rotated forearm or shank itself; True if it moved."""
    _, upper, root = limb_parts(limb, pose.positions.shape[0] - POINTS_BESIDE_SPINE)
    return clamp_bend(limits[limb], upper, pose.positions[root + 1], pose)


@kernel
def clamp_bend(row, upper, pivot, pose):
    """Clamp one elbow or knee to its limits; True if it moved."""
    positions, rotations = pose
    bend, slant, rotation = bend_carrying_twist(rotations[upper], rotations[upper + 1])
    middle, half = 0.5 * (row.bends[0] + row.bends[1]), 0.5 * (row.bends[1] - row.bends[0])
    fraction, own_part = range_fraction(middle, half, bend), range_fraction(middle, half, row.own_bend)
    twist, own_twist = (
        range_fraction(row.turns[0], row.turns[1], rotation),
        range_fraction(row.turns[0], row.turns[1], row.own_turn),
    )
    tilt, own_tilt = slant / row.aslant, row.own_slant / row.aslant
    kept, kept_twist = (
        soft_clamp_both(fraction, own_part, SOFT_LIMIT_FRACTION, 1.0),
        soft_clamp_both(twist, own_twist, SOFT_LIMIT_FRACTION, 1.0),
    )
    kept_tilt = soft_clamp_both(tilt, own_tilt, SOFT_LIMIT_FRACTION, 1.0)
    if kept == fraction and kept_twist == twist and kept_tilt == tilt:
        return False
    share = half_turn_certainty(0.5 * math.pi + abs(slant), 0.5 * math.pi + row.aslant) if kept_tilt != tilt else 1.0
    bent = share * (
        half_turn_certainty(half * abs(fraction), half * max(1.0, abs(own_part))) if kept != fraction else 1.0
    )
    twisted = share * (
        half_turn_certainty(row.turns[1] * abs(twist), row.turns[1] * max(1.0, abs(own_twist)))
        if kept_twist != twist
        else 1.0
    )
    bend = middle + half * (own_part + bent * (kept - own_part))
    slant = row.aslant * (own_tilt + share * (kept_tilt - own_tilt))
    rotation = row.turns[0] + row.turns[1] * (own_twist + twisted * (kept_twist - own_twist))
    bent = compose(
        rotation_from_vector(bend, 0.0, 0.0),
        compose(rotation_from_vector(0.0, slant, 0.0), rotation_from_vector(0.0, 0.0, rotation)),
    )
    rotate_towards(upper + 1, pivot, compose(rotation_from_matrix(rotations[upper]), bent), 1.0, positions, rotations)
    row.is_active = 1
    return True


@kernel
def rotate_towards(segment, pivot, required, fraction, positions, rotations):
    """Rotate a segment and its subtree about ``pivot`` by ``fraction`` of the rotation to ``required``.

    The rotation is orthonormalised: its errors would be doubled every time.
    """
    rotation = compose(required, inverse_rotation(rotation_from_matrix(rotations[segment])))
    x, y, z = rotation[7] - rotation[5], rotation[2] - rotation[6], rotation[3] - rotation[1]
    size = math.sqrt(x * x + y * y + z * z)
    angle = math.atan2(size, rotation[0] + rotation[4] + rotation[8] - 1.0)
    scale = fraction * (angle / size if size > 1e-12 else 0.5)
    exact = rotation_from_vector(scale * x, scale * y, scale * z)
    rotate_part(exact, segment, positions.shape[0] - POINTS_BESIDE_SPINE, pivot, positions, rotations)
