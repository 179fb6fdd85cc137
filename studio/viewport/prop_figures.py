"""VTK surfaces of props in a unit cube, to be scaled to a prop's size."""

from typing import Any

import pyvista as pv

from studio.core.stage.prop import Prop, PropShape
from studio.core.stage.prop_shapes import FloatArray, fitted_to_cube, unit_surface


def unit_mesh(prop: Prop) -> pv.PolyData:
    """Surface of a prop's shape in a cube of one metre; faces do not share vertices at sharp edges."""
    if prop.shape is PropShape.MESH and prop.mesh is not None:
        return _polygons(fitted_to_cube(prop.mesh), prop.mesh.triangles)
    surface = unit_surface(prop.shape)
    mesh = _polygons(surface.vertices, surface.triangles)
    mesh.point_data.active_normals = surface.normals
    return mesh


def _polygons(vertices: FloatArray, triangles: Any) -> pv.PolyData:
    surface: pv.PolyData = pv.PolyData.from_regular_faces(vertices, triangles)
    return surface
