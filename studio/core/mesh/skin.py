"""Skin: a mesh bound to the segments of a body, fitted to other bodies and deformed by their poses."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray, Morphology
from studio.core.body.rest_pose import rest_pose
from studio.core.body.standing import standing_points
from studio.core.mesh.appearance import Appearance
from studio.core.mesh.hand_shapes import HandShapes
from studio.core.mesh.rig import Rig
from studio.core.plausible import SKIN_RANGE
from studio.core.project_cache import project_cache

VERTEX_INFLUENCES = 4
"""Maximum number of segments to which a vertex is bound."""
_FOOT_LENGTHS = (0.6, 1.6)
_FOOT_HEIGHTS = (0.3, 4.0)
_COLUMNS: tuple[tuple[str, type, int], ...] = (
    ("vertices", np.float32, 3),
    ("normals", np.float32, 3),
    ("centres", np.float32, 3),
    ("triangles", np.int32, 3),
    ("segments", np.int32, VERTEX_INFLUENCES),
    ("weights", np.float32, VERTEX_INFLUENCES),
)


class Blending(StrEnum):
    """Method that blends the motions of several segments into the motion of a vertex."""

    LINEAR = "linear"
    """Weighted mean of the positions that each segment gives the vertex, or its centre of rotation."""
    DUAL_QUATERNIONS = "dual_quaternions"
    """One screw motion between those of the segments: wrists and shoulders keep their girth when they twist."""


@dataclass(frozen=True, eq=False)
class SkinnedMesh:
    """Triangle mesh of a build, each vertex bound to up to four segments.

    ``vertices`` (V, 3) in metres and unit ``normals`` (V, 3) are in the world space of the bind pose; ``triangles`` (T,
    3) are counter-clockwise seen from outside; ``segments`` (V, 4) are indices in the canonical layout; ``weights`` (V,
    4) decrease along each row, which sums to 1; ``centres`` (V, 3) are the centres of rotation of the vertices, the
    vertices themselves for plain linear blending. Raises ValueError naming a member whose shape or index is wrong.
    """

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    centres: NDArray[np.float32]
    triangles: NDArray[np.int32]
    segments: NDArray[np.int32]
    weights: NDArray[np.float32]
    stance: FloatArray | None = None
    """World rotations (K+18, 3, 3) of the segments in the bind pose, with points as in ``standing_points``; None for
    the rest pose.
    """
    appearance: Appearance | None = None
    """Materials; None for a mesh that has only the colour of its character."""
    hands: HandShapes | None = None
    """Further shapes of the hands; None for a mesh whose hands have one shape."""
    rig: Rig | None = None
    """Joints of the file that the mesh came from; None if it had none."""

    def __post_init__(self) -> None:
        for name, kind, width in _COLUMNS:
            array: NDArray[Any] = np.array(getattr(self, name), dtype=kind)
            rows = array.shape[0] if name == "triangles" else len(self.vertices)
            if array.shape != (rows, width):
                raise ValueError(f"{name}: expected shape ({rows}, {width}), got {array.shape}.")
            if not np.isfinite(array).all():
                raise ValueError(f"{name}: holds a number that is not finite.")
            if (kind, width) == (np.float32, 3):
                SKIN_RANGE.check(array)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if not len(self.vertices) or not len(self.triangles):
            raise ValueError("vertices: a mesh needs at least one triangle.")
        if self.triangles.min() < 0 or self.triangles.max() >= len(self.vertices):
            raise ValueError("triangles: name a vertex that is not there.")
        if self.segments.min() < 0:
            raise ValueError("segments: an index is below zero.")
        if (np.diff(self.weights, axis=1) > 0).any() or not np.allclose(self.weights.sum(axis=1), 1, atol=1e-5):
            raise ValueError("weights: each row falls and sums to 1.")
        if self.stance is not None:
            self._check_stance(np.array(self.stance, dtype=np.float64))
        if self.hands is not None and self.hands.count >= len(self.vertices):
            raise ValueError("hands: they have more vertices than the mesh.")
        look = self.appearance
        if look and (len(look.coordinates), len(look.triangle_materials)) != (len(self.vertices), len(self.triangles)):
            raise ValueError("appearance: does not fit the mesh.")
        if self.rig is not None and len(self.rig.joints) != len(self.vertices):
            raise ValueError("rig: does not fit the mesh.")

    def fits_body(self, segment_count: int) -> bool:
        """True if a body with ``segment_count`` segments can wear the skin."""
        stands = self.stance is None or len(self.stance) == segment_count
        hangs = self.rig is None or int(self.rig.segments.max()) < segment_count
        return int(self.segments.max()) < segment_count and stands and hangs

    def _check_stance(self, stance: FloatArray) -> None:
        if stance.ndim != 3 or stance.shape[1:] != (3, 3) or not np.isfinite(stance).all():
            raise ValueError("stance: expected a rotation for every segment.")
        if not np.allclose(stance @ np.swapaxes(stance, 1, 2), np.eye(3), atol=1e-4):
            raise ValueError("stance: holds a matrix that is not a rotation.")
        stance.setflags(write=False)
        object.__setattr__(self, "stance", stance)


def skin_vertices(
    mesh: SkinnedMesh,
    build: Morphology,
    morphology: Morphology,
    positions: FloatArray,
    rotations: FloatArray,
    out_vertices: NDArray[np.float32] | None = None,
    out_normals: NDArray[np.float32] | None = None,
    blending: Blending = Blending.LINEAR,
    shaped: "Callable[[SkinnedMesh], tuple[NDArray[np.float32], NDArray[np.float32]]] | None" = None,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """World vertices and normals (V, 3) of one frame, written in place if ``out_`` arrays are given.

    ``positions`` (K+23, 3) and ``rotations`` (K+18, 3, 3) pose a body of ``morphology``; ``mesh`` is bound to
    ``build``. The mesh fitted to ``morphology`` is cached. ``shaped``, if given, returns other vertices and normals of
    the fitted mesh for this frame, such as bent fingers.
    """
    from studio.core.kernels.body import dual_quaternions, skinning  # late: numba takes longer than a window

    fitted = fit_skin(mesh, build, morphology)
    rest_positions, rest_rotations = bound_pose(mesh, morphology)
    proximal = list(morphology.layout.proximal_points())
    motions = np.empty((morphology.layout.segment_count, 16))
    skinning.segment_motions(rest_rotations, rest_positions[proximal], rotations, positions[proximal], motions)
    vertices = np.empty_like(mesh.vertices) if out_vertices is None else out_vertices
    normals = np.empty_like(mesh.normals) if out_normals is None else out_normals
    bound = fitted.segments, fitted.weights, motions, vertices, normals
    rest_vertices, rest_normals = shaped(fitted) if shaped else (fitted.vertices, fitted.normals)
    if blending is Blending.DUAL_QUATERNIONS:
        dual_quaternions.skin_by_dual_quaternions(rest_vertices, rest_normals, *bound)
    else:
        centres = rest_vertices if shaped else fitted.centres
        skinning.skin_by_rotation_centres(rest_vertices, rest_normals, centres, *bound)
    return vertices, normals


@project_cache(maxsize=64)
def with_grip(mesh: SkinnedMesh, grip: float) -> SkinnedMesh:
    """Mesh with its hands shaped by ``grip`` from open (-1) over at ease (0) to fists (1).

    A mesh whose hands have only one shape is returned unchanged.
    """
    if mesh.hands is None or grip == 0.0:
        return mesh
    vertices, normals = mesh.hands.shaped_vertices(mesh.vertices, mesh.normals, grip)
    return replace(mesh, vertices=vertices, normals=normals, hands=None)


def bound_pose(mesh: SkinnedMesh, morphology: Morphology) -> tuple[FloatArray, FloatArray]:
    """Points (K+23, 3) and rotations (K+18, 3, 3) of the bind pose of ``mesh``, fitted to ``morphology``."""
    return rest_pose(morphology) if mesh.stance is None else _standing(mesh, morphology)


@project_cache(maxsize=64)
def fit_skin(mesh: SkinnedMesh, build: Morphology, morphology: Morphology) -> SkinnedMesh:
    """Mesh bound to ``build``, reshaped to fit ``morphology``.

    Each segment stretches with its bone and thickens with the body; a uniformly scaled body gives a uniformly scaled
    mesh. Raises ValueError if the two bodies differ in the number of spine segments.
    """
    if build == morphology:
        return mesh
    form, shift = _forms(mesh, build, morphology)
    turns = np.linalg.inv(form)
    normals = np.einsum("vji,vj->vi", turns, mesh.normals)
    hands = mesh.hands
    if hands is not None:
        last = slice(-hands.count, None)
        moved = np.einsum("vij,gvj->gvi", form[last], hands.vertices) + shift[last]
        turned = np.einsum("vji,gvj->gvi", turns[last], hands.normals)
        hands = HandShapes(moved, turned / np.linalg.norm(turned, axis=2, keepdims=True))
    return replace(
        mesh,
        hands=hands,
        vertices=np.einsum("vij,vj->vi", form, mesh.vertices) + shift,
        centres=np.einsum("vij,vj->vi", form, mesh.centres) + shift,
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
    )


def fit_vertices(mesh: SkinnedMesh, build: Morphology, morphology: Morphology) -> NDArray[np.float32]:
    """Vertices (V, 3) of ``mesh`` fitted to ``morphology``, in a third of the time of ``fit_skin``."""
    if build == morphology:
        return mesh.vertices
    form, shift = _forms(mesh, build, morphology)
    return np.asarray(np.einsum("vij,vj->vi", form, mesh.vertices) + shift, dtype=np.float32)


def _forms(mesh: SkinnedMesh, build: Morphology, morphology: Morphology) -> tuple[FloatArray, FloatArray]:
    """Linear map (V, 3, 3) and translation (V, 3) of each vertex from ``build`` to ``morphology``."""
    forms, shifts = segment_forms(mesh, build, morphology)
    rows = np.concatenate([forms.reshape(-1, 9), shifts], axis=1)
    blended = np.zeros((len(mesh.vertices), rows.shape[1]))
    for weight, segment in zip(mesh.weights.T, mesh.segments.T, strict=True):
        part = np.take(rows, segment, axis=0)
        blended += np.multiply(part, weight[:, None], out=part)
    return blended[:, :9].reshape(-1, 3, 3), blended[:, 9:]


def segment_forms(mesh: SkinnedMesh, build: Morphology, morphology: Morphology) -> tuple[FloatArray, FloatArray]:
    """Linear map (S, 3, 3) and translation (S, 3) from ``build`` to ``morphology`` of points bound to each segment."""
    if build.layout != morphology.layout:
        raise ValueError("A skin fits bodies with the same number of spine segments only.")
    old_positions, old_rotations = bound_pose(mesh, build)
    new_positions, new_rotations = bound_pose(mesh, morphology)
    scales = segment_scales(build, morphology)
    proximal = list(build.layout.proximal_points())
    forms = np.einsum("sij,sj,skj->sik", new_rotations, scales, old_rotations)
    return forms, new_positions[proximal] - np.einsum("sij,sj->si", forms, old_positions[proximal])


def segment_scales(build: Morphology, morphology: Morphology) -> FloatArray:
    """Stretch factors (K+18, 3) of each segment along its own axes, from ``build`` to ``morphology``.

    Girth follows the ratio that most measures share, and a quarter of the segment's own lengthening beyond it. Head and
    hands keep their shape. Feet grow with their length and reach down to the ground. The trunk widens with hips and
    shoulders.
    """
    layout, spine_count = build.layout, build.layout.spine_count
    lengths = np.stack([_bone_lengths(body) for body in (build, morphology)])
    along = np.divide(lengths[1], lengths[0], out=np.ones(len(lengths[0])), where=lengths[0] > 1e-9)
    shared = float(np.median(along))
    girth = shared * (along / shared) ** 0.25
    scales = np.stack([girth, girth, along], axis=1)
    for side in (0, 1):
        hand, foot = (layout.segment_of_part(part) + 4 * side for part in (BodyPart.LEFT_HAND, BodyPart.LEFT_FOOT))
        scales[hand] = along[hand]
        scales[foot : foot + 2] = _foot_scales(build, morphology, side, shared)
    scales[layout.segment_of_part(BodyPart.HEAD)] = along[layout.segment_of_part(BodyPart.HEAD)]
    hips, shoulders = _trunk_widths(morphology) / _trunk_widths(build)
    scales[:spine_count, 0] = shared
    scales[:spine_count, 1] = np.linspace(hips, shoulders, spine_count)
    return scales


def _foot_scales(build: Morphology, morphology: Morphology, side: int, shared: float) -> FloatArray:
    """Stretch factors (2, 3) of foot and toe: horizontally by their lengths, vertically so that the sole stays on the
    ground.

    They are limited to the neighbourhood of the ratio that most measures share, because a captured foot may have zero
    length or height.
    """
    measures = [
        [(np.linalg.norm(body.foot[side, :2]), body.ankle_height[side]),
         (np.linalg.norm(body.toe[side, :2]), body.toe_height[side])]
        for body in (build, morphology)
    ]  # fmt: skip
    old, new = np.maximum(np.array(measures), 1e-6)
    lengths, heights = (new / old).T / shared
    sideways = shared * np.clip(lengths, *_FOOT_LENGTHS)
    return np.stack([sideways, sideways, shared * np.clip(heights, *_FOOT_HEIGHTS)], axis=1)


def _bone_lengths(body: Morphology) -> FloatArray:
    """Length (K+18,) of each segment between its two ends."""
    positions, _ = rest_pose(body)
    ends = positions[list(body.layout.distal_points())] - positions[list(body.layout.proximal_points())]
    return np.asarray(np.linalg.norm(ends, axis=1))


def _trunk_widths(body: Morphology) -> FloatArray:
    """Distances between the hips and between the shoulders."""
    shoulders = np.ptp(body.collar_base[:, 1]) + body.clavicle.sum()
    return np.array([np.ptp(body.hip_offset[:, 1]), shoulders])


@project_cache(maxsize=64)
def _standing(mesh: SkinnedMesh, morphology: Morphology) -> tuple[FloatArray, FloatArray]:
    assert mesh.stance is not None
    return standing_points(morphology, mesh.stance), mesh.stance
