"""Hand-hand and hand-body contacts, and arms pushed out of the body over a whole clip."""

import numpy as np

from studio.core.kernels.algebra.rotation_tuples import rotation_from_matrix, transform_point
from studio.core.kernels.algebra.vectors import add_vectors
from studio.core.kernels.body_indices import (
    POINTS_BESIDE_SPINE,
    POINTS_PER_LIMB,
    SEGMENTS_PER_LIMB,
    SHOULDER_POINT,
    UPPER_ARM_SEGMENT,
)
from studio.core.kernels.compiling import allocating_kernel, kernel
from studio.core.kernels.limits.arm_clearance import (
    ARM_STEP_SIZE,
    CONTACT_MARGIN,
    arm_step,
    copy_arm,
    move_arm,
    place_capsules,
    probe_centre,
)
from studio.core.kernels.limits.self_collision import make_clearance_scratch
from studio.core.kernels.records import CAPSULE, Pose
from studio.core.kernels.tasks.goals import interpolate_point
from studio.core.kernels.tasks.task import PRIORITY_TOLERANCE

SPOT_WEIGHT, SPOT_ALONG, SPOT_NORMAL, SPOT_DISTANCE = 0, 1, 2, 5
"""Columns of a contact point (6,) on a capsule: weight, fraction of the capsule's length, normal (3) in the axes of the
segment where the capsule begins, and distance in metres from its surface.
"""
PALM_PROBE = 3
"""Index of the probe in the palm."""
HAND_ITERATIONS = 6
"""Iterations of a hand-hand contact: an arm near full extension makes only a part of each step."""
HANDS_MET_DISTANCE = 0.05 * PRIORITY_TOLERANCE
"""Distance in metres, of both hands from their contact positions, below which the iteration ends."""
PUSH_OUT_ITERATIONS = 3
"""Iterations over an arm's probes; further ones change nothing."""


@allocating_kernel
def solve_hand_hand_contact(gaps, fractions, positions, rotations):
    """Move the arms of all frames, in place, until the right wrist lies ``gaps`` (F, 3) metres from the left one.

    ``fractions`` (F, 2) are the parts of the displacement that each arm makes; their sum is the weight of the contact.
    Hands keep their world rotations.
    """
    saved, rotation = Pose(np.empty((4, 3)), np.empty((3, 3, 3))), np.empty((3, 3))
    goal, shift = np.empty(3), np.zeros(ARM_STEP_SIZE)
    for frame in range(positions.shape[0]):
        whole = fractions[frame, 0] + fractions[frame, 1]
        if whole == 0.0:
            continue
        pose = Pose(positions[frame], rotations[frame])
        left, right = pose.positions[pose.positions.shape[0] - 17], pose.positions[pose.positions.shape[0] - 12]
        for axis in range(3):
            now = right[axis] - left[axis]
            goal[axis] = now + whole * (gaps[frame, axis] - now)
        for _ in range(HAND_ITERATIONS):
            residual = 0.0
            for axis in range(3):
                shift[axis] = left[axis] - right[axis] + goal[axis]
                residual = max(residual, abs(shift[axis]))
                shift[axis] *= -fractions[frame, 0] / whole
            if residual < HANDS_MET_DISTANCE:
                break
            move_wrist(0, shift, saved, rotation, pose)
            rest = min(4.0 * fractions[frame, 1] / whole, 1.0)  # all that the left one leaves, unless it is to stay
            for axis in range(3):
                shift[axis] = rest * (left[axis] - right[axis] + goal[axis])
            move_wrist(1, shift, saved, rotation, pose)


@kernel
def move_wrist(side, shift, saved, rotation, pose):
    """Move the wrist of an arm by the arm step ``shift`` (7,), as far as the arm reaches."""
    if shift[0] == 0.0 and shift[1] == 0.0 and shift[2] == 0.0:
        return
    spine_count = pose.positions.shape[0] - POINTS_BESIDE_SPINE
    shoulder, upper = (
        spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
        spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
    )
    copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
    move_arm(side, 1.0, shift, saved, rotation, pose)


