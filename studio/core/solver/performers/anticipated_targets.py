"""Anticipated targets: a performer that is to meet another one moves to that one's position at full activation."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core.constraints.base import Constraint
from studio.core.constraints.follow import FollowPerformer
from studio.core.constraints.target import follows_of
from studio.core.curves.activation import ActivationCurve
from studio.core.solver.task_assembly.tracks import Track, Tracks

FloatArray = NDArray[np.float64]


def anticipated_time(curve: ActivationCurve, time: float) -> float | None:
    """Time in seconds of the anticipated meeting: before full activation its beginning, afterwards its end; None during
    it.
    """
    if curve.start <= time < curve.full:
        return curve.full
    return curve.full_end if curve.full_end < time <= curve.end else None


def with_expected_positions(tracks: Tracks, places: Mapping[FollowPerformer, FloatArray]) -> Tracks:
    """``tracks`` of one frame, with anticipated performers at the positions ``places`` (3,)."""
    found = dict(tracks)
    for follow, place in places.items():
        track = tracks.get(follow)
        if isinstance(track, Track):
            found[follow] = Track(place[None], track.rotations)
    return found


def with_anticipated_targets(tracks: Tracks, constraints: Sequence[Constraint], frame_rate: float) -> Tracks:
    """``tracks`` over a whole motion, with anticipated targets at their positions during full activation of
    ``constraints``.
    """
    found = dict(tracks)
    for constraint in constraints:
        for follow in follows_of(constraint):
            track = tracks.get(follow) if isinstance(follow, FollowPerformer) and follow.awaits else None
            if isinstance(track, Track) and len(track.positions) > 1:
                found[follow] = _awaited(track, constraint.activation, frame_rate)
    return found


def _awaited(track: Track, curve: ActivationCurve, frame_rate: float) -> Track:
    """``track`` frozen at full activation of ``curve`` while the activation rises or falls."""
    rows = np.arange(len(track.positions))
    first, full, full_end, last = np.rint(
        np.array([curve.start, curve.full, curve.full_end, curve.end]) * frame_rate
    ).clip(0, len(rows) - 1)
    coming, leaving = (rows >= first) & (rows < full), (rows > full_end) & (rows <= last)
    rows[coming], rows[leaving] = full, full_end
    return Track(track.positions[rows], track.rotations[rows])
