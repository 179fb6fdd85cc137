"""Arms pushed out of their own body, a set of capsules, by moving the wrist, bending the hand and swivelling the elbow.

Each step is a smooth closed form of the frame's own pose, independent of the frame before;
``kernels.limits.self_collision`` applies it. Records are those of ``kernels.records``. An arm has five spheres, its
probes: at the elbow, half way down the forearm, at the wrist, in the palm and in the fingers. Distances are signed,
from a probe's surface to the body's, negative inside.
"""

import math

import numpy as np

from studio.core.kernels.algebra.rotation_tuples import rotation_from_vector
from studio.core.kernels.algebra.vectors import copy_matrix, copy_point, distance, offset_between
from studio.core.kernels.body.parts import body_point_position, rotate_part
from studio.core.kernels.body_indices import (
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.touching_arms import extend_softly
from studio.core.kernels.records import CAPSULE, Pose

PROBE_COUNT = 5
"""Number of probes of an arm."""
HAND_ROTATION, ELBOW_SWIVEL, ARM_STEP_SIZE = 3, 6, 7
"""Layout of an arm step (7,): displacement of the wrist (3,) in metres, rotation vector of the hand (3,) in radians,
swivel of the elbow in radians. First column of the hand's rotation, column of the swivel, and number of columns.
"""
SMOOTH_MINIMUM_WIDTH = 0.02
"""Difference in metres of the distances to two capsules up to which they are blended."""
CAPSULE_CORE_FRACTION = 0.3
"""Fraction of a capsule's radius within which its outward direction fades to zero, because it is undefined on the axis.
"""
LONGEST_APPROACH, CONTACT_MARGIN = 0.08, 0.003
"""Greatest distance in metres before its required distance at which a probe is decelerated, and the margin of a contact
in metres.
"""
SHORTEST_APPROACH = 5.0 * CONTACT_MARGIN
"""Least distance in metres before its required distance at which a probe is decelerated."""
CLEARANCE_ITERATIONS = 6
"""Iterations over the probes of an arm."""
SWIVEL_COST_METRES = 0.3
"""Wrist displacement in metres that costs as much as one radian of swivel. One radian moves the elbow of a bent arm by
0.15 to 0.2 m, and the wrist takes the elbow along by half of its own displacement, so that both move an elbow out, and
the arm tips less.
"""
HAND_COST_METRES = 0.5 * SWIVEL_COST_METRES
"""Wrist displacement in metres that costs as much as one radian of hand rotation: fingers that alone are too deep bend
out, and move the wrist by a third.
"""
MAX_SWIVEL = 1.2
"""Greatest swivel of an elbow, and rotation of a hand, in radians."""
MAX_INHERITED_CLEARANCE = 0.02
"""Greatest clearance in metres inherited from the actor."""
MAX_INHERITED_PENETRATION = 2.0 * MAX_INHERITED_CLEARANCE
"""Greatest penetration in metres inherited from the actor."""
ACTOR_DIRECTION_DEPTH = 1.5 * MAX_INHERITED_PENETRATION
"""Depth in metres at which an arm is pushed out along the actor's outward direction alone: deeper than any inherited
penetration.
"""
CORE_DISTANCE = math.sqrt(1.0 + CAPSULE_CORE_FRACTION * CAPSULE_CORE_FRACTION)
"""Softened distance from a capsule's axis, in radii, at its surface."""
WRIST_FRACTIONS = (0.5, 0.75, 1.0, 1.0, 1.0)
"""Fraction of the wrist's displacement by which each probe moves."""


@kernel
def place_capsules(volume, pose, proximal, out_capsules):
    """Write the ``CAPSULE`` records (N,) of a body volume in the world; ``proximal`` (S,) is the first point of each
    segment.
    """
    segments, positions, radii = volume.segments, volume.places, volume.radii
    for n in range(segments.shape[0]):
        capsule = out_capsules[n]
        first, last = segments[n, 0], segments[n, 1]
        begin = body_point_position(proximal[first], first, positions[n, 0], pose.positions, pose.rotations)
        x, y, z = offset_between(
            begin, body_point_position(proximal[last], last, positions[n, 1], pose.positions, pose.rotations)
        )
        copy_point(begin, capsule.begin)
        copy_point((x, y, z), capsule.axis)
        capsule.per_squared_length = 1.0 / max(x * x + y * y + z * z, 1e-9)
        capsule.radius, capsule.radius_change = radii[n, 0], radii[n, 1] - radii[n, 0]


@allocating_kernel
def signed_distance_to_body(x, y, z, girth, capsules, out_direction):
    """Signed distance in metres of a sphere with radius ``girth`` from the body; writes its outward direction (3,).

    It is the smooth minimum (polynomial, over ``SMOOTH_MINIMUM_WIDTH``) of the distances from tapered capsules. The
    direction is shorter than 1 near a capsule's axis.
    """
    distance, most = math.inf, math.inf
    out_direction[0] = out_direction[1] = out_direction[2] = 0.0
    for n in range(capsules.shape[0]):
        capsule = capsules[n]
        ux, uy, uz = capsule.axis[0], capsule.axis[1], capsule.axis[2]
        px, py, pz = x - capsule.begin[0], y - capsule.begin[1], z - capsule.begin[2]
        t = soft_clamp((px * ux + py * uy + pz * uz) * capsule.per_squared_length)
        px, py, pz = px - t * ux, py - t * uy, pz - t * uz
        radius = capsule.radius + t * capsule.radius_change
        squared = px * px + py * py + pz * pz + CAPSULE_CORE_FRACTION * CAPSULE_CORE_FRACTION * radius * radius
        if squared >= (most + CORE_DISTANCE * radius) ** 2:
            continue
        away = math.sqrt(squared)
        here = away - CORE_DISTANCE * radius - girth
        if here >= distance + SMOOTH_MINIMUM_WIDTH:
            continue
        fraction = 1.0
        if here > distance - SMOOTH_MINIMUM_WIDTH:
            fraction = 0.5 * (1.0 + (distance - here) / SMOOTH_MINIMUM_WIDTH)
            distance = (
                distance + fraction * (here - distance) - 0.5 * SMOOTH_MINIMUM_WIDTH * fraction * (1.0 - fraction)
            )
        else:
            distance = here
        most = max(distance + SMOOTH_MINIMUM_WIDTH + girth, 0.0)
        keep = 1.0 - fraction
        out_direction[0] = keep * out_direction[0] + fraction * px / away
        out_direction[1] = keep * out_direction[1] + fraction * py / away
        out_direction[2] = keep * out_direction[2] + fraction * pz / away
    return distance


@kernel
def soft_clamp(t):
    """``t`` clamped to [0, 1], with corners rounded over a width of 0.1 on either side."""
    return t + linear_ramp(-t, 0.1) - linear_ramp(t - 1.0, 0.1)


@kernel
def linear_ramp(x, band):
    """max(x, 0) with its corner rounded from -``band`` to ``band``; never below max(x, 0)."""
    if x <= -band:
        return 0.0
    return x if x >= band else (x + band) ** 2 / (4.0 * band)


@kernel
def probe_centre(probe, shoulder, positions, out_point):
    """Write the centre (3,) of one of the five probes of the arm that begins at the point ``shoulder``."""
    if probe < 3:
        begin, end, fraction = shoulder + 1, shoulder + 2, 0.5 * probe
    else:
        begin, end, fraction = shoulder + 2, shoulder + 3, 0.45 if probe == 3 else 0.85
    for axis in range(3):
        out_point[axis] = positions[begin, axis] + fraction * (positions[end, axis] - positions[begin, axis])


@allocating_kernel
def measure_arm_distances(side, volume, capsules, positions, out_distances, out_directions):
    """Write the signed distances (5,) in metres and outward directions (5, 3) of the probes of one arm."""
    shoulder, point = positions.shape[0] - POINTS_BESIDE_SPINE + SHOULDER_POINT + POINTS_PER_LIMB * side, np.empty(3)
    for probe in range(PROBE_COUNT):
        probe_centre(probe, shoulder, positions, point)
        girth = volume.girths[probe]
        out_distances[probe] = signed_distance_to_body(
            point[0], point[1], point[2], girth, capsules, out_directions[probe]
        )


@allocating_kernel
def measure_clip_distances(volume, proximal, positions, rotations, out_distances, out_directions):
    """Write the signed distances (F, 2, 5) in metres and outward directions (F, 2, 5, 3) of all probes in
    every frame.
    """
    capsules = np.empty(volume.segments.shape[0], CAPSULE)
    for frame in range(positions.shape[0]):
        place_capsules(volume, Pose(positions[frame], rotations[frame]), proximal, capsules)
        for side in range(2):
            measure_arm_distances(
                side, volume, capsules, positions[frame], out_distances[frame, side], out_directions[frame, side]
            )


@allocating_kernel
def required_distances(actor_distances, margin, out_required):
    """Write the signed distances required of probes: ``margin`` plus y C / (|y| + C), with y the actor's signed
    distance.

    All in metres, arrays of any shape. A hand lands on a wide body as softly as the actor's does on its own, and where
    the actor seems to penetrate, the body may too, with a limit. C is ``MAX_INHERITED_CLEARANCE`` outside and
    ``MAX_INHERITED_PENETRATION`` inside.
    """
    own, required = actor_distances.ravel(), out_required.ravel()
    for i in range(own.shape[0]):
        most = MAX_INHERITED_CLEARANCE if own[i] > 0.0 else MAX_INHERITED_PENETRATION
        required[i] = margin + own[i] * most / (abs(own[i]) + most)


@allocating_kernel
def push_arm_out(side, touch, frame, fractions, clearance, clearing, pose):
    """Push one arm out where its probes are below ``clearing.required_distances``; True if it moved.

    Each iteration begins at the result of the last one. ``fractions`` (4,): fraction of the result that is applied,
    then weights of wrist, hand and swivel. ``touch`` is the distance in metres at which probes decelerate, 0 for the
    default. An arm with enough clearance stays, and ``clearing.distances`` become its signed distances.
    """
    positions, rotations = pose
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    shoulder, upper = (
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    saved, rotation = clearing.saved, clearing.rotation
    moved, move, step = False, np.zeros(ARM_STEP_SIZE), np.empty(ARM_STEP_SIZE)
    for _ in range(CLEARANCE_ITERATIONS):
        near = touch if touch > 0.0 else CONTACT_MARGIN if moved else 0.0
        if not arm_step(side, near, frame, fractions, clearance, clearing, positions, step):
            break
        if not moved:
            copy_arm(Pose(positions[shoulder : shoulder + 4], rotations[upper : upper + 3]), saved)
            moved = True
        move += step
        move_arm(side, 1.0, move, saved, rotation, pose)
    if moved and fractions[0] < 1.0:
        move_arm(side, fractions[0], move, saved, rotation, pose)
    return moved


@allocating_kernel
def arm_step(side, near, frame, fractions, clearance, clearing, positions, out_step):
    """Write the step (7,) of wrist (metres), hand and swivel (radians) that brings each probe to its required distance;
    False if it is zero.

    Each probe in turn adds its own least step, weighted by the costs, to those of the probes before. The nearer a probe
    is to the body than the actor's, the earlier it decelerates, unless it is to stop within ``near`` metres (``touch``
    of ``push_arm_out``).
    """
    required, own, directions = (
        clearing.required_distances,
        clearance.actor_distances[frame, side],
        clearance.actor_directions[frame, side],
    )
    shoulder = positions.shape[0] - POINTS_BESIDE_SPINE + SHOULDER_POINT + POINTS_PER_LIMB * side
    position, arc, lever, direction, entry = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    line = stretched_line(shoulder, positions)
    out_step[:] = 0.0
    for probe in range(PROBE_COUNT):
        k = WRIST_FRACTIONS[probe]
        probe_centre(probe, shoulder, positions, position)
        swivel_lever(probe, shoulder, position, positions, arc)
        for axis in range(3):
            lever[axis] = position[axis] - positions[shoulder + 2, axis] if probe > 2 else 0.0
        segment_rotations = cross_with(
            out_step[HAND_ROTATION], out_step[HAND_ROTATION + 1], out_step[HAND_ROTATION + 2], lever
        )
        for axis in range(3):
            position[axis] += k * out_step[axis] + out_step[ELBOW_SWIVEL] * arc[axis] + segment_rotations[axis]
        distance = signed_distance_to_body(
            position[0], position[1], position[2], clearance.volume.girths[probe], clearing.capsules, direction
        )
        clearing.distances[side, probe] = distance
        blend_actor_direction(distance, own[probe], directions[probe], direction if probe < 3 else entry, direction)
        if probe == 2:
            copy_point(direction, entry)
        if near > 0.0:
            short = linear_ramp(required[probe] - distance, near)
        else:
            narrower = max(own[probe] - distance, 0.0)
            fade = SHORTEST_APPROACH + narrower * LONGEST_APPROACH / (narrower + LONGEST_APPROACH)
            short = linear_ramp(required[probe] + CONTACT_MARGIN - distance, fade)
        if short > 0.0:
            add_probe_step(short, k, fractions, (arc, lever, direction, line), out_step)
    return out_step.any()


@kernel
def add_probe_step(short, follows, fractions, probe, step):
    """Add to ``step`` (7,) the least step that moves a probe outwards by ``short`` metres.

    ``follows`` is the probe's fraction of the wrist's displacement, ``fractions`` the argument of ``push_arm_out``.
    ``probe``: its swivel lever, its lever about the wrist, its outward direction, and the arm's ``stretched_line``,
    (3,) each.
    """
    arc, lever, direction, line = probe
    stiff = direction[0] * line[0] + direction[1] * line[1] + direction[2] * line[2]
    swings = max(1.0 - stiff * stiff, 0.0)
    swivel = (direction[0] * arc[0] + direction[1] * arc[1] + direction[2] * arc[2]) / SWIVEL_COST_METRES
    x, y, z = cross_with(lever[0], lever[1], lever[2], direction)
    hand = (x * x + y * y + z * z) / HAND_COST_METRES**2
    along = short / (
        follows * follows * swings * fractions[1] + hand * fractions[2] + swivel * swivel * fractions[3] + 0.02
    )
    for axis in range(3):
        step[axis] += along * follows * fractions[1] * (direction[axis] - stiff * line[axis])
    bent = along * fractions[2] / HAND_COST_METRES**2
    step[HAND_ROTATION] += bent * x
    step[HAND_ROTATION + 1] += bent * y
    step[HAND_ROTATION + 2] += bent * z
    step[ELBOW_SWIVEL] += along * swivel / SWIVEL_COST_METRES * fractions[3]


@kernel
def stretched_line(shoulder, positions):
    """Vector (x, y, z) from shoulder to wrist divided by the length of the arm: its length is 1 for a straight arm.

    A straight arm pays more for steps along this vector: it would have to bend its elbow far, so it swings aside
    instead.
    """
    root, elbow, wrist = positions[shoulder], positions[shoulder + 1], positions[shoulder + 2]
    whole, line = distance(root, elbow) + distance(elbow, wrist), offset_between(root, wrist)
    return line[0] / whole, line[1] / whole, line[2] / whole


@kernel
def cross_with(x, y, z, other):
    """Cross product (x, y, z) × ``other`` (3,), as a tuple."""
    return y * other[2] - z * other[1], z * other[0] - x * other[2], x * other[1] - y * other[0]


@kernel
def blend_actor_direction(distance, actor_distance, actor_direction, entry, direction):
    """Blend the actor's outward direction into ``direction`` (3,), in place, deep in the body and near a capsule's
    axis.

    The weight of the actor's direction decreases with the depth of the actor in its own body. There a hand leaves along
    ``entry`` (3,) instead, the outward direction of the wrist.
    """
    depth = min(actor_distance, 0.0)
    outside = (
        MAX_INHERITED_PENETRATION
        * MAX_INHERITED_PENETRATION
        / (MAX_INHERITED_PENETRATION * MAX_INHERITED_PENETRATION + depth * depth)
    )
    within = min(max(-distance / ACTOR_DIRECTION_DEPTH, 0.0), 1.0)
    within *= within * (3.0 - 2.0 * within)
    deep = outside * within
    take = deep + (1.0 - deep) * outside * (1.0 - direction[0] ** 2 - direction[1] ** 2 - direction[2] ** 2)
    inner = (1.0 - outside) * within
    for axis in range(3):
        own = direction[axis] + inner * (entry[axis] - direction[axis])
        direction[axis] = (1.0 - deep) * own + take * actor_direction[axis]


@allocating_kernel
def swivel_lever(probe, shoulder, position, positions, out_arc):
    """Write the displacement (3,) of a probe, metres per radian of swivel about the line from shoulder to wrist."""
    if probe > 1:
        out_arc[0] = out_arc[1] = out_arc[2] = 0.0
        return
    root, wrist = positions[shoulder], positions[shoulder + 2]
    ax, ay, az = wrist[0] - root[0], wrist[1] - root[1], wrist[2] - root[2]
    length = max(math.sqrt(ax * ax + ay * ay + az * az), 1e-9)
    ax, ay, az = ax / length, ay / length, az / length
    x, y, z = position[0] - root[0], position[1] - root[1], position[2] - root[2]
    out_arc[0], out_arc[1], out_arc[2] = ay * z - az * y, az * x - ax * z, ax * y - ay * x


@allocating_kernel
def move_arm(side, fraction, move, saved, rotation, pose):
    """Pose an arm as the ``saved`` one displaced by ``fraction`` of the step ``move`` (7,): wrist, hand and swivel.

    The hand keeps its world rotation but for its own part of the step. An arm that is too short extends softly, up to
    its soft-IK threshold or to its saved extension if that is more: the elbow of a straight arm whirls.
    """
    positions, rotations = pose
    spine_count = positions.shape[0] - POINTS_BESIDE_SPINE
    shoulder, upper = (
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    copy_arm(saved, Pose(positions[shoulder : shoulder + 4], rotations[upper : upper + 3]))
    root, wrist = positions[shoulder], positions[shoulder + 2]
    target = wrist[0] + fraction * move[0], wrist[1] + fraction * move[1], wrist[2] + fraction * move[2]
    extend_softly(side, distance(root, wrist), target, pose)
    angle = MAX_SWIVEL * math.tanh(fraction * move[ELBOW_SWIVEL] / MAX_SWIVEL)
    ax, ay, az = wrist[0] - root[0], wrist[1] - root[1], wrist[2] - root[2]
    scale = angle / max(math.sqrt(ax * ax + ay * ay + az * az), 1e-9)
    rotate_part(
        rotation_from_vector(scale * ax, scale * ay, scale * az), upper, spine_count, root, positions, rotations
    )
    copy_matrix(saved.rotations[2], rotations[upper + 2])
    for axis in range(3):
        positions[shoulder + 3, axis] = wrist[axis] + saved.positions[3, axis] - saved.positions[2, axis]
    bent = math.sqrt(move[HAND_ROTATION] ** 2 + move[HAND_ROTATION + 1] ** 2 + move[HAND_ROTATION + 2] ** 2)
    if bent > 0.0:
        scale = MAX_SWIVEL * math.tanh(fraction * bent / MAX_SWIVEL) / bent
        x, y, z = scale * move[HAND_ROTATION], scale * move[HAND_ROTATION + 1], scale * move[HAND_ROTATION + 2]
        rotate_part(rotation_from_vector(x, y, z), upper + 2, spine_count, wrist, positions, rotations)


@kernel
def copy_arm(arm, out_arm):
    """Copy an arm: points (4, 3) and rotations (3, 3, 3)."""
    for point in range(4):
        copy_point(arm.positions[point], out_arm.positions[point])
    for segment in range(3):
        copy_matrix(arm.rotations[segment], out_arm.rotations[segment])
