"""Arms kept clear of their own body: out of capsules, by moving the wrist, bending the hand and swivelling the elbow.

In smooth closed-form steps from the frame's own pose, so that it needs no frame before; ``kernels.limits.clearing``
says when. Records are those of ``kernels.records``; an arm has five spheres, its probes: at the elbow, half way down
the forearm, at the wrist, in the palm and in the fingers. *Room* is how far a probe's surface is from the body's,
negative inside.
"""

import math

import numpy as np

from studio.core.kernels.algebra.turns import turn_by
from studio.core.kernels.algebra.vectors import between, copy_matrix, copy_point, distance
from studio.core.kernels.body.parts import body_point, turn_part
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limbs.limb import COMFORT, STRETCHED, soft_reach
from studio.core.kernels.limbs.reach import reach_to, span_range
from studio.core.kernels.records import CAPSULE, Pose

PROBES = 5
HAND, SWIVEL, STEP = 3, 6, 7
"""A step of an arm: the way of its wrist (3,), in metres, from number ``HAND`` on how its hand turns about that (3,),
and its swivel, in radians.
"""
BLEND = 0.02
"""Metres over which the distances to two capsules run into each other."""
CORE = 0.3
"""Part of a capsule's radius within which its outward direction fades: at the axis there is none."""
FADE, TOUCH = 0.08, 0.003
"""Metres before its place at which a probe begins to be led there at most, and within which it is kept."""
LEAST_FADE = 5.0 * TOUCH
"""Metres before its place at which a probe begins to be led there at least."""
SWEEPS = 6
SWIVEL_COST = 0.3
"""Metres of wrist that are worth one radian of swivel, by which the elbow of a bent arm goes 0.15 to 0.2 m; the wrist
takes it along by half of its own way. So an elbow goes out by both, and the arm is tipped less.
"""
HAND_COST = 0.5 * SWIVEL_COST
"""The same of the turn of a hand: fingers that alone are too deep bend out, and take the wrist along by a third."""
MOST_SWIVEL = 1.2
"""Radians to which a swivel, and the turn of a hand, tend."""
NEARNESS = 0.02
FLESH = 2.0 * NEARNESS
"""Metres of room, and of depth, to which what the actor itself has is kept at most."""
DEEP = 1.5 * FLESH
"""Metres in the body at which an arm comes out the actor's way alone: deeper than any that is to be kept."""
RIM = math.sqrt(1.0 + CORE * CORE)
FOLLOWS = (0.5, 0.75, 1.0, 1.0, 1.0)
"""Part of the wrist's way that each probe goes along."""


@kernel
def place_capsules(volume, pose, proximal, out_capsules):
    """The capsules (N,) in the world; ``proximal`` (S,) is the point where each segment begins."""
    segments, places, radii = volume.segments, volume.places, volume.radii
    for n in range(segments.shape[0]):
        capsule = out_capsules[n]
        first, last = segments[n, 0], segments[n, 1]
        begin = body_point(proximal[first], first, places[n, 0], pose.positions, pose.rotations)
        x, y, z = between(begin, body_point(proximal[last], last, places[n, 1], pose.positions, pose.rotations))
        copy_point(begin, capsule.begin)
        copy_point((x, y, z), capsule.axis)
        capsule.per_squared_length = 1.0 / max(x * x + y * y + z * z, 1e-9)
        capsule.radius, capsule.widens = radii[n, 0], radii[n, 1] - radii[n, 0]


@allocating_kernel
def room_at(x, y, z, girth, capsules, out_way):
    """Metres of room of a sphere, and the unit way out of the body (3,), shorter towards a capsule's axis.

    The smooth minimum (polynomial, over ``BLEND``) of the distances from tapered capsules.
    """
    room, most = math.inf, math.inf
    out_way[0] = out_way[1] = out_way[2] = 0.0
    for n in range(capsules.shape[0]):
        capsule = capsules[n]
        ux, uy, uz = capsule.axis[0], capsule.axis[1], capsule.axis[2]
        px, py, pz = x - capsule.begin[0], y - capsule.begin[1], z - capsule.begin[2]
        t = soft_clamp((px * ux + py * uy + pz * uz) * capsule.per_squared_length)
        px, py, pz = px - t * ux, py - t * uy, pz - t * uz
        radius = capsule.radius + t * capsule.widens
        squared = px * px + py * py + pz * pz + CORE * CORE * radius * radius
        if squared >= (most + RIM * radius) ** 2:
            continue
        away = math.sqrt(squared)
        here = away - RIM * radius - girth
        if here >= room + BLEND:
            continue
        share = 1.0
        if here > room - BLEND:
            share = 0.5 * (1.0 + (room - here) / BLEND)
            room = room + share * (here - room) - 0.5 * BLEND * share * (1.0 - share)
        else:
            room = here
        most = max(room + BLEND + girth, 0.0)
        keep = 1.0 - share
        out_way[0] = keep * out_way[0] + share * px / away
        out_way[1] = keep * out_way[1] + share * py / away
        out_way[2] = keep * out_way[2] + share * pz / away
    return room


