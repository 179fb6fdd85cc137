"""Retiming: conversion between motion seconds and playback seconds, at a speed that may be keyed over
motion seconds.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.keyed import KeyedNumber

FloatArray = NDArray[np.float64]
Speed = float | KeyedNumber
"""Playback speed as a factor on the captured speed; if keyed, over motion seconds, and constant outside its keys."""

SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED = 0.1, 10.0
"""Least and greatest playback speed of a clip, also between keys, as factors on the captured speed."""
RETIMING_STEP_SECONDS, MOST_RETIMING_STEPS = 1.0 / 240.0, 2**14
"""Motion seconds between the nodes of the table of times, which is linear between them, and maximum number of such
steps between two keys. For keys farther apart (68 s) the steps are longer, so that a distant key costs no memory.
"""


def check_speed(speed: Speed) -> None:
    """Raise ValueError unless a speed, or the speed at every key, is in the range of clips."""
    for value in speed.values if isinstance(speed, KeyedNumber) else (speed,):
        if not SLOWEST_CLIP_SPEED <= value <= FASTEST_CLIP_SPEED:
            raise ValueError(
                f"A clip's speed lies between {SLOWEST_CLIP_SPEED:g} and {FASTEST_CLIP_SPEED:g}, got {value}."
            )


def speed_at(speed: Speed, seconds: ArrayLike) -> FloatArray:
    """Speed at ``seconds`` of the motion, of the same shape."""
    times = np.asarray(seconds, dtype=np.float64)
    if not isinstance(speed, KeyedNumber):
        return np.full(times.shape, speed)
    held = np.clip(times, speed.times[0], speed.times[-1])
    return np.asarray(
        np.clip(speed.at(held.ravel())[:, 0], SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED).reshape(times.shape)
    )


def playing_seconds(speed: Speed, seconds: ArrayLike) -> FloatArray:
    """Playback seconds from motion second 0 to motion ``seconds``, of the same shape."""
    times = np.asarray(seconds, dtype=np.float64)
    if not isinstance(speed, KeyedNumber):
        return times / speed
    nodes, played = _table(speed)
    before, after = speed_at(speed, nodes[[0, -1]])
    outside = np.minimum(times - nodes[0], 0.0) / before + np.maximum(times - nodes[-1], 0.0) / after
    return np.asarray(np.interp(times, nodes, played) + outside)


def motion_seconds(speed: Speed, seconds: ArrayLike) -> FloatArray:
    """Motion seconds after playback of ``seconds`` from motion second 0 on, of the same shape."""
    times = np.asarray(seconds, dtype=np.float64)
    if not isinstance(speed, KeyedNumber):
        return times * speed
    nodes, played = _table(speed)
    before, after = speed_at(speed, nodes[[0, -1]])
    outside = np.minimum(times - played[0], 0.0) * before + np.maximum(times - played[-1], 0.0) * after
    return np.asarray(np.interp(times, played, nodes) + outside)


def scaled_speed(speed: Speed, factor: float) -> Speed:
    """Speed multiplied by ``factor``, clamped to the range of clips."""
    if not isinstance(speed, KeyedNumber):
        return float(np.clip(speed * factor, SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED))
    values = np.clip(np.array(speed.values) * factor, SLOWEST_CLIP_SPEED, FASTEST_CLIP_SPEED)
    scaled = speed.with_rates(lambda rate: rate * factor)
    return KeyedNumber(speed.times, tuple(values.tolist()), tangents=scaled.tangents)


@lru_cache(maxsize=256)
def _table(speed: KeyedNumber) -> tuple[FloatArray, FloatArray]:
    """Motion seconds (N,) from the first key to the last, and the playback seconds (N,) up to each."""
    counts = (
        np.clip(np.round(np.diff(speed.times) / RETIMING_STEP_SECONDS), 1, MOST_RETIMING_STEPS).astype(int).tolist()
    )
    stretches = zip(speed.times[:-1], speed.times[1:], counts, strict=True)
    nodes = np.concatenate([*(np.linspace(*each, endpoint=False) for each in stretches), speed.times[-1:]])
    slowness = 1.0 / speed_at(speed, nodes)
    middle = 1.0 / speed_at(speed, (nodes[1:] + nodes[:-1]) / 2.0)
    steps = np.diff(nodes) * (slowness[:-1] + 4.0 * middle + slowness[1:]) / 6.0  # Simpson
    return nodes, np.concatenate([[0.0], np.cumsum(steps)]) + nodes[0] * slowness[0]
