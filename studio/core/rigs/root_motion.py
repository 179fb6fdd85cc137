"""Root motion: the travel of a body is stored in its hips or in a root joint on the floor, or removed."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.rotations import IDENTITY_QUATERNION, from_matrix, inverse, multiply, rotate

FloatArray = NDArray[np.float64]

ROOT_JOINT_NAME = "root"
"""Name of the added root joint."""


def with_root_joint(capture: Capture, root: int = 0) -> Capture:
    """Copy whose root joint is on the floor below the hips and has their heading.

    The joint ``root`` is used if it is above the hips; otherwise a new joint is added above all others, at the origin
    at rest. A capture without a body map keeps its heading.
    """
    skeleton, poses = capture.skeleton, capture.poses
    if capture.body_map and capture.body_map.spine[0] != root:
        return _with_moving_root(capture, root)
    name = ROOT_JOINT_NAME
    while name in skeleton.names:
        name += "_"
    travel, turns = _travel(capture), _headings(capture)
    back = inverse(turns)
    hips = multiply(back, poses.local_rotations[:, 0])
    moved = rotate(back, poses.local_translations[:, 0] - travel)
    return replace(
        capture,
        skeleton=Skeleton(
            (name, *skeleton.names),
            np.concatenate([[-1], skeleton.parents + 1]),
            np.concatenate([np.zeros((1, 3)), skeleton.offsets]),
            np.concatenate([[False], skeleton.end_sites]),
        ),
        poses=PoseSequence(
            np.concatenate([turns[:, None], hips[:, None], poses.local_rotations[:, 1:]], axis=1),
            np.concatenate([travel[:, None], moved[:, None], poses.local_translations[:, 1:]], axis=1),
        ),
        body_map=_shifted(capture.body_map),
        reference_rotations=np.concatenate([IDENTITY_QUATERNION[None], capture.reference_rotations]),
    )


def _with_moving_root(capture: Capture, root: int) -> Capture:
    """Copy whose own joint ``root`` moves with the hips, while all other joints keep their world positions."""
    rotations, translations = np.array(capture.poses.local_rotations), np.array(capture.poses.local_translations)
    away, above = _carrier(capture, root)
    moved, turned = (each[:, root].copy() for each in (translations, rotations))
    standing = rest_poses(capture.skeleton, capture.reference_rotations)
    at_rest = from_matrix(joint_world(capture.skeleton, standing)[1][0, root])
    rotations[:, root] = multiply(inverse(above), multiply(_headings(capture), at_rest))
    translations[:, root] = rotate(inverse(above), _travel(capture) - away)
    back = inverse(rotations[:, root])
    for child in capture.skeleton.children[root]:
        place = moved + rotate(turned, translations[:, child]) - translations[:, root]
        translations[:, child] = rotate(back, place)
        rotations[:, child] = multiply(multiply(back, turned), rotations[:, child])
    return replace(capture, poses=PoseSequence(rotations, translations))


def capture_in_place(capture: Capture) -> Capture:
    """Copy whose hips stay above their first position; joints above the hips rest."""
    translations = np.array(capture.poses.local_translations)
    travel, hips = _travel(capture), capture.body_map.spine[0] if capture.body_map else 0
    translations[:, hips] -= rotate(inverse(_carrier(capture, hips)[1]), travel - travel[0])
    return replace(capture, poses=PoseSequence(capture.poses.local_rotations, translations))


def _carrier(capture: Capture, joint: int) -> tuple[FloatArray, FloatArray]:
    """World positions (F, 3) and rotations (F, 4) of the parent of ``joint``; the world's axes if it has none."""
    chain = list(capture.skeleton.path(0, joint)[:-1])
    places, turns = np.zeros((capture.frame_count, 3)), np.tile(IDENTITY_QUATERNION, (capture.frame_count, 1))
    for each in chain:
        places = places + rotate(turns, capture.poses.local_translations[:, each])
        turns = multiply(turns, capture.poses.local_rotations[:, each])
    return places, turns


def _travel(capture: Capture) -> FloatArray:
    """Positions (F, 3) in metres on the floor below the hips, or below the root if there are no hips."""
    joint = capture.body_map.spine[0] if capture.body_map else 0
    away, above = _carrier(capture, joint)
    travel = away + rotate(above, capture.poses.local_translations[:, joint])
    travel[:, 2] = capture.floor
    return travel


def _headings(capture: Capture) -> FloatArray:
    """Smoothed rotations (F, 4) about Z of the pelvis from its reference pose."""
    turns = np.zeros((capture.frame_count, 4))
    if capture.body_map is None:
        turns[:, 3] = 1.0
        return turns
    pelvis = capture.body_map[BodyPart.PELVIS]
    standing = rest_poses(capture.skeleton, capture.reference_rotations)
    rotations = joint_world(capture.skeleton, capture.poses)[1][:, pelvis]
    reference = joint_world(capture.skeleton, standing)[1][0, pelvis]
    from studio.core.normalized.normalize import smoothed_heading  # late: what computes is loaded after the window

    half = smoothed_heading(rotations @ reference.T, capture.frame_rate) / 2.0
    turns[:, 2], turns[:, 3] = np.sin(half), np.cos(half)
    return turns


def _shifted(body: BodyMap | None) -> BodyMap | None:
    """Body map with all joint indices raised by one, for a skeleton with a new first joint."""
    if body is None:
        return None
    return BodyMap({part: joint + 1 for part, joint in body.parts.items()}, tuple(joint + 1 for joint in body.spine))
