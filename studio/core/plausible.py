"""Physically possible ranges of quantities: numbers beyond them come from a wrong unit or damage, and are refused."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Range:
    """Possible range of a physical quantity named ``what``: absolute values from ``least`` to ``most``, in ``unit``."""

    what: str
    most: float
    unit: str = "m"
    least: float = 0.0

    def check(self, values: ArrayLike, what: str = "") -> None:
        """Raise ValueError if any finite one of ``values`` is outside the range; values that are not finite pass.

        ``what`` names the quantity more exactly in the message.
        """
        what = what or self.what
        amounts = np.abs(np.asarray(values, dtype=np.float64))
        amounts = amounts[np.isfinite(amounts)]
        if amounts.size and amounts.max() > self.most:
            told = f"{amounts.max():.3g} {self.unit}"
            raise ValueError(f"{what} of {told} is out of range: it must be at most {self.most:g} {self.unit}.")
        if amounts.size and amounts.min() < self.least:
            told = f"{amounts.min():.3g} {self.unit}"
            raise ValueError(f"{what} of {told} is out of range: it must be at least {self.least:g} {self.unit}.")


BONE_RANGE = Range("A bone", 1e3)
TRAVEL_RANGE = Range("A root position", 1e5)
MESH_RANGE = Range("A mesh vertex position", 1e5)
PLACE_RANGE = Range("A position", 1e5)
SKIN_RANGE = Range("A skin vertex position", 1e3)
TIME_RANGE = Range("A time", 1e9, "s")  # also "always", as files write it
PERIOD_RANGE = Range("A period", 1e6, "s", least=1e-3)
FRAME_RATE_RANGE = Range("A frame rate", 1e5, "fps", least=0.01)
TURN_RANGE = Range("A rotation angle", 1e4, "rad")
GROUND_RANGE = Range("A dimension of the ground", 1e4)
UNIT_RANGE = Range("A unit", 1e3, least=1e-6)
WEIGHT_RANGE = Range("A relative weight", 1e6, "times the default")
