"""Hands put where they touch: on their own body, and beside each other; arms brought out of that body."""

import numpy as np

from studio.core.kernels.algebra.turns import beside, turn_in
from studio.core.kernels.algebra.vectors import plus
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limits.clearance import STEP, TOUCH, copy_arm, move_arm, place_capsules, probe_at, sweep_arm
from studio.core.kernels.limits.clearing import make_clearing
from studio.core.kernels.records import CAPSULE, Pose
from studio.core.kernels.tasks.goals import ease_goal
from studio.core.kernels.tasks.task import STRICT

COUNTS, ALONG, OUT, SPARE = 0, 1, 2, 5
"""The numbers of a spot on a capsule: how much it counts, part of the capsule's length, the way out (3) in the axes of
the segment where that begins, and metres of room.
"""
PALM = 3
"""The probe in the palm."""
ROUNDS = 6
"""Times that hands go what is left of their way: an arm near its full length goes but a part of it."""
CLOSE_ENOUGH = 0.05 * STRICT
"""Metres that hands may be off that meet."""
TURNS = 3
"""Sweeps over an arm's probes from where the last one has brought it: more bring it no farther out."""


@allocating_kernel
def join_hands(gaps, shares, positions, rotations):
    """Move arms of all frames, in place, so that the right wrist lies ``gaps`` (F, 3) metres from the left one.

    ``shares`` (F, 2) are the parts of the way that each goes, together how much of it; hands keep their turns.
    """
    saved, turn = Pose(np.empty((4, 3)), np.empty((3, 3, 3))), np.empty((3, 3))
    goal, shift = np.empty(3), np.zeros(STEP)
    for frame in range(positions.shape[0]):
        whole = shares[frame, 0] + shares[frame, 1]
        if whole == 0.0:
            continue
        pose = Pose(positions[frame], rotations[frame])
        left, right = pose.positions[pose.positions.shape[0] - 17], pose.positions[pose.positions.shape[0] - 12]
        for axis in range(3):
            now = right[axis] - left[axis]
            goal[axis] = now + whole * (gaps[frame, axis] - now)
        for _ in range(ROUNDS):
            missed = 0.0
            for axis in range(3):
                shift[axis] = left[axis] - right[axis] + goal[axis]
                missed = max(missed, abs(shift[axis]))
                shift[axis] *= -shares[frame, 0] / whole
            if missed < CLOSE_ENOUGH:
                break
            bring(0, shift, saved, turn, pose)
            rest = min(4.0 * shares[frame, 1] / whole, 1.0)  # all that the left one leaves, unless it is to stay
            for axis in range(3):
                shift[axis] = rest * (left[axis] - right[axis] + goal[axis])
            bring(1, shift, saved, turn, pose)


@kernel
def bring(side, shift, saved, turn, pose):
    """Move the wrist of an arm by a step ``shift`` (7,), as far as it reaches; no shift leaves it alone."""
    if shift[0] == 0.0 and shift[1] == 0.0 and shift[2] == 0.0:
        return
    spine_count = pose.positions.shape[0] - 23
    shoulder, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
    copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
    move_arm(side, 1.0, shift, saved, turn, pose)


@allocating_kernel
def rest_hands(side, members, spots, firm, volume, proximal, positions, rotations):
    """Move one arm of all frames, in place, so that its palm lies on the body where ``spots`` (F, M, 6) say.

    Those are for M capsules ``members`` (M,) of ``volume``; ``firm`` (F,) is the part of the way that is gone.
    """
    saved, turn = Pose(np.empty((4, 3)), np.empty((3, 3, 3))), np.empty((3, 3))
    capsules, place, shift = np.empty(volume.segments.shape[0], CAPSULE), np.empty(3), np.zeros(STEP)
    for frame in range(positions.shape[0]):
        if firm[frame] == 0.0:
            continue
        pose = Pose(positions[frame], rotations[frame])
        place_capsules(volume, pose, proximal, capsules)
        probe_at(PALM, pose.positions.shape[0] - 19 + 5 * side, pose.positions, place)
        for axis in range(3):
            shift[axis] = -firm[frame] * place[axis]
        for m in range(members.shape[0]):
            capsule, spot = capsules[members[m]], spots[frame, m]
            far = capsule.radius + spot[ALONG] * capsule.widens + volume.girths[PALM] + spot[SPARE]
            x, y, z = far * spot[OUT], far * spot[OUT + 1], far * spot[OUT + 2]
            axes = turn_in(pose.rotations[volume.segments[members[m], 0]])
            touched = beside(ease_goal(capsule.begin, plus(capsule.begin, capsule.axis), spot[ALONG]), axes, x, y, z)
            for axis in range(3):
                shift[axis] += firm[frame] * spot[COUNTS] * touched[axis]
        bring(side, shift, saved, turn, pose)


@allocating_kernel
def find_ways_out(wanted, actor, free, proximal, positions, rotations, out_moves):
    """The steps of each arm out of the body, ``out_moves`` (F, 2, 7).

    They give probes the room ``wanted`` (F, 2, 5); ``actor`` the record ``ActorRooms``; ``free`` (F, 2, 2) how freely
    wrist, with the hand, and swivel move. Poses are left as they were.
    """
    clearing, step, spine_count = make_clearing(actor.volume), np.empty(STEP), positions.shape[1] - 23
    saved, turn = clearing.saved, clearing.turn
    for frame in range(positions.shape[0]):
        pose = Pose(positions[frame], rotations[frame])
        placed = False
        for side in range(2):
            move = out_moves[frame, side]
            move[:] = 0.0
            shares = (1.0, free[frame, side, 0], free[frame, side, 0], free[frame, side, 1])
            if shares[1] == 0.0 and shares[3] == 0.0:
                continue
            if not placed:
                place_capsules(actor.volume, pose, proximal, clearing.capsules)
                placed = True
            for probe in range(wanted.shape[2]):
                clearing.asks[probe] = wanted[frame, side, probe]
            shoulder, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
            moved = False
            for _ in range(TURNS):
                if not sweep_arm(side, TOUCH, frame, shares, actor, clearing, pose.positions, step):
                    break
                if not moved:
                    copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
                    moved = True
                move += step
                move_arm(side, 1.0, move, saved, turn, pose)
            if moved:
                copy_arm(saved, Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]))


@allocating_kernel
def move_arms(moves, positions, rotations):
    """Take steps ``moves`` (F, 2, 7) of both arms in all frames, in place."""
    saved, turn = Pose(np.empty((4, 3)), np.empty((3, 3, 3))), np.empty((3, 3))
    spine_count = positions.shape[1] - 23
    for frame in range(positions.shape[0]):
        for side in range(2):
            move, pose = moves[frame, side], Pose(positions[frame], rotations[frame])
            if move.any():
                shoulder, upper = spine_count + 4 + 5 * side, spine_count + 3 + 4 * side
                copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
                move_arm(side, 1.0, move, saved, turn, pose)
