"""Frames where what was solved jolts, posed again as they were eased in time (METHOD (36) to (38)).

``easing`` is the tuple (frames (n,) to be solved, states (F, N, 3) of their searches, turns (F, 16, 3, 3) of the limbs'
joints, four a limb, as eased, none while nothing is, level (5,) that is eased, whether it is met again, how many are
contacts', whether frames that change what stands above go back to it, misses (C + Q, F) of those above as eased and of
others before, kept (positions, rotations, states, back (F,)) what those above have become and how far frames go back
to that, and of ``kernels.jolts`` limbs, carriers, source, rate (1,) and jolts, the first of which become by how much
those above are changed by the easing).
"""

import math

from studio.core.kernels.balance import centre_of_mass
from studio.core.kernels.body import copy_pose
from studio.core.kernels.clearing import clear_after
from studio.core.kernels.compiling import kernel, pack
from studio.core.kernels.edges import HERE, IN_PART, THERE, blend_kept, next_edge, note_misses, note_turns, pose_kept
from studio.core.kernels.goals import BALANCE, DISTANCE, LOOK_AT, ORIENTATION, POSITION, end_place, second_place
from studio.core.kernels.limb_constraints import HUNG
from studio.core.kernels.placing import KEPT_TURNS, TURN, carry_body, follow, miss_of
from studio.core.kernels.rows import AWAY
from studio.core.kernels.stages import measure_rooms, note_spot
from studio.core.kernels.stance import keep_feet_in_reach
from studio.core.kernels.vectors import copy_matrix, copy_point, distance
from studio.core.kernels.wishes import set_goals

ANY = 1e-9
"""The least activation: of what is told of all that act at all."""
HELD = 1.5e-4
"""Metres or radians by which easing a level may change what those above it miss."""
HALVES = 5
"""Times that the way of a frame is halved."""


@kernel
def ease_frame(frame, asking, clearing, work, start, pose, easing):
    """Pose a frame that was just solved as it was eased, and hold what stands above where that has come to be; tell
    what everything misses.

    ``asking`` the tuple (asked, areas, chain, wishes, activations, body), ``clearing`` (what has ``waited``, clearance,
    its work, residuals), each as in ``kernels.adapt``.
    """
    asked, areas, chain, wishes, activations, body = asking
    waited, clearance, clear_work, residuals = clearing
    _, states, turns, level, misses, kept, _, _, _, _, out_lost = easing
    clear = pack((waited, clearance, clear_work, level[4], residuals))
    given = pack((asked, areas, chain, wishes, activations, body, work, start, pose, misses, clear))
    above = pack((kept[0][frame], kept[1][frame]))
    for joint in range(states.shape[1]):
        put_state(states[frame, joint], chain[3][joint], work[3][0, joint])
    for turn in range(16):
        copy_matrix(turns[frame, turn], work[7][KEPT_TURNS + turn])
    pull_root(chain, body, work, start, pose)
    if kept[3][frame] == 1.0:
        out_lost[frame, 0] = pose_as_above(frame, level[0], kept[2][frame], given, above)
    else:
        out_lost[frame, 0] = pose_eased(frame, level[0], level[1], level[2], given, above)
        if level[3] and out_lost[frame, 0] >= HELD:
            go_back(frame, level[0], level[2], kept[2][frame], given, above)
    tell_misses(frame, level[0], given)


@kernel
def pose_eased(frame, level, meets, held, given, above):
    """Pose the body as its state and limbs are kept, and hold what stands above a level; by how much that changes.

    Whether the level ``meets`` what it wants, as far as it may, or stays as it is.
    """
    asked, areas, chain, _, activations, body, work, start, pose, misses, clear = given
    for c in range(asked.shape[0]):
        row = asked[c]
        row.blended = misses[c, frame] if misses[c, frame] > 0.0 else 0.0
        if activations[c, frame] > 0.0 and row.rank < level:
            pin(c, row.rank < held, asked, areas, body, work, start, above)
        elif row.wanted == 1 and not meets:
            row.wanted = IN_PART
    pose_kept(frame, asked, areas, activations, chain, body, work, start, pose)
    waited, clearance, clear_work, _, residuals = clear
    if clearance[2].shape[0] > 0:
        tell_misses(frame, level, given)
        last = asked.shape[0] + clearance[2].shape[0]
        clear_after(frame, last, True, waited, asked, areas, clearance, clear_work, body, work, start, pose, residuals)
    return change_above(frame, level, given, above)


@kernel
def go_back(frame, level, held, state, given, above):
    """Leave but as much of the way from what stands above as changes nothing there; in the end that is none.

    ``state`` (N, 3) is the search's where it begins.
    """
    work, pose = given[6], given[8]
    turned, least, most, share = work[3], 0.0, 1.0, 1.0
    for joint in range(turned.shape[1]):
        copy_point(turned[0, joint], turned[1, joint])
        copy_point(state[joint], turned[2, joint])
    note_turns(HERE, work[7], pose)
    note_turns(THERE, work[7], above)
    for _ in range(HALVES):
        share = 0.5 * (least + most)
        blend_kept(1.0 - share, work)
        if pose_eased(frame, level, False, held, given, above) < HELD:
            least = share
        else:
            most = share
    if share == least:
        return
    blend_kept(1.0 - least, work)
    if least == 0.0 or pose_eased(frame, level, False, held, given, above) >= HELD:
        pose_as_above(frame, level, state, given, above)


