"""The camera that goes with a character: by its root's way over the ground, not by every sway of the hips."""

from dataclasses import replace

import numpy as np

from studio.engine.performance import Posed
from studio.viewport.camera import FloatArray, OrbitCamera

SECONDS = 0.6
"""The way is smoothed over so long on either side."""


class Follower:
    """Moves a camera as far as the followed character went since the last picture."""

    def __init__(self) -> None:
        self._last: tuple[str, FloatArray] | None = None

    def moved(self, camera: OrbitCamera, performer_id: str, pose: Posed | None) -> OrbitCamera:
        """``camera`` gone on with a performer, brought before one that is followed anew; itself without a ``pose``."""
        if pose is None:
            self._last = None
            return camera
        place = way_place(pose)
        before, self._last = self._last, (performer_id, place)
        known = before is not None and before[0] == performer_id
        return gone_on(camera, place - (before[1] if before is not None and known else camera.target[:2]))


def gone_on(camera: OrbitCamera, way: FloatArray) -> OrbitCamera:
    """``camera`` moved along a way (2,) over the ground."""
    x, y, z = camera.target
    return replace(camera, target=(x + float(way[0]), y + float(way[1]), z))


def way_place(pose: Posed) -> FloatArray:
    """(2,) where the smoothed way of a performer's root is on the stage."""
    motion, reach = pose.over_time, round(SECONDS * pose.motion.frame_rate)
    here = pose.frame - motion.first_frame
    rows = np.clip(np.arange(here - reach, here + reach + 1), 0, motion.frame_count - 1)
    return np.asarray(pose.placement.to_stage(motion.positions[rows, 0]).mean(axis=0)[:2])
