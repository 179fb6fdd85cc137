"""Placement of a performer's motion on the stage."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.stage.project import Performer

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Placement:
    """Transform from motion space to the stage: a rotation by ``heading`` (radians) about Z, then a move by
    ``position``.
    """

    position: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0

    @classmethod
    def of(cls, performer: Performer) -> "Placement":
        """Placement at the position and heading of a performer."""
        return cls(performer.position, performer.heading)

    def compose(self, inner: "Placement") -> "Placement":
        """Placement on the stage of ``inner``, which is given in this placement's space."""
        x, y, _ = self.to_stage((*inner.position, 0.0)).tolist()
        return Placement((x, y), self.heading + inner.heading)

    @cached_property
    def rotation(self) -> FloatArray:
        """Rotation, (3, 3), from motion space to the stage."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    @cached_property
    def _origin(self) -> FloatArray:
        """Origin of the motion on the stage, (3,) metres."""
        return np.array([*self.position, 0.0])

    def to_stage(self, points: ArrayLike) -> FloatArray:
        """Stage coordinates (..., 3) of ``points`` (..., 3) in motion space."""
        return np.asarray(np.asarray(points, dtype=np.float64) @ self.rotation.T + self._origin)

    def to_motion(self, points: ArrayLike) -> FloatArray:
        """Motion space coordinates (..., 3) of ``points`` (..., 3) on the stage."""
        return np.asarray((np.asarray(points, dtype=np.float64) - self._origin) @ self.rotation)
