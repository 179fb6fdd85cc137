"""A body that comes in live, on another body: a pose in the place of a capture, with what is asked at that moment."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.constraints.carried_over import Carry, carried_over
from studio.core.normalized.encode import encode
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import hold
from studio.core.solver.asking.tracks import OwnPath
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.live import vmc
from studio.live.planting import Planted
from studio.live.tracker import Inbox

FloatArray = NDArray[np.float64]

POSE_FRAME_RATE = 60.0
"""Frames a second that a pose alone is said to have; nothing depends on it."""
STILL_FRAMES = 2
"""Frames of what stands still: kernels are compiled for motions of more than one."""
UNBOUNDED_SECONDS = 1e6


class ReceivedPose:
    """The newest body of an inbox as a still motion, whenever it is called; None while bones are missing."""

    def __init__(self, inbox: Inbox) -> None:
        self._inbox, self._taken = inbox, -1
        self._pose: NormalizedMotion | None = None

    def __call__(self) -> NormalizedMotion | None:
        """Made anew only when something has come."""
        taken = self._inbox.counts.taken
        if taken != self._taken:
            self._taken, found = taken, vmc.posed(self._inbox.bones())
            self._pose = None if found is None else _pose_of(*found)
        return self._pose


def _pose_of(positions: FloatArray, rotations: FloatArray, body: Morphology) -> NormalizedMotion | None:
    pose = encode(
        np.stack([positions] * STILL_FRAMES), np.stack([rotations] * STILL_FRAMES), body, POSE_FRAME_RATE, "live"
    )
    return pose if np.isfinite(pose.channels).all() else None


def driven(request: AdaptRequest, row: int, pose: NormalizedMotion, planted: Planted, seconds: float) -> AdaptedMotion:
    """Frame ``row`` of a request with ``pose`` in the place of its motion: stood, and solved for what is asked.

    ``planted`` knows how the feet stood before, ``seconds`` by the clock.
    """
    now = Carry(-row / request.motion.frame_rate, 1.0, 0.0, (0.0, 0.0), False, -UNBOUNDED_SECONDS, UNBOUNDED_SECONDS)
    window = slice(row, row + 1)
    tracks = {
        key: track if isinstance(track, OwnPath) else track.within(window) for key, track in request.tracks.items()
    }
    body = request.morphology
    body = body if isinstance(body, Morphology) else body.at(row)
    alone = replace(request, motion=pose, morphology=body, contacts=(), tracks={}, actor=None)
    asked = [carried_over(each, now) for each in request.constraints]
    return replace(hold(planted.stand(alone, seconds), asked, 0, 0, tracks), first_frame=row)
