"""A whole clip on one body: feet on their ankles, then constraints, frame by frame, each from its own pose."""

import numpy as np

from studio.core.kernels.algebra.vectors import clear_points
from studio.core.kernels.body.parts import copy_pose, move_all
from studio.core.kernels.compiling import allocating_kernel, kernel, pack, small_kernel
from studio.core.kernels.limbs.legs import is_placed, place_leg
from studio.core.kernels.limits.clearance_tiers import hold_above, keep_tier, make_kept, next_tier
from studio.core.kernels.limits.clearing import clear_after, clear_before, make_clearing
from studio.core.kernels.records import (
    BRAKE,
    LAST_STEP,
    LIMB_STATE,
    PULL,
    Asked,
    Body,
    Clip,
    DampedStep,
    Equations,
    FlatRows,
    Legs,
    Pose,
    Problem,
    Scratch,
    Search,
    TaskRows,
)
from studio.core.kernels.search.levels import note_carried, solve_frame
from studio.core.kernels.search.recruiting import free_joints
from studio.core.kernels.search.retreat import RETREAT
from studio.core.kernels.tasks.kinds import follow
from studio.core.kernels.tasks.targets import set_goals, weigh
from studio.core.kernels.tasks.task import INACTIVE, ON_EDGE
from studio.core.kernels.time.activation_blend import keep_solution, next_edge, note_misses, pose_between
from studio.core.kernels.time.easing import ease_frame
from studio.core.kernels.time.jolts import note_jolts


@kernel
def place_frames(measures, drops, legs, positions, rotations):
    """Lower the root by ``drops`` (F,) and put both ``legs`` (``kernels.records``) on their ankles, in place.

    ``measures`` (F or 1, n); ``positions`` (F, P, 3) and ``rotations`` (F, S, 3, 3).
    """
    for frame in range(drops.shape[0]):
        if drops[frame] != 0.0:
            move_all(0.0, 0.0, -drops[frame], positions[frame])
        row = measures[frame if measures.shape[0] > 1 else 0]
        pose, now = pack(Pose(positions[frame], rotations[frame])), pack(legs_at(frame, legs))
        for side in range(2):
            if not is_placed(side, row, now, pose):
                place_leg(side, row, now, pose)


@allocating_kernel
def solve_frames(asked, body, motion, clearance, easing, out_residuals):
    """Constraints of every frame, in place (METHOD 5 and 6).

    Records as in ``kernels.records``. What keeps clear works on the unsolved poses of ``motion``, in place, and again
    after the constraints; its solved poses begin as copies of the unsolved ones.
    ``out_residuals`` (C, F): by how much each is missed (metres, radians for an orientation), NaN where not active.
    """
    count, joints = asked.tasks.shape[0], asked.chain.joints.shape[0]
    search = make_search(count, joints, motion.positions.shape[1])
    scratch = Scratch(search, make_clearing(clearance.volume), make_kept(clearance, count, joints))
    solve_each(asked, body, motion, clearance, easing, scratch, out_residuals)


@kernel
def solve_each(asked, body, motion, clearance, easing, scratch, out_residuals):
    """``solve_frames`` with its scratch."""
    chain, made = pack(asked.chain), scratch.search
    search = pack(with_packed(pack(made.rows), pack(made.equations), pack(made.damped), made))
    known = Clip(
        pack(Asked(asked.tasks, asked.areas, chain, pack(asked.recruits), pack(asked.targets), asked.activations)),
        pack(body),
        pack(motion),
        pack(clearance),
        pack(scratch.clearing),
        pack(scratch.kept),
        pack(easing),
        out_residuals,
    )
    clip = pack(known)
    eases, clears, acts = easing.turns.shape[0] > 0, clearance.wanted.shape[0] > 0, False
    for number in range(easing.frames.shape[0]):
        frame = easing.frames[number]
        start = pack(Pose(motion.start_positions[frame], motion.start_rotations[frame]))
        pose = pack(Pose(motion.positions[frame], motion.rotations[frame]))
        now = pack(body_at(frame, body, pack(legs_at(frame, body.legs))))
        problem = pack(Problem(asked.tasks, asked.areas, chain, now, search, start, pose))
        if eases:
            solve_eased(frame, clears, clip, problem)
        elif clears:
            acts = solve_tiers(frame, clip, problem)
        else:
            acts = solve_one(frame, 0, clip, problem)
        for joint in range(easing.states.shape[1]):
            for axis in range(3):
                easing.states[frame, joint, axis] = search.state[joint, axis] if acts or eases else 0.0
        if not eases:
            note_jolts(frame, clip)


@kernel
def solve_eased(frame, clears, clip, problem):
    """One frame posed again as it was eased, after it was solved with all that acts."""
    waited = clears and clear_before(frame, True, clip, problem.start)
    begin(problem)
    solve_one(frame, clip.asked.activations.shape[0] - 1, clip, problem)
    ease_frame(frame, waited, clip, problem)


