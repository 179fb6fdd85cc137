"""Camera that follows a performer along the smoothed path of its root over the ground."""

from dataclasses import replace

import numpy as np

from studio.engine.posed_performer import PosedPerformer
from studio.viewport.camera import FloatArray, OrbitCamera

HALF_CAMERA_WINDOW_SECONDS = 0.6
"""Half of the smoothing window in seconds."""


class FollowCamera:
    """Camera motion by the followed performer's displacement since the last image."""

    def __init__(self) -> None:
        self._last: tuple[str, FloatArray] | None = None

    def moved(self, camera: OrbitCamera, performer_id: str, pose: PosedPerformer | None) -> OrbitCamera:
        """``camera`` moved along with a performer, or in front of a newly followed one; unchanged without a
        ``pose``.
        """
        if pose is None:
            self._last = None
            return camera
        place = smoothed_root(pose)
        before, self._last = self._last, (performer_id, place)
        known = before is not None and before[0] == performer_id
        return translated_camera(camera, place - (before[1] if before is not None and known else camera.target[:2]))


def translated_camera(camera: OrbitCamera, way: FloatArray) -> OrbitCamera:
    """``camera`` moved by a horizontal displacement ``way`` (2,) in metres."""
    x, y, z = camera.target
    return replace(camera, target=(x + float(way[0]), y + float(way[1]), z))


def smoothed_root(pose: PosedPerformer) -> FloatArray:
    """(2,) smoothed position of a performer's root on the stage.

    A performer driven by live input has only its current position; the smoothing offset is taken from its clips.
    """
    roots, reach = pose.over_time.positions[:, 0], round(HALF_CAMERA_WINDOW_SECONDS * pose.motion.frame_rate)
    here = pose.frame - pose.over_time.first_frame
    here, *rows = np.clip([here, *range(here - reach, here + reach + 1)], 0, len(roots) - 1)
    root = pose.motion.positions[pose.row, 0] + roots[rows].mean(axis=0) - roots[here]
    return np.asarray(pose.placement.to_stage(root)[:2])
