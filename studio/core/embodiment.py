"""From a standing skeleton and a mesh round it to a character: measures, stance, weights on canonical segments."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.appearance import Appearance
from studio.core.canonical import BodyLayout, BodyPart
from studio.core.capture import Capture
from studio.core.contacts import FootPoint
from studio.core.humanoid import BodyMap
from studio.core.kinematics import rest_poses
from studio.core.morphology import Morphology
from studio.core.normalized.alignment import find_alignments
from studio.core.normalized.landmarks import find_landmarks
from studio.core.normalized.measure import measure_actor
from studio.core.rotations import IDENTITY
from studio.core.skeleton import Skeleton
from studio.core.skin import INFLUENCES, SkinnedMesh
from studio.core.standing import standing_points

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_LEAST_WEIGHT = 0.004


def measured(skeleton: Skeleton, body_map: BodyMap) -> tuple[Morphology, FloatArray]:
    """The measures of a body that stands on z = 0 with all its joints at ``skeleton``'s zero pose, facing +X.

    Also its stance: the rotations (S, 3, 3) of the canonical segments as it stands.
    """
    still = np.tile(IDENTITY, (skeleton.joint_count, 1))
    standing = Capture("body", "", skeleton, rest_poses(skeleton, still), 1.0, body_map, still, 0.0, "m", "Z", 0, (), ())
    marks = find_landmarks(standing, body_map)
    stance = marks.rotations[0] @ find_alignments(marks)
    contacts = {point: [(0, 0)] for point in FootPoint}
    return measure_actor(marks, stance, stance[None], marks.points, contacts, 0), stance


def segments_of_joints(skeleton: Skeleton, body_map: BodyMap) -> IntArray:
    """(J,) the canonical segment that each joint moves: its own, or that of the nearest joint above with one."""
    layout = BodyLayout(len(body_map.spine))
    own = {joint: place for place, joint in enumerate(body_map.spine)}
    own |= {joint: layout.segment(part) for part, joint in body_map.parts.items() if joint not in own}
    segments = np.zeros(skeleton.joint_count, dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        segments[joint] = own.get(joint, segments[parent] if parent >= 0 else 0)
    return segments


def segment_weights(joints: IntArray, weights: FloatArray, segments: IntArray, count: int) -> FloatArray:
    """(V, count) share of each segment in each vertex, out of joints (V, n) and their weights (V, n)."""
    total = np.zeros((len(joints), count), dtype=np.float32)
    rows = np.arange(len(joints))
    for column in range(joints.shape[1]):
        np.add.at(total, (rows, segments[joints[:, column]]), weights[:, column])
    return total


def strongest(weights: FloatArray) -> tuple[IntArray, FloatArray]:
    """(V, 4) segments and weights of the strongest influences, heaviest first, summing to 1."""
    segments = np.argsort(-weights, axis=1, kind="stable")[:, :INFLUENCES]
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
    """A mesh (V, 3) round a body in its stance; ``root`` (3,) is where the body's root stands among the vertices."""
    shift = standing_points(body, stance)[0] - root
    segments, chosen = strongest(weights)
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
    """The body with crown, finger tips, toe tips, heels and soles where its mesh (V, 3) has them.

    ``points`` (P, 3) are the canonical points among the vertices; ``weights`` (V, S) say which vertex belongs where.
    """
    layout = body.layout

    def owned(*segments: int) -> FloatArray:
        return vertices[weights[:, list(segments)].sum(axis=1) > 0.5]

    head = owned(layout.segment(BodyPart.HEAD))
    crown = head[:, 2].max() - points[layout.head_joint, 2] if len(head) else 0.0
    values = {name: np.array(getattr(body, name)) for name in _ENDS}
    for side in range(2):
        hand = layout.spine_count + 5 + 4 * side
        fingers = (owned(hand) - points[layout.wrist(side)]) @ stance[hand]
        if len(fingers) and fingers[:, 2].max() > 0.02:
            values["hand"][side] = [0.0, 0.0, fingers[:, 2].max()]
        _measure_foot(side, values, stance, points, owned, layout)
    longest_head = 1.5 * body.spine_length
    return replace(body, head=float(np.clip(crown, 0.5 * body.head, longest_head)) if len(head) else body.head, **values)


_ENDS = ("hand", "toe", "ankle_height", "toe_height", "heel_length")


def _measure_foot(
    side: int, values: dict[str, FloatArray], stance: FloatArray, points: FloatArray, owned: object, layout: BodyLayout
) -> None:
    foot = layout.spine_count + 12 + 4 * side
    sole = owned(foot, foot + 1)  # type: ignore[operator]
    if not len(sole):
        return
    ankle, toe = points[layout.ankle(side)], points[layout.toe(side)]
    along = (sole - ankle) @ stance[foot]
    ground = sole[:, 2].min()
    values["ankle_height"][side] = max(ankle[2] - ground, 0.005)
    values["toe_height"][side] = max(toe[2] - ground, 0.0)
    values["heel_length"][side] = max(-along[:, 0].min(), 0.005)
    reach = ((sole - toe) @ stance[foot + 1])[:, 0].max()
    values["toe"][side] = [max(reach, 0.01), 0.0, -0.5 * values["toe_height"][side]]
