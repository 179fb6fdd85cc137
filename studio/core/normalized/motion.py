"""The morphology-independent motion: numbers without any body's measures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NormalizedMotion:
    """A motion free of any body's measures (METHOD: 89 + 7 K numbers a frame; ``kernels.layout`` has the columns).

    ``channels`` (F, 89 + 7 K); ``ankle_height`` and ``toe_height`` (2,) are the actor's, as parts of the leg length.
    """

    name: str
    frame_rate: float
    spine_count: int
    channels: FloatArray
    ankle_height: FloatArray
    toe_height: FloatArray

    @property
    def frame_count(self) -> int:
        return len(self.channels)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frame_count - 1) / self.frame_rate
