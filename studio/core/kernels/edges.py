"""Frames on the edge of a constraint's activation: what is solved is blended there, not what is asked (METHOD (31)).

On the straight way from where a point is to where it is to be, a hand passes by its own shoulder, where the arm whirls
about, or is out of reach after a moment, where elbow and trunk stop at once. So such a frame is solved with all its
constraints, then without the one that acts least, and so on until what is wholly active is left, and each pose is
blended with the one before, joint by joint. Those that both have then get back what the blend has cost them.

The pose before is kept in the ``work`` of ``kernels.constraints``: the state of its search as the last of ``turned``,
the rotations of its limbs' segments in what carries each from ``THERE`` on in ``turns``, four a limb, those of the pose
just solved from ``HERE`` on and of the blend from ``KEPT_TURNS`` on; misses as ``blended`` in the records; and as
the second four of ``grips`` which limbs are to stay as blended.
"""

import math

from studio.core.kernels.compiling import kernel
from studio.core.kernels.constraints import disturbance, mend, note_kept
from studio.core.kernels.goals import BALANCE, LOOK_AT, ORIENTATION, POSITION
from studio.core.kernels.joint_limits import limb_parts
from studio.core.kernels.limb_constraints import CLOSE_ENOUGH, HUNG
from studio.core.kernels.placing import KEPT_TURNS, carry_body, miss_of, place_limbs, turn_error
from studio.core.kernels.rotation import multiply, rotation_vector_to_matrix
from studio.core.kernels.rows import MISSED, TURN_ARM, aim_limb
from studio.core.kernels.steps import KEPT
from studio.core.kernels.vectors import copy_matrix, copy_point, distance

IN_PART = 3
"""What ``wanted`` becomes where a constraint is on its edge, or was out of reach in what is blended."""
LOST = 2e-4
"""Metres or radians by which what is blended may be missed more than what it is blended of."""
GIVEN_UP_THERE = 2
"""What a limb is whose constraint was given up in what is kept, while the next is solved."""

THERE, HERE = KEPT_TURNS + 16, KEPT_TURNS + 32
"""Where in the scratch ``turns`` the limbs of what is kept and of what was just solved begin."""
STRAIGHT = 0.01
"""Part of its length that a limb has to spare from which on it bends as its place wants, rather than the trunk."""


@kernel
def next_edge(least, frame, asked, activations):
    """The smallest activation above ``least`` of what is on its edge; 1 where there is none."""
    found = 1.0
    for c in range(asked.shape[0]):
        if least < activations[c, frame] < found and asked[c].blends:
            found = activations[c, frame]
    return found


@kernel
def clear_state(work):
    """Nothing has turned yet."""
    turned = work[3][0]
    for joint in range(turned.shape[0]):
        turned[joint, 0] = turned[joint, 1] = turned[joint, 2] = 0.0


@kernel
def keep_solution(first, asked, areas, body, work, pose):
    """Note a pose, to be blended with the next; what is missed by the ``first``."""
    turned, hung = work[3], work[4]
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[2, joint])
    note_turns(THERE, work[7], pose)
    for limb in range(4):
        hung[4 + limb] = 0
    for c in range(asked.shape[0]):
        row = asked[c]
        if first:
            row.blended = miss_of(c, asked, areas, body, work, pose) if row.wanted else 0.0
        note_hung(row, GIVEN_UP_THERE, hung)


@kernel
def note_turns(first, turns, pose):
    """Note the rotations of all limbs' segments in what carries each, as ``turns`` from the ``first`` on."""
    for limb in range(4):
        before, upper, _ = limb_parts(limb, pose[0].shape[0] - 23)
        for bone in range(3 if limb < 2 else 4):
            turn_between(pose[1][before], pose[1][upper + bone], turns[first + 4 * limb + bone])
            before = upper + bone


@kernel
def note_hung(row, how, hung):
    """A limb whose constraint is given up, or on its edge, is not to be solved anew from the motion."""
    if row.wanted > 1 and row.kind != BALANCE:
        for end in range(2):
            if row.ends[end, 2] >= 0 and row.freedoms[end, 0] > 0.0:
                hung[4 + row.ends[end, 2]] = how


