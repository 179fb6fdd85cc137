"""Activation of a constraint: a curve over time that rises from 0 to 1 and falls back to 0."""

import math
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.curves.tangents import LEAST_TANGENT_WEIGHT, LEFT_OUT_IF_DEFAULT, MOST_TANGENT_WEIGHT
from studio.core.plausible import TIME_RANGE


class EaseShape(StrEnum):
    """Polynomial of an activation's ramp."""

    LINEAR = "linear"
    SMOOTH = "smooth"
    QUINTIC = "quintic"


LEAST_FULL_ACTIVATION = 1.0 - 1e-9
"""Activation from which a constraint counts as fully active."""
QUINTIC_PEAK_SLOPE = 1.875
"""Greatest slope of a quintic ease from 0 to 1 over an interval of 1."""


def ease(progress: ArrayLike, shape: EaseShape) -> NDArray[np.float64]:
    """Eased rise from 0 to 1 over ``progress``, clipped to [0, 1]: 3t^2-2t^3 for smooth, 6t^5-15t^4+10t^3
    for quintic.
    """
    t = np.minimum(np.maximum(np.asarray(progress, dtype=np.float64), 0.0), 1.0)
    match shape:
        case EaseShape.LINEAR:
            return t
        case EaseShape.SMOOTH:
            return t * t * (3.0 - 2.0 * t)
        case EaseShape.QUINTIC:
            return np.minimum(t * t * t * (t * (6.0 * t - 15.0) + 10.0), 1.0)  # rounded, it may pass by a hair


def weighted_progress(progress: ArrayLike, leaving: ArrayLike, arriving: ArrayLike) -> NDArray[np.float64]:
    """Progress in [0, 1], slower at the start the greater ``leaving`` is, and slower at the end the greater
    ``arriving`` is.

    Both weights are above 0. This is the monotone rational quadratic of Gregory and Delbourgo (1982) with the slopes 1
    / leaving at 0 and 1 / arriving at 1.
    """
    t = np.asarray(progress, dtype=np.float64)
    begin, end, rest = 1.0 / np.asarray(leaving), 1.0 / np.asarray(arriving), t * (1.0 - t)
    return np.asarray((t * t + begin * rest) / (1.0 + (begin + end - 2.0) * rest))


@dataclass(frozen=True)
class ActivationCurve:
    """Curve that is 0 before ``start``, eased to 1 at ``full``, held to ``full_end`` and eased to 0 at ``end``
    (seconds).

    Each of ``weights`` lengthens the time near 0 or 1 at one of the four times. Raises ValueError if the times are not
    finite or not in order.
    """

    start: float
    full: float
    full_end: float
    end: float
    shape: EaseShape = EaseShape.QUINTIC
    weights: tuple[float, float, float, float] = field(
        default=(1.0, 1.0, 1.0, 1.0), kw_only=True, metadata=LEFT_OUT_IF_DEFAULT
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", EaseShape(self.shape))
        object.__setattr__(self, "weights", tuple(float(weight) for weight in self.weights))
        if len(self.weights) != 4 or not all(
            LEAST_TANGENT_WEIGHT <= weight <= MOST_TANGENT_WEIGHT for weight in self.weights
        ):
            raise ValueError(
                f"An activation has four weights from {LEAST_TANGENT_WEIGHT} to {MOST_TANGENT_WEIGHT}, "
                f"got {self.weights}."
            )
        times = self.times
        if not all(math.isfinite(time) for time in times):
            raise ValueError("An activation needs four finite times.")
        TIME_RANGE.check(times)
        if not self.start <= self.full <= self.full_end <= self.end:
            raise ValueError(
                "An activation's times are in order, start, full, full end, end: "
                + ", ".join(f"{time:.3f} s" for time in times)
                + " are not."
            )

    @property
    def times(self) -> tuple[float, float, float, float]:
        """Start, full, full end and end."""
        return self.start, self.full, self.full_end, self.end

    def at(self, times: ArrayLike) -> NDArray[np.float64]:
        """Activation in [0, 1] at ``times`` (seconds), same shape."""
        t = np.asarray(times, dtype=np.float64)
        rise, fall = _progress(t, self.start, self.full), _progress(-t, -self.end, -self.full_end)
        if self.weights != (1.0, 1.0, 1.0, 1.0):
            start, full, full_end, end = self.weights
            rise = weighted_progress(np.clip(rise, 0.0, 1.0), start, full)
            fall = weighted_progress(np.clip(fall, 0.0, 1.0), end, full_end)
        return ease(np.minimum(rise, fall), self.shape)

    def is_whole(self, first: float, last: float) -> bool:
        """True if the activation is 1 from ``first`` to ``last`` (seconds)."""
        return self.full <= first and last <= self.full_end

    def moved(self, seconds: float) -> "ActivationCurve":
        """Curve shifted in time by ``seconds``; positive is later."""
        return self.with_times(*(time + seconds for time in self.times))

    def with_weight(self, index: int, weight: float) -> "ActivationCurve":
        """Copy with ``weight`` at one of the four times, given by its index."""
        weights = [*self.weights]
        weights[index] = weight
        start, full, full_end, end = weights
        return replace(self, weights=(start, full, full_end, end))

    def with_times(self, start: float, full: float, full_end: float, end: float) -> "ActivationCurve":
        """Copy with other times."""
        return replace(self, start=start, full=full, full_end=full_end, end=end)


def _progress(times: NDArray[np.float64], begin: float, full: float) -> NDArray[np.float64]:
    if full <= begin:
        return np.where(times >= begin, 1.0, 0.0)
    return (times - begin) / (full - begin)
