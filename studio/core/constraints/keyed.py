"""Values keyed over time: places, rotations and numbers, smooth between their keys and still beyond them.

Every key is passed in a straight line, at the slower of the two rates around it and the slower the more the way turns
there; between two keys the two lines are blended by the quintic ease, so that places and rotations have two continuous
derivatives everywhere. It is local (a key changes four stretches at most), turning the world turns the path, two equal
keys hold still, and two keys alone are the quintic ease itself.
"""

import math
from bisect import bisect_left, insort
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.constraints.activation import EaseShape, ease
from studio.core.plausible import PLACE, TIME

FloatArray = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

SAME_TIME = 1e-4
"""Seconds; nearer than this two keys are one."""


class Keys:
    """Common part of keyed values: ``times`` in seconds, in increasing order."""

    kind: ClassVar[str] = "keyed"
    size: ClassVar[int]
    times: tuple[float, ...]
    values: tuple[Any, ...]

    def __post_init__(self) -> None:
        times = tuple(float(time) for time in self.times)
        object.__setattr__(self, "times", times)
        if not times or len(times) != len(self.values):
            raise ValueError(
                f"Keys need as many times as values, and at least one: {len(times)} and {len(self.values)}."
            )
        if not all(math.isfinite(time) for time in times):
            raise ValueError("The times of keys are finite numbers of seconds.")
        TIME.check(times)
        for before, after in pairwise(times):
            if after - before < SAME_TIME:
                raise ValueError(f"Keys must be in the order of their times: {after:.3f} s comes after {before:.3f} s.")
        object.__setattr__(self, "values", tuple(self._checked(value) for value in self.values))

    def _checked(self, value: Any) -> Any:
        numbers = np.array(value, dtype=np.float64).reshape(-1)
        if numbers.shape != (self.size,) or not np.isfinite(numbers).all():
            raise ValueError(f"The value of a key is {self.size} finite numbers, got {value}.")
        PLACE.check(numbers, "The value of a key")
        return tuple(numbers.tolist()) if self.size > 1 else float(numbers[0])

    def key_at(self, time: float) -> int | None:
        """Index of the key at ``time``; None where there is none."""
        place = bisect_left(self.times, time - SAME_TIME)
        return place if place < len(self.times) and self.times[place] <= time + SAME_TIME else None

    def with_key(self, time: float, value: Any) -> Self:
        """The same with a key of ``value`` at ``time``, replacing one at that time."""
        kept = [pair for pair in zip(self.times, self.values, strict=True) if abs(pair[0] - time) > SAME_TIME]
        insort(kept, (float(time), value), key=lambda pair: pair[0])
        return self._with(kept)

    def without_key(self, place: int) -> Self:
        """The same without one key. Raises ValueError for the last one."""
        kept = [pair for k, pair in enumerate(zip(self.times, self.values, strict=True)) if k != place]
        return self._with(kept)

    def with_time(self, place: int, time: float) -> Self:
        """The same with one key at another ``time``, or as near to it as its neighbours allow."""
        times = [-math.inf, *self.times, math.inf]
        between = max(min(time, times[place + 2] - 2.0 * SAME_TIME), times[place] + 2.0 * SAME_TIME)
        return replace(self, times=(*self.times[:place], between, *self.times[place + 1 :]))  # type: ignore[type-var]

    def moved(self, seconds: float) -> Self:
        """The same ``seconds`` later."""
        return replace(self, times=tuple(time + seconds for time in self.times))  # type: ignore[type-var]

    def _with(self, pairs: list[tuple[float, Any]]) -> Self:
        times, values = zip(*pairs, strict=True) if pairs else ((), ())
        return replace(self, times=times, values=values)  # type: ignore[type-var]

    def _spans(self, times: ArrayLike) -> tuple[NDArray[np.int64], FloatArray, FloatArray, FloatArray]:
        """Key before each of ``times`` (N,), seconds since it and to the next one."""
        keys, t = np.array(self.times), np.clip(np.asarray(times, dtype=np.float64), self.times[0], self.times[-1])
        before = np.clip(np.searchsorted(keys, t, "right") - 1, 0, max(len(keys) - 2, 0))
        after = np.minimum(before + 1, len(keys) - 1)
        length = np.maximum(keys[after] - keys[before], SAME_TIME)
        return before, t - keys[before], t - keys[after], ease((t - keys[before]) / length, EaseShape.QUINTIC)


