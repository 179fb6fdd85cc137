"""Orientation: a segment of the body is to be turned one way."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from studio.core.constraints.base import Constraint

Quaternion = tuple[float, float, float, float]


@dataclass(frozen=True)
class OrientationConstraint(Constraint):
    """The segment of ``point`` is to have the rotation ``target`` (x, y, z, w), in the space of the motion.

    Raises ValueError when the four numbers make no rotation. The miss is an angle.
    """

    kind: ClassVar[str] = "orientation"
    unit: ClassVar[str] = "rad"
    target: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        numbers = np.array(self.target, dtype=np.float64)
        length = np.linalg.norm(numbers) if numbers.shape == (4,) and np.isfinite(numbers).all() else 0.0
        if length < 1e-9:
            raise ValueError(f"'{self.name}': an orientation is four finite numbers (x, y, z, w), not all zero.")
        object.__setattr__(self, "target", tuple(float(number) for number in numbers / length))
