"""Restricted areas in the words of the kernels, and the nearest allowed place to a point."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.kernels import areas

FloatArray = NDArray[np.float64]

_SHAPES = {
    AreaShape.HALF_SPACE: areas.HALF_SPACE,
    AreaShape.BOX: areas.BOX,
    AreaShape.SPHERE: areas.SPHERE,
    AreaShape.CYLINDER: areas.CYLINDER,
    AreaShape.TABLE: areas.TABLE,
}


def area_row(constraint: AreaConstraint) -> FloatArray:
    """(10,) an area as ``kernels.areas`` takes it."""
    turn = math.cos(constraint.heading), math.sin(constraint.heading)
    shape, inside = _SHAPES[constraint.shape], float(constraint.inside)
    return np.array([shape, inside, *constraint.centre, *constraint.size, *turn], dtype=np.float64)


def nearest_place(constraint: AreaConstraint, point: ArrayLike) -> FloatArray:
    """(3,) metres: where ``point`` (3,) may be, nearest to it; itself where it may stay."""
    place = np.empty(3)
    areas.nearest_allowed(area_row(constraint), np.array(point, dtype=np.float64), place)
    return place
