"""Values keyed over time: positions, rotations and numbers, smooth between their keys and constant outside.

At every key the curve follows a straight line, the key's tangent; between two keys their lines are blended by the
quintic ease, so that the curve has two continuous derivatives wherever tangents are not broken. At a key without
``Tangents`` of its own the curve takes the slower of the two rates around it, and is slower the more the path bends
there. The curve is local (a key changes at most four intervals) and independent of the axes. Two equal keys hold the
value. Two keys alone give the quintic ease.
"""

import math
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.activation import EaseShape, ease, weighted_progress
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT, Beyond, Tangents, rates_of
from studio.core.plausible import PLACE_RANGE, TIME_RANGE
from studio.core.rotations import from_matrix, unit_vectors

FloatArray = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

SAME_KEY_SECONDS = 1e-4
"""Distance in seconds below which two keys are one."""


def read_only(values: FloatArray) -> FloatArray:
    """The array ``values`` itself, made read-only."""
    values.setflags(write=False)
    return values


@dataclass(frozen=True)
class Key:
    """Key of a curve: time in seconds, value, and tangents; None for automatic tangents."""

    time: float
    value: Any
    tangents: Tangents | None = None


@dataclass(frozen=True)
class Keys:
    """Base class of keyed values: ``times`` in seconds, ascending, and as many ``values``.

    ``tangents`` are empty, or as many as there are keys. ``before`` and ``after`` are the extrapolation before the
    first and after the last key.
    """

    kind: ClassVar[str] = "keyed"
    size: ClassVar[int]
    times: tuple[float, ...]
    values: tuple[Any, ...]
    tangents: tuple[Tangents | None, ...] = field(default=(), kw_only=True, metadata=LEFT_OUT_IF_DEFAULT)
    before: Beyond = field(default=Beyond.HOLD, kw_only=True, metadata=LEFT_OUT_IF_DEFAULT)
    after: Beyond = field(default=Beyond.HOLD, kw_only=True, metadata=LEFT_OUT_IF_DEFAULT)

    def __post_init__(self) -> None:
        times = tuple(float(time) for time in self.times)
        object.__setattr__(self, "times", times)
        if not times or len(times) != len(self.values):
            raise ValueError(
                f"Keys need as many times as values, and at least one: {len(times)} and {len(self.values)}."
            )
        if not all(math.isfinite(time) for time in times):
            raise ValueError("The times of keys are finite numbers of seconds.")
        TIME_RANGE.check(times)
        for before, after in pairwise(times):
            if after - before < SAME_KEY_SECONDS:
                raise ValueError(f"Keys must be in the order of their times: {after:.3f} s comes after {before:.3f} s.")
        object.__setattr__(self, "values", self._checked_values())
        self._check_tangents()
        object.__setattr__(self, "before", Beyond(self.before))
        object.__setattr__(self, "after", Beyond(self.after))

    def _check_tangents(self) -> None:
        if self.tangents and len(self.tangents) != len(self.times):
            raise ValueError(f"{len(self.times)} keys need as many tangents, or none: {len(self.tangents)}.")
        for tangents in self.tangents:
            for rate in tangents.rates if tangents is not None else ():
                if len(rate) != self.dimension():
                    raise ValueError(f"The rate of a tangent is {self.dimension()} numbers a second, got {len(rate)}.")
        own = tuple(each or None for each in self.tangents)
        object.__setattr__(self, "tangents", own if any(own) else ())

    def _checked_values(self) -> tuple[Any, ...]:
        return tuple(self._checked(value) for value in self.values)

    def _checked(self, value: Any) -> Any:
        numbers = np.array(value, dtype=np.float64).reshape(-1)
        if numbers.shape != (self.size,) or not np.isfinite(numbers).all():
            raise ValueError(f"The value of a key is {self.size} finite numbers, got {value}.")
        PLACE_RANGE.check(numbers, "The value of a key")
        return tuple(numbers.tolist()) if self.size > 1 else float(numbers[0])

    @cached_property
    def seconds(self) -> FloatArray:
        """Times (K,) of the keys in seconds."""
        return read_only(np.array(self.times))

    @property
    def keys(self) -> tuple[Key, ...]:
        """Keys in order of their times."""
        tangents = self.tangents or (None,) * len(self.times)
        return tuple(map(Key, self.times, self.values, tangents))

    def key_at(self, time: float) -> int | None:
        """Index of the key at ``time``; None where there is none."""
        index = bisect_left(self.times, time - SAME_KEY_SECONDS)
        return index if index < len(self.times) and self.times[index] <= time + SAME_KEY_SECONDS else None

    def value_at(self, time: float) -> Any:
        """Value at ``time``, in the type of the values of keys."""
        return self._checked(self.at([time])[0])

    def at(self, times: ArrayLike) -> FloatArray:
        """Values (N, ...) at ``times`` (N,) seconds."""
        raise NotImplementedError

    def with_key(self, time: float, value: Any) -> Self:
        """Copy with a key of ``value`` at ``time``, replacing one at that time."""
        place = self.key_at(time)
        tangents = self.tangents[place] if self.tangents and place is not None else None
        return self.with_keys((Key(float(time), value, tangents),))

    def with_keys(self, keys: Iterable[Key]) -> Self:
        """Copy with more ``keys``, each replacing one at its time."""
        return self._with(self.keys, keys)

    def without_key(self, index: int) -> Self:
        """Copy without one key. Raises ValueError for the last one."""
        return self.without_keys({index})

    def without_keys(self, indices: set[int]) -> Self:
        """Copy without the keys at these indices. Raises ValueError if none would be left."""
        return self._with(key for index, key in enumerate(self.keys) if index not in indices)

    def with_times(self, times: Mapping[int, float], speed: float = 1.0) -> Self:
        """Copy with the keys at some indices moved to other ``times``; each replaces a key at that time.

        Their free tangents are multiplied by ``speed``, so that keys that move closer together keep the shape of the
        curve.
        """
        if speed == 1.0:
            every = np.array(self.times)
            every[[*times]] = [*times.values()]
            if (np.diff(every) >= SAME_KEY_SECONDS).all():  # none passes another one
                return replace(self, times=tuple(every.tolist()))
        keys = self.keys
        kept = [key for place, key in enumerate(keys) if place not in times]
        moved = [Key(float(time), keys[place].value, keys[place].tangents) for place, time in times.items()]
        if speed != 1.0:
            steeper = lambda rate: rate * speed  # noqa: E731
            moved = [replace(key, tangents=key.tangents.with_rates(steeper)) if key.tangents else key for key in moved]
        return self._with(kept, moved)

    def with_time(self, index: int, time: float) -> Self:
        """Copy with the key at ``index`` moved to ``time``, at most to its neighbours."""
        times = [-math.inf, *self.times, math.inf]
        between = max(min(time, times[index + 2] - 2.0 * SAME_KEY_SECONDS), times[index] + 2.0 * SAME_KEY_SECONDS)
        return replace(self, times=(*self.times[:index], between, *self.times[index + 1 :]))

    def with_tangents(self, index: int, tangents: Tangents | None) -> Self:
        """Copy with other tangents of one key."""
        every = list(self.tangents or (None,) * len(self.times))
        every[index] = tangents
        return replace(self, tangents=tuple(every))

    def with_rates(self, change: Callable[[FloatArray], FloatArray]) -> Self:
        """Copy with the rate (size,) per second of every free tangent transformed by ``change``."""
        return replace(self, tangents=tuple(each.with_rates(change) if each else None for each in self.tangents))

    def moved(self, seconds: float) -> Self:
        """Copy shifted in time by ``seconds``; positive is later."""
        return replace(self, times=tuple(time + seconds for time in self.times))

    @classmethod
    def dimension(cls) -> int:
        """Number of components of a rate: as many as a value has, but three for a rotation."""
        return cls.size

    def rates(self) -> tuple[FloatArray, FloatArray]:
        """Rates (K, D) per second with which the curve arrives at each key, and (K, D) with which it leaves."""
        return self._rates

    @cached_property
    def _rates(self) -> tuple[FloatArray, FloatArray]:
        arriving, leaving = rates_of(self.seconds, self._steps(), self.tangents, self.before, self.after)
        return read_only(arriving), read_only(leaving)

    def _steps(self) -> FloatArray:
        """(K - 1, D) differences from each key to the next."""
        raise NotImplementedError

    def _with(self, kept: Iterable[Key], added: Iterable[Key] = ()) -> Self:
        """Copy with the keys ``kept`` and ``added``; of two keys at one time the last added stays."""
        keys: list[Key] = []
        ranked = [*((key, False) for key in kept), *((key, True) for key in added)]
        was_added = False
        for key, is_added in sorted(ranked, key=lambda each: each[0].time):
            if keys and key.time - keys[-1].time < SAME_KEY_SECONDS:
                if not is_added and was_added:
                    continue
                keys.pop()
            keys.append(key)
            was_added = is_added
        return replace(
            self,
            times=tuple(key.time for key in keys),
            values=tuple(key.value for key in keys),
            tangents=tuple(key.tangents for key in keys),
        )

    def _bracketing_keys(self, times: ArrayLike) -> "_KeySpans":
        """Keys around each of ``times`` (N,), and the progress between them."""
        keys = self.seconds
        asked = self._looped(np.asarray(times, dtype=np.float64))
        t = np.clip(asked, self.times[0], self.times[-1])
        before = np.clip(np.searchsorted(keys, t, "right") - 1, 0, max(len(keys) - 2, 0))
        after = np.minimum(before + 1, len(keys) - 1)
        progress = (t - keys[before]) / np.maximum(keys[after] - keys[before], SAME_KEY_SECONDS)
        share = ease(self._weighted(progress, before, after), EaseShape.QUINTIC)
        if stepped := [index for index, each in enumerate(self.tangents) if each is not None and each.is_stepped]:
            share = np.where(np.isin(before, stepped), (progress >= 1.0).astype(np.float64), share)
        return _KeySpans(before, after, t - keys[before], t - keys[after], share, asked - t)

    def _weighted(self, progress: FloatArray, before: NDArray[np.int64], after: NDArray[np.int64]) -> FloatArray:
        """Progress (N,) from one key to the next, delayed by the weights of the tangents."""
        if not self.tangents:
            return progress
        weights = np.array([(1.0, 1.0) if each is None else each.weights for each in self.tangents])
        leaving, arriving = weights[before, 1], weights[after, 0]
        return np.where((leaving == 1.0) & (arriving == 1.0), progress, weighted_progress(progress, leaving, arriving))

    def _looped(self, times: FloatArray) -> FloatArray:
        """Times (N,), of which those beyond the end of a loop are mapped into it."""
        first, length = self.times[0], self.times[-1] - self.times[0]
        if length > 0.0:
            for beyond, outside in ((self.before, times < first), (self.after, times > self.times[-1])):
                if beyond is Beyond.LOOP and outside.any():
                    times = np.where(outside, first + np.mod(times - first, length), times)
        return times

    def _continued(self, outside: FloatArray, arriving: FloatArray, leaving: FloatArray) -> FloatArray | None:
        """Extrapolated differences (N, D) from the first or last key; None if the value is held there."""
        begins, ends = self.before is Beyond.CONTINUE, self.after is Beyond.CONTINUE
        if not (begins or ends):
            return None
        earlier, later = np.minimum(outside, 0.0) * begins, np.maximum(outside, 0.0) * ends
        return np.asarray(earlier[:, None] * arriving[0] + later[:, None] * leaving[-1])