@kernel
def solve_tiers(frame, clip, problem):
    """One frame solved and cleared tier by tier (``kernels.limits.clearance_tiers``); whether anything acts in the
    last.
    """
    last = clip.asked.activations.shape[0] - 1
    waited = clear_before(frame, False, clip, problem.start)
    tier, first, acts = next_tier(0, frame, clip), True, False
    while tier <= last:
        begin(problem)
        acts = solve_one(frame, tier, clip, problem)
        clear_after(frame, tier, acts, waited, clip, problem)
        follow(problem.tasks.shape[0], True, problem)
        note_misses(frame, problem, clip.residuals)
        if not first:
            hold_above(tier, frame, clip, problem)
        if tier < last:
            keep_tier(tier, first, frame, clip, problem)
        first, tier = False, next_tier(tier + 1, frame, clip)
    return acts


@kernel
def begin(problem):
    """Begin from the motion's own pose, with nothing turned."""
    copy_pose(problem.start, problem.pose)
    clear_points(problem.search.state)


@kernel
def solve_one(frame, tier, clip, problem):
    """One frame down to a ``tier``; whether anything acts. On edges it is blended of several solves."""
    tasks, chain, activations = problem.tasks, problem.chain, clip.asked.activations[tier]
    least, any_acts = 0.0, False
    while True:
        more = next_edge(least, frame, tasks, activations)
        acts = set_goals(more, frame, activations, clip.asked.targets, problem)
        if acts:
            weigh(tasks)
            free_joints(more, frame, activations, clip.asked.recruits, problem)
            solve_frame(chain.mobilities.shape[0] - tasks.shape[0], problem)
        any_acts = any_acts or acts
        if least > 0.0:
            free_joints(0.0, frame, clip.asked.activations[-1], clip.asked.recruits, problem)
            pose_between(least / more, frame, activations, problem)
        if more == 1.0:
            break
        keep_solution(least == 0.0, problem)
        begin(problem)
        least = more
    if least > 0.0:
        for c in range(tasks.shape[0]):
            tasks[c].status = ON_EDGE if tasks[c].status != INACTIVE else 0
    note_misses(frame, problem, clip.residuals)
    return any_acts


@small_kernel
def legs_at(frame, legs):
    """Legs at one frame."""
    ankles, feet, toes = legs.ankles[:, frame], legs.feet[:, frame], legs.toes[:, frame]
    return Legs(legs.channels[frame], legs.comforts[:, frame], ankles, feet, toes)


@small_kernel
def body_at(frame, body, legs):
    """The body at one frame, with its ``legs`` there, packed by who calls."""
    row = body.measures[frame if body.measures.shape[0] > 1 else 0]
    return Body(row, body.masses, body.root_reaches[:, frame], legs, body.limits, body.shares)


@small_kernel
def with_packed(rows, equations, damped, search):
    """A search with these of its records packed: who calls packs them, as what is packed ends with its maker."""
    return Search(
        rows,
        equations,
        damped,
        search.last,
        search.retreat,
        search.carried,
        search.state,
        search.before,
        search.kept,
        search.tried,
        search.ends,
        search.blended,
        search.idle,
        search.sums,
        search.limbs,
        search.blended_turns,
        search.solved_turns,
        search.kept_turns,
    )


@allocating_kernel
def make_search(task_count, joint_count, point_count):
    """The scratch of a search for C tasks, N joints and P points."""
    rows, segments, unknowns = 8 * task_count + 2, point_count - 5, 3 * joint_count
    jacobian, weighted, steps = np.empty((rows, unknowns)), np.empty((rows, unknowns)), np.zeros((rows + 2, unknowns))
    task_rows = TaskRows(
        jacobian.reshape((rows, joint_count, 3)),
        np.empty(rows),
        np.empty(rows, np.int64),
        np.empty(rows, np.int64),
        np.zeros(joint_count, BRAKE),
        np.zeros(rows, PULL),
        np.empty(rows),
    )
    equations = Equations(
        np.empty((rows, rows)),
        np.empty((rows, rows + 2)),
        np.empty((rows, rows + 1)),
        np.empty(rows, np.bool_),
        np.empty(rows),
        steps.reshape((rows + 2, joint_count, 3)),
        np.empty((rows, rows + 12)),
        FlatRows(jacobian, weighted, steps),
    )
    damped = DampedStep(
        np.empty((unknowns, unknowns + 1)), np.empty(unknowns), np.empty(unknowns), np.empty((joint_count, 3))
    )
    carried = np.zeros((segments + 1, 3, 3))
    note_carried(carried)
    return Search(
        task_rows,
        equations,
        damped,
        np.zeros(1, LAST_STEP),
        np.zeros(1, RETREAT),
        carried,
        np.zeros((joint_count, 3)),
        np.zeros((joint_count, 3)),
        np.zeros((joint_count, 3)),
        np.zeros((joint_count, 3)),
        np.zeros(4, np.int64),
        np.zeros(4, np.int64),
        np.zeros(4, np.int64),
        np.empty((segments + 1, 4)),
        np.zeros(4, LIMB_STATE),
        np.empty((16, 3, 3)),
        np.empty((16, 3, 3)),
        np.empty((16, 3, 3)),
    )
