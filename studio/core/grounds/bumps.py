"""Ground with smooth bumps everywhere, determined by a seed."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from studio.core.grounds.ground import FloatArray, Ground

GROUND_WAVES = 4
"""Number of plane waves whose mean is the ground; with this many, no direction has a straight crest."""


@dataclass(frozen=True)
class Bumps(Ground):
    """Ground with smooth bumps of at most ``amplitude`` metres up and down, about ``wavelength`` metres from crest to
    crest.
    """

    kind: ClassVar[str] = "bumps"
    amplitude: float = 0.08
    wavelength: float = 1.2
    seed: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (self.wavelength >= 0.1 and self.seed >= 0):
            raise ValueError("Bumps have a wavelength of at least 0.1 m and a seed that is not negative.")

    def rise_at(self, xy: FloatArray) -> FloatArray:
        waves, phases = self._waves
        return np.asarray(self.amplitude * np.sin(xy @ waves.T + phases).mean(axis=-1))

    def slope_at(self, xy: FloatArray) -> FloatArray:
        waves, phases = self._waves
        return np.asarray(self.amplitude * np.cos(xy @ waves.T + phases) @ waves / GROUND_WAVES)

    @cached_property
    def _waves(self) -> tuple[FloatArray, FloatArray]:
        """Wave vectors (W, 2), radians a metre, spread over the half circle, and phases (W,)."""
        random = np.random.default_rng(self.seed)
        ways = (
            math.pi
            * (np.arange(GROUND_WAVES) + random.uniform(-0.3, 0.3, GROUND_WAVES) + random.uniform())
            / GROUND_WAVES
        )
        lengths = self.wavelength * random.uniform(0.85, 1.2, GROUND_WAVES)
        vectors = (2 * math.pi / lengths)[:, None] * np.column_stack([np.cos(ways), np.sin(ways)])
        return vectors, random.uniform(0.0, 2 * math.pi, GROUND_WAVES)
