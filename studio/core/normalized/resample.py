"""Resampling of a motion between its frames, at another speed, and slightly beyond its ends."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.kernels import channel_columns as channel
from studio.core.normalized.differences import (
    ANGLE_CHANNELS,
    BENDS,
    channel_difference,
    channel_quaternions,
    with_difference,
    write_quaternions,
)
from studio.core.normalized.motion import NormalizedMotion
from studio.core.rotations import normalized, sign_continuous

FloatArray = NDArray[np.float64]

SPLINE_MARGIN = 8
"""Number of frames on each side of the requested ones to which a spline is fitted, so that its ends have no effect."""


@dataclass(frozen=True, eq=False)
class ResampledMotion:
    """Motion that can be sampled at any frame, with spine joints at ``spine_places`` (K,)."""

    motion: NormalizedMotion
    spine_places: FloatArray

    def at(self, frames: FloatArray) -> FloatArray:
        """Channels (N, C) at ``frames`` (N,), which need not be whole; extrapolated at constant speed beyond the ends.

        Whole frames are returned to the bit; between them a cubic spline interpolates every channel, with continuous
        speed and acceleration.
        """
        last = self.motion.frame_count - 1
        within = np.clip(frames, 0, last)
        first = max(int(within.min()) - SPLINE_MARGIN, 0)
        source = self._with_spine(self.motion.channels[first : int(np.ceil(within.max())) + SPLINE_MARGIN + 1])
        rows = within - first
        sampled = source[np.rint(rows).astype(np.int64)]
        between = np.abs(rows - np.rint(rows)) > 1e-6
        if between.any():
            sampled[between] = _splined(source, rows[between])
        for end, near, beyond in ((0, 1, frames < 0), (last, last - 1, frames > last)):
            if beyond.any() and last > 0:
                ends = self._with_spine(self.motion.channels[[near, end]])
                steps = np.abs(frames - end)[beyond]
                sampled[beyond] = with_difference(
                    sampled[beyond], steps[:, None] * channel_difference(ends[0], ends[1])
                )
        return sampled

    def _with_spine(self, channels: FloatArray) -> FloatArray:
        own = self.motion.spine_places
        if len(own) == len(self.spine_places) and np.array_equal(own, self.spine_places):
            return np.array(channels)
        turns = channels[:, channel.SPINE :].reshape(len(channels), -1, 4)
        turns = np.concatenate([np.tile([0.0, 0.0, 0.0, 1.0], (len(channels), 1, 1)), turns], axis=1)
        places = np.clip(self.spine_places[1:], own[0], own[-1])
        before = np.clip(np.searchsorted(own, places, "right") - 1, 0, len(own) - 2)
        share = ((places - own[before]) / (own[before + 1] - own[before]))[:, None]
        low, high = turns[:, before], turns[:, before + 1]
        high = np.where(np.sum(low * high, axis=2, keepdims=True) < 0.0, -high, high)
        spine = normalized((1.0 - share) * low + share * high)
        return np.concatenate([channels[:, : channel.SPINE], spine.reshape(len(channels), -1)], axis=1)


def _splined(channels: FloatArray, rows: FloatArray) -> FloatArray:
    """Channels, (N, C), interpolated by a spline between the rows of (F, C)."""
    from scipy.interpolate import CubicSpline  # late: it takes longer than a window

    smooth = np.array(channels)
    smooth[:, ANGLE_CHANNELS] = np.unwrap(smooth[:, ANGLE_CHANNELS], axis=0)
    write_quaternions(smooth, sign_continuous(channel_quaternions(smooth)))
    sampled = np.asarray(CubicSpline(np.arange(len(smooth)), smooth, axis=0)(rows))
    write_quaternions(sampled, normalized(channel_quaternions(sampled)))
    sampled[:, BENDS] = channels[np.rint(rows).astype(np.int64), BENDS]
    return sampled


def common_spine(motions: Sequence[NormalizedMotion]) -> FloatArray:
    """Positions (K,) along the trunk of the spine joints of all motions."""
    places = np.unique(np.concatenate([motion.spine_places for motion in motions]))
    return np.asarray(places[np.concatenate([[True], np.diff(places) > 1e-6])])
