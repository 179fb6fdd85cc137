"""Construction of a character from a standing skeleton and a mesh: measures, bind pose and weights of segments."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.body.kinematics import rest_poses
from studio.core.body.morphology import Morphology
from studio.core.body.skeleton import Skeleton
from studio.core.body.standing import standing_points
from studio.core.captures.capture import Capture
from studio.core.captures.contacts import ContactPoint
from studio.core.mesh.appearance import Appearance
from studio.core.mesh.skin import VERTEX_INFLUENCES, SkinnedMesh
from studio.core.normalized.alignment import find_alignments
from studio.core.normalized.landmarks import find_landmarks
from studio.core.normalized.measure import measure_actor
from studio.core.rotations import IDENTITY_QUATERNION

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_LEAST_WEIGHT = 0.004
_SHORTEST_HAND = 0.02
_LEAST_BALL, _USUAL_BALL, _BENDS_OVER = 0.5, 0.72, 0.2
"""Parts of a sole from its heel on: before which no ball is, where it is else, and how much of the sole bends there."""


def measured_body(skeleton: Skeleton, body_map: BodyMap) -> tuple[Morphology, FloatArray]:
    """Measures of a body in its zero pose, and its bind pose: the rotations (S, 3, 3) of the canonical segments.

    The zero pose of ``skeleton`` stands on z = 0 and faces +X.
    """
    still = np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1))
    poses = rest_poses(skeleton, still)
    standing = Capture("body", "", skeleton, poses, 1.0, body_map, still, 0.0, "m", "Z", 0, (), ())
    marks = find_landmarks(standing, body_map)
    stance = marks.align_rotations(find_alignments(marks))[0]
    contacts = {point: [(0, 0)] for point in ContactPoint}
    return measure_actor(marks, stance, stance[None], contacts, 0, 0.0), stance


def segments_of_joints(skeleton: Skeleton, body_map: BodyMap) -> IntArray:
    """Canonical segment (J,) that each joint moves: its own, or that of its nearest ancestor with one."""
    layout = BodyLayout(len(body_map.spine))
    own = {joint: index for index, joint in enumerate(body_map.spine)}
    own |= {joint: layout.segment_of_part(part) for part, joint in body_map.parts.items() if joint not in own}
    segments = np.zeros(skeleton.joint_count, dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        segments[joint] = own.get(joint, segments[parent] if parent >= 0 else 0)
    return segments


def segment_weights(joints: IntArray, weights: FloatArray, segments: IntArray, count: int) -> FloatArray:
    """Weights (V, count) of the segments in each vertex, from ``joints`` (V, n) and their ``weights`` (V, n).

    ``segments`` (J,) is the segment of each joint.
    """
    total = np.zeros((len(joints), count))
    rows = np.arange(len(joints))
    for column in range(joints.shape[1]):
        np.add.at(total, (rows, segments[joints[:, column]]), weights[:, column])
    return total


def strongest_influences(weights: FloatArray) -> tuple[IntArray, FloatArray]:
    """Segments (V, 4) and weights (V, 4) of the strongest influences, strongest first, with sum 1."""
    segments = np.argsort(-weights, axis=1, kind="stable")[:, :VERTEX_INFLUENCES]
    chosen = np.take_along_axis(weights, segments, axis=1).astype(np.float64)
    chosen[chosen < _LEAST_WEIGHT * chosen[:, :1]] = 0.0
    return segments, chosen / chosen.sum(axis=1, keepdims=True)


def bound_mesh(
    body: Morphology,
    stance: FloatArray,
    root: FloatArray,
    vertices: FloatArray,
    normals: FloatArray,
    triangles: IntArray,
    weights: FloatArray,
    appearance: Appearance | None,
) -> SkinnedMesh:
    """Mesh with ``vertices`` (V, 3) bound to a body in its bind pose ``stance``.

    ``root`` (3,) is the position of the body's root in the space of the vertices.
    """
    shift = standing_points(body, stance)[0] - root
    segments, chosen = strongest_influences(weights)
    moved = vertices + shift
    return SkinnedMesh(
        moved.astype(np.float32),
        normals.astype(np.float32),
        moved.astype(np.float32),
        triangles.astype(np.int32),
        segments.astype(np.int32),
        chosen.astype(np.float32),
        stance,
        appearance,
    )


def measured_by_mesh(
    body: Morphology, stance: FloatArray, points: FloatArray, vertices: FloatArray, weights: FloatArray
) -> Morphology:
    """Body with the crown, finger tips, toe tips, heels and soles of its mesh, whose ``vertices`` are (V, 3).

    ``points`` (P, 3) are the canonical points in the space of the vertices; ``weights`` (V, S) assign the vertices to
    segments.
    """
    layout = body.layout
    head = vertices[weights[:, layout.segment_of_part(BodyPart.HEAD)] > 0.5]
    if len(head):
        crown = float(head[:, 2].max() - points[layout.head_joint, 2])
        body = replace(body, head=float(np.clip(crown, 0.5 * body.head, 1.5 * body.spine_length)))
    hands, toes = body.hand.copy(), body.toe.copy()
    ankle_height, toe_height, heel_length = body.ankle_height.copy(), body.toe_height.copy(), body.heel_length.copy()
    for side in range(2):
        hand, foot = layout.hand_segment(side), layout.foot_segment(side)
        fingers = (vertices[weights[:, hand] > 0.5] - points[layout.wrist_point(side)]) @ stance[hand]
        if len(fingers) and fingers[:, 2].max() > _SHORTEST_HAND:
            hands[side] = [0.0, 0.0, fingers[:, 2].max()]
        sole = vertices[weights[:, foot] + weights[:, foot + 1] > 0.5]
        if not len(sole):
            continue
        ankle, toe = points[layout.ankle_point(side)], points[layout.toe_point(side)]
        ankle_height[side] = max(ankle[2] - sole[:, 2].min(), 0.005)
        toe_height[side] = max(toe[2] - sole[:, 2].min(), 0.0)
        heel_length[side] = max(-((sole - ankle) @ stance[foot])[:, 0].min(), 0.005)
        reach = ((sole - toe) @ stance[foot + 1])[:, 0].max()
        toes[side] = [max(reach, 0.01), 0.0, -0.5 * toe_height[side]]
    return replace(
        body, hand=hands, toe=toes, ankle_height=ankle_height, toe_height=toe_height, heel_length=heel_length
    )


def rolling_on_balls(
    body: Morphology, stance: FloatArray, points: FloatArray, vertices: FloatArray, weights: FloatArray
) -> tuple[Morphology, FloatArray]:
    """Body of ``measured_by_mesh``, and weights (V, S) with which each foot bends at its ball.

    A toe joint under the ankle moves the whole front of a foot, so that the foot could not rise on its toes. Such a
    foot is bent at the usual fraction of its length.
    """
    layout, foot, toe, weights = body.layout, body.foot.copy(), body.toe.copy(), weights.copy()
    for side in range(2):
        segment = layout.foot_segment(side)
        heel, tip = float(body.heel_length[side]), float(foot[side, 0] + toe[side, 0])
        if foot[side, 0] + heel >= _LEAST_BALL * (tip + heel):
            continue
        ball = _USUAL_BALL * (tip + heel) - heel
        foot[side] = [ball, 0.0, body.toe_height[side] - body.ankle_height[side]]
        toe[side, :2] = [tip - ball, 0.0]
        ahead = ((vertices - points[layout.ankle_point(side)]) @ stance[segment])[:, 0] - ball
        bends = np.clip(0.5 + ahead / (_BENDS_OVER * (tip + heel)), 0.0, 1.0)
        of_foot = weights[:, segment : segment + 2].sum(axis=1)
        weights[:, segment : segment + 2] = of_foot[:, None] * np.stack([1.0 - bends, bends], axis=1)
    return replace(body, foot=foot, toe=toe), weights
