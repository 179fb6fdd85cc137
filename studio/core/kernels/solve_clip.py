"""Solution of all frames of a clip on one body: legs are placed on their ankles, then tasks are solved, frame by
frame.
"""

import numpy as np

from studio.core.kernels.algebra.vectors import zero_points
from studio.core.kernels.body.parts import copy_pose, translate_points
from studio.core.kernels.compiling import allocating_kernel, kernel, pack, small_kernel
from studio.core.kernels.limbs.legs import is_leg_placed, place_leg
from studio.core.kernels.limits.clearance_tiers import back_track_tier, make_kept_tier, next_tier, save_tier
from studio.core.kernels.limits.self_collision import clear_after_tasks, clear_before_tasks, make_clearance_scratch
from studio.core.kernels.records import (
    JOINT_DAMPING,
    LAST_STEP,
    LIMB_STATE,
    POINT_ERROR,
    ClipProblem,
    ConstraintSet,
    Equations,
    FlattenedTaskRows,
    FrameBody,
    FrameProblem,
    FullNewtonScratch,
    LegTargets,
    Pose,
    SearchState,
    SolverScratch,
    TaskRows,
)
from studio.core.kernels.search.backtracking import BACKTRACKING
from studio.core.kernels.search.levels import reset_rotations, solve_frame
from studio.core.kernels.search.redundancy import update_joint_weights
from studio.core.kernels.tasks.targets import set_goals, update_relative_weights
from studio.core.kernels.tasks.task_kinds import update_goals
from studio.core.kernels.tasks.task_status import INACTIVE, begin_transition
from studio.core.kernels.time.acceleration_peaks import update_acceleration_peaks
from studio.core.kernels.time.activation_blend import next_activation, pose_blend, save_solution, write_residuals
from studio.core.kernels.time.smoothed_frames import pose_smoothed


@kernel
def place_frames(measures, drops, legs, positions, rotations):
    """Lower the root by ``drops`` (F,) metres and place both ``legs`` (``LegTargets``) on their ankle targets, in
    place.

    ``measures`` (F or 1, n); ``positions`` (F, P, 3) and ``rotations`` (F, S, 3, 3).
    """
    for frame in range(drops.shape[0]):
        if drops[frame] != 0.0:
            translate_points(0.0, 0.0, -drops[frame], positions[frame])
        row = measures[frame if measures.shape[0] > 1 else 0]
        pose, now = pack(Pose(positions[frame], rotations[frame])), pack(legs_at(frame, legs))
        for side in range(2):
            if not is_leg_placed(side, row, now, pose):
                place_leg(side, row, now, pose)


@allocating_kernel
def solve_frames(request, body, motion, clearance, easing, out_residuals):
    """Solve the tasks of every frame in ``easing.frames``, in place (METHOD 7 to 9).

    Arguments are records of ``kernels.records``. Arms are pushed out of the body in the unsolved poses of ``motion``,
    in place, and again after the tasks; the solved poses of ``motion`` must begin as copies of the unsolved ones.
    ``out_residuals`` (C, F): residual of each task (metres, radians for rotations), NaN where inactive.
    """
    count, joints = request.tasks.shape[0], request.chain.joints.shape[0]
    search = make_search(count, joints, motion.positions.shape[1])
    scratch = SolverScratch(search, make_clearance_scratch(clearance.volume), make_kept_tier(clearance, count, joints))
    solve_run(request, body, motion, clearance, easing, scratch, out_residuals)


@kernel
def solve_run(request, body, motion, clearance, easing, scratch, out_residuals):
    """Solve all frames of ``solve_frames`` with scratch that the caller has allocated."""
    chain, made = pack(request.chain), scratch.search
    search = pack(pack_search(pack(made.rows), pack(made.equations), pack(made.damped), made))
    known = ClipProblem(
        pack(
            ConstraintSet(
                request.tasks,
                request.areas,
                chain,
                pack(request.redundancy),
                pack(request.targets),
                request.activations,
                request.weights,
            )
        ),
        pack(body),
        pack(motion),
        pack(clearance),
        pack(scratch.clearing),
        pack(scratch.kept),
        pack(easing),
        out_residuals,
    )
    clip = pack(known)
    eases, clears, acts = easing.rotations.shape[0] > 0, clearance.required_distances.shape[0] > 0, False
    for number in range(easing.frames.shape[0]):
        frame = easing.frames[number]
        start = pack(Pose(motion.start_positions[frame], motion.start_rotations[frame]))
        pose = pack(Pose(motion.positions[frame], motion.rotations[frame]))
        now = pack(body_at(frame, body, pack(legs_at(frame, body.legs))))
        problem = pack(FrameProblem(request.tasks, request.areas, chain, now, search, start, pose))
        if eases:
            pose_smoothed_frame(frame, clears, clip, problem)
        elif clears:
            acts = solve_tiers(frame, clip, problem)
        else:
            acts = solve_activations(frame, 0, clip, problem)
        for joint in range(easing.states.shape[1]):
            for axis in range(3):
                easing.states[frame, joint, axis] = search.state[joint, axis] if acts or eases else 0.0
        if not eases:
            update_acceleration_peaks(frame, clip)


