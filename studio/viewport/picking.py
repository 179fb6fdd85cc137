"""Picking under the mouse: the nearest joint or bone of a performer, or a prop."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from studio.core.body.sticks import bone_pairs
from studio.engine.posed_performer import PosedPerformer
from studio.engine.prop_places import PropPose
from studio.viewport.body_points import BodyJoint, body_joints
from studio.viewport.camera import FloatArray, OrbitCamera

JOINT_PICK_PIXELS = 14.0
"""Distance in pixels within which a joint is picked."""
BODY_PICK_METRES = 0.09
"""Distance in metres from a bone within which a body is picked."""
EQUALLY_NEAR_PIXELS = 2.0
"""Difference in pixels up to which two joints count as equally near to the mouse."""

Size = tuple[float, float]


@dataclass(frozen=True)
class PickedJoint:
    """Joint picked on a performer."""

    performer_id: str
    joint: BodyJoint


def joint_at(
    posed: Mapping[str, PosedPerformer], camera: OrbitCamera, size: Size, x: float, y: float
) -> PickedJoint | None:
    """Joint nearest to pixel (x, y) within reach, of equally near ones the front one; None if there is none."""
    found: list[tuple[float, float, PickedJoint]] = []
    for performer_id, pose in posed.items():
        joints = body_joints(pose.motion.morphology.layout)
        pixels, depth = camera.project(pose.points[[joint.index for joint in joints]], size)
        away = np.hypot(*(pixels - (x, y)).T)
        found += [
            (float(away[row]), float(depth[row]), PickedJoint(performer_id, joints[row]))
            for row in np.flatnonzero((away <= JOINT_PICK_PIXELS) & (depth > 0))
        ]
    nearest = min((away for away, _, _ in found), default=0.0)
    in_front = min(
        (one for one in found if one[0] <= nearest + EQUALLY_NEAR_PIXELS), key=lambda one: one[1], default=None
    )
    return in_front[2] if in_front else None


def body_at(posed: Mapping[str, PosedPerformer], camera: OrbitCamera, size: Size, x: float, y: float) -> str | None:
    """Id of the performer with bones at pixel (x, y), the front one of several; None if there is none."""
    found: list[tuple[float, str]] = []
    for performer_id, pose in posed.items():
        pairs = bone_pairs(pose.motion.morphology.layout)
        pixels, depth = camera.project(pose.points, size)
        begin, along = pixels[pairs[:, 0]], pixels[pairs[:, 1]] - pixels[pairs[:, 0]]
        share = ((np.array([x, y]) - begin) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-9)
        away = np.hypot(*(begin + np.clip(share, 0, 1)[:, None] * along - (x, y)).T)
        near = depth[pairs].mean(axis=1)
        metres = away * np.array([camera.metres_per_pixel(size[1], float(one)) for one in near])
        hit = (metres < BODY_PICK_METRES) & (near > 0)
        if hit.any():
            found.append((float(near[hit].min()), performer_id))
    return min(found)[1] if found else None


def prop_under(props: Mapping[str, PropPose], camera: OrbitCamera, size: Size, x: float, y: float) -> str | None:
    """Id of the prop whose box the view ray through pixel (x, y) meets first; None if there is none."""
    origin, sight = camera.ray(x, y, size)
    found: list[tuple[float, str]] = []
    for prop_id, pose in props.items():
        begin, way = (origin - pose.place) @ pose.axes, sight @ pose.axes
        way = np.where(np.abs(way) < 1e-12, 1e-12, way)
        half = np.array(pose.prop.size) / 2
        walls = np.sort(np.stack([(-half - begin) / way, (half - begin) / way]), axis=0)
        enter, leave = float(walls[0].max()), float(walls[1].min())
        if enter <= leave and leave > 0:
            found.append((enter, prop_id))
    return min(found)[1] if found else None


def nearest_place(
    places: Iterable[tuple[str, FloatArray]],
    camera: OrbitCamera,
    size: Size,
    x: float,
    y: float,
    reach: float,
) -> str | None:
    """Key of the stage position (3,) nearest to pixel (x, y) within ``reach`` pixels; None if there is none."""
    best, found = reach, None
    for key, place in places:
        pixels, depth = camera.project(place, size)
        away = float(np.hypot(*(pixels[0] - (x, y))))
        if depth[0] > 0 and away <= best:
            best, found = away, key
    return found
