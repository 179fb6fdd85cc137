"""Camera that follows a character, by its root's smoothed path over the ground."""

from dataclasses import replace

import numpy as np

from studio.engine.performance import PosedPerformer
from studio.viewport.camera import FloatArray, OrbitCamera

SECONDS = 0.6
"""The way is smoothed over so long on either side."""


class FollowCamera:
    """Moves a camera by the followed character's displacement since the last picture."""

    def __init__(self) -> None:
        self._last: tuple[str, FloatArray] | None = None

    def moved(self, camera: OrbitCamera, performer_id: str, pose: PosedPerformer | None) -> OrbitCamera:
        """``camera`` moved along with a performer, or moved in front of a newly followed one; unchanged without a
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
    """``camera`` moved by a displacement (2,) over the ground."""
    x, y, z = camera.target
    return replace(camera, target=(x + float(way[0]), y + float(way[1]), z))


def smoothed_root(pose: PosedPerformer) -> FloatArray:
    """(2,) position on the stage of a performer's smoothed root path.

    A performer that is driven live is displaced from its clips, which are known over time: the smoothing is theirs, the
    position its own.
    """
    roots, reach = pose.over_time.positions[:, 0], round(SECONDS * pose.motion.frame_rate)
    here = pose.frame - pose.over_time.first_frame
    here, *rows = np.clip([here, *range(here - reach, here + reach + 1)], 0, len(roots) - 1)
    root = pose.motion.positions[pose.row, 0] + roots[rows].mean(axis=0) - roots[here]
    return np.asarray(pose.placement.to_stage(root)[:2])
