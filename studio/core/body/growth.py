"""Bodies whose proportions change over time."""

from dataclasses import astuple, dataclass, fields
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.body.morphology import AnimatedMorphology, Morphology, Proportions
from studio.core.curves.keyed import Line, read_only
from studio.core.project_cache import project_cache

FloatArray = NDArray[np.float64]

_FACTORS = tuple(field.name for field in fields(Proportions))


@dataclass(frozen=True)
class KeyedProportions(Line):
    """Proportions keyed at ``times`` in stage seconds, smooth between the keys and constant outside."""

    size: ClassVar[int] = len(_FACTORS)
    times: tuple[float, ...]
    values: tuple[Proportions, ...]

    def at(self, times: ArrayLike) -> FloatArray:
        """Factors (N, 11) at ``times`` (N,) seconds, clamped to the range of the keys."""
        factors = self.points
        return np.asarray(np.clip(super().at(times), factors.min(axis=0), factors.max(axis=0)))

    def proportions_at(self, time: float) -> Proportions:
        """Proportions at ``time``, in seconds of the stage."""
        return Proportions(*self.at([time])[0].tolist())

    @cached_property
    def points(self) -> FloatArray:
        """Factors (K, 11) of the keys."""
        return read_only(np.array([astuple(value) for value in self.values]))

    def _checked(self, value: Any) -> Proportions:
        return value if isinstance(value, Proportions) else Proportions(*super()._checked(value))


@project_cache(maxsize=64)
def animated_morphology(
    build: Morphology, keyed: KeyedProportions, begin: float, frame_rate: float, count: int
) -> AnimatedMorphology:
    """Measures of ``build`` over ``count`` frames from stage second ``begin`` on, with keyed proportions.

    The result is cached: equal arguments give the same object.
    """
    factors = keyed.at(begin + np.arange(count) / frame_rate)
    return AnimatedMorphology(build.packed * np.exp(np.log(factors) @ _exponents(build)))


@lru_cache(maxsize=64)
def _exponents(build: Morphology) -> FloatArray:
    """Exponents (11, 57 + 3 K) of each factor in each measure; every measure is a product of powers of factors."""
    doubled = np.array([Proportions(**{name: 2.0}).applied_to(build).packed for name in _FACTORS])
    return np.log2(np.where(build.packed == 0.0, 1.0, doubled / np.where(build.packed == 0.0, 1.0, build.packed)))
