"""A whole clip on one body: feet on their ankles, then constraints, frame by frame, each from its own pose."""

import numpy as np

from studio.core.kernels.body import copy_pose, move_all
from studio.core.kernels.clearing import clear_after, clear_before, make_clear_work
from studio.core.kernels.compiling import allocating_kernel, kernel, pack
from studio.core.kernels.constraints import note_carried, solve_frame
from studio.core.kernels.easing import ease_frame
from studio.core.kernels.edges import HERE, IN_PART, clear_state, keep_solution, next_edge, note_misses, pose_between
from studio.core.kernels.jolts import note_jolts
from studio.core.kernels.legs import is_placed, place_leg
from studio.core.kernels.placing import follow
from studio.core.kernels.recruiting import free_limbs
from studio.core.kernels.stages import hold_above, keep_stage, make_kept, next_stage
from studio.core.kernels.wishes import set_goals


@allocating_kernel
def place_frames(channels, measures, drops, comforts, ankles, feet, toes, positions, rotations):
    """Lower the root by ``drops`` (F,) and put both legs on their ankles (2, F, 3), in place."""
    for frame in range(channels.shape[0]):
        if drops[frame] != 0.0:
            move_all(0.0, 0.0, -drops[frame], positions[frame])
        row = frame if measures.shape[0] > 1 else 0
        for side in range(2):
            place_side(frame, row, side, channels, measures, comforts, ankles, feet, toes, positions, rotations)


@kernel
def place_side(frame, row, side, channels, measures, comforts, ankles, feet, toes, positions, rotations):
    """One leg of one frame of ``place_frames`` with the measures of ``row``."""
    leg = (
        channels[frame],
        measures[row],
        side,
        comforts[side, frame],
        ankles[side, frame],
        feet[side, frame],
        toes[side, frame],
        positions[frame],
        rotations[frame],
    )
    if not is_placed(*leg):
        place_leg(*leg)


@allocating_kernel
def solve_frames(
    asked,
    areas,
    chain,
    recruits,
    wishes,
    activations,
    leashes,
    stance,
    body,
    clearance,
    start_positions,
    start_rotations,
    easing,
    out_residuals,
    positions,
    rotations,
):
    """Constraints of every frame, in place (METHOD 5 and 6).

    ``asked``, ``areas`` and ``chain`` as in ``kernels.constraints``; ``recruits`` the tuple (joints (n,), usual
    (C + L + 1, n), free (L, n, F)) of the limbs that a balance may turn: their joints, mobilities with limits last, how
    free each is for each level; ``wishes`` the tuple (places (C, F or 1, 3), turns (C, F or 1, 3, 3), distances
    (C, F or 1)) where things are to be at full activation; ``activations`` (K, C, F) of all down to each of
    K stages of ``kernels.stages``, the last of all; ``leashes`` (2, F) of the legs;
    ``stance`` the tuple (channels, comforts, ankles, feet, toes) of the legs; ``body`` the tuple (measures, masses
    (S, 2), shares (P,) of ``kernels.balance``, limits of ``kernels.joint_limits``); ``clearance`` as in
    ``kernels.clearance``, which works on the unsolved poses, in place, and again after the constraints; ``easing`` as
    in ``kernels.easing``.
    ``positions`` and ``rotations`` begin as copies of the unsolved ones.
    ``out_residuals`` (C, F): by how much each is missed (metres, radians for an orientation), NaN where not active.
    """
    work = make_work(asked.shape[0], chain[1].shape[0], positions.shape[1])
    clear_work, kept = make_clear_work(clearance), make_kept(clearance, asked.shape[0], chain[1].shape[0])
    motion = (start_positions, start_rotations, positions, rotations)
    solve_each(
        asked,
        areas,
        chain,
        recruits,
        wishes,
        activations,
        leashes,
        stance,
        body,
        clearance,
        clear_work,
        kept,
        work,
        motion,
        easing,
        out_residuals,
    )


@kernel
def solve_each(
    asked,
    areas,
    chain,
    recruits,
    wishes,
    activations,
    leashes,
    stance,
    body,
    clearance,
    clear_work,
    kept,
    work,
    motion,
    easing,
    out_residuals,
):
    """``solve_frames`` with its scratch: ``work``, and that of ``kernels.clearance``."""
    chain, recruits, wishes, stance, body = pack(chain), pack(recruits), pack(wishes), pack(stance), pack(body)
    clearance, clear_work, kept = pack(clearance), pack(clear_work), pack(kept)
    ask, solving, carried, turned, grips, points, sums, turns, full, past = work
    matrix, system, newton, active, answer, ways, levers, long = solving
    solving = pack((matrix, system, newton, active, answer, ways, levers, pack(long)))
    work = pack((pack(ask), solving, carried, turned, grips, points, sums, turns, pack(full), past))
    motion, easing = pack(motion), pack(easing)
    frames, states, eases, clears = easing[0], easing[1], easing[2].shape[0] > 0, clearance[2].shape[0] > 0
    last, every, acts = activations.shape[0] - 1, activations[activations.shape[0] - 1], False
    for number in range(frames.shape[0]):
        frame, first, waited, stage = frames[number], True, False, last
        start, pose = pack((motion[0][frame], motion[1][frame])), pack((motion[2][frame], motion[3][frame]))
        if clears:
            waited = clear_before(frame, eases, clearance, every, clear_work, start)
            stage = last if eases else next_stage(0, frame, clearance, activations)
        while stage <= last:
            if clears or eases:
                copy_pose(start, pose)
                clear_state(work)
            down = activations[stage]
            acts = solve_one(
                frame, asked, areas, chain, recruits, wishes, down, leashes, stance, body, work, motion, out_residuals
            )
            if eases or clears:
                frame_body = pack(body_at(frame, leashes, stance, body))
            if eases:
                given = pack((asked, areas, chain, wishes, every, frame_body))
                clear = pack((waited, clearance, clear_work, out_residuals))
                ease_frame(frame, given, clear, work, start, pose, easing)
            elif clears:
                keep_clear(
                    frame,
                    stage,
                    first,
                    acts,
                    waited,
                    asked,
                    areas,
                    activations,
                    chain,
                    frame_body,
                    clearance,
                    clear_work,
                    kept,
                    work,
                    start,
                    pose,
                    out_residuals,
                )
                first = False
            stage = last + 1 if eases or not clears else next_stage(stage + 1, frame, clearance, activations)
        for joint in range(states.shape[1]):
            for axis in range(3):
                states[frame, joint, axis] = work[3][0, joint, axis] if acts or eases else 0.0
        if not eases:
            note_jolts(frame, chain[1], motion, easing)