@dataclass(frozen=True, eq=False)
class _KeySpans:
    """Keys around each of N times: indices of the keys ``before`` and ``after``, and the position between them.

    ``since`` the one and ``until`` the other (negative) are in seconds, ``share`` is the eased fraction, and
    ``outside`` is in seconds past the last key, or before the first one (negative).
    """

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    since: FloatArray
    until: FloatArray
    share: FloatArray
    outside: FloatArray


class Line(Keys):
    """Keyed vectors of ``size`` numbers."""

    def _checked_values(self) -> tuple[Any, ...]:
        """Values, checked all at once because a recorded take has a key in every frame."""
        if all(type(value) is (float if self.size == 1 else tuple) for value in self.values):
            try:
                numbers = np.array(self.values, dtype=np.float64).reshape(len(self.values), -1)
            except ValueError:
                return super()._checked_values()
            if numbers.shape[1] == self.size and np.isfinite(numbers).all():
                PLACE_RANGE.check(numbers, "The value of a key")
                rows = numbers.tolist()
                return tuple(map(tuple, rows)) if self.size > 1 else tuple(row[0] for row in rows)
        return super()._checked_values()

    def at(self, times: ArrayLike) -> FloatArray:
        """Values (N, size) at ``times`` (N,) seconds."""
        values, spans = self.points, self._bracketing_keys(times)
        arriving, leaving = self.rates()
        begin = values[spans.before] + spans.since[:, None] * leaving[spans.before]
        end = values[spans.after] + spans.until[:, None] * arriving[spans.after]
        between = begin + spans.share[:, None] * (end - begin)
        further = self._continued(spans.outside, arriving, leaving)
        return np.asarray(between if further is None else between + further)

    def path(self, time: float) -> FloatArray:
        """Points (N, size) of the whole curve from the first key to the last; ``time`` is not used."""
        return self._path

    @cached_property
    def _path(self) -> FloatArray:
        return read_only(self.at(np.linspace(self.times[0], self.times[-1], 24 * len(self.times) + 1)))

    @cached_property
    def points(self) -> FloatArray:
        """Values (K, size) of the keys."""
        return read_only(np.array(self.values, dtype=np.float64).reshape(-1, self.size))

    def _steps(self) -> FloatArray:
        return np.diff(self.points, axis=0)


