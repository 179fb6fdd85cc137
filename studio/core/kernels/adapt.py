"""A whole clip on one body: feet on their ankles, then constraints, frame by frame, each from its own pose."""

import math

import numpy as np
from numba import njit

from studio.core.kernels.areas import put_area
from studio.core.kernels.balance import centre_of_mass, segment_centres
from studio.core.kernels.body import move_all
from studio.core.kernels.constraints import solve_frame
from studio.core.kernels.goals import AREA, BALANCE, DISTANCE, LOOK_AT, ORIENTATION, ease_goal, end_place, second_place
from studio.core.kernels.legs import place_leg
from studio.core.kernels.limb_constraints import distance
from studio.core.kernels.placing import miss_of, turn_error
from studio.core.kernels.rotation import multiply, rotation_vector_to_matrix


@njit(cache=True, nogil=True)
def place_frames(channels, measures, drops, comforts, ankles, feet, toes, positions, rotations):
    """Lower the root by ``drops`` (F,) and put both legs on their ankles (2, F, 3), in place."""
    work = np.empty((3, 3, 3))
    for frame in range(channels.shape[0]):
        row = measures[frame if measures.shape[0] > 1 else 0]
        move_all(0.0, 0.0, -drops[frame], positions[frame])
        for side in range(2):
            place_leg(
                channels[frame],
                row,
                side,
                comforts[side, frame],
                ankles[side, frame],
                feet[side, frame],
                toes[side, frame],
                work,
                positions[frame],
                rotations[frame],
            )


@njit(cache=True, nogil=True)
def solve_frames(asked, wishes, activations, leashes, stance, body, out_residuals, positions, rotations):
    """Constraints of every frame, in place (METHOD 5 and 6).

    ``asked`` as in ``kernels.constraints``; ``wishes`` the tuple (places (C, F or 1, 3), turns (C, F or 1, 3, 3),
    distances (C, F or 1), shares (C, 2)) where things are to be at full activation, of an area its centre and
    heading; ``activations`` (C, F); ``leashes`` (2, F) of the legs; ``stance`` the tuple (channels, comforts, ankles,
    feet, toes) of the legs; ``body`` the tuple (measures, masses (S, 2), limits (N,)). ``out_residuals`` (C, F): by
    how much each is missed (metres, radians for an orientation), NaN where not active.
    """
    constraint_count, frame_count = activations.shape
    channels, comforts, ankles, feet, toes = stance
    work = make_work(constraint_count, asked[7].shape[0], positions.shape[1])
    goal = (
        np.zeros((constraint_count, 2, 3)),
        np.zeros((constraint_count, 3, 3)),
        wishes[3],
        np.zeros(constraint_count),
        np.zeros(constraint_count, np.bool_),
        np.zeros(constraint_count, np.bool_),
    )
    held = (np.zeros(constraint_count), np.zeros((constraint_count, 2, 3)), np.zeros((constraint_count, 3, 3)))
    scratch, arm_turns, arm_places = np.empty((3, 3, 3)), np.empty((2, 3, 3, 3)), np.empty((2, 3, 3))
    level_count = asked[1].max() + 1
    for frame in range(frame_count):
        row = body[0][frame if body[0].shape[0] > 1 else 0]
        legs = (channels[frame], comforts[:, frame], ankles[:, frame], feet[:, frame], toes[:, frame], scratch)
        frame_body = (row, body[1], body[2], leashes[:, frame], legs, arm_turns, arm_places)
        pose = (positions[frame], rotations[frame])
        out_residuals[:, frame] = math.nan
        if set_goals(frame, asked, wishes, activations[:, frame], frame_body, work, pose, goal):
            solve_frame(level_count, asked, goal, held, frame_body, work, pose)
            for c in range(constraint_count):
                if goal[4][c]:
                    out_residuals[c, frame] = miss_of(c, asked, goal, frame_body, work, pose)


@njit(cache=True, nogil=True)
def make_work(constraint_count, joint_count, point_count):
    """Scratch, in the order that ``kernels.constraints.solve_frame`` names."""
    rows, segments = 3 * 2 * constraint_count + 2, point_count - 5
    return (
        np.empty((rows, joint_count, 3)),
        np.empty(rows),
        np.empty(rows, np.int64),
        np.empty((rows, rows + 1)),
        np.empty((2, joint_count, 3)),
        np.empty((2, 3, 3)),
        np.empty((segments, 3)),
        np.empty((2, point_count, 3)),
        np.empty((2, segments, 3, 3)),
        np.empty((constraint_count, 2)),
        np.empty((constraint_count, 2)),
    )


@njit(cache=True, nogil=True)
def set_goals(frame, asked, wishes, activations, body, work, pose, out_goal):
    """What is to be at this frame: between the unsolved pose and the wish, by activation. False when nothing acts."""
    kinds, ends, offsets = asked[0], asked[2], asked[3]
    places, turns, distances, _ = wishes
    acts, point, other = False, work[5][1, 0], work[5][1, 1]
    for c in range(kinds.shape[0]):
        share = activations[c]
        out_goal[4][c] = share > 0.0
        if share <= 0.0:
            continue
        acts = True
        at = frame if places.shape[1] > 1 else 0
        if kinds[c] == ORIENTATION:
            start = pose[1][ends[c, 0, 1]]
            turn_error(turns[c, frame if turns.shape[1] > 1 else 0], start, work[5][0], point)
            rotation_vector_to_matrix(share * point[0], share * point[1], share * point[2], work[5][0])
            multiply(work[5][0], start, out_goal[1][c])
        elif kinds[c] == BALANCE:
            segment_centres(body[1], pose[0], work[6])
            centre_of_mass(body[1], work[6], point)
            target = point if math.isnan(places[c, at, 0]) else places[c, at]
            ease_goal(point, target, share, out_goal[0][c, 0])
        elif kinds[c] == LOOK_AT:
            out_goal[0][c, 0], out_goal[0][c, 1] = places[c, at], pose[1][ends[c, 0, 1], :, 0]
            out_goal[3][c] = share
        elif kinds[c] == AREA:
            out_goal[3][c] = share
            put_area(asked[8][c], places[c, at], turns[c, frame if turns.shape[1] > 1 else 0])
        elif kinds[c] == DISTANCE:
            out_goal[0][c, 1] = places[c, at]
            end_place(ends, offsets, c, 0, pose, point)
            second_place(asked, out_goal, c, pose, other)
            now = distance(point, other)
            wanted = distances[c, frame if distances.shape[1] > 1 else 0]
            out_goal[3][c] = now + share * (wanted - now)
        else:
            end_place(ends, offsets, c, 0, pose, point)
            ease_goal(point, places[c, at], share, out_goal[0][c, 0])
    return acts