@kernel
def keep_clear(
    frame,
    stage,
    first,
    acts,
    waited,
    asked,
    areas,
    activations,
    chain,
    body,
    clearance,
    clear_work,
    kept,
    work,
    start,
    pose,
    out_residuals,
):
    """Clear the arms of one frame that was solved down to a ``stage``, and hold what stands above that."""
    clear_after(frame, stage, acts, waited, asked, areas, clearance, clear_work, body, work, start, pose, out_residuals)
    follow(asked.shape[0], True, asked, areas, work, start, pose)
    note_misses(frame, asked, areas, body, work, pose, out_residuals)
    down = activations[stage]
    if not first:
        hold_above(
            stage, frame, asked, areas, down, chain, body, clearance, clear_work, kept, work, start, pose, out_residuals
        )
    if stage < activations.shape[0] - 1:
        keep_stage(stage, first, frame, asked, clearance, kept, work, pose, out_residuals)


@kernel
def solve_one(
    frame, asked, areas, chain, recruits, wishes, activations, leashes, stance, body, work, motion, out_residuals
):
    """One frame of ``solve_frames``; whether anything acts. ``motion`` is what was, and what is being solved."""
    start, pose = pack((motion[0][frame], motion[1][frame])), pack((motion[2][frame], motion[3][frame]))
    frame_body = pack(body_at(frame, leashes, stance, body))
    least, any_acts = 0.0, False
    while True:
        more = next_edge(least, frame, asked, activations)
        acts = set_goals(more, frame, asked, areas, wishes, activations, frame_body, work, pose)
        if acts:
            free_limbs(frame, asked, recruits, chain)
            solve_frame(chain[0].shape[0] - asked.shape[0], asked, areas, chain, frame_body, work, start, pose)
        any_acts = any_acts or acts
        if least > 0.0:
            pose_between(least / more, frame, asked, areas, activations, chain, frame_body, work, start, pose)
        if more == 1.0:
            break
        keep_solution(least == 0.0, asked, areas, frame_body, work, pose)
        copy_pose(start, pose)
        clear_state(work)
        least = more
    if least > 0.0:
        for c in range(asked.shape[0]):
            asked[c].wanted = IN_PART if asked[c].wanted else 0
    note_misses(frame, asked, areas, frame_body, work, pose, out_residuals)
    return any_acts


@kernel
def body_at(frame, leashes, stance, body):
    """The ``body`` of ``kernels.constraints`` at one frame."""
    channels, comforts, ankles, feet, toes = stance
    row = body[0][frame if body[0].shape[0] > 1 else 0]
    legs = (channels[frame], comforts[:, frame], ankles[:, frame], feet[:, frame], toes[:, frame])
    return row, body[1], leashes[:, frame], legs, body[3], body[2]


@allocating_kernel
def make_work(constraint_count, joint_count, point_count):
    """Scratch, in the order that ``kernels.constraints`` names."""
    rows, segments = 8 * constraint_count + 2, point_count - 5
    long = np.empty((rows, 3 * joint_count)), np.empty((rows, 3 * joint_count)), np.zeros((rows + 2, 3 * joint_count))
    ask = (
        long[0].reshape((rows, joint_count, 3)),
        np.empty(rows),
        np.empty(rows, np.int64),
        np.empty(rows, np.int64),
        np.ones((joint_count, 4)),
        np.empty((rows, 9)),
        np.empty(rows),
    )
    solving = (
        np.empty((rows, rows)),
        np.empty((rows, rows + 2)),
        np.empty((rows, rows + 1)),
        np.empty(rows, np.bool_),
        np.empty(rows),
        long[2].reshape((rows + 2, joint_count, 3)),
        np.empty((rows, rows + 12)),
        long,
    )
    unknowns = 3 * joint_count
    full = (
        np.empty((unknowns, unknowns + 1)),
        np.empty((2, unknowns)),
        np.empty((joint_count, 3)),
    )
    carried = np.zeros((segments + 1, 3, 3))
    note_carried(carried)
    return (
        ask,
        solving,
        carried,
        np.zeros((4, joint_count, 3)),
        np.zeros(12, np.int64),
        np.empty((8, 3)),
        np.empty((segments + 1, 4)),
        np.empty((HERE + 16, 3, 3)),
        full,
        np.empty(5),
    )
