"""Surfaces of props in a cube of one metre, which are scaled to the size of a prop."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.core.stage.prop import Prop, PropShape

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

PROP_COLOUR = "#8a8f96"
TABLE_TOP_FRACTION, TABLE_LEG_FRACTION = 0.08, 0.09
"""Thickness of a table top as a fraction of the table's height, and of a leg as a fraction of length and width."""
STAIR_COUNT = 4
"""Number of steps of stairs."""
_AROUND, _DOWN = 36, 24
"""Edges of a ball around its axis and from pole to pole."""
_SIDES = 24
"""Number of sides of a stick."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangle mesh for display: ``vertices`` (V, 3), unit ``normals`` (V, 3) and ``triangles`` (T, 3), seen
    counter-clockwise from outside.

    Faces share no vertices where edges are sharp.
    """

    vertices: FloatArray
    normals: FloatArray
    triangles: IntArray


def prop_surface(prop: Prop) -> Surface:
    """Surface of a prop in metres about its centre."""
    unit = _flat(prop.mesh) if prop.shape is PropShape.MESH and prop.mesh is not None else unit_surface(prop.shape)
    size = np.array(prop.size)
    normals = unit.normals / size
    return Surface(unit.vertices * size, normals / np.linalg.norm(normals, axis=1, keepdims=True), unit.triangles)


@cache
def unit_surface(shape: PropShape) -> Surface:
    """Surface of a shape in a cube of one metre; a box for a prop with its own mesh."""
    match shape:
        case PropShape.BALL:
            return _ball()
        case PropShape.STICK:
            return _stick()
        case PropShape.TABLE:
            legs = [(x, y) for x in (-0.5, 0.5 - TABLE_LEG_FRACTION) for y in (-0.5, 0.5 - TABLE_LEG_FRACTION)]
            top = ((-0.5, -0.5, 0.5 - TABLE_TOP_FRACTION), (0.5, 0.5, 0.5))
            return _boxes(
                [
                    top,
                    *(
                        ((x, y, -0.5), (x + TABLE_LEG_FRACTION, y + TABLE_LEG_FRACTION, 0.5 - TABLE_TOP_FRACTION))
                        for x, y in legs
                    ),
                ]
            )
        case PropShape.STAIRS:
            edges = np.linspace(-0.5, 0.5, STAIR_COUNT + 1).tolist()
            return _boxes([((edges[k], -0.5, -0.5), (edges[k + 1], 0.5, edges[k + 1])) for k in range(STAIR_COUNT)])
    return _boxes([((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))])


def fitted_to_cube(mesh: TriangleMesh) -> FloatArray:
    """Vertices (V, 3) of a mesh, centred in the cube of one metre and scaled to it in every direction in which the mesh
    is not flat.
    """
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return np.asarray((mesh.vertices - (low + high) / 2) / np.where(high - low > 1e-9, high - low, 1.0))


def _flat(mesh: TriangleMesh) -> Surface:
    """Surface of a mesh with flat shading: its faces do not share vertices."""
    corners = fitted_to_cube(mesh)[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Surface(corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), np.arange(3 * len(corners)).reshape(-1, 3))


def _ball() -> Surface:
    around, down = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, _AROUND + 1), np.linspace(0.0, np.pi, _DOWN + 1))
    normals = np.stack([np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)], axis=-1)
    triangles = _grid(_DOWN, _AROUND)
    kept = triangles[[len(np.unique(corners.round(9), axis=0)) == 3 for corners in normals.reshape(-1, 3)[triangles]]]
    return Surface(0.5 * normals.reshape(-1, 3), normals.reshape(-1, 3), kept)


def _stick() -> Surface:
    angles = np.linspace(0.0, 2.0 * np.pi, _SIDES + 1)
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros(_SIDES + 1)], axis=1)
    half = np.array([0.0, 0.0, 0.5])
    side = np.concatenate([0.5 * rim + half, 0.5 * rim - half])
    parts = [Surface(side, np.concatenate([rim, rim]), _grid(1, _SIDES))]
    for sign in (1.0, -1.0):
        cap = np.concatenate([[sign * half], 0.5 * rim + sign * half])
        fan = np.array([[0, k, k + 1] if sign > 0.0 else [0, k + 1, k] for k in range(1, _SIDES + 1)])
        parts.append(Surface(cap, np.tile([0.0, 0.0, sign], (len(cap), 1)), fan))
    return _joined(parts)


def _grid(rows: int, columns: int) -> IntArray:
    """(T, 3) triangles of a grid of (rows + 1) x (columns + 1) vertices, rows from above, columns to the left."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    below = first + columns + 1
    return np.concatenate([np.column_stack([first, below, below + 1]), np.column_stack([first, below + 1, first + 1])])


def _boxes(corners: list[tuple[tuple[float, ...], tuple[float, ...]]]) -> Surface:
    """Surface of boxes, each given by two opposite corners; their faces do not share vertices."""
    two = np.array([[0, 1, 2], [0, 2, 3]])
    return _joined(
        [
            Surface(np.array(low) + face * (np.array(high) - np.array(low)), np.tile(normal, (4, 1)), two)
            for low, high in corners
            for face, normal in zip(_FACES, _NORMALS, strict=True)
        ]
    )


def _joined(parts: list[Surface]) -> Surface:
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Surface(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, first, strict=False)]),
    )


_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_FACES = [
    np.insert(_SQUARE if bool(side) != (axis == 1) else _SQUARE[::-1], axis, side, axis=1)
    for axis in (0, 1, 2)
    for side in (0.0, 1.0)
]
"""(4, 3) corners of each face of a cube of one metre, seen from outside counter-clockwise."""
_NORMALS = [np.eye(3)[axis] * sign for axis in (0, 1, 2) for sign in (-1.0, 1.0)]
