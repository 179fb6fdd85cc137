"""Restricted areas as rows of numbers for ``kernels.tasks.area_shapes``, and the nearest allowed position of a
point.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core.constraints.area import AreaConstraint, AreaShape
from studio.core.kernels.tasks import area_shapes
from studio.core.mesh.distance_field import distance_field
from studio.core.rotations import rotations_about_z, to_matrix

FloatArray = NDArray[np.float64]

AREA_ORIGIN, UPRIGHT = np.zeros(3), np.eye(3)
"""Default position and rotation of an area."""

_SHAPES = {
    AreaShape.HALF_SPACE: area_shapes.HALF_SPACE_SHAPE,
    AreaShape.BOX: area_shapes.BOX_SHAPE,
    AreaShape.SPHERE: area_shapes.SPHERE_SHAPE,
    AreaShape.CYLINDER: area_shapes.CYLINDER_SHAPE,
    AreaShape.TABLE: area_shapes.TABLE_SHAPE,
    AreaShape.MESH: area_shapes.MESH_SHAPE,
}


def area_row(
    constraint: AreaConstraint, centre: FloatArray = AREA_ORIGIN, rotation: FloatArray = UPRIGHT
) -> FloatArray:
    """Row (n,) of an area in the columns of ``kernels.tasks.area_shapes``; the distance field of a mesh follows them.

    The kernel moves the area frame by frame (``place_area``).
    """
    shape = _SHAPES[constraint.shape]
    side = (
        area_shapes.ON_AREA_SURFACE
        if constraint.on_surface
        else area_shapes.INSIDE_AREA
        if constraint.inside
        else area_shapes.OUTSIDE_AREA
    )
    numbers = [shape, side, *centre, *constraint.size, constraint.margin, *rotation.ravel()]
    row = np.array(numbers, dtype=np.float64)
    if constraint.shape is not AreaShape.MESH or constraint.mesh is None:
        return row
    return np.concatenate([row, distance_field(constraint.mesh)])


def fixed_rotation(constraint: AreaConstraint) -> FloatArray:
    """Rotation (3, 3) of a fixed area; that of a half-space takes x to its normal."""
    heading = rotations_about_z(np.array(constraint.heading))
    if constraint.shape is AreaShape.HALF_SPACE:
        return heading
    return np.asarray(heading @ to_matrix(np.array(constraint.tilt)))


def nearest_allowed_position(constraint: AreaConstraint, point: ArrayLike) -> FloatArray:
    """Position (3,) in metres nearest to ``point`` (3,) that a fixed area allows."""
    row = area_row(constraint, np.array(constraint.centre), fixed_rotation(constraint))
    return np.array(area_shapes.nearest_allowed_point(row, np.array(point, dtype=np.float64))[1])