@allocating_kernel
def solve_hand_body_contact(side, members, contact_points, contact_weight, volume, proximal, positions, rotations):
    """Move one arm of all frames, in place, until its palm lies at its ``contact_points`` (F, M, 6) on the body.

    The points are on the capsules ``members`` (M,) of ``volume``; ``contact_weight`` (F,) scales the displacement.
    """
    saved, rotation = Pose(np.empty((4, 3)), np.empty((3, 3, 3))), np.empty((3, 3))
    capsules, position, shift = np.empty(volume.segments.shape[0], CAPSULE), np.empty(3), np.zeros(ARM_STEP_SIZE)
    for frame in range(positions.shape[0]):
        if contact_weight[frame] == 0.0:
            continue
        pose = Pose(positions[frame], rotations[frame])
        place_capsules(volume, pose, proximal, capsules)
        probe_centre(
            PALM_PROBE,
            pose.positions.shape[0] - POINTS_BESIDE_SPINE + SHOULDER_POINT + POINTS_PER_LIMB * side,
            pose.positions,
            position,
        )
        for axis in range(3):
            shift[axis] = -contact_weight[frame] * position[axis]
        for m in range(members.shape[0]):
            capsule, contact_point = capsules[members[m]], contact_points[frame, m]
            far = (
                capsule.radius
                + contact_point[SPOT_ALONG] * capsule.radius_change
                + volume.girths[PALM_PROBE]
                + contact_point[SPOT_DISTANCE]
            )
            x, y, z = (
                far * contact_point[SPOT_NORMAL],
                far * contact_point[SPOT_NORMAL + 1],
                far * contact_point[SPOT_NORMAL + 2],
            )
            axes = rotation_from_matrix(pose.rotations[volume.segments[members[m], 0]])
            touched = transform_point(
                interpolate_point(capsule.begin, add_vectors(capsule.begin, capsule.axis), contact_point[SPOT_ALONG]),
                axes,
                x,
                y,
                z,
            )
            for axis in range(3):
                shift[axis] += contact_weight[frame] * contact_point[SPOT_WEIGHT] * touched[axis]
        move_wrist(side, shift, saved, rotation, pose)


@allocating_kernel
def push_out_steps(required, actor, free, proximal, positions, rotations, out_moves):
    """Write the arm steps (F, 2, 7) that push each arm out of the body.

    ``required`` (F, 2, 5) are the signed distances required of the probes, ``actor`` the record ``ActorClearance``,
    ``free`` (F, 2, 2) the weights of the wrist with its hand, and of the swivel. Poses stay unchanged.
    """
    clearing, step, spine_count = (
        make_clearance_scratch(actor.volume),
        np.empty(ARM_STEP_SIZE),
        positions.shape[1] - POINTS_BESIDE_SPINE,
    )
    saved, rotation = clearing.saved, clearing.rotation
    for frame in range(positions.shape[0]):
        pose = Pose(positions[frame], rotations[frame])
        placed = False
        for side in range(2):
            move = out_moves[frame, side]
            move[:] = 0.0
            fractions = (1.0, free[frame, side, 0], free[frame, side, 0], free[frame, side, 1])
            if fractions[1] == 0.0 and fractions[3] == 0.0:
                continue
            if not placed:
                place_capsules(actor.volume, pose, proximal, clearing.capsules)
                placed = True
            for probe in range(required.shape[2]):
                clearing.required_distances[probe] = required[frame, side, probe]
            shoulder, upper = (
                spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
                spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
            )
            moved = False
            for _ in range(PUSH_OUT_ITERATIONS):
                if not arm_step(side, CONTACT_MARGIN, frame, fractions, actor, clearing, pose.positions, step):
                    break
                if not moved:
                    copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
                    moved = True
                move += step
                move_arm(side, 1.0, move, saved, rotation, pose)
            if moved:
                copy_arm(saved, Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]))


@allocating_kernel
def apply_arm_steps(moves, positions, rotations):
    """Displace both arms of all frames by the arm steps ``moves`` (F, 2, 7), in place."""
    saved, rotation = Pose(np.empty((4, 3)), np.empty((3, 3, 3))), np.empty((3, 3))
    spine_count = positions.shape[1] - POINTS_BESIDE_SPINE
    for frame in range(positions.shape[0]):
        for side in range(2):
            move, pose = moves[frame, side], Pose(positions[frame], rotations[frame])
            if move.any():
                shoulder, upper = (
                    spine_count + SHOULDER_POINT + POINTS_PER_LIMB * side,
                    spine_count + UPPER_ARM_SEGMENT + SEGMENTS_PER_LIMB * side,
                )
                copy_arm(Pose(pose.positions[shoulder : shoulder + 4], pose.rotations[upper : upper + 3]), saved)
                move_arm(side, 1.0, move, saved, rotation, pose)