@kernel
def note_blended(part, asked, areas, body, work, pose):
    """Note the pose just solved, and what is missed where that which is kept counts ``part``."""
    turned = work[3]
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[1, joint])
    note_turns(HERE, work[7], pose)
    for c in range(asked.shape[0]):
        now = miss_of(c, asked, areas, body, work, pose) if asked[c].wanted else 0.0
        asked[c].blended = part * asked[c].blended + (1.0 - part) * now


@kernel
def blend_kept(part, work):
    """Blend state and limbs of what is kept, which counts ``part``, into those of what was just solved."""
    turned = work[3]
    for joint in range(turned.shape[1]):
        for axis in range(3):
            turned[0, joint, axis] = turned[1, joint, axis] + part * (turned[2, joint, axis] - turned[1, joint, axis])
    for limb in range(4):
        blend_limb(part, limb, work)


@kernel
def blend_limb(part, limb, work):
    """``blend_kept`` of one limb alone."""
    turns, turn, vector = work[7], work[7][0], work[5][7]
    for bone in range(4 * limb, 4 * limb + (3 if limb < 2 else 4)):
        turn_error(turns[THERE + bone], turns[HERE + bone], turn, vector)
        rotation_vector_to_matrix(part * vector[0], part * vector[1], part * vector[2], turn)
        multiply(turn, turns[HERE + bone], turns[KEPT_TURNS + bone])


@kernel
def turn_between(carrier, segment, out_turn):
    """Rotation of a segment in the axes of what carries it, all (3, 3)."""
    for row in range(3):
        for column in range(3):
            out_turn[row, column] = (
                carrier[0, row] * segment[0, column]
                + carrier[1, row] * segment[1, column]
                + carrier[2, row] * segment[2, column]
            )


@kernel
def pose_between(part, frame, asked, areas, activations, chain, body, work, start, pose):
    """Pose the body ``part`` of the way from what was just solved to what was kept; what both have is held.

    Where that cannot be held in between, the body is as the nearer of both has it.
    """
    note_blended(part, asked, areas, body, work, pose)
    blend_kept(part, work)
    pose_kept(frame, asked, areas, activations, chain, body, work, start, pose)
    if loses(asked, areas, body, work, pose):
        blend_kept(1.0 if part >= 0.5 else 0.0, work)
        for limb in range(4):
            work[4][4 + limb] = HUNG
        carry_body(chain, body, work, start, pose)
        for limb in range(4):
            work[4][4 + limb] = 0


@kernel
def loses(asked, areas, body, work, pose):
    """Whether anything that was to be held is missed by more than what is blended."""
    lost = False
    for c in range(asked.shape[0]):
        row = asked[c]
        lost = lost or (row.wanted == 1 and miss_of(c, asked, areas, body, work, pose) > row.blended + LOST)
    return lost


@kernel
def note_misses(frame, asked, areas, body, work, pose, out_residuals):
    """By how much each constraint is missed at one frame."""
    for c in range(asked.shape[0]):
        out_residuals[c, frame] = math.nan
        if asked[c].wanted == IN_PART:
            out_residuals[c, frame] = asked[c].blended
        elif asked[c].wanted:
            out_residuals[c, frame] = miss_of(c, asked, areas, body, work, pose)


@kernel
def pose_kept(frame, asked, areas, activations, chain, body, work, start, pose):
    """Pose the body as state and limbs were kept, and give what was ``blended`` with little missing what it asks."""
    level = chain[0].shape[0] - asked.shape[0]
    hung = work[4]
    for c in range(asked.shape[0]):
        row = asked[c]
        on_edge = not row.wanted and 0.0 < activations[c, frame] < 1.0
        turns = row.kind == ORIENTATION or row.kind == LOOK_AT
        if on_edge or (row.wanted == 1 and not row.pinned and row.blended * (TURN_ARM if turns else 1.0) > MISSED):
            row.wanted = IN_PART
        note_hung(row, HUNG, hung)
    for limb in range(4):
        hung[4 + limb] = HUNG if hung[4 + limb] else 0
    carry_body(chain, body, work, start, pose)
    note_kept(0, level, asked, areas, body, work, pose)
    for c in range(asked.shape[0]):
        if asked[c].wanted == 1:
            note_held(asked[c], hung, work, pose)
    place_limbs(level, asked, areas, chain, body, work, start, pose)
    mend_kept(level, asked, areas, chain, body, work, start, pose)
    for c in range(asked.shape[0]):
        row = asked[c]
        if row.wanted == 1 and row.blended > KEPT and row.ends[0, 2] >= 0 and hung[4 + row.ends[0, 2]]:
            row.wanted = IN_PART  # its place was where the blend has it, and not where it wants to be
    for limb in range(4):
        hung[4 + limb] = 0


