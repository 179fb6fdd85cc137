"""Restricted area: a point of the body is to stay inside, or outside, a part of space."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar

from studio.core.constraints.base import Constraint, Vector, finite_vector
from studio.core.constraints.keyed import KeyedNumber
from studio.core.constraints.target import Place, checked_place


class AreaShape(StrEnum):
    """Half-space: above the plane of its tilted top. Table: as a box kept out of, but always left upwards."""

    HALF_SPACE = "half_space"
    BOX = "box"
    SPHERE = "sphere"
    CYLINDER = "cylinder"
    TABLE = "table"


@dataclass(frozen=True)
class AreaConstraint(Constraint):
    """``point`` stays outside the shape, or inside it.

    ``centre`` in metres, motion space; ``size`` in metres: the edges of a box or table (x, y, z), the diameter of a
    sphere (x), diameter and height of an upright cylinder (x, z); ``heading`` turns box and table about Z. A
    half-space is bounded by the plane through ``centre`` whose normal is ``size`` as a direction; outside is the side
    to which the normal points. An area moves when centre or heading is keyed, and with what its centre follows: its
    turn about Z is added to the heading. Raises ValueError for an area of no size.
    """

    kind: ClassVar[str] = "area"
    shape: AreaShape = AreaShape.TABLE
    centre: Place = (0.0, 0.0, 0.0)
    size: Vector = (1.0, 1.0, 1.0)
    heading: float | KeyedNumber = 0.0
    inside: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "shape", AreaShape(self.shape))
        object.__setattr__(self, "centre", checked_place(self.centre, self, "the centre of an area"))
        object.__setattr__(self, "size", finite_vector(self.size, f"'{self.name}': the size of an area"))
        if not (isinstance(self.heading, KeyedNumber) or math.isfinite(self.heading)):
            raise ValueError(f"'{self.name}': a heading is a finite number of radians, got {self.heading}.")
        used = {AreaShape.SPHERE: self.size[:1], AreaShape.CYLINDER: (self.size[0], self.size[2])}
        if self.shape is AreaShape.HALF_SPACE:
            empty = math.hypot(*self.size) < 1e-9
        else:
            empty = any(edge <= 0.0 for edge in used.get(self.shape, self.size))
        if empty:
            raise ValueError(f"'{self.name}': an area needs a size above zero.")
