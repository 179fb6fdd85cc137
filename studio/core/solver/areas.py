"""Restricted areas in the words of the kernels, and the nearest allowed place to a point."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.kernels import areas

FloatArray = NDArray[np.float64]

ORIGIN = np.zeros(3)

_SHAPES = {
    AreaShape.HALF_SPACE: areas.HALF_SPACE,
    AreaShape.BOX: areas.BOX,
    AreaShape.SPHERE: areas.SPHERE,
    AreaShape.CYLINDER: areas.CYLINDER,
    AreaShape.TABLE: areas.TABLE,
}


def area_row(constraint: AreaConstraint, centre: FloatArray = ORIGIN, heading: float = 0.0) -> FloatArray:
    """(10,) an area as ``kernels.areas`` takes it; frame by frame its place is put in there (``put_area``)."""
    shape, inside = _SHAPES[constraint.shape], float(constraint.inside)
    return np.array([shape, inside, *centre, *constraint.size, np.cos(heading), np.sin(heading)], dtype=np.float64)


def nearest_place(constraint: AreaConstraint, point: ArrayLike) -> FloatArray:
    """(3,) metres: where ``point`` (3,) may be, nearest to it; itself where it may stay. The area is a fixed one."""
    place, row = np.empty(3), area_row(constraint, np.array(constraint.centre), float(np.array(constraint.heading)))
    areas.nearest_allowed(row, np.array(point, dtype=np.float64), place)
    return place
