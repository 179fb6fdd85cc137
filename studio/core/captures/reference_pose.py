"""Reference pose, upright and at ease: the zero pose if it is human, else a neutral pose estimated from all frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.kinematics import joint_positions, rest_poses
from studio.core.body.neutral_pose import find_neutral_pose
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.confidence import Confidence
from studio.core.rotations import IDENTITY_QUATERNION, from_matrix, multiply, normalized, shortest_arc

FloatArray = NDArray[np.float64]

ZERO_POSE, ALL_FRAMES = "zero pose", "all frames"
"""Sources of a reference pose, as they are named to the user."""
_UP: FloatArray = np.array([0.0, 0.0, 1.0])
_NEVER_STOOD = 2.0
"""Worst fault of a take's best frame from which no frame of it stands at ease."""
_HARDLY_HUMAN, _SURE_HEAD = 0.8, 15.0
"""Worst fault of a zero pose, and degrees of doubt about the head, up to which nothing is doubtful."""
_UNTILTED = np.cos(np.radians(10.0))
"""Cosine of the angle from which no zero pose leans as a whole."""
_NO_WIDTH = 1e-9
"""Distance in metres of joints that lie in one place."""


@dataclass(frozen=True)
class ReferencePose:
    """Local rotations (J, 4) of a body upright along Z, with their source and the reason for it."""

    rotations: FloatArray
    source: str
    """``ZERO_POSE`` or ``ALL_FRAMES``."""
    reason: str
    confidence: Confidence


def find_reference_pose(skeleton: Skeleton, poses: PoseSequence, body_map: BodyMap) -> ReferencePose:
    """Zero pose, rotated upright if it lies, if it is human; else the neutral pose estimated from all frames."""
    zero = np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))
    standing = upright_pose(skeleton, zero, body_map)
    if standing is not None:
        points = joint_positions(skeleton, rest_poses(skeleton, standing))
        worst = float(stance_deviations(points, body_map).max())
        if worst <= 1.0:
            turned = "" if np.array_equal(standing, zero) else "; it was turned upright"
            return ReferencePose(
                standing,
                ZERO_POSE,
                f"With all rotations zero the body stands like a human{turned}.",
                Confidence.SURE if worst <= _HARDLY_HUMAN else Confidence.LIKELY,
            )
    points = joint_positions(skeleton, poses)
    neutral = find_neutral_pose(skeleton, poses, body_map, ease_weights(points, body_map))
    doubt = f"The head may be turned by {neutral.head_doubt:.0f} degrees" if neutral.head_doubt else "It has no head"
    stood = stance_deviations(points, body_map).max(axis=1).min() <= _NEVER_STOOD
    if not stood:
        doubt += ", and the body is never in a neutral stance: check its head, hands and feet"
    reason = "With all rotations zero the body is not human; its mean pose was stood upright."
    confidence = Confidence.LIKELY if stood and neutral.head_doubt <= _SURE_HEAD else Confidence.DOUBTFUL
    return ReferencePose(neutral.rotations, ALL_FRAMES, f"{reason} {doubt}.", confidence)


def upright_pose(skeleton: Skeleton, local_rotations: FloatArray, body_map: BodyMap) -> FloatArray | None:
    """Pose (J, 4) with the root rotated so that the trunk points to +Z; None if the trunk points elsewhere than the
    body.

    The direction of the body, from feet to shoulders, counts as the nearest world axis if it is within 10 degrees of
    that. Otherwise the zero pose is taken to be in the axes of a tilted camera.
    """
    points = joint_positions(skeleton, rest_poses(skeleton, local_rotations))[0]
    trunk = normalized(_middle(points, body_map, "UPPER_ARM") - _middle(points, body_map, "THIGH"))
    body = normalized(_middle(points, body_map, "UPPER_ARM") - _middle(points, body_map, "FOOT"))
    axis = np.zeros(3)
    largest = int(np.argmax(np.abs(body)))
    axis[largest] = np.sign(body[largest])
    if body @ axis < _UNTILTED:
        axis = body
    if trunk @ axis < 0.9:
        return None
    if axis[2] == 1.0:
        return local_rotations
    stood = np.array(local_rotations)
    stood[0] = multiply(from_matrix(shortest_arc(axis, _UP)), stood[0])
    return stood


def ease_weights(points: FloatArray, body_map: BodyMap) -> FloatArray:
    """Weights (F,) from 0 to 1 that are greater the more upright and symmetric the body stands; ``points``
    (F, J, 3).
    """
    return np.asarray(1.0 / (1.0 + (stance_deviations(points, body_map) ** 2).sum(axis=1)) ** 2)


def stance_deviations(points: FloatArray, body_map: BodyMap) -> FloatArray:
    """Deviations (F, n) of each frame of ``points`` (F, J, 3) from a relaxed human stance; 1 is the tolerable limit.

    They measure the lean of trunk and head, splay and bend of the legs, twist of shoulders against hips, narrow
    shoulders, and arms that are asymmetric, bent or raised.
    """
    hips, shoulders = _middle(points, body_map, "THIGH"), _middle(points, body_map, "UPPER_ARM")
    across_hips, across_shoulders = _across(points, body_map, "THIGH"), _across(points, body_map, "UPPER_ARM")
    down = np.broadcast_to(-_UP, hips.shape)
    terms = [_angle(shoulders - hips, -down) / 20.0, _angle(across_hips, across_shoulders) / 25.0]
    if BodyPart.HEAD in body_map.parts:
        terms.append(_angle(points[:, body_map[BodyPart.HEAD]] - shoulders, -down) / 60.0)
    hip_width = np.maximum(np.linalg.norm(across_hips, axis=-1), _NO_WIDTH)
    width = np.linalg.norm(across_shoulders, axis=-1) / hip_width
    terms.append(0.8 / np.maximum(width, 1e-3))
    mirror = normalized(across_hips)
    arms = []
    for side in ("LEFT", "RIGHT"):
        hip, knee, ankle, shoulder, elbow, wrist = (
            points[:, body_map[BodyPart[f"{side}_{part}"]]]
            for part in ("THIGH", "SHANK", "FOOT", "UPPER_ARM", "FOREARM", "HAND")
        )
        terms += [_angle(knee - hip, down) / 35.0, _angle(ankle - knee, down) / 35.0]
        terms.append(_angle(elbow - shoulder, wrist - elbow) / 45.0)
        terms.append(_angle(wrist - shoulder, down) / 115.0)
        arms.append(wrist - shoulder)
    mirrored = arms[0] - 2 * np.sum(arms[0] * mirror, axis=-1, keepdims=True) * mirror
    terms.append(_angle(mirrored, arms[1]) / 35.0)
    return np.stack(terms, axis=1)


def _middle(points: FloatArray, body_map: BodyMap, part: str) -> FloatArray:
    left, right = body_map[BodyPart[f"LEFT_{part}"]], body_map[BodyPart[f"RIGHT_{part}"]]
    return 0.5 * (points[..., left, :] + points[..., right, :])


def _across(points: FloatArray, body_map: BodyMap, part: str) -> FloatArray:
    """Vector from the right to the left joint of a pair."""
    across = points[:, body_map[BodyPart[f"LEFT_{part}"]]] - points[:, body_map[BodyPart[f"RIGHT_{part}"]]]
    return np.asarray(across)


def _angle(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles in degrees between vectors."""
    sine = np.linalg.norm(np.cross(first, second), axis=-1)
    degrees: FloatArray = np.degrees(np.arctan2(sine, np.sum(first * second, axis=-1)))
    return degrees