class Line(Keys):
    """Keyed points of a space of ``size`` numbers."""

    def at(self, times: ArrayLike) -> FloatArray:
        """Values (N, size) at ``times`` (N,) seconds."""
        values = self.points
        rates = passing_rates(np.array(self.times), np.diff(values, axis=0))
        before, since, until, share = self._spans(times)
        after = np.minimum(before + 1, len(values) - 1)
        begin = values[before] + since[:, None] * rates[before]
        end = values[after] + until[:, None] * rates[after]
        return np.asarray(begin + share[:, None] * (end - begin))

    def path(self, time: float) -> FloatArray:
        """Path (N, size) from the first key to the last."""
        return self.at(np.linspace(self.times[0], self.times[-1], 24 * len(self.times) + 1))

    @property
    def points(self) -> FloatArray:
        """Values (K, size) of the keys."""
        return np.array(self.values, dtype=np.float64).reshape(-1, self.size)


@dataclass(frozen=True)
class KeyedPlace(Line):
    """Keyed positions (x, y, z) in metres, motion space."""

    size: ClassVar[int] = 3
    times: tuple[float, ...]
    values: tuple[Vector, ...]


@dataclass(frozen=True)
class KeyedNumber(Line):
    """Keyed numbers, such as a heading in radians or a distance in metres."""

    size: ClassVar[int] = 1
    times: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class KeyedTurn(Keys):
    """Rotations (x, y, z, w) in the motion's space, turned the short way from each to the next."""

    size: ClassVar[int] = 4
    times: tuple[float, ...]
    values: tuple[Quaternion, ...]

    def _checked(self, value: Any) -> Quaternion:
        return unit_quaternion(super()._checked(value))

    def at(self, times: ArrayLike) -> FloatArray:
        """Rotations (N, 3, 3) at ``times`` (N,) seconds."""
        from scipy.spatial.transform import Rotation

        keys = Rotation.from_quat(np.array(self.values))
        steps = (keys[:-1].inv() * keys[1:]).as_rotvec() if len(self.times) > 1 else np.empty((0, 3))
        rates = passing_rates(np.array(self.times), steps)
        before, since, until, share = self._spans(times)
        after = np.minimum(before + 1, len(self.times) - 1)
        begin = keys[before] * Rotation.from_rotvec(since[:, None] * rates[before])
        end = keys[after] * Rotation.from_rotvec(until[:, None] * rates[after])
        between = Rotation.from_rotvec(share[:, None] * (begin.inv() * end).as_rotvec())
        return np.asarray((begin * between).as_matrix())


def unit_quaternion(value: ArrayLike) -> Quaternion:
    """Unit quaternion of four numbers. Raises ValueError if they make no rotation."""
    numbers = np.array(value, dtype=np.float64)
    length = np.linalg.norm(numbers) if numbers.shape == (4,) and np.isfinite(numbers).all() else 0.0
    if length < 1e-9:
        raise ValueError("a rotation is four finite numbers (x, y, z, w), not all zero.")
    x, y, z, w = (numbers / length).tolist()
    return x, y, z, w


def passing_rates(times: FloatArray, steps: FloatArray) -> FloatArray:
    """Rates (N, D) a second of N keys; ``steps`` (N - 1, D) lead from each key to the next.

    min(|a|, |b|) max(0, cos(a, b)) along a + b, for the rates a before and b after a key; zero at both ends, where the
    motion begins and comes to rest.
    """
    rates = np.zeros((len(times), steps.shape[1]))
    if len(times) > 2:
        slopes = steps / np.diff(times)[:, None]
        speeds = np.linalg.norm(slopes, axis=1)
        a, b, both = slopes[:-1], slopes[1:], slopes[:-1] + slopes[1:]
        cosine = np.sum(a * b, axis=1) / np.maximum(speeds[:-1] * speeds[1:], 1e-30)
        speed = np.minimum(speeds[:-1], speeds[1:]) * np.clip(cosine, 0.0, 1.0)
        rates[1:-1] = (speed / np.maximum(np.linalg.norm(both, axis=1), 1e-30))[:, None] * both
    return rates
