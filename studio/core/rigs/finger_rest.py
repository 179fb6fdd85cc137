"""Rest pose of the fingers of a skeleton: its finger joints, the axes of its hands, and the bend of its fingers.

The axes of a hand lie at its knuckles: x from the little finger to the index finger, z towards the fingers, y out of
the left palm and out of the back of the right hand. All skeletons share these axes; a mirror image exchanges the hands
and reverses y.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_joints import JOINTS_PER_FINGER, Digit, FingerJoint, find_fingers
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.rest_pose import REST_FORWARD
from studio.core.body.skeleton import Skeleton
from studio.core.rotations import frame_along, inverse, multiply

FloatArray = NDArray[np.float64]

HAND_PARTS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)
DIGITS = tuple(Digit)
FINGER_CELLS = (len(HAND_PARTS), len(DIGITS), JOINTS_PER_FINGER)
"""Shape of an array with an element for each finger joint: side, digit, place."""
T_POSE_HANDS = np.array([frame_along(np.array([0.0, sign, 0.0]), REST_FORWARD) for sign in (1.0, -1.0)])
"""Axes (2, 3, 3) of the hands in a T-pose."""
PALM_SIGNS = np.array([1.0, -1.0])
"""Sign of the y axis that points out of the palm of each hand."""


@dataclass(frozen=True, eq=False)
class FingerRest:
    """Finger joints of a skeleton, and the directions of their bones in its rest pose."""

    joints: dict[FingerJoint, int]
    hands: tuple[int, int]
    axes: FloatArray
    """Axes (2, 3, 3) of the hands in the world."""
    flexions: FloatArray
    """Angles (2, 5, 3) in radians from the direction of the hand to each finger's bone, towards the palm; 0 for thumbs,
    which point aside.
    """
    directions: FloatArray
    """Directions (2, 5, 3, 3) of the bones in the axes of the hand."""


def finger_rest(skeleton: Skeleton, body: BodyMap, local_rotations: FloatArray, t_pose_hands: FloatArray) -> FingerRest:
    """Rest of the fingers of ``skeleton`` in the pose ``local_rotations`` (J, 4).

    ``t_pose_hands`` (2, 3, 3) are the world axes of hands without a row of knuckles.
    """
    joints, hands = find_fingers(skeleton, body), (body[HAND_PARTS[0]], body[HAND_PARTS[1]])
    places = joint_world(skeleton, rest_poses(skeleton, local_rotations))[0][0]
    axes, flexions, directions = np.array(t_pose_hands), np.zeros(FINGER_CELLS), np.zeros((*FINGER_CELLS, 3))
    directions[..., 2] = 1.0
    for side, hand in enumerate(hands):
        row = [joints[each] for each in joints if each.side == side and each.place == 0 and each.digit != Digit.THUMB]
        if len(row) > 1:
            axes[side] = frame_along((places[row] - places[hand]).sum(axis=0), places[row[0]] - places[row[-1]])
        for index, digit in enumerate(DIGITS):
            chain = [joints[each] for each in joints if each.side == side and each.digit == digit]
            if chain:
                bones = _bones(skeleton, hand, chain, places) @ axes[side]
                directions[side, index] = bones / np.linalg.norm(bones, axis=1, keepdims=True)
    bent = directions[:, 1:]
    flexions[:, 1:] = np.arctan2(PALM_SIGNS[:, None, None] * bent[..., 1], bent[..., 2])
    return FingerRest(joints, hands, axes, flexions, directions)


def _bones(skeleton: Skeleton, hand: int, chain: Sequence[int], positions: FloatArray) -> FloatArray:
    """Vectors (3, 3) from each joint of a finger to the next; the last joint has the vector before it."""
    ends = [*chain[1:], *skeleton.children[chain[-1]][:1]]
    bones = [positions[end] - positions[joint] for joint, end in zip(chain, ends, strict=False)]
    last = bones[-1] if bones else positions[chain[0]] - positions[hand]
    return np.array([*bones, *[last] * (JOINTS_PER_FINGER - len(bones))])


def bend(angles: FloatArray) -> FloatArray:
    """Rotations (..., 2, n, 3, 4) about x that bend fingers by ``angles`` (..., 2, n, 3) radians into the palm."""
    halves = angles / 2.0
    rotations = np.zeros((*angles.shape, 4))
    rotations[..., 0] = -PALM_SIGNS[:, None, None] * np.sin(halves)
    rotations[..., 3] = np.cos(halves)
    return rotations


def relative_rotations(rotations: FloatArray) -> FloatArray:
    """Rotations (..., 3, 4) of finger joints relative to the previous joint, from ``rotations`` relative to
    the hand.
    """
    return np.concatenate(
        [rotations[..., :1, :], multiply(inverse(rotations[..., :-1, :]), rotations[..., 1:, :])], axis=-2
    )


def rotations_in_hand(relative: FloatArray) -> FloatArray:
    """Rotations (..., 3, 4) of finger joints relative to the hand, from ``relative`` ones to the previous joint."""
    rotations = [relative[..., 0, :]]
    for index in range(1, JOINTS_PER_FINGER):
        rotations.append(multiply(rotations[-1], relative[..., index, :]))
    return np.stack(rotations, axis=-2)
