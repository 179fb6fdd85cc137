"""The ground under the performers. Flat for now; every kind answers ``height_at``."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Ground:
    """A level floor at ``height`` metres."""

    height: float = 0.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.height):
            raise ValueError(f"The ground's height is a finite number of metres, got {self.height}.")

    def height_at(self, places: ArrayLike) -> NDArray[np.float64]:
        """Height in metres at ``places`` (..., 2 or 3), shape (...)."""
        return np.full(np.shape(places)[:-1], self.height)