@kernel
def soft_clamp(t):
    """``t`` held between 0 and 1 with a tenth of rounding at either end."""
    return t + ramp(-t, 0.1) - ramp(t - 1.0, 0.1)


@kernel
def ramp(x, band):
    """max(x, 0) with its corner rounded over ``band`` on either side; never below it."""
    if x <= -band:
        return 0.0
    return x if x >= band else (x + band) ** 2 / (4.0 * band)


@kernel
def probe_at(probe, shoulder, positions, out_point):
    """The centre (3,) of a probe of the arm whose shoulder is the point of that index."""
    if probe < 3:
        begin, end, share = shoulder + 1, shoulder + 2, 0.5 * probe
    else:
        begin, end, share = shoulder + 2, shoulder + 3, 0.45 if probe == 3 else 0.85
    for axis in range(3):
        out_point[axis] = positions[begin, axis] + share * (positions[end, axis] - positions[begin, axis])


@allocating_kernel
def measure_arm(side, volume, capsules, positions, out_rooms, out_ways):
    """The room of every probe of one arm, (5,) metres, and the way out (5, 3)."""
    shoulder, point = positions.shape[0] - 19 + 5 * side, np.empty(3)
    for probe in range(PROBES):
        probe_at(probe, shoulder, positions, point)
        girth = volume.girths[probe]
        out_rooms[probe] = room_at(point[0], point[1], point[2], girth, capsules, out_ways[probe])


@allocating_kernel
def room_frames(volume, proximal, positions, rotations, out_rooms, out_ways):
    """The room of every probe at every frame, (F, 2, 5) metres, and the way out (F, 2, 5, 3)."""
    capsules = np.empty(volume.segments.shape[0], CAPSULE)
    for frame in range(positions.shape[0]):
        place_capsules(volume, Pose(positions[frame], rotations[frame]), proximal, capsules)
        for side in range(2):
            measure_arm(side, volume, capsules, positions[frame], out_rooms[frame, side], out_ways[frame, side])


@allocating_kernel
def wanted_rooms(actor_rooms, margin, out_wanted):
    """Room that probes are to have, any shape: ``margin`` more than y C / (|y| + C), where y is the actor's.

    So a hand lands on a wide body as softly as the actor's does on its own, and where the actor seems to sink in, the
    body may too, but never deeper. C is ``NEARNESS`` outside and ``FLESH`` inside.
    """
    own, wanted = actor_rooms.ravel(), out_wanted.ravel()
    for i in range(own.shape[0]):
        most = NEARNESS if own[i] > 0.0 else FLESH
        wanted[i] = margin + own[i] * most / (abs(own[i]) + most)


@allocating_kernel
def clear_arm(side, touch, frame, shares, clearance, clearing, pose):
    """Bring one arm out of its body where its probes have less room than ``clearing.asks``; True when it moved.

    In sweeps, each from where the last one has brought the arm. ``shares`` (4,): how much of the answer is taken, how
    freely wrist, hand and swivel may move; ``touch`` metres within which a probe is led, 0 for as usual. An arm with
    enough room is not touched, and ``clearing.rooms`` become the room that it has.
    """
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    shoulder, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
    saved, turn = clearing.saved, clearing.turn
    moved, move, step = False, np.zeros(STEP), np.empty(STEP)
    for _ in range(SWEEPS):
        near = touch if touch > 0.0 else TOUCH if moved else 0.0
        if not sweep_arm(side, near, frame, shares, clearance, clearing, positions, step):
            break
        if not moved:
            copy_arm(Pose(positions[shoulder : shoulder + 4], rotations[upper : upper + 3]), saved)
            moved = True
        move += step
        move_arm(side, 1.0, move, saved, turn, pose)
    if moved and shares[0] < 1.0:
        move_arm(side, shares[0], move, saved, turn, pose)
    return moved


