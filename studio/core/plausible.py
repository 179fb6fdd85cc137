"""What is physically possible, in one table: numbers beyond it are slips of a unit or damage, and are refused."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Range:
    """Of a physical number: ``what`` it is, and the ``most`` that its amount can be, in ``unit``."""

    what: str
    most: float
    unit: str = "m"

    def check(self, values: ArrayLike) -> None:
        """Raise ValueError where any of ``values`` is more than that; those that are not finite are somebody else's."""
        amounts = np.abs(np.asarray(values, dtype=np.float64))
        amounts = amounts[np.isfinite(amounts)]
        if amounts.size and amounts.max() > self.most:
            told = f"{amounts.max():.3g} {self.unit}"
            raise ValueError(f"{self.what} of {told} cannot be true: it is at most {self.most:g} {self.unit}.")


BONE = Range("A bone", 1e3)
TRAVEL = Range("A way of the root", 1e5)
MESH = Range("A mesh with a place", 1e5)
GROUND = Range("A height of the ground", 1e4)
