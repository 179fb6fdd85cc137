"""Tangents of the keys of a curve, and its extrapolation before the first and after the last key."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Rate = tuple[float, ...]

LEFT_OUT_IF_DEFAULT: Mapping[str, Any] = {"sparse": True}
"""Metadata of a field that files leave out if it has its default value."""
LEAST_TANGENT_WEIGHT, MOST_TANGENT_WEIGHT = 0.05, 20.0
"""Least and greatest weight of a tangent."""


class Beyond(StrEnum):
    """Extrapolation of a curve before its first and after its last key."""

    HOLD = "hold"
    LOOP = "loop"
    CONTINUE = "continue"


class TangentMode(StrEnum):
    """Rule for the slope of a curve at a key."""

    AUTO = "auto"
    """Slope from the neighbouring keys that never overshoots their values."""
    SMOOTH = "smooth"
    """Slope of the parabola through the key and its neighbours, which may overshoot their values."""
    LINEAR = "linear"
    """Slope of the straight line to the next key, or from the previous one."""
    FLAT = "flat"
    STEPPED = "stepped"
    """The value holds until the next key."""
    FREE = "free"


@dataclass(frozen=True)
class Tangent:
    """One side of a key: a free tangent has a ``rate`` per second; a greater ``weight`` lets the curve follow it for
    longer.
    """

    mode: TangentMode = TangentMode.AUTO
    rate: Rate = ()
    weight: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "mode", TangentMode(self.mode))
        object.__setattr__(self, "rate", tuple(float(number) for number in self.rate))
        if bool(self.rate) != (self.mode is TangentMode.FREE) or not all(map(math.isfinite, self.rate)):
            raise ValueError(f"A free tangent has a rate of finite numbers, any other has none: {self.rate}.")
        if not LEAST_TANGENT_WEIGHT <= self.weight <= MOST_TANGENT_WEIGHT:
            raise ValueError(
                f"The weight of a tangent lies from {LEAST_TANGENT_WEIGHT} to {MOST_TANGENT_WEIGHT}, got {self.weight}."
            )


@dataclass(frozen=True)
class Tangents:
    """Tangents on both sides of a key. Unless they are ``broken``, free ones have the same rate."""

    arriving: Tangent = Tangent()
    leaving: Tangent = Tangent()
    broken: bool = field(default=False, metadata=LEFT_OUT_IF_DEFAULT)

    def __post_init__(self) -> None:
        if self.arriving.mode is TangentMode.STEPPED:
            raise ValueError("Only the tangent that leaves a key can be stepped.")
        if not self.broken and self.arriving.rate and self.leaving.rate and self.arriving.rate != self.leaving.rate:
            raise ValueError("The free tangents of a key have the same rate unless they are broken.")

    def __bool__(self) -> bool:
        """True if the tangents differ from automatic ones."""
        return self != AUTO_TANGENTS

    @property
    def is_stepped(self) -> bool:
        """True if the value holds until the next key."""
        return self.leaving.mode is TangentMode.STEPPED

    @property
    def weights(self) -> tuple[float, float]:
        """Weights of the arriving and of the leaving side."""
        return self.arriving.weight, self.leaving.weight

    @property
    def rates(self) -> tuple[Rate, ...]:
        """Rates of the free sides."""
        return tuple(side.rate for side in (self.arriving, self.leaving) if side.rate)

    def with_rates(self, change: Callable[[FloatArray], FloatArray]) -> "Tangents":
        """Copy with the rates (D,) of its free sides transformed by ``change``."""
        arriving, leaving = (
            replace(side, rate=tuple(change(np.array(side.rate)).tolist())) if side.rate else side
            for side in (self.arriving, self.leaving)
        )
        return replace(self, arriving=arriving, leaving=leaving)


AUTO_TANGENTS = Tangents()


def tangents_of(mode: TangentMode, weights: tuple[float, float] = (1.0, 1.0)) -> Tangents:
    """Tangents with one mode on both sides; the arriving side of a stepped key is automatic."""
    arriving = TangentMode.AUTO if mode is TangentMode.STEPPED else mode
    return Tangents(Tangent(arriving, weight=weights[0]), Tangent(mode, weight=weights[1]))


def rates_of(
    times: FloatArray, steps: FloatArray, tangents: Sequence[Tangents | None], before: Beyond, after: Beyond
) -> tuple[FloatArray, FloatArray]:
    """Rates (K, D) per second with which a curve arrives at each key, and (K, D) with which it leaves.

    ``steps`` (K - 1, D) are the differences from each key to the next.
    """
    auto = _auto_rates(times, steps, before, after)
    if not tangents or not len(steps):
        return auto, auto
    gaps = np.diff(times)
    slopes = steps / gaps[:, None]
    earlier, later = np.concatenate([slopes[:1], slopes]), np.concatenate([slopes, slopes[-1:]])
    ahead, behind = np.append(gaps, gaps[-1])[:, None], np.append(gaps[0], gaps)[:, None]
    smooth = (earlier * ahead + later * behind) / (ahead + behind)
    arriving, leaving = auto.copy(), auto.copy()
    for index, each in enumerate(tangents):
        if each is not None:
            arriving[index] = _rate(each.arriving, auto[index], smooth[index], earlier[index])
            leaving[index] = _rate(each.leaving, auto[index], smooth[index], later[index])
    return arriving, leaving


def _rate(side: Tangent, auto: FloatArray, smooth: FloatArray, slope: FloatArray) -> FloatArray:
    match side.mode:
        case TangentMode.AUTO:
            return auto
        case TangentMode.SMOOTH:
            return smooth
        case TangentMode.LINEAR:
            return slope
        case TangentMode.FREE:
            return np.array(side.rate)
    return np.zeros_like(auto)


def _auto_rates(times: FloatArray, steps: FloatArray, before: Beyond, after: Beyond) -> FloatArray:
    """Automatic rates (K, D) per second; zero at both ends if the curve is held there."""
    rates = np.zeros((len(times), steps.shape[1]))
    if len(times) < 2:
        return rates
    slopes = steps / np.diff(times)[:, None]
    if len(times) > 2:
        rates[1:-1] = _passing(slopes[:-1], slopes[1:])
    if Beyond.LOOP in (before, after):
        rates[[0, -1]] = _passing(slopes[-1:], slopes[:1])
    if before is Beyond.CONTINUE:
        rates[0] = slopes[0]
    if after is Beyond.CONTINUE:
        rates[-1] = slopes[-1]
    return rates


def _passing(a: FloatArray, b: FloatArray) -> FloatArray:
    """(N, D) min(|a|, |b|) max(0, cos(a, b)) along a + b, for the rates a before and b after each of N keys."""
    speeds_a, speeds_b, both = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1), a + b
    cosine = np.sum(a * b, axis=1) / np.maximum(speeds_a * speeds_b, 1e-30)
    speed = np.minimum(speeds_a, speeds_b) * np.clip(cosine, 0.0, 1.0)
    return np.asarray((speed / np.maximum(np.linalg.norm(both, axis=1), 1e-30))[:, None] * both)
