"""Binding a mannequin to its segments: smooth weights and centres of rotation."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray
from studio.core.mannequin.form import Form
from studio.core.mannequin.surface import vertex_links
from studio.core.mesh.skin import VERTEX_INFLUENCES


def weights_by_joints(form: Form, vertices: FloatArray) -> FloatArray:
    """Weights (V, K+18) of each segment in each vertex.

    At every joint a smooth step gives the fraction of a vertex beyond it. A segment has the fraction that is beyond its
    own joint and not beyond those of its children.
    """
    layout = form.physique.morphology().layout
    beyond = np.ones((len(vertices), layout.segment_count))
    sides = [_left_steps(form, vertices * [1, 1 - 2 * side, 1]) for side in (0, 1)]
    arms = np.maximum(sides[0]["arm region"], sides[1]["arm region"])
    h = form.physique.stature
    for k in range(1, layout.spine_count):
        joint = form.rest[0][k]
        beyond[:, k] = np.maximum(_step(vertices[:, 2] - joint[2], 0.045 * h), arms)
    _, neck, skull, _, _ = form.regions(vertices)
    above = vertices - form.point("neck base")
    beyond[:, layout.segment_of_part(BodyPart.NECK)] = _step(above @ [0.3, 0, 0.95] - 0.004 * h, 0.026 * h) * (1 - arms)
    beyond[:, layout.segment_of_part(BodyPart.HEAD)] = _step(neck - skull - 0.008 * h, 0.016 * h)
    for side, steps in enumerate(sides):
        for part in _LIMB_PARTS:
            beyond[:, layout.segment_of_part(part) + 4 * side] = steps[part]
    return _owned(beyond, layout.parent_segments())


_LIMB_PARTS = (
    BodyPart.LEFT_CLAVICLE,
    BodyPart.LEFT_UPPER_ARM,
    BodyPart.LEFT_FOREARM,
    BodyPart.LEFT_HAND,
    BodyPart.LEFT_THIGH,
    BodyPart.LEFT_SHANK,
    BodyPart.LEFT_FOOT,
    BodyPart.LEFT_TOE,
)


def _owned(beyond: FloatArray, parents: tuple[int, ...]) -> FloatArray:
    """Weights of segments from the fractions ``beyond`` their joints.

    Each is the product, down the tree, of the fraction that reaches the segment and of the fractions that its children
    leave.
    """
    reached = beyond.copy()
    for segment, parent in enumerate(parents):
        if parent >= 0:
            reached[:, segment] *= reached[:, parent]
    weights = reached.copy()
    for segment, parent in enumerate(parents):
        if parent >= 0:
            weights[:, parent] -= reached[:, segment]
    weights = np.maximum(weights, 0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _left_steps(form: Form, vertices: FloatArray) -> dict[str, FloatArray]:
    """Fractions of the vertices beyond each joint of the left limbs; vertices of the right half are passed mirrored."""
    h = form.physique.stature
    torso, _, _, arm, leg = form.regions(vertices)
    left = vertices[:, 1] > 0
    region = _step(np.minimum(torso, leg) - arm, 0.022 * h) * left
    shoulder, elbow, wrist, collar = (form.point(n) for n in ("shoulder", "elbow", "wrist", "collar"))
    upper, lower = (form.frame(p)[:, 2] for p in (BodyPart.LEFT_UPPER_ARM, BodyPart.LEFT_FOREARM))
    out = np.array([0.0, 1.0, 0.0])
    beyond_shoulder = _step((vertices - shoulder) @ _unit(upper + 0.6 * out) - 0.004 * h, 0.036 * h) * region
    lateral = _step(vertices[:, 1] - 0.5 * (collar + shoulder)[1], 0.6 * (shoulder - collar)[1])
    high = _step(vertices[:, 2] - shoulder[2] + 0.025 * h, 0.045 * h)
    clavicle = np.maximum(0.85 * lateral * high * left, beyond_shoulder)
    groin = _unit(np.array([0.10, 0.42, -0.90]))
    hip, knee, ankle, toe = (form.point(n) for n in ("hip", "knee", "ankle", "toe"))
    own_side = _step(vertices[:, 1], 0.010 * h)
    thigh = _step((vertices - hip) @ groin, 0.050 * h) * own_side * (1 - region)
    sole = np.array([0.0, 0.0, -1.0])
    foot = _step((vertices - ankle) @ _unit(np.array([0.35, 0.0, -1.0])) + 0.004 * h, 0.020 * h)
    return {
        "arm region": region,
        BodyPart.LEFT_CLAVICLE: clavicle,
        BodyPart.LEFT_UPPER_ARM: np.where(clavicle > 0, beyond_shoulder / np.maximum(clavicle, 1e-9), 0),
        BodyPart.LEFT_FOREARM: _step((vertices - elbow) @ _unit(upper + lower), 0.030 * h),
        BodyPart.LEFT_HAND: _step((vertices - wrist) @ lower, 0.018 * h),
        BodyPart.LEFT_THIGH: thigh,
        BodyPart.LEFT_SHANK: _step((vertices - knee) @ sole, 0.036 * h),
        BodyPart.LEFT_FOOT: foot,
        BodyPart.LEFT_TOE: _step(vertices[:, 0] - toe[0], 0.014 * h),
    }


def diffused_weights(weights: FloatArray, triangles: NDArray[np.int64], rounds: int) -> FloatArray:
    """Weights smoothed over the surface in ``rounds``, so that no influence ends abruptly or crosses a gap."""
    links = vertex_links(triangles, len(weights))
    for _ in range(rounds):
        weights = 0.5 * weights + 0.5 * (links @ weights)
    return weights


def four_strongest(weights: FloatArray) -> tuple[NDArray[np.int64], FloatArray]:
    """Segments (V, 4) and weights (V, 4) of the four strongest influences, strongest first, with sum 1."""
    segments = np.argsort(-weights, axis=1, kind="stable")[:, :VERTEX_INFLUENCES]
    chosen = np.take_along_axis(weights, segments, axis=1)
    chosen[chosen < 0.008] = 0
    return segments, chosen / chosen.sum(axis=1, keepdims=True)


def rotation_centres(
    vertices: FloatArray, triangles: NDArray[np.int64], segments: NDArray[np.int64], weights: FloatArray
) -> FloatArray:
    """Centres of rotation (V, 3) of the vertices: the mean position of the vertices with similar weights.

    Le and Hodgins (2016), equation 1, summed over vertices by area. The centre of a rigid vertex is the vertex itself.
    """
    dense = np.zeros((len(vertices), int(segments.max()) + 1))
    np.put_along_axis(dense, segments, weights, axis=1)
    corners = vertices[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    areas = np.bincount(triangles.ravel(), np.repeat(area, 3), len(vertices))
    total, mass = np.zeros_like(vertices), np.zeros(len(vertices))
    for j, k in combinations(range(dense.shape[1]), 2):
        both = np.flatnonzero((dense[:, j] > 0) & (dense[:, k] > 0))
        if not len(both):
            continue
        wj, wk = dense[both, j], dense[both, k]
        unlike = (wj[:, None] * wk - wk[:, None] * wj) / 0.1
        alike = (wj * wk)[:, None] * (wj * wk) * np.exp(-(unlike**2)) * areas[both]
        total[both] += alike @ vertices[both]
        mass[both] += alike.sum(axis=1)
    found = mass > 1e-15
    return np.where(found[:, None], total / np.where(found, mass, 1)[:, None], vertices)


def _step(distance: FloatArray, half_width: float) -> FloatArray:
    """Smooth step of ``distance``: 0 below -half_width, 1 above half_width."""
    t = np.clip((distance / half_width + 1) / 2, 0, 1)
    return np.asarray(t * t * (3 - 2 * t))


def _unit(vector: FloatArray) -> FloatArray:
    return np.asarray(vector / np.linalg.norm(vector))
