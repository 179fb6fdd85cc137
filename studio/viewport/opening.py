"""Default camera: a low three-quarter view in which every performer is visible and separate."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from studio.core.grounds.ground import Ground
from studio.engine.posed_performer import PosedPerformer
from studio.viewport.camera import FloatArray, OrbitCamera

OPENING_AZIMUTHS = tuple(math.radians(degrees) for degrees in (-52, 52, -40, 40, -30, 30))
"""Candidate azimuths in radians relative to the direction that the bodies face, in order of preference."""
SLOPE_VIEW_ANGLES = tuple(math.radians(degrees) for degrees in (-105, 105, -80, 80))
"""Candidate azimuths in radians over uneven ground; from the front, the risers of steps would not be visible."""
UNEVEN_GROUND_METRES = 0.15
"""Difference in height in metres of the ground under the performers from which it counts as uneven."""
ENOUGH_APART_METRES = 0.8
"""Distance in metres between two bodies in the image beyond which more distance is no improvement."""
ROWS = 24
CHIPS_HEIGHT_PX, MAX_STEPS_BACK = 56.0, 12
"""Pixels that the chips take at the upper edge, and maximum number of steps by which the camera moves back."""
FACING_SAMPLES = 500
"""Number of frames, spread over a motion, from which the direction that a body faces is estimated."""
MIN_MEAN_DIRECTION = 0.3
"""Minimum length of a mean of unit vectors to count as a direction."""
SIZE_CHANGE_FRACTION = 0.2
"""Change of a view's width or height, as a fraction, from which it counts as another size."""


def performed_points(posed: Mapping[str, PosedPerformer]) -> FloatArray:
    """(N, 3) stage points that the performers reach during their whole motions, thinned out."""
    paths = []
    for pose in posed.values():
        rows = np.linspace(0, pose.over_time.frame_count - 1, ROWS).round().astype(int)
        paths.append(pose.placement.to_stage(pose.over_time.positions[rows]).reshape(-1, 3))
    return np.concatenate(paths) if paths else np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 1.8]])


def opening_camera(
    posed: Mapping[str, PosedPerformer],
    size: tuple[float, float],
    parallel: bool = False,
    ground: Ground | None = None,
    covered_below: float = 0.0,
) -> OrbitCamera:
    """Default camera for these performers; more from the side if the ``ground`` under them is uneven.

    The performers are above the ``covered_below`` pixels at the lower edge.
    """
    places = np.array([pose.points[0] for pose in posed.values()]).reshape(-1, 3)
    front = _facing(posed)
    heights = ground.height_at(performed_points(posed)) if ground is not None else np.zeros(1)
    azimuths = SLOPE_VIEW_ANGLES if float(np.ptp(heights)) > UNEVEN_GROUND_METRES else OPENING_AZIMUTHS
    cameras = [replace(OrbitCamera(), azimuth=front + azimuth, parallel=parallel) for azimuth in azimuths]
    best = max(cameras, key=lambda camera: round(5 * _apart(camera, places)) - _tall_in_front(camera, posed))
    now = np.concatenate([pose.points for pose in posed.values()]) if posed else np.zeros((0, 3))
    return clear_of_overlays(best.framing(performed_points(posed), size), now, size, covered_below)


def clear_of_overlays(
    camera: OrbitCamera, points: FloatArray, size: tuple[float, float], covered_below: float = 0.0
) -> OrbitCamera:
    """Camera moved back and tilted until no stage point (N, 3) is behind the chips at the upper edge or the
    ``covered_below`` pixels at the lower edge.
    """
    for _ in range(MAX_STEPS_BACK):
        pixels, depth = camera.project(points, size)
        above = max(CHIPS_HEIGHT_PX - float(pixels[:, 1].min(initial=CHIPS_HEIGHT_PX)), 0.0)
        below = max(float(pixels[:, 1].max(initial=0.0)) - (size[1] - covered_below), 0.0) if covered_below else 0.0
        if above <= 0.0 and below <= 0.0:
            break
        raised = 0.5 * (above - below) * camera.metres_per_pixel(size[1], float(depth.min()))
        target = np.asarray(camera.target) + camera.axes[1] * raised
        camera = replace(camera, target=tuple(target.tolist()), distance=camera.distance * 1.04)
    return camera


def _facing(posed: Mapping[str, PosedPerformer]) -> float:
    """Azimuth in radians that the pelves face most of the time; 0 if there is no clear direction."""
    ways = []
    for pose in posed.values():
        rows = np.unique(np.linspace(0, pose.over_time.frame_count - 1, FACING_SAMPLES).astype(int))
        ways.append((pose.placement.rotation @ pose.over_time.rotations[rows, 0, :, 0].mean(axis=0))[:2])
    way = np.mean(ways, axis=0) if ways else np.zeros(2)
    return float(np.arctan2(way[1], way[0])) if np.hypot(*way) > MIN_MEAN_DIRECTION else 0.0


def _apart(camera: OrbitCamera, positions: FloatArray) -> float:
    if len(positions) < 2:
        return 0.0
    across = np.sort(positions @ camera.axes[0])
    return float(np.minimum(np.diff(across), ENOUGH_APART_METRES).mean())


def _tall_in_front(camera: OrbitCamera, posed: Mapping[str, PosedPerformer]) -> bool:
    """True if taller bodies are nearer and hide smaller ones."""
    statures = np.array([pose.over_time.morphology.stature for pose in posed.values()])
    nearness = np.array([pose.points[0] @ camera.axes[2] for pose in posed.values()])
    return bool((statures - statures.mean()) @ (nearness - nearness.mean()) > 0) if len(posed) > 1 else False


def is_another_size(now: tuple[float, float], before: tuple[float, float]) -> bool:
    """True if the size of a view has changed by more than the message strip below it."""
    return any(abs(one / other - 1) > SIZE_CHANGE_FRACTION for one, other in zip(now, before, strict=True))
