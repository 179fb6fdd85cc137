"""Wireframes of solids: the capsules of a body, the edges of a mesh."""

import numpy as np

from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.mesh.volume import BodyVolume, usual_volume
from studio.core.project_cache import project_cache
from studio.core.solver.request import AdaptedMotion
from studio.viewport.camera import FloatArray

MAX_DRAWN_EDGES = 240
"""Maximum number of edges that are drawn of a mesh, the sharpest first."""
_TURN = np.linspace(0.0, 2 * np.pi, 25)
_CIRCLE = np.stack([np.cos(_TURN), np.sin(_TURN)], axis=1)
_HALF_TURN_ANGLES = np.linspace(0.0, np.pi, 9)


def capsule_lines(motion: AdaptedMotion, row: int) -> list[FloatArray]:
    """Capsules of a body in a frame of a motion, each as two rings and two outlines."""
    volume = motion.volume or usual_volume(motion.morphology)
    ends = capsule_ends(volume, motion, row)
    return [line for pair, radii in zip(ends, volume.radii, strict=True) for line in _capsule(*pair, *radii)]


def capsule_ends(volume: BodyVolume, motion: AdaptedMotion, row: int) -> FloatArray:
    """(N, 2, 3) ends of the capsules, motion space."""
    origins = motion.positions[row][list(motion.morphology.layout.proximal_points())][volume.segments]
    turns = motion.rotations[row][volume.segments]
    return np.asarray(origins + np.einsum("neij,nej->nei", turns, volume.places))


def _capsule(begin: FloatArray, end: FloatArray, first: float, last: float) -> list[FloatArray]:
    length = float(np.linalg.norm(end - begin))
    along = (end - begin) / length if length > 1e-6 else np.eye(3)[2]  # a ball has no direction
    side = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    side /= np.linalg.norm(side)
    across = np.stack([side, np.cross(along, side)])
    rings = [centre + radius * _CIRCLE @ across for centre, radius in ((begin, first), (end, last))]
    outlines = []
    for way in across:
        cap = np.cos(_HALF_TURN_ANGLES)[:, None] * way, np.sin(_HALF_TURN_ANGLES)[:, None] * along
        top, bottom = end + last * (cap[0] + cap[1]), begin - first * (cap[0] + cap[1])
        outlines.append(np.concatenate([top, bottom, top[:1]]))
    return [*rings, *outlines]


@project_cache(maxsize=8)
def mesh_lines(mesh: TriangleMesh) -> tuple[list[FloatArray], list[FloatArray]]:
    """Rim and sharpest edges (2, 3) of a mesh, and no faces, so that the body behind stays visible."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    pairs = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, which, count = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True)
    total = np.zeros((len(edges), 3))
    np.add.at(total, which.reshape(-1), np.repeat(normals, 3, axis=0))
    # Two faces in one plane add up to 2; a rim has one face alone.
    flat = np.where(count == 1, 0.0, np.linalg.norm(total, axis=1) / count)
    lengths = np.linalg.norm(np.diff(mesh.vertices[edges], axis=1)[:, 0], axis=1)
    weight = (1.0 - flat) * lengths + 1e-9 * lengths
    sharp = np.argsort(-weight, kind="stable")[:MAX_DRAWN_EDGES]
    bent = sharp[flat[sharp] < 0.9999]
    return list(mesh.vertices[edges[bent if len(bent) else sharp]]), []