@dataclass(frozen=True)
class KeyedPlace(Line):
    """Keyed positions (x, y, z) in metres, in motion space."""

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
    """Keyed rotations as quaternions (x, y, z, w) in motion space, interpolated along the shorter arc."""

    size: ClassVar[int] = 4
    times: tuple[float, ...]
    values: tuple[Quaternion, ...]

    def _checked(self, value: Any) -> Quaternion:
        return unit_quaternion(super()._checked(value))

    def at(self, times: ArrayLike) -> FloatArray:
        """Rotation matrices (N, 3, 3) at ``times`` (N,) seconds."""
        from scipy.spatial.transform import Rotation

        keys, spans = Rotation.from_quat(np.array(self.values)), self._bracketing_keys(times)
        arriving, leaving = self.rates()
        since, until, share = spans.since[:, None], spans.until[:, None], spans.share[:, None]
        begin = keys[spans.before] * Rotation.from_rotvec(since * leaving[spans.before])
        end = keys[spans.after] * Rotation.from_rotvec(until * arriving[spans.after])
        result = begin * Rotation.from_rotvec(share * (begin.inv() * end).as_rotvec())
        matrices = np.asarray(result.as_matrix())
        if self.tangents:
            own = np.array([each is not None for each in self.tangents])
            chosen = own[spans.before] | own[spans.after]
            matrices[chosen] = (keys[spans.before] * Rotation.from_rotvec(self._vectors(spans))).as_matrix()[chosen]
        further = self._continued(spans.outside, arriving, leaving)
        if further is not None:
            matrices = np.where(
                spans.outside[:, None, None] == 0.0, matrices, matrices @ Rotation.from_rotvec(further).as_matrix()
            )
        return matrices

    def _vectors(self, spans: _KeySpans) -> FloatArray:
        """Rotation vectors (N, 3) relative to the previous key, in its axes: a smooth path of vectors cannot flip."""
        arriving, leaving = self.rates()
        steps = np.concatenate([self._steps(), np.zeros((1, 3))])
        begin = spans.since[:, None] * leaving[spans.before]
        end_rates = _vector_rates(steps, arriving[np.minimum(np.arange(len(steps)) + 1, len(steps) - 1)])
        end = steps[spans.before] + spans.until[:, None] * end_rates[spans.before]
        return np.asarray(begin + spans.share[:, None] * (end - begin))

    @classmethod
    def dimension(cls) -> int:
        """Three: radians per second about the axes of the key's rotation."""
        return 3

    def value_at(self, time: float) -> Quaternion:
        """Quaternion (x, y, z, w) at ``time``."""
        return unit_quaternion(from_matrix(self.at([time])[0]))

    def _steps(self) -> FloatArray:
        """Rotation vectors (K - 1, 3) of the shorter arc from each key to the next, equal in the axes of both."""
        from scipy.spatial.transform import Rotation

        keys = Rotation.from_quat(np.array(self.values))
        return np.asarray((keys[:-1].inv() * keys[1:]).as_rotvec()) if len(self.times) > 1 else np.empty((0, 3))


def _vector_rates(vectors: FloatArray, rates: FloatArray) -> FloatArray:
    """(N, 3) time derivatives of rotation vectors (N, 3) whose rotations have the body rates ``rates`` (N, 3).

    The inverse right Jacobian of SO(3): w + v x w / 2 + (1 - a / 2 cot(a / 2)) / a^2 v x (v x w) for |v| = a.
    """
    half = np.maximum(np.linalg.norm(vectors, axis=1), 1e-6) / 2.0
    across = np.cross(vectors, rates)
    factor = (1.0 - half / np.tan(half)) / (4.0 * half * half)
    return np.asarray(rates + across / 2.0 + factor[:, None] * np.cross(vectors, across))


def unit_quaternion(value: ArrayLike) -> Quaternion:
    """Quaternion scaled to unit length; one of unit length is returned to the bit. Raises ValueError for a norm of
    zero.
    """
    numbers = np.array(value, dtype=np.float64)
    length = np.linalg.norm(numbers) if numbers.shape == (4,) and np.isfinite(numbers).all() else 0.0
    if length < 1e-9:
        raise ValueError("a rotation is four finite numbers (x, y, z, w), not all zero.")
    x, y, z, w = unit_vectors(numbers).tolist()
    return x, y, z, w
