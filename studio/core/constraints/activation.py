"""Activation of a constraint: a curve in time from 0 to 1 and back."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.plausible import TIME


class EaseShape(StrEnum):
    """Polynomial of an activation's ramp."""

    LINEAR = "linear"
    SMOOTH = "smooth"
    QUINTIC = "quintic"


EASE_PEAK = 1.875
"""Highest slope of a quintic ease."""


def ease(progress: ArrayLike, shape: EaseShape) -> NDArray[np.float64]:
    """Rise from 0 to 1 over ``progress`` in [0, 1] (clipped): 3t^2-2t^3 for smooth, 6t^5-15t^4+10t^3 for quintic."""
    t = np.minimum(np.maximum(np.asarray(progress, dtype=np.float64), 0.0), 1.0)
    match shape:
        case EaseShape.LINEAR:
            return t
        case EaseShape.SMOOTH:
            return t * t * (3.0 - 2.0 * t)
        case EaseShape.QUINTIC:
            return np.minimum(t * t * t * (t * (6.0 * t - 15.0) + 10.0), 1.0)  # rounded, it may pass by a hair


@dataclass(frozen=True)
class ActivationCurve:
    """0 before ``start``, eased to 1 at ``full``, held to ``full_end``, eased to 0 at ``end`` (seconds).

    Raises ValueError when the four times are not finite or not in order.
    """

    start: float
    full: float
    full_end: float
    end: float
    shape: EaseShape = EaseShape.QUINTIC

    def __post_init__(self) -> None:
        object.__setattr__(self, "shape", EaseShape(self.shape))
        times = (self.start, self.full, self.full_end, self.end)
        if not all(math.isfinite(time) for time in times):
            raise ValueError("An activation needs four finite times.")
        TIME.check(times)
        if not self.start <= self.full <= self.full_end <= self.end:
            raise ValueError(
                "An activation's times are in order, start, full, full end, end: "
                + ", ".join(f"{time:.3f} s" for time in times)
                + " are not."
            )

    def at(self, times: ArrayLike) -> NDArray[np.float64]:
        """Activation in [0, 1] at ``times`` (seconds), same shape."""
        t = np.asarray(times, dtype=np.float64)
        rise, fall = _progress(t, self.start, self.full), _progress(-t, -self.end, -self.full_end)
        return ease(np.minimum(rise, fall), self.shape)

    def is_whole(self, first: float, last: float) -> bool:
        """True if it is 1 from ``first`` to ``last`` (seconds)."""
        return self.full <= first and last <= self.full_end

    def moved(self, seconds: float) -> "ActivationCurve":
        """The same curve ``seconds`` later."""
        return ActivationCurve(
            self.start + seconds, self.full + seconds, self.full_end + seconds, self.end + seconds, self.shape
        )


def _progress(times: NDArray[np.float64], begin: float, full: float) -> NDArray[np.float64]:
    if full <= begin:
        return np.where(times >= begin, 1.0, 0.0)
    return (times - begin) / (full - begin)