@kernel
def pose_smoothed_frame(frame, clears, clip, problem):
    """Pose one frame from its smoothed state. It is solved with all active tasks first, to update goals and weights."""
    waited = clears and clear_before_tasks(frame, True, clip, problem.start)
    reset_pose(problem)
    solve_activations(frame, clip.constraints.activations.shape[0] - 1, clip, problem)
    pose_smoothed(frame, waited, clip, problem)


@kernel
def solve_tiers(frame, clip, problem):
    """Solve one frame tier by tier, pushing arms out of the body after each; True if a task is active.

    A tier is a group of priorities solved together (``kernels.limits.clearance_tiers``).
    """
    last = clip.constraints.activations.shape[0] - 1
    waited = clear_before_tasks(frame, False, clip, problem.start)
    tier, first, acts = next_tier(0, frame, clip), True, False
    while tier <= last:
        reset_pose(problem)
        acts = solve_activations(frame, tier, clip, problem)
        clear_after_tasks(frame, tier, acts, waited, clip, problem)
        update_goals(problem.tasks.shape[0], True, problem)
        write_residuals(frame, problem, clip.residuals)
        if not first:
            back_track_tier(tier, frame, clip, problem)
        if tier < last:
            save_tier(tier, first, frame, clip, problem)
        first, tier = False, next_tier(tier + 1, frame, clip)
    return acts


@kernel
def reset_pose(problem):
    """Reset the pose to the unsolved one, and the state to zero."""
    copy_pose(problem.start, problem.pose)
    zero_points(problem.search.state)


@kernel
def solve_activations(frame, tier, clip, problem):
    """Solve the tasks of one frame down to a ``tier``; True if any is active.

    During an activation transition several solutions, with and without the tasks in transition, are blended.
    """
    tasks, chain, activations = problem.tasks, problem.chain, clip.constraints.activations[tier]
    least, any_acts = 0.0, False
    while True:
        more = next_activation(least, frame, tasks, activations)
        acts = set_goals(more, frame, activations, clip.constraints, problem)
        if acts:
            update_relative_weights(tasks)
            update_joint_weights(more, frame, activations, clip.constraints.redundancy, problem)
            solve_frame(chain.weights.shape[0] - tasks.shape[0], problem)
        any_acts = any_acts or acts
        if least > 0.0:
            update_joint_weights(0.0, frame, clip.constraints.activations[-1], clip.constraints.redundancy, problem)
            pose_blend(least / more, frame, activations, problem)
        if more == 1.0:
            break
        save_solution(least == 0.0, problem)
        reset_pose(problem)
        least = more
    if least > 0.0:
        for c in range(tasks.shape[0]):
            if tasks[c].status != INACTIVE:
                begin_transition(tasks[c])
    write_residuals(frame, problem, clip.residuals)
    return any_acts


@small_kernel
def legs_at(frame, legs):
    """``LegTargets`` of one frame, from those of all frames."""
    ankles, feet, toes = legs.ankles[:, frame], legs.feet[:, frame], legs.toes[:, frame]
    return LegTargets(legs.channels[frame], legs.soft_thresholds[:, frame], ankles, feet, toes)


@small_kernel
def body_at(frame, body, legs):
    """``FrameBody`` of one frame, from the ``BodyFrames`` of all and the frame's packed leg targets."""
    row = body.measures[frame if body.measures.shape[0] > 1 else 0]
    contacts = body.hand_contacts[:, frame if body.hand_contacts.shape[1] > 1 else 0]
    ground = body.ground[:, frame if body.ground.shape[1] > 1 else 0]
    return FrameBody(
        row, body.masses, body.root_reaches[:, frame], legs, body.limits, body.mass_fractions, contacts, ground
    )


@small_kernel
def pack_search(rows, equations, damped, search):
    """``SearchState`` with its nested records packed by the caller: a packed record is valid only in its packing
    function.
    """
    return SearchState(
        rows,
        equations,
        damped,
        search.last_step,
        search.backtracking,
        search.segment_rotations,
        search.state,
        search.level_start,
        search.kept_state,
        search.trial_state,
        search.end_tasks,
        search.blended_limbs,
        search.idle_limbs,
        search.mass_sums,
        search.limbs,
        search.blended_rotations,
        search.solved_rotations,
        search.kept_rotations,
    )


@allocating_kernel
def make_search(task_count, joint_count, point_count):
    """Scratch of a search for C tasks, N joints and P points."""
    rows, segments, unknowns = 8 * task_count + 2, point_count - 5, 3 * joint_count
    jacobian, weighted, steps = np.empty((rows, unknowns)), np.empty((rows, unknowns)), np.zeros((rows + 2, unknowns))
    task_rows = TaskRows(
        jacobian.reshape((rows, joint_count, 3)),
        np.empty(rows),
        np.empty(rows, np.int64),
        np.empty(rows, np.int64),
        np.zeros(joint_count, JOINT_DAMPING),
        np.zeros(rows, POINT_ERROR),
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
        FlattenedTaskRows(jacobian, weighted, steps),
    )
    damped = FullNewtonScratch(
        np.empty((unknowns, unknowns + 1)), np.empty(unknowns), np.empty(unknowns), np.empty((joint_count, 3))
    )
    segment_rotations = np.zeros((segments + 1, 3, 3))
    reset_rotations(segment_rotations)
    return SearchState(
        task_rows,
        equations,
        damped,
        np.zeros(1, LAST_STEP),
        np.zeros(1, BACKTRACKING),
        segment_rotations,
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
