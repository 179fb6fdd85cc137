"""Restricted areas as rows of numbers for ``kernels.tasks.areas``, and the nearest allowed place to a point."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.kernels.tasks import areas
from studio.core.mesh.distance_field import distance_field

FloatArray = NDArray[np.float64]

ORIGIN = np.zeros(3)

_SHAPES = {
    AreaShape.HALF_SPACE: areas.HALF_SPACE,
    AreaShape.BOX: areas.BOX,
    AreaShape.SPHERE: areas.SPHERE,
    AreaShape.CYLINDER: areas.CYLINDER,
    AreaShape.TABLE: areas.TABLE,
    AreaShape.MESH: areas.MESH,
}


def area_row(constraint: AreaConstraint, centre: FloatArray = ORIGIN, heading: float = 0.0) -> FloatArray:
    """(10,) an area as ``kernels.tasks.areas`` takes it, longer by its field for a mesh.

    Frame by frame its place is put in there (``put_area``).
    """
    shape, turn = _SHAPES[constraint.shape], (np.cos(heading), np.sin(heading))
    side = areas.ON if constraint.on_surface else areas.INSIDE if constraint.inside else areas.OUTSIDE
    row = np.array([shape, side, *centre, *constraint.size, *turn], dtype=np.float64)
    if constraint.shape is not AreaShape.MESH or constraint.mesh is None:
        return row
    return np.concatenate([row, distance_field(constraint.mesh)])


def nearest_place(constraint: AreaConstraint, point: ArrayLike) -> FloatArray:
    """(3,) metres: where ``point`` (3,) may be, nearest to it; itself where it may stay. The area is a fixed one."""
    row = area_row(constraint, np.array(constraint.centre), float(np.array(constraint.heading)))
    return np.array(areas.nearest_allowed(row, np.array(point, dtype=np.float64))[1])
