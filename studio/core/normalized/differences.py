"""Differences between frames of channels, from which blends and transitions are made.

Angles and lengths differ by numbers, rotations by the rotation vector from one to the other. The amount and direction
of a limb's fold form one vector: with separate slacks and signs, blended elbows and knees would snap where limbs are
nearly straight.
"""

import numpy as np
from numpy.typing import NDArray

from studio.core.kernels import channel_columns as channel
from studio.core.rotations import inverse, multiply, normalized, sign_continuous

FloatArray = NDArray[np.float64]

ANGLE_CHANNELS = (channel.YAW, *range(channel.LIMB_TWIST, channel.HAND))
"""Columns of channels that are angles, in which full turns make no difference."""
SLACKS = slice(channel.LIMB_SLACK, channel.LIMB_OFF_PLANE)
OFF_PLANES = slice(channel.LIMB_OFF_PLANE, channel.LIMB_BEND)
BENDS = slice(channel.LIMB_BEND, channel.LIMB_TWIST)


def turn_columns(width: int) -> NDArray[np.int64]:
    """First columns (T,) of the quaternions in channels with ``width`` columns."""
    return np.array([*channel.QUATERNION_COLUMNS, *range(channel.SPINE, width, 4)])


def channel_quaternions(channels: FloatArray) -> FloatArray:
    """Quaternions (..., T, 4) in ``channels`` (..., C)."""
    return np.asarray(channels[..., turn_columns(channels.shape[-1])[:, None] + np.arange(4)])


def write_quaternions(channels: FloatArray, turns: FloatArray) -> None:
    """Write the quaternions ``turns`` (..., T, 4) into their columns of ``channels`` (..., C)."""
    channels[..., turn_columns(channels.shape[-1])[:, None] + np.arange(4)] = turns


def channel_difference(start: FloatArray, end: FloatArray) -> FloatArray:
    """Difference (..., C) between channels, such that ``with_difference(start, channel_difference(start, end))`` is
    ``end``.

    Rotation vectors are in the first three columns of their quaternions, folds in those of slacks and off-planes,
    lengths beyond a limb's own in those of bends. The shorter arc is taken in the first of frames (F, C) only; the
    others continue it, or a blend would whirl where both arcs are equally long.
    """
    between = end - start
    for columns, a, b in zip(_FOLDS, _folds(start), _folds(end), strict=True):
        between[..., columns] = b - a
    angles = np.array(ANGLE_CHANNELS)
    between[..., angles] = _continuous((between[..., angles] + np.pi) % (2 * np.pi) - np.pi)
    turn = multiply(channel_quaternions(end), inverse(channel_quaternions(start)))
    nearest = turn[:1] if turn.ndim == 3 else turn
    nearest *= np.where(nearest[..., 3:] < 0.0, -1.0, 1.0)
    vectors = rotation_vectors(sign_continuous(turn) if turn.ndim == 3 else turn)
    write_quaternions(between, np.concatenate([vectors, np.zeros_like(vectors[..., :1])], axis=-1))
    return np.asarray(between)


def with_difference(channels: FloatArray, by: FloatArray) -> FloatArray:
    """Channels (..., C) with the ``channel_difference`` ``by`` added."""
    from scipy.spatial.transform import Rotation  # late: it takes longer than a window

    summed = channels + by
    aside, along, beyond = (a + by[..., columns] for columns, a in zip(_FOLDS, _folds(channels), strict=True))
    fold = np.minimum(np.hypot(aside, along), np.pi)
    summed[..., SLACKS] = 2.0 * np.sin(fold / 2.0) ** 2 + beyond
    summed[..., OFF_PLANES] = 0.5 * np.sin(fold) * aside / np.maximum(fold, 1e-12)
    summed[..., BENDS] = np.where(along < 0.0, -1.0, np.where(along > 0.0, 1.0, channels[..., BENDS]))
    vectors = channel_quaternions(by)[..., :3]
    turn = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_quat().reshape(*vectors.shape[:-1], 4)
    write_quaternions(summed, normalized(multiply(turn, channel_quaternions(channels))))
    return np.asarray(summed)


def blended_channels(first: FloatArray, second: FloatArray, shares: FloatArray) -> FloatArray:
    """Interpolation (F, C) from channels ``first`` to ``second`` by the fractions ``shares`` (F,)."""
    return with_difference(first, shares[:, None] * channel_difference(first, second))


def _continuous(angles: FloatArray) -> FloatArray:
    return np.unwrap(angles, axis=0) if angles.ndim == 2 else angles


def rotation_vectors(turns: FloatArray) -> FloatArray:
    """Rotation vectors (..., 3) of quaternions (..., 4); longer than pi where w is negative."""
    sine = np.linalg.norm(turns[..., :3], axis=-1, keepdims=True)
    scale = np.where(sine > 1e-12, 2.0 * np.arctan2(sine, turns[..., 3:]) / np.maximum(sine, 1e-12), 2.0)
    return np.asarray(scale * turns[..., :3])


_FOLDS = (OFF_PLANES, SLACKS, BENDS)


def _folds(channels: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Fold of each limb (..., 4): radians out of its plane, radians within it, and negative slack.

    The norm of the two angles is the angle whose 1 - cos is the limb's slack; in a limb with two equal bones it is half
    the bend. Slack is negative where a limb is stretched beyond its length, as in some captures.
    """
    slack = channels[..., SLACKS]
    fold = 2.0 * np.arcsin(np.sqrt(np.clip(slack, 0.0, 2.0) / 2.0))
    share = np.clip(2.0 * channels[..., OFF_PLANES] / np.maximum(np.sin(fold), 1e-12), -1.0, 1.0)
    return fold * share, channels[..., BENDS] * fold * np.sqrt(1.0 - share * share), np.minimum(slack, 0.0)
