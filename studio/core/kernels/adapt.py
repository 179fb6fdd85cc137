"""A whole clip on one body: feet on their ankles, then constraints, frame by frame, each from its own pose."""

import math

import numpy as np
from numba import njit

from studio.core.kernels.body import body_point, move_all
from studio.core.kernels.constraints import solve_frame
from studio.core.kernels.legs import place_leg


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
def solve_frames(
    codes, offsets, chains, targets, activations, states, channels, measures, comforts, ankles, feet, toes,
    positions, rotations, out_residuals,
):  # fmt: skip
    """Position constraints of every frame, in place (METHOD 5 and 6).

    ``targets`` (C, 3); ``activations`` (C, F): a point is to be at CP0 + a (T - CP0), CP0 where the unsolved pose
    has it. ``states`` (2, F) of the feet. ``out_residuals`` (C, F) metres from there, NaN where not active.
    """
    constraint_count, frame_count = activations.shape
    spine_count = positions.shape[1] - 23
    scratch = (
        np.empty((3 * constraint_count, 7)),
        np.empty((3 * constraint_count, 2), np.int64),
        np.empty((3 * constraint_count, 3 * constraint_count + 1)),
        np.empty((2, spine_count + 4, 3)),
        np.empty((3, 3)),
        np.empty(constraint_count),
        np.empty(positions.shape[1:]),
        np.empty(rotations.shape[1:]),
    )
    goals, wanted = np.empty((constraint_count, 3)), np.empty(constraint_count, np.bool_)
    work, point = np.empty((3, 3, 3)), np.empty(3)
    for frame in range(frame_count):
        active = False
        for c in range(constraint_count):
            share = activations[c, frame]
            wanted[c] = share > 0.0
            out_residuals[c, frame] = math.nan
            if wanted[c]:
                active = True
                body_point(codes[c, 0], codes[c, 1], offsets[c], positions[frame], rotations[frame], point)
                for axis in range(3):
                    goals[c, axis] = point[axis] + share * (targets[c, axis] - point[axis])
        if not active:
            continue
        legs = (channels[frame], comforts[:, frame], ankles[:, frame], feet[:, frame], toes[:, frame], work)
        row = measures[frame if measures.shape[0] > 1 else 0]
        asked = (codes, offsets, chains, goals, wanted)
        solve_frame(asked, states[:, frame], legs, row, scratch, (positions[frame], rotations[frame]))
        for c in range(constraint_count):
            if wanted[c]:
                body_point(codes[c, 0], codes[c, 1], offsets[c], positions[frame], rotations[frame], point)
                squared = 0.0
                for axis in range(3):
                    squared += (point[axis] - goals[c, axis]) ** 2
                out_residuals[c, frame] = math.sqrt(squared)
