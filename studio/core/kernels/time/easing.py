"""Frames where what was solved jolts, posed again as they were eased in time (METHOD (36) to (38))."""

import math

from studio.core.kernels.algebra.vectors import ORIGIN, copy_matrix, copy_point, copy_points, plus
from studio.core.kernels.body.parts import copy_pose
from studio.core.kernels.compiling import kernel, pack
from studio.core.kernels.limbs.limb_tasks import BLENDED
from studio.core.kernels.limits.clearance_tiers import measure_rooms
from studio.core.kernels.limits.clearing import clear_after
from studio.core.kernels.limits.root_reach import keep_feet_in_reach
from studio.core.kernels.records import Pose
from studio.core.kernels.search.placing import carry_body, posed
from studio.core.kernels.search.retreat import begin_retreat, note_disturbance, tries_share
from studio.core.kernels.tasks.goals import moves_mass
from studio.core.kernels.tasks.kinds import follow, miss_of, pin_goal
from studio.core.kernels.tasks.targets import set_goals
from studio.core.kernels.tasks.task import ACTIVE, INACTIVE, ON_EDGE, PINNED, STRICT
from studio.core.kernels.time.activation_blend import blend_kept, next_edge, note_misses, note_turns, pose_kept

ANY = 1e-9
"""The least activation: of what is told of all that act at all."""
HELD = 0.75 * STRICT
"""Metres or radians by which easing a level may change what those above it miss."""


@kernel
def ease_frame(frame, waited, clip, problem):
    """Pose a frame that was just solved as it was eased, and hold what stands above where that has come to be; tell
    what everything misses. Whether what keeps clear has ``waited``.
    """
    easing, chain, search = clip.easing, problem.chain, problem.search
    level, changes = easing.level[0], easing.changes
    above = pack(posed(problem, pack(Pose(easing.above.positions[frame], easing.above.rotations[frame]))))
    for joint in range(search.state.shape[0]):
        put_state(easing.states[frame, joint], chain.limits[joint], search.state[joint])
    for turn in range(16):
        copy_matrix(easing.turns[frame, turn], search.blended_turns[turn])
    pull_root(problem)
    if easing.above.back[frame] == 1.0:
        changes[frame] = pose_as_above(frame, clip, problem, above)
    else:
        changes[frame] = pose_eased(frame, level.meets, waited, clip, problem, above)
        if level.strict and changes[frame] >= HELD:
            retreat_from(changes[frame], frame, waited, clip, problem, above)
    tell_misses(frame, clip, problem)


@kernel
def pose_eased(frame, meets, waited, clip, problem, above):
    """Pose the body as its state and limbs are kept, and hold what stands above a level; by how much that changes.

    Whether the level ``meets`` what it wants, as far as it may, or stays as it is.
    """
    tasks, activations = problem.tasks, clip.asked.activations[-1]
    misses, level = clip.easing.misses, clip.easing.level[0]
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.blended_miss, row.miss_change = misses[c, frame] if misses[c, frame] > 0.0 else 0.0, math.inf
        if activations[c, frame] > 0.0 and row.rank < level.rank:
            pin(c, row.rank < level.contacts, above)
        elif row.status == ACTIVE and not meets:
            row.status = ON_EDGE
    pose_kept(frame, activations, problem)
    clears = clip.clearance.wanted.shape[0]
    if clears > 0:
        tell_misses(frame, clip, problem)
        clear_after(frame, tasks.shape[0] + clears, True, waited, clip, problem)
    return change_above(frame, clip, problem, above)


@kernel
def retreat_from(disturbs, frame, waited, clip, problem, above):
    """Leave but as much of the way from what stands above as changes nothing there; in the end that is none."""
    search, retreat = problem.search, problem.search.retreat[0]
    copy_points(search.state, search.before)
    copy_points(clip.easing.above.states[frame], search.kept)
    note_turns(search.solved_turns, problem.pose)
    note_turns(search.kept_turns, above.pose)
    begin_retreat(0.0, disturbs, HELD, retreat)
    while tries_share(retreat):
        blend_kept(1.0 - retreat.share, search)
        note_disturbance(pose_eased(frame, False, waited, clip, problem, above), retreat)
    if retreat.disturbs >= HELD:
        pose_as_above(frame, clip, problem, above)


