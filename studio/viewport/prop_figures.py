"""What props look like: meshes within a cube of one metre, to be scaled to a prop's size."""

from functools import cache
from typing import Any

import numpy as np
import pyvista as pv

from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.stage.prop import Prop, PropShape

TOP, LEG = 0.08, 0.09
"""Of a table: the thickness of its top in parts of its height, of its legs in parts of its length and width."""
STEPS = 4


def unit_mesh(prop: Prop) -> Any:
    """The surface of a prop's shape; faces share no corners where edges are sharp."""
    if prop.shape is PropShape.MESH and prop.mesh is not None:
        return fitted(prop.mesh)
    return _made(prop.shape)


@cache
def _made(shape: PropShape) -> Any:
    match shape:
        case PropShape.BALL:
            return pv.Sphere(radius=0.5, theta_resolution=36, phi_resolution=24)
        case PropShape.STICK:
            return pv.Cylinder(direction=(0.0, 0.0, 1.0), radius=0.5, height=1.0, resolution=24)
        case PropShape.TABLE:
            legs = [(x, y) for x in (-0.5, 0.5 - LEG) for y in (-0.5, 0.5 - LEG)]
            top = ((-0.5, -0.5, 0.5 - TOP), (0.5, 0.5, 0.5))
            return _boxes([top, *(((x, y, -0.5), (x + LEG, y + LEG, 0.5 - TOP)) for x, y in legs)])
        case PropShape.STAIRS:
            edges = np.linspace(-0.5, 0.5, STEPS + 1).tolist()
            return _boxes([((edges[k], -0.5, -0.5), (edges[k + 1], 0.5, edges[k + 1])) for k in range(STEPS)])
    return _boxes([((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))])


def fitted(mesh: TriangleMesh) -> Any:
    """A mesh in the middle of the cube, as long as it in every direction in which it is not flat."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    size = np.where(high - low > 1e-9, high - low, 1.0)
    faces = np.column_stack([np.full(len(mesh.triangles), 3), mesh.triangles])
    return pv.PolyData((mesh.vertices - (low + high) / 2) / size, faces.reshape(-1))


def _boxes(corners: list[tuple[tuple[float, ...], tuple[float, ...]]]) -> Any:
    """Boxes from one corner to the opposite one; each face has corners of its own."""
    points = [np.array(low) + face * (np.array(high) - np.array(low)) for low, high in corners for face in _FACES]
    count = len(points)
    quads = np.column_stack([np.full(count, 4), np.arange(4 * count).reshape(-1, 4)])
    return pv.PolyData(np.concatenate(points), quads.reshape(-1))


_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_FACES = [
    np.insert(_SQUARE if bool(side) != (axis == 1) else _SQUARE[::-1], axis, side, axis=1)
    for axis in (0, 1, 2)
    for side in (0.0, 1.0)
]
"""(4, 3) corners of each face of a cube of one metre, seen from outside counter-clockwise."""
