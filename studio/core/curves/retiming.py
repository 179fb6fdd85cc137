"""Retiming: conversion between seconds of a motion and of its playback, whose speed may be keyed over the motion's own
seconds.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.keyed import KeyedNumber

FloatArray = NDArray[np.float64]
Speed = float | KeyedNumber
"""Times as fast as it was captured; keyed over the seconds of the motion, it holds before and after its keys."""

SLOWEST_CLIP, FASTEST_CLIP = 0.1, 10.0
"""Times as fast as it was captured that a clip plays at least and at most, also between keys."""
RETIMING_STEP, MOST_RETIMING_STEPS = 1.0 / 240.0, 2**14
"""Seconds of the motion between the nodes of a table, between which time is linear. Between keys that are farther apart
than so many steps (68 s) the steps are longer: a key far away costs no memory.
"""


def check_speed(speed: Speed) -> None:
    """Raise ValueError unless a speed, or that of every key, is in the range of clips."""
    for value in speed.values if isinstance(speed, KeyedNumber) else (speed,):
        if not SLOWEST_CLIP <= value <= FASTEST_CLIP:
            raise ValueError(f"A clip's speed lies between {SLOWEST_CLIP:g} and {FASTEST_CLIP:g}, got {value}.")


def speed_at(speed: Speed, seconds: ArrayLike) -> FloatArray:
    """Speed at ``seconds`` of the motion, of the same shape."""
    times = np.asarray(seconds, dtype=np.float64)
    if not isinstance(speed, KeyedNumber):
        return np.full(times.shape, speed)
    held = np.clip(times, speed.times[0], speed.times[-1])
    return np.asarray(np.clip(speed.at(held.ravel())[:, 0], SLOWEST_CLIP, FASTEST_CLIP).reshape(times.shape))


def playing_seconds(speed: Speed, seconds: ArrayLike) -> FloatArray:
    """Playback seconds from second 0 of the motion to its ``seconds``, of the same shape."""
    times = np.asarray(seconds, dtype=np.float64)
    if not isinstance(speed, KeyedNumber):
        return times / speed
    nodes, played = _table(speed)
    before, after = speed_at(speed, nodes[[0, -1]])
    outside = np.minimum(times - nodes[0], 0.0) / before + np.maximum(times - nodes[-1], 0.0) / after
    return np.asarray(np.interp(times, nodes, played) + outside)


def motion_seconds(speed: Speed, seconds: ArrayLike) -> FloatArray:
    """Second of the motion after a playback of ``seconds`` from its second 0 on, of the same shape."""
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
        return float(np.clip(speed * factor, SLOWEST_CLIP, FASTEST_CLIP))
    values = np.clip(np.array(speed.values) * factor, SLOWEST_CLIP, FASTEST_CLIP)
    scaled = speed.with_rates(lambda rate: rate * factor)
    return KeyedNumber(speed.times, tuple(values.tolist()), tangents=scaled.tangents)


@lru_cache(maxsize=256)
def _table(speed: KeyedNumber) -> tuple[FloatArray, FloatArray]:
    """Seconds of the motion (N,) from the first key to the last one, and the playback seconds (N,) until then."""
    counts = np.clip(np.round(np.diff(speed.times) / RETIMING_STEP), 1, MOST_RETIMING_STEPS).astype(int).tolist()
    stretches = zip(speed.times[:-1], speed.times[1:], counts, strict=True)
    nodes = np.concatenate([*(np.linspace(*each, endpoint=False) for each in stretches), speed.times[-1:]])
    slowness = 1.0 / speed_at(speed, nodes)
    middle = 1.0 / speed_at(speed, (nodes[1:] + nodes[:-1]) / 2.0)
    steps = np.diff(nodes) * (slowness[:-1] + 4.0 * middle + slowness[1:]) / 6.0  # Simpson
    return nodes, np.concatenate([[0.0], np.cumsum(steps)]) + nodes[0] * slowness[0]