@kernel
def mend_kept(level, asked, areas, chain, body, work, start, pose):
    """Give what was blended with little missing what it asks; where steps lead away from that, none is taken."""
    turned = work[3]
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[3, joint])
    missed, work[9][1] = disturbance(level, False, asked, areas, body, work, pose), -1.0
    if mend(level, CLOSE_ENOUGH, False, asked, areas, chain, body, work, start, pose):
        return
    if disturbance(level, False, asked, areas, body, work, pose) > missed:
        for joint in range(turned.shape[1]):
            copy_point(turned[3, joint], turned[0, joint])
        carry_body(chain, body, work, start, pose)
        place_limbs(level, asked, areas, chain, body, work, start, pose)


@kernel
def note_held(row, hung, work, pose):
    """What both poses have keeps what it asks, or as much of it as they brought."""
    turn, vector = work[7][0], work[5][7]
    missed = row.blended * (TURN_ARM if row.kind == ORIENTATION or row.kind == LOOK_AT else 1.0)
    part = min(max(1.1 * (1.0 - missed / MISSED), 0.0), 1.0)
    row.kept_miss = row.blended
    if row.kind == ORIENTATION or row.kind == LOOK_AT:
        turn_error(row.turn, pose[1][row.ends[0, 1]], turn, vector)
        rotation_vector_to_matrix(part * vector[0], part * vector[1], part * vector[2], turn)
        multiply(turn, pose[1][row.ends[0, 1]], row.kept_turn)
        if row.ends[0, 2] >= 0 and hung[4 + row.ends[0, 2]]:
            copy_matrix(row.kept_turn, row.turn)
        return
    for end in range(2):
        wish = row.places[1 if row.kind == BALANCE else end]
        for axis in range(3):
            row.kept_places[end, axis] += part * (wish[axis] - row.kept_places[end, axis])
        if row.kind == POSITION and row.ends[end, 2] >= 0 and hung[4 + row.ends[end, 2]]:
            copy_point(row.kept_places[end], row.places[end])
            row.comforts[end], row.easings[end] = 1.0, 0.0
            if row.longest[end] > 0.0:  # a shoulder has no limb before it
                note_stretch(row, end, row.ends[end, 2] >= 2 or hung[row.ends[end, 2]] >= 0, work[5], pose)


@kernel
def note_stretch(row, end, holds_end, points, pose):
    """How far a limb that was blended is to stretch for its place: the straighter it is, the less it does.

    With d of its length to spare as it was blended, and w for its place, it keeps d s(w) / s(d) (``softly``); what that
    is beside w is for the trunk (METHOD (31)).
    """
    root, longest = limb_parts(row.ends[end, 2], pose[0].shape[0] - 23)[2], row.longest[end]
    x, y, z = aim_limb(row, end, False, holds_end, points, pose)
    shoulder, edge = pose[0][root], STRAIGHT * longest
    span = math.sqrt((x - shoulder[0]) ** 2 + (y - shoulder[1]) ** 2 + (z - shoulder[2]) ** 2)
    spare = max(longest - distance(points[0], shoulder), 0.0)
    row.reaches[end] = longest - spare * softly(longest - span, edge) / softly(spare, edge)
    row.folds[end] = row.reaches[end]


@kernel
def softly(value, edge):
    """``value`` where it is well above ``edge``, and ever less but never 0 below."""
    return 0.5 * (value + math.sqrt(value * value + 4.0 * edge * edge))
