"""Live capture on another body: a received pose replaces the motion, and is solved with the current constraints."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import Morphology
from studio.core.constraints.carried_over import ClipTransform, constraint_on_clip
from studio.core.normalized.encode import encode_motion
from studio.core.normalized.motion import NormalizedMotion
from studio.core.solver.adapt import solve_constraints
from studio.core.solver.request import AdaptedMotion, AdaptRequest
from studio.core.solver.task_assembly.tracks import OwnPath
from studio.live import vmc
from studio.live.live_grounding import LiveGrounding
from studio.live.tracker import Inbox

FloatArray = NDArray[np.float64]

POSE_FRAME_RATE = 60.0
"""Nominal frame rate in Hz of a single pose; no result depends on it."""
STILL_FRAMES = 2
"""Frames of a still motion; kernels need motions of more than one frame."""
UNBOUNDED_SECONDS = 1e6


class ReceivedPose:
    """Newest body in an inbox, as a still motion; None while bones are missing."""

    def __init__(self, inbox: Inbox) -> None:
        self._inbox, self._taken = inbox, -1
        self._pose: NormalizedMotion | None = None

    def __call__(self) -> NormalizedMotion | None:
        """Still motion of the newest pose; recomputed only if packets have arrived since the last call."""
        taken = self._inbox.counts.accepted
        if taken != self._taken:
            self._taken, found = taken, vmc.posed_body(self._inbox.bones())
            self._pose = None if found is None else _pose_of(*found)
        return self._pose


def _pose_of(positions: FloatArray, rotations: FloatArray, body: Morphology) -> NormalizedMotion | None:
    pose = encode_motion(
        np.stack([positions] * STILL_FRAMES), np.stack([rotations] * STILL_FRAMES), body, POSE_FRAME_RATE, "live"
    )
    return pose if np.isfinite(pose.channels).all() else None


def driven_frame(
    request: AdaptRequest, row: int, pose: NormalizedMotion, planted: LiveGrounding, seconds: float
) -> AdaptedMotion:
    """Frame ``row`` of a request with ``pose`` in place of its motion, grounded and solved with the constraints of that
    frame.

    ``planted`` keeps the state of the feet between poses; ``seconds`` is the clock time of the pose.
    """
    now = ClipTransform(
        -row / request.motion.frame_rate, 1.0, 0.0, (0.0, 0.0), False, -UNBOUNDED_SECONDS, UNBOUNDED_SECONDS
    )
    window = slice(row, row + 1)
    tracks = {
        key: track if isinstance(track, OwnPath) else track.in_frames(window) for key, track in request.tracks.items()
    }
    body = request.morphology
    body = body if isinstance(body, Morphology) else body.at(row)
    alone = replace(request, motion=pose, morphology=body, contacts=(), tracks={}, actor=None)
    asked = [constraint_on_clip(each, now) for each in request.constraints]
    return replace(solve_constraints(planted.stand(alone, seconds), asked, 0, 0, tracks), first_frame=row)