@allocating_kernel
def sweep_arm(side, near, frame, shares, clearance, clearing, positions, out_step):
    """The step (7,) of wrist (metres), hand and swivel (radians) that gives every probe its room; False when none is
    needed.

    Probe after probe takes the least step for itself, each part counted by its cost, where the steps before have
    brought it. The narrower the actor is beside this body, the earlier a probe begins to give way, unless it is to be
    kept ``near`` its place, in metres.
    """
    wanted, own, ways = clearing.asks, clearance.rooms[frame, side], clearance.ways[frame, side]
    shoulder = positions.shape[0] - 19 + 5 * side
    place, arc, lever, way, entry = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    line = stiff_line(shoulder, positions)
    out_step[:] = 0.0
    for probe in range(PROBES):
        k = FOLLOWS[probe]
        probe_at(probe, shoulder, positions, place)
        arc_of(probe, shoulder, place, positions, arc)
        for axis in range(3):
            lever[axis] = place[axis] - positions[shoulder + 2, axis] if probe > 2 else 0.0
        carried = cross(out_step[HAND], out_step[HAND + 1], out_step[HAND + 2], lever)
        for axis in range(3):
            place[axis] += k * out_step[axis] + out_step[SWIVEL] * arc[axis] + carried[axis]
        room = room_at(place[0], place[1], place[2], clearance.volume.girths[probe], clearing.capsules, way)
        clearing.rooms[side, probe] = room
        turn_way(room, own[probe], ways[probe], way if probe < 3 else entry, way)
        if probe == 2:
            copy_point(way, entry)
        if near > 0.0:
            short = ramp(wanted[probe] - room, near)
        else:
            narrower = max(own[probe] - room, 0.0)
            fade = LEAST_FADE + narrower * FADE / (narrower + FADE)
            short = ramp(wanted[probe] + TOUCH - room, fade)
        if short > 0.0:
            add_step(short, k, shares, (arc, lever, way, line), out_step)
    return out_step.any()


@kernel
def add_step(short, follows, shares, probe, step):
    """Add the least step that brings a probe out by ``short`` metres, which goes along with the wrist's way as it
    ``follows``; ``probe`` are its arc, its lever about the wrist, its way out, and the arm's ``stiff_line``, (3,) each.
    """
    arc, lever, way, line = probe
    stiff = way[0] * line[0] + way[1] * line[1] + way[2] * line[2]
    swings = max(1.0 - stiff * stiff, 0.0)
    swivel = (way[0] * arc[0] + way[1] * arc[1] + way[2] * arc[2]) / SWIVEL_COST
    x, y, z = cross(lever[0], lever[1], lever[2], way)
    hand = (x * x + y * y + z * z) / HAND_COST**2
    along = short / (follows * follows * swings * shares[1] + hand * shares[2] + swivel * swivel * shares[3] + 0.02)
    for axis in range(3):
        step[axis] += along * follows * shares[1] * (way[axis] - stiff * line[axis])
    bent = along * shares[2] / HAND_COST**2
    step[HAND] += bent * x
    step[HAND + 1] += bent * y
    step[HAND + 2] += bent * z
    step[SWIVEL] += along * swivel / SWIVEL_COST * shares[3]


@kernel
def stiff_line(shoulder, positions):
    """The line from shoulder to wrist (3,), 1 long where the arm is straight, and shorter the more it is folded.

    Along it a straight arm gives way by bending its elbow far for little, so it swings instead.
    """
    root, elbow, wrist = positions[shoulder], positions[shoulder + 1], positions[shoulder + 2]
    whole, line = distance(root, elbow) + distance(elbow, wrist), between(root, wrist)
    return line[0] / whole, line[1] / whole, line[2] / whole


@kernel
def cross(x, y, z, other):
    """(x, y, z) times ``other`` (3,), a tuple."""
    return y * other[2] - z * other[1], z * other[0] - x * other[2], x * other[1] - y * other[0]


