"""Frames where what was solved jolts, posed again as they were eased in time (METHOD (36) to (38)).

``easing`` is the tuple (frames (n,) to be solved, states (F, N, 3) of their searches, turns (F, 16, 3, 3) of the limbs'
joints, four a limb, as eased, none while nothing is, level (3,) that is eased, whether it is met again, how many are
contacts', misses (C, F) before the easing, kept (positions, rotations) what those above it have become, and of
``kernels.jolts`` limbs, carriers, source, rate (1,) and jolts, the first of which become the metres that those above
have lost by the easing).
"""

import math

from studio.core.kernels.balance import centre_of_mass
from studio.core.kernels.compiling import kernel
from studio.core.kernels.constraints import disturbance
from studio.core.kernels.edges import IN_PART, pose_kept
from studio.core.kernels.goals import BALANCE, LOOK_AT, ORIENTATION, POSITION, end_place
from studio.core.kernels.limb_constraints import HUNG
from studio.core.kernels.packed import pack
from studio.core.kernels.placing import KEPT_TURNS, carry_body, follow, miss_of
from studio.core.kernels.stance import keep_feet_in_reach
from studio.core.kernels.vectors import copy_matrix, copy_point
from studio.core.kernels.wishes import set_goals


@kernel
def ease_frame(frame, asked, areas, chain, wishes, activations, body, work, start, pose, easing):
    """Pose a frame that was just solved as it was eased, and hold what stands above where that has come to be."""
    _, states, turns, level, misses, kept, _, _, _, _, out_lost = easing
    above = pack((kept[0][frame], kept[1][frame]))
    for joint in range(states.shape[1]):
        put_state(states[frame, joint], chain[3][joint], work[3][0, joint])
    for turn in range(16):
        copy_matrix(turns[frame, turn], work[7][KEPT_TURNS + turn])
    pull_root(chain, body, work, start, pose)
    for c in range(asked.shape[0]):
        row = asked[c]
        row.blended = misses[c, frame] if misses[c, frame] > 0.0 else 0.0
        if activations[c, frame] > 0.0 and row.rank < level[0]:
            pin(c, row.rank < level[2], asked, areas, body, work, start, above)
        elif row.wanted == 1 and not level[1]:
            row.wanted = IN_PART
    pose_kept(frame, asked, areas, activations, chain, body, work, start, pose)
    out_lost[frame, 0] = disturbance(level[0], False, asked, areas, body, work, pose)
    note_goals(frame, asked, areas, wishes, activations, body, work, start, pose)


@kernel
def pin(c, stands, asked, areas, body, work, start, above):
    """Ask of a constraint, or of what ``stands``, what it has in the pose ``above``."""
    row, hung = asked[c], work[4]
    row.wanted, row.blended = 1, 0.0
    if row.kind == POSITION and row.ends[1, 0] < 0:
        end_place(row, 0, above, row.places[0])
    elif row.kind == LOOK_AT or (row.kind == ORIENTATION and row.ends[1, 0] < 0):
        row.pinned = 1
        copy_matrix(above[1][row.ends[0, 1]], row.turn)
    elif row.kind == BALANCE and row.ends[1, 0] < 0:
        centre_of_mass(body[5], above[0], row.places[0])
        copy_point(row.places[0], row.places[1])
    else:
        row.engaged = 0
        follow(row.rank, False, asked, areas, work, start, above)
        row.blended = miss_of(c, asked, areas, body, work, above)
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