@kernel
def pose_as_above(frame, level, state, given, above):
    """Pose the body as what stands above a level has it, with a search's ``state`` (N, 3); by how much that changes."""
    _, _, _, _, _, _, work, _, pose, _, clear = given
    for joint in range(state.shape[0]):
        copy_point(state[joint], work[3][0, joint])
    copy_pose(above, pose)
    if clear[1][2].shape[0] > 0:
        measure_rooms(frame, clear[1], clear[2], pose)
    return change_above(frame, level, given, above)


@kernel
def change_above(frame, level, given, above):
    """By how much what stands above a level is missed otherwise than it is to be, metres or radians.

    Where any is on its edge what is told of all is blended: they are to be missed as in the pose ``above``.
    """
    asked, areas, _, wishes, activations, body, work, start, pose, misses, (_, clearance, _, clears, _) = given
    set_goals(ANY, frame, asked, areas, wishes, activations, body, work, start)
    edges = has_edge(frame, asked, activations)
    for row in asked:
        row.engaged = 0
    if edges:
        follow(asked.shape[0], False, asked, areas, work, start, above)
        for c in range(asked.shape[0]):
            asked[c].engaged = 0
            if asked[c].rank < level and asked[c].wanted:
                asked[c].blended = miss_of(c, asked, areas, body, work, above)
    follow(asked.shape[0], False, asked, areas, work, start, pose)
    most = 0.0
    for c in range(asked.shape[0]):
        row = asked[c]
        row.engaged = 0
        if row.rank < level and row.wanted:
            before = row.blended if edges else misses[c, frame]
            most = max(most, abs(miss_of(c, asked, areas, body, work, pose) - before))
    for q in range(clears, clearance[2].shape[0]):
        if clearance[3][q, frame] > 0.0:
            most = max(most, abs(clearance[7][q, frame] - misses[asked.shape[0] + q, frame]))
    return most


@kernel
def tell_misses(frame, level, given):
    """Tell what everything misses as it is posed: on its edge what was blended, and then so of all above a level."""
    asked, areas, _, wishes, activations, body, work, start, pose, misses, clear = given
    note_goals(frame, asked, areas, wishes, activations, body, work, start, pose)
    edges = has_edge(frame, asked, activations)
    for c in range(asked.shape[0]):
        row = asked[c]
        row.blended = misses[c, frame] if misses[c, frame] > 0.0 else 0.0
        if edges and row.rank < level and row.wanted:
            row.wanted = IN_PART
    note_misses(frame, asked, areas, body, work, pose, clear[4])


@kernel
def has_edge(frame, asked, activations):
    """Whether anything is on an edge that is blended (``kernels.edges``)."""
    return next_edge(0.0, frame, asked, activations) < 1.0


@kernel
def pin(c, stands, asked, areas, body, work, start, above):
    """Ask of a constraint, or of what ``stands``, what it has in the pose ``above``."""
    row, hung, point, other = asked[c], work[4], work[5][0], work[5][1]
    row.wanted, row.pinned, row.blended = 1, 1, 0.0
    if row.kind == DISTANCE:
        end_place(row, 0, above, point)
        second_place(row, above, other)
        row.distance = distance(point, other)
    elif row.kind == POSITION:
        note_spot(row, work, above, row.relative[0] if row.ends[1, 0] >= 0 else row.places[0])
    elif row.kind == ORIENTATION and row.ends[1, 0] < 0:
        copy_matrix(above[1][row.ends[0, 1]], row.turn)
    elif row.kind == BALANCE and row.ends[1, 0] < 0:
        centre_of_mass(body[5], above[0], row.places[0])
        copy_point(row.places[0], row.places[1])
    else:
        row.engaged = 0
        follow(row.rank, False, asked, areas, work, start, above)
        row.blended = miss_of(c, asked, areas, body, work, above)
        row.pinned = 1 if row.kind == LOOK_AT else 0
        if row.kind == LOOK_AT and row.blended >= AWAY:
            row.pinned, row.blended = TURN, 0.0
            copy_matrix(above[1][row.ends[0, 1]], row.turn)
    for end in range(2):
        limb = row.ends[end, 2]
        if row.kind != BALANCE and limb >= 0 and row.freedoms[end, 0] > 0.0 and not (stands and limb >= 2):
            hung[4 + limb] = HUNG  # legs that stand are placed on their ankles


@kernel
def put_state(state, most, out_state):
    """Write how a joint has turned (3,), as far as it may at this frame."""
    size = math.sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2])
    part = most / size if size > most else 1.0
    for axis in range(3):
        out_state[axis] = part * state[axis]


@kernel
def pull_root(chain, body, work, start, pose):
    """Bring the root back to where planted feet are in reach."""
    root, turned, way = chain[2][-1], work[3][0], work[5][7]
    if root < 0:
        return
    carry_body(chain, body, work, start, pose)
    way[0] = way[1] = way[2] = 0.0
    keep_feet_in_reach(body, start, work[2], turned[root], way)
    for axis in range(3):
        turned[root, axis] += way[axis]


@kernel
def note_goals(frame, asked, areas, wishes, activations, body, work, start, pose):
    """Let every constraint ask again what it asked before easing, for how much it misses now to be told."""
    set_goals(1.0, frame, asked, areas, wishes, activations, body, work, start)
    for c in range(asked.shape[0]):
        row = asked[c]
        row.engaged = 0
        if not row.wanted and activations[c, frame] > 0.0:
            row.wanted = IN_PART
    follow(asked.shape[0], False, asked, areas, work, start, pose)
    for c in range(asked.shape[0]):
        asked[c].engaged = 0