@kernel
def turn_way(room, actor_room, actor_way, entry, way):
    """Blend the way out (3,), in place, into the actor's: deep in the body, and near an axis, where there is none.

    So an arm comes out on the side on which the actor's is, which counts as far as that is outside its own body. Where
    the actor's is inside, a hand comes out where it has gone in, by ``entry`` (3,), the wrist's way.
    """
    depth = min(actor_room, 0.0)
    outside = FLESH * FLESH / (FLESH * FLESH + depth * depth)
    within = min(max(-room / DEEP, 0.0), 1.0)
    within *= within * (3.0 - 2.0 * within)
    deep = outside * within
    take = deep + (1.0 - deep) * outside * (1.0 - way[0] ** 2 - way[1] ** 2 - way[2] ** 2)
    inner = (1.0 - outside) * within
    for axis in range(3):
        own = way[axis] + inner * (entry[axis] - way[axis])
        way[axis] = (1.0 - deep) * own + take * actor_way[axis]


@allocating_kernel
def arc_of(probe, shoulder, place, positions, out_arc):
    """Metres a radian by which a probe moves when the arm swivels about the line from shoulder to wrist, (3,)."""
    if probe > 1:
        out_arc[0] = out_arc[1] = out_arc[2] = 0.0
        return
    root, wrist = positions[shoulder], positions[shoulder + 2]
    ax, ay, az = wrist[0] - root[0], wrist[1] - root[1], wrist[2] - root[2]
    length = max(math.sqrt(ax * ax + ay * ay + az * az), 1e-9)
    ax, ay, az = ax / length, ay / length, az / length
    x, y, z = place[0] - root[0], place[1] - root[1], place[2] - root[2]
    out_arc[0], out_arc[1], out_arc[2] = ay * z - az * y, az * x - ax * z, ax * y - ay * x


@allocating_kernel
def move_arm(side, share, move, saved, turn, pose):
    """The ``saved`` arm gone a ``share`` of a ``move`` (7,): of its wrist, of its hand, and about its axis.

    The hand turns by nothing else. An arm that is too short stretches as ``limb.soft_reach`` says, but to its comfort
    at most, unless it is as straight already: the elbow of a straight one whirls.
    """
    positions, rotations = pose
    spine_count = positions.shape[0] - 23
    shoulder, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
    copy_arm(saved, Pose(positions[shoulder : shoulder + 4], rotations[upper : upper + 3]))
    root, wrist, target = positions[shoulder], positions[shoulder + 2], np.empty(3)
    reach = span_range(root, positions[shoulder + 1], rotations[upper, :, 0], wrist)[1]
    now, needed = 0.0, 0.0
    for axis in range(3):
        target[axis] = saved.positions[2, axis] + share * move[axis]
        now += (saved.positions[2, axis] - root[axis]) ** 2
        needed += (target[axis] - root[axis]) ** 2
    now, needed = math.sqrt(now) / reach, math.sqrt(needed) / reach
    most = min(max(now, COMFORT), STRETCHED)
    freely = max(now, 2.0 * COMFORT - 1.0)
    if needed > freely:
        needed = most * soft_reach(needed / most, freely / most) if freely < most else most
    reach_to(target, needed * reach, upper, shoulder, wrist, positions, rotations)
    angle = MOST_SWIVEL * math.tanh(share * move[SWIVEL] / MOST_SWIVEL)
    ax, ay, az = wrist[0] - root[0], wrist[1] - root[1], wrist[2] - root[2]
    scale = angle / max(math.sqrt(ax * ax + ay * ay + az * az), 1e-9)
    turn_part(turn_by(scale * ax, scale * ay, scale * az), upper, spine_count, root, positions, rotations)
    copy_matrix(saved.rotations[2], rotations[upper + 2])
    for axis in range(3):
        positions[shoulder + 3, axis] = wrist[axis] + saved.positions[3, axis] - saved.positions[2, axis]
    bent = math.sqrt(move[HAND] ** 2 + move[HAND + 1] ** 2 + move[HAND + 2] ** 2)
    if bent > 0.0:
        scale = MOST_SWIVEL * math.tanh(share * bent / MOST_SWIVEL) / bent
        x, y, z = scale * move[HAND], scale * move[HAND + 1], scale * move[HAND + 2]
        turn_part(turn_by(x, y, z), upper + 2, spine_count, wrist, positions, rotations)


@kernel
def copy_arm(arm, out_arm):
    """``out_arm`` becomes ``arm``: points (4, 3) and rotations (3, 3, 3)."""
    for point in range(4):
        copy_point(arm.positions[point], out_arm.positions[point])
    for segment in range(3):
        copy_matrix(arm.rotations[segment], out_arm.rotations[segment])
