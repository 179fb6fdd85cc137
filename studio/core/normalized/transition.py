"""Transition between motions: their difference at the change decays, so that neither position nor speed jumps.

Inertialisation (Bollo 2018): the new motion plays at once, and the decaying difference to the old one, with its speed,
is added to it. It needs only the moment of the change, which may therefore be decided at any frame.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from studio.core.kernels import channel_columns as channel
from studio.core.normalized.differences import OFF_PLANES, SLACKS, channel_difference, turn_columns

FloatArray = NDArray[np.float64]

LEAST_TRANSITION_SECONDS, MOST_TRANSITION_SECONDS = 0.2, 1.0
"""Shortest and longest transition in seconds, if none is given."""
ADDED_ACCELERATION_FRACTION = 0.25
"""Acceleration that the decaying offset and the decaying speed may each add to a joint, as a fraction of its greatest
acceleration in either motion.
"""
QUIET_PEAK = 20.0
"""Least acceleration peak of a joint, in radians per second squared; lower peaks are raised to it, or ratios to a still
motion would be unbounded.
"""
_PLACE_PEAK, _SPEED_PEAK = 5.78, 3.96
"""Greatest second derivatives of the two decay polynomials below, over one second."""


@dataclass(frozen=True, eq=False)
class Inertialisation:
    """Difference between two motions at the moment of their transition, which decays to zero (inertialisation).

    ``offset`` (C,) is a ``channel_difference`` that changes by ``speed`` (C,) per second; the offset decays within
    ``seconds``. ``peaks`` are those of ``joint_peaks``: the greater of both motions.
    """

    offset: FloatArray
    speed: FloatArray
    peaks: FloatArray
    seconds: float

    @classmethod
    def of(cls, offset: FloatArray, speed: FloatArray, peaks: FloatArray) -> "Inertialisation":
        """Shortest inertialisation that adds no more acceleration to any joint than ``ADDED_ACCELERATION_FRACTION``
        allows.
        """
        return cls(offset, speed, peaks, offset_decay_seconds(np.linalg.norm(joint_vectors(offset), axis=-1), peaks))

    @cached_property
    def decay_times(self) -> FloatArray:
        """Decay times (C,) in seconds of the speeds of the columns; shorter for fast joints, which would overshoot."""
        halts = np.full(len(self.offset), self.seconds)
        halting = speed_decay_times(np.linalg.norm(joint_vectors(self.speed), axis=-1), self.peaks, self.seconds)
        turns = turn_columns(len(self.offset))
        halts[turns[:, None] + np.arange(3)] = halting[: len(turns), None]
        halts[OFF_PLANES] = halts[SLACKS] = halting[len(turns) :]
        return halts

    def remaining_offset(self, times: FloatArray) -> FloatArray:
        """Offsets (N, C) that remain ``times`` (N,) seconds after the transition."""
        place = remaining_offset_fraction(times[:, None], self.seconds) * self.offset
        return np.asarray(place + remaining_speed_offset(times[:, None], self.decay_times) * self.speed)


def offset_decay_seconds(offsets: FloatArray, peaks: FloatArray) -> float:
    """Seconds in which ``offsets`` (N,) decay with the acceleration that the joints' ``peaks`` (N,) allow."""
    needed = np.sqrt(_PLACE_PEAK * offsets / (ADDED_ACCELERATION_FRACTION * np.maximum(peaks, QUIET_PEAK))).max()
    return float(np.clip(needed, LEAST_TRANSITION_SECONDS, MOST_TRANSITION_SECONDS))


def speed_decay_times(speeds: FloatArray, peaks: FloatArray, seconds: float) -> FloatArray:
    """Seconds (N,) in which ``speeds`` (N,) decay with the acceleration that the joints' ``peaks`` (N,) allow.

    They are at most ``seconds``.
    """
    return np.clip(
        _SPEED_PEAK * speeds / (ADDED_ACCELERATION_FRACTION * np.maximum(peaks, QUIET_PEAK)), min(0.1, seconds), seconds
    )


def remaining_offset_fraction(times: FloatArray, seconds: float) -> FloatArray:
    """Fraction of an offset left after ``times``: 1 - 10 s^3 + 15 s^4 - 6 s^5, s = t / T; continuous in
    acceleration.
    """
    s = np.clip(times / seconds, 0.0, 1.0)
    return np.asarray(1.0 - s**3 * (10.0 - s * (15.0 - 6.0 * s)))


def remaining_speed_offset(times: FloatArray, seconds: float | FloatArray) -> FloatArray:
    """Offset from a decaying speed of 1 after ``times``: T (s - 6 s^3 + 8 s^4 - 3 s^5), s = t / T."""
    s = np.clip(times / seconds, 0.0, 1.0)
    return np.asarray((s - s**3 * (6.0 - s * (8.0 - 3.0 * s))) * seconds)


def fade_seconds(differences: FloatArray, peaks: FloatArray) -> float:
    """Seconds of a cross-fade that adds no more acceleration to any joint than allowed, for ``differences`` (N, C) in
    it.
    """
    offsets = np.linalg.norm(joint_vectors(differences), axis=-1).max(axis=0)
    return offset_decay_seconds(offsets, peaks)


def joint_peaks(channels: FloatArray, frame_rate: float) -> FloatArray:
    """Greatest accelerations (T + 4,) of each rotation and each fold in ``channels`` (F, C), in radians per second
    squared.
    """
    if len(channels) < 3:
        return np.zeros(len(turn_columns(channels.shape[1])) + 4)
    speeds = joint_vectors(channel_difference(channels[:-1], channels[1:]))
    return np.asarray(np.linalg.norm(np.diff(speeds, axis=0), axis=-1).max(axis=0) * frame_rate**2)


def joint_vectors(between: FloatArray) -> FloatArray:
    """Rotation vectors (..., T + 4, 3) of a ``channel_difference`` (..., C), with the bends of elbows and
    knees last.
    """
    turns = between[..., turn_columns(between.shape[-1])[:, None] + np.arange(3)]
    folds = 2.0 * np.stack([between[..., OFF_PLANES], between[..., SLACKS], 0.0 * between[..., SLACKS]], axis=-1)
    return np.concatenate([turns, folds], axis=-2)


def placed_channels(channels: FloatArray, turn: float, offset: FloatArray) -> FloatArray:
    """Channels (F, C) rotated by ``turn`` radians about Z, then moved by ``offset`` (2,) leg lengths."""
    c, s = np.cos(turn), np.sin(turn)
    moved = np.array(channels)
    x, y = channels[:, channel.HIPS], channels[:, channel.HIPS + 1]
    moved[:, channel.HIPS] = c * x - s * y + offset[0]
    moved[:, channel.HIPS + 1] = s * x + c * y + offset[1]
    moved[:, channel.YAW] += turn
    return moved