@kernel
def pose_as_above(frame, clip, problem, above):
    """Pose the body as what stands above a level has it; by how much that changes."""
    copy_points(clip.easing.above.states[frame], problem.search.state)
    copy_pose(above.pose, problem.pose)
    if clip.clearance.wanted.shape[0] > 0:
        measure_rooms(frame, clip, problem.pose)
    return change_above(frame, clip, problem, above)


@kernel
def change_above(frame, clip, problem, above):
    """By how much what stands above a level is missed otherwise than it is to be, metres or radians.

    Where any is on its edge what is told of all is blended: they are to be missed as in the pose ``above``.
    """
    tasks, activations, misses = problem.tasks, clip.asked.activations[-1], clip.easing.misses
    clearance, level = clip.clearance, clip.easing.level[0]
    set_goals(ANY, frame, activations, clip.asked.targets, problem)
    edges = has_edge(frame, tasks, activations)
    for row in tasks:
        row.engaged = 0
    if edges:
        follow(tasks.shape[0], False, above)
        for c in range(tasks.shape[0]):
            tasks[c].engaged = 0
            if tasks[c].rank < level.rank and tasks[c].status != INACTIVE:
                tasks[c].blended_miss = miss_of(c, above)
    follow(tasks.shape[0], False, problem)
    most = 0.0
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.engaged = 0
        if row.rank < level.rank and row.status != INACTIVE:
            before = row.blended_miss if edges else misses[c, frame]
            most = max(most, abs(miss_of(c, problem) - before))
    for q in range(level.clears, clearance.wanted.shape[0]):
        if clearance.activations[q, frame] > 0.0:
            most = max(most, abs(clearance.misses[q, frame] - misses[tasks.shape[0] + q, frame]))
    return most


@kernel
def tell_misses(frame, clip, problem):
    """Tell what everything misses as it is posed: on its edge what was blended, and then so of all above a level."""
    tasks, activations, misses = problem.tasks, clip.asked.activations[-1], clip.easing.misses
    note_goals(frame, activations, clip.asked.targets, problem)
    edges = has_edge(frame, tasks, activations)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.blended_miss = misses[c, frame] if misses[c, frame] > 0.0 else 0.0
        if edges and row.rank < clip.easing.level[0].rank and row.status != INACTIVE:
            row.status = ON_EDGE
    note_misses(frame, problem, clip.residuals)


@kernel
def has_edge(frame, tasks, activations):
    """Whether anything is on an edge that is blended (``kernels.time.activation_blend``)."""
    return next_edge(0.0, frame, tasks, activations) < 1.0


@kernel
def pin(c, stands, above):
    """Ask of a constraint, or of what ``stands``, what it has in the pose ``above``."""
    row, search = above.tasks[c], above.search
    row.status, row.pinned, row.blended_miss, row.miss_change = ACTIVE, PINNED, 0.0, 0.0
    pin_goal(c, above)
    for end in range(2):
        limb = row.limbs[end]
        if not moves_mass(row) and limb >= 0 and row.freedoms[end, 0] > 0.0 and not (stands and limb >= 2):
            search.blended[limb] = BLENDED  # legs that stand are placed on their ankles


@kernel
def put_state(state, most, out_state):
    """Write how a joint has turned (3,), as far as it may at this frame."""
    size = math.sqrt(state[0] * state[0] + state[1] * state[1] + state[2] * state[2])
    part = most / size if size > most else 1.0
    for axis in range(3):
        out_state[axis] = part * state[axis]


@kernel
def pull_root(problem):
    """Bring the root back to where planted feet are in reach."""
    search, root = problem.search, problem.chain.slots[-1]
    if root < 0:
        return
    carry_body(problem)
    way = keep_feet_in_reach(problem.body, problem.start, search.carried, search.state[root], ORIGIN)
    copy_point(plus(search.state[root], way), search.state[root])


@kernel
def note_goals(frame, activations, targets, problem):
    """Let every constraint ask again what it asked before easing, for how much it misses now to be told."""
    tasks = problem.tasks
    set_goals(1.0, frame, activations, targets, problem)
    for c in range(tasks.shape[0]):
        row = tasks[c]
        row.engaged = 0
        if row.status == INACTIVE and activations[c, frame] > 0.0:
            row.status = ON_EDGE
    follow(tasks.shape[0], False, problem)
    for c in range(tasks.shape[0]):
        tasks[c].engaged = 0
