"""Construction of the bound mesh of a physique."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyPart
from studio.core.body.morphology import FloatArray
from studio.core.mannequin import binding, remesh, surface
from studio.core.mannequin.form import Form
from studio.core.mannequin.physique import Physique
from studio.core.mesh.hand_shapes import STORED_GRIPS, HandShapes
from studio.core.mesh.skin import SkinnedMesh

GRID_CELL_FRACTION = 0.0058
"""Grid cell of the first surface as a fraction of stature."""

SCULPT_ROUNDS = 7
CREASE_SOFTENING_ROUNDS = 3


def make_mannequin(physique: Physique) -> SkinnedMesh:
    """Mesh of the body of ``physique`` in its rest pose: smooth, symmetric, closed, and bound to its segments."""
    form, h = Form(physique), physique.stature
    points, _ = form.rest
    low = np.array([-0.16, 0.0, -0.03]) * h
    high = np.array([0.20, points[:, 1].max() / h + 0.05, 1.04]) * h
    half, half_triangles = surface.left_half_surface(form.distance, low, high, GRID_CELL_FRACTION * h)
    half, half_triangles = remesh.remeshed_surface(
        half,
        half_triangles,
        form.edge_lengths,
        lambda points: surface.project(form.distance, points, GRID_CELL_FRACTION * h, 2),
        SCULPT_ROUNDS,
    )
    vertices, triangles = surface.whole_surface(half, half_triangles)
    vertices = surface.softened_surface(vertices, triangles, CREASE_SOFTENING_ROUNDS)
    weights = binding.diffused_weights(binding.weights_by_joints(form, vertices), triangles, 4)
    tubes, tube_triangles = surface.whole_surface(*form.fingers())
    held = np.zeros((len(tubes), weights.shape[1]))
    layout = physique.morphology().layout
    for part, side in ((BodyPart.LEFT_HAND, tubes[:, 1] > 0), (BodyPart.RIGHT_HAND, tubes[:, 1] < 0)):
        held[side, layout.segment_of_part(part)] = 1.0
    triangles = np.concatenate([triangles, tube_triangles + len(vertices)])
    vertices, weights = np.concatenate([vertices, tubes]), np.concatenate([weights, held])
    segments, chosen = binding.four_strongest(weights)
    return SkinnedMesh(
        vertices=_rounded(vertices, 16),
        normals=_rounded(surface.vertex_normals(vertices, triangles), 14),
        centres=_rounded(binding.rotation_centres(vertices, triangles, segments, chosen), 14),
        triangles=triangles.astype(np.int32),
        segments=segments.astype(np.int32),
        weights=chosen.astype(np.float32),
        hands=_hand_shapes(form),
    )


def _hand_shapes(form: Form) -> HandShapes:
    """Further shapes of thumbs and fingers, which are the last vertices of the mesh."""
    shapes = [surface.whole_surface(*form.fingers(grip)) for grip in STORED_GRIPS]
    vertices = np.stack([places for places, _ in shapes])
    normals = np.stack([surface.vertex_normals(places, triangles) for places, triangles in shapes])
    return HandShapes(_rounded(vertices, 16), _rounded(normals, 14))


def _rounded(array: FloatArray, bits: int) -> NDArray[np.float32]:
    """Array rounded to multiples of 2^-bits, invisible to the eye, which halves the file."""
    return (np.round(array * 2.0**bits) / 2.0**bits).astype(np.float32)
