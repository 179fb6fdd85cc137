"""Picking of a point on the skin of a performer."""

from collections.abc import Mapping

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.mesh.skin import SkinnedMesh, with_grip
from studio.core.stage.project import Project
from studio.engine.posed_performer import PosedPerformer
from studio.viewport.bodies import pose_skin
from studio.viewport.body_points import skin_point
from studio.viewport.camera import FloatArray, OrbitCamera
from studio.viewport.picking import PickedJoint, Size

LEAST_DETERMINANT = 1e-12
"""Determinant below which a triangle is seen from behind or edge-on."""


def skin_point_at(
    project: Project, posed: Mapping[str, PosedPerformer], camera: OrbitCamera, size: Size, x: float, y: float
) -> PickedJoint | None:
    """Point of the first skin that the view ray through pixel (x, y) meets, fixed to the segment with most weight
    there; None if there is none.
    """
    origin, sight = camera.ray(x, y, size)
    found: list[tuple[float, str, PickedJoint]] = []
    for performer_id, pose in posed.items():
        character, axes = project.characters[pose.performer.character_id], pose.placement.rotation
        skin = with_grip(character.skin, pose.grip(character.grip))
        vertices = pose_skin(skin, character, pose)[0].astype(np.float64)
        hit = _first_triangle(vertices[skin.triangles], pose.placement.to_motion(origin), axes.T @ sight)
        if hit is not None:
            depth, triangle, shares = hit
            place = shares @ vertices[skin.triangles[triangle]]
            part = pose.motion.morphology.layout.part_of_segment(_leading_segment(skin, triangle, shares))
            found.append((depth, performer_id, _fixed_point(performer_id, pose, part, place)))
    return min(found, default=(0.0, "", None))[2]


def _first_triangle(corners: FloatArray, origin: FloatArray, sight: FloatArray) -> tuple[float, int, FloatArray] | None:
    """Depth, index and barycentric coordinates (3,) of the nearest triangle of ``corners`` (T, 3, 3) that a ray meets
    from outside (Möller and Trumbore 1997); None if there is none.
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across, begin = np.cross(sight, second), origin - corners[:, 0]
    facing = (first * across).sum(axis=1)
    scale = 1.0 / np.where(facing > LEAST_DETERMINANT, facing, np.inf)
    turned = np.cross(begin, first)
    v, w = (begin * across).sum(axis=1) * scale, (turned @ sight) * scale
    depth = (second * turned).sum(axis=1) * scale
    hit = (facing > LEAST_DETERMINANT) & (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0) & (depth > 0.0)
    if not hit.any():
        return None
    nearest = int(np.where(hit, depth, np.inf).argmin())
    return float(depth[nearest]), nearest, np.array([1.0 - v[nearest] - w[nearest], v[nearest], w[nearest]])


def _leading_segment(skin: SkinnedMesh, triangle: int, shares: FloatArray) -> int:
    """Segment with the largest weight at a point of a triangle with barycentric coordinates ``shares`` (3,)."""
    corners = skin.triangles[triangle]
    weights = (shares[:, None] * skin.weights[corners]).ravel()
    return int(np.bincount(skin.segments[corners].ravel(), weights).argmax())


def _fixed_point(performer_id: str, pose: PosedPerformer, part: BodyPart, position: FloatArray) -> PickedJoint:
    """Picked point at ``position`` (3,), motion space; a point on the waist is fixed to the chest."""
    part = BodyPart.THORAX if part is BodyPart.ABDOMEN else part
    layout, row = pose.motion.morphology.layout, pose.row
    segment = layout.segment_of_part(part)
    ends = pose.motion.positions[row, [layout.proximal_points()[segment], layout.distal_points()[segment]]]
    at_end = int(np.linalg.norm(ends - position, axis=1).argmin())
    x, y, z = (pose.motion.rotations[row, segment].T @ (position - ends[at_end])).tolist()
    return PickedJoint(performer_id, skin_point(layout, part, (x, y, z), bool(at_end)))
