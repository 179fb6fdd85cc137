"""Procedural target positions: on a circle, as a pendulum, or at random.

Each is a function of time, so that frames may be evaluated in any order.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.constraints.base import Vector, finite_vector
from studio.core.constraints.own_place import OwnPlace
from studio.core.curves.tangents import LEFT_OUT_IF_DEFAULT
from studio.core.plausible import PERIOD_RANGE, PLACE_RANGE, TIME_RANGE, TURN_RANGE

FloatArray = NDArray[np.float64]

NOISE_WAVES = 5
"""Number of sine waves that make each coordinate of a noise."""
SLOWEST_WAVE_FRACTION = 0.3
"""Frequency of the slowest wave of a noise as a fraction of the fastest."""


@dataclass(frozen=True, kw_only=True)
class ProceduralPosition(ABC):
    """Base class of procedural target paths about ``centre`` (metres), with a period in ``seconds`` and phase 0 at
    ``since``.

    ``heading`` rotates the whole path about Z, in radians. With an ``origin`` the centre is relative to it, so that
    every body moves about its own position.
    """

    kind: ClassVar[str]
    rounds: ClassVar[float] = 1.0
    """Number of periods that show the whole path."""
    centre: Vector = (0.0, 0.0, 1.0)
    heading: float = 0.0
    seconds: float = 2.0
    since: float = 0.0
    origin: OwnPlace | None = field(default=None, metadata=LEFT_OUT_IF_DEFAULT)

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", finite_vector(self.centre, "The centre of a procedural target"))
        numbers = [value for value in vars(self).values() if isinstance(value, float | int)]
        if not all(math.isfinite(number) for number in numbers) or self.seconds <= 0.0:
            raise ValueError("A procedural target needs finite numbers and a period greater than 0 seconds.")
        PERIOD_RANGE.check(self.seconds)
        TIME_RANGE.check(self.since)
        TURN_RANGE.check(self.heading)

    def at(self, times: ArrayLike) -> FloatArray:
        """Positions (N, 3) in metres at ``times`` (N,) seconds."""
        x, y, z = self._offsets((np.asarray(times, dtype=np.float64) - self.since) / self.seconds).T
        c, s = math.cos(self.heading), math.sin(self.heading)
        # No matrix product: on some processors that rounds one row otherwise than many.
        return np.stack([c * x - s * y, s * x + c * y, z], axis=-1) + self.centre

    def path(self, time: float) -> FloatArray:
        """Points (N, 3) of the path around ``time``."""
        around = self.rounds * self.seconds / 2.0
        return self.at(np.linspace(time - around, time + around, round(96 * self.rounds) + 1))

    def passing(self, position: Vector, time: float) -> Self:
        """Path translated so that it passes ``position`` at ``time``."""
        x, y, z = (np.array(self.centre) + position - self.at([time])[0]).tolist()
        return replace(self, centre=(x, y, z))

    def mirrored(self) -> Self:
        """Mirror image of the path, with y negated."""
        x, y, z = self.centre
        return replace(self, centre=(x, -y, z), heading=-self.heading)

    @abstractmethod
    def _offsets(self, rounds: FloatArray) -> FloatArray:
        """Offsets (N, 3) from the centre after ``rounds`` (N,) periods, with heading 0."""


@dataclass(frozen=True, kw_only=True)
class CirclePlace(ProceduralPosition):
    """Target on a circle of ``radius`` metres, horizontal or tilted by ``tilt`` radians about its starting point."""

    kind: ClassVar[str] = "circle"
    radius: float = 0.2
    tilt: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        PLACE_RANGE.check(self.radius, "The radius of a circle")
        TURN_RANGE.check(self.tilt)

    def mirrored(self) -> Self:
        return replace(super().mirrored(), tilt=math.pi - self.tilt)

    def _offsets(self, rounds: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * rounds
        ahead, aside = self.radius * np.cos(angle), self.radius * np.sin(angle)
        return np.stack([ahead, math.cos(self.tilt) * aside, math.sin(self.tilt) * aside], axis=-1)


@dataclass(frozen=True, kw_only=True)
class PendulumPlace(ProceduralPosition):
    """Target at the end of a pendulum of ``length`` metres that swings by ``angle`` radians to each side of ``centre``,
    the pivot.
    """

    kind: ClassVar[str] = "pendulum"
    length: float = 1.0
    angle: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        PLACE_RANGE.check(self.length, "The length of a pendulum")
        TURN_RANGE.check(self.angle)

    def _offsets(self, rounds: FloatArray) -> FloatArray:
        swing = self.angle * np.cos(2.0 * np.pi * rounds)
        level = np.zeros_like(swing)
        return self.length * np.stack([np.sin(swing), level, 1.0 - np.cos(swing)], axis=-1)


@dataclass(frozen=True, kw_only=True)
class NoisePlace(ProceduralPosition):
    """Target that moves by smooth noise within ``reach`` metres of the centre; ``seed`` selects the noise.

    The fastest wave has a period of ``seconds``.
    """

    kind: ClassVar[str] = "noise"
    rounds: ClassVar[float] = 2.0
    reach: Vector = (0.1, 0.1, 0.1)
    seed: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "reach", finite_vector(self.reach, "The amplitude of a noise target"))
        if not 0 <= self.seed < 2**32:
            raise ValueError(f"The seed of a noise target must be a whole number of 0 or more, not {self.seed}.")

    def mirrored(self) -> Self:
        x, y, z = self.reach
        return replace(super().mirrored(), reach=(x, -y, z))

    def _offsets(self, rounds: FloatArray) -> FloatArray:
        paces, phases = _waves(self.seed)
        waves = np.sin(2.0 * np.pi * (rounds[..., None, None] * paces + phases))
        return np.asarray(waves.mean(axis=-1) * np.array(self.reach))


ProceduralPlace = CirclePlace | PendulumPlace | NoisePlace


@lru_cache(maxsize=256)
def _waves(seed: int) -> tuple[FloatArray, FloatArray]:
    """Frequencies and phases (3, WAVES) of each coordinate, in turns; constant for a seed."""
    drawn = np.random.RandomState(seed).random_sample((2, 3, NOISE_WAVES))  # whose numbers never change
    return SLOWEST_WAVE_FRACTION + (1.0 - SLOWEST_WAVE_FRACTION) * drawn[0], drawn[1]
