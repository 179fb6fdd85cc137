"""Shapes of VRML and X3D as triangles."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.io.hanim.scene import SceneNode
from studio.io.meshes.shapes import face_normals, smooth_normals, unit

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_AROUND = 24
_CREASE = 0.5
"""Radians: a crease angle below makes a shape's faces flat."""


@dataclass(frozen=True, eq=False)
class ShapeSurface:
    """Triangle mesh of a shape; ``points`` (V,) is the index of each vertex in the coordinates of the shape."""

    vertices: FloatArray
    normals: FloatArray
    coordinates: FloatArray
    triangles: IntArray
    points: IntArray
    two_sided: bool = False


def surface_of(geometry: SceneNode, smooth: bool = False) -> ShapeSurface | None:
    """Surface of a geometry node; None for one without a surface (lines, text). ``smooth`` overrides its
    crease angle.
    """
    match geometry.kind:
        case "IndexedFaceSet":
            return _faces(geometry, *_polygons(geometry, "coordIndex"), smooth)
        case "IndexedTriangleSet" | "TriangleSet":
            count = len(_points(geometry)) if geometry.kind == "TriangleSet" else -1
            index = np.arange(count) if count >= 0 else _whole(geometry, "index")
            corners = index[: len(index) // 3 * 3].reshape(-1, 3)
            return _faces(geometry, corners, corners, smooth)
        case "Box":
            return _box(geometry.vector("size", (2.0, 2.0, 2.0)))
        case "Sphere":
            radius = geometry.vector("radius", (1.0,))[0]
            angles = np.linspace(-np.pi / 2, np.pi / 2, _AROUND // 2 + 1)
            return _turned(radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))
        case "Cylinder":
            radius, half = geometry.vector("radius", (1.0,))[0], geometry.vector("height", (2.0,))[0] / 2
            return _turned(np.array([[0, -half], [radius, -half], [radius, half], [0, half]]), flat=True)
        case "Cone":
            radius, half = geometry.vector("bottomRadius", (1.0,))[0], geometry.vector("height", (2.0,))[0] / 2
            return _turned(np.array([[0, -half], [radius, -half], [0, half]]), flat=True)
    return None


def _points(geometry: SceneNode) -> FloatArray:
    coord = geometry.node("coord")
    return coord.numbers("point", 3) if coord is not None else np.empty((0, 3))


def _whole(geometry: SceneNode, name: str) -> IntArray:
    return geometry.numbers(name)[:, 0].astype(np.int64)


def _polygons(geometry: SceneNode, name: str) -> tuple[IntArray, IntArray]:
    """Corners (T, 3) of the triangulated polygons, and the index of each corner in the list."""
    index = _whole(geometry, name)
    starts, ends = _runs(index)
    corners, places = [], []
    for count in np.unique(ends - starts):
        if count < 3:
            continue
        first = starts[ends - starts == count]
        fan = np.array([[0, k, k + 1] for k in range(1, count - 1)])
        where = (first[:, None, None] + fan).reshape(-1, 3)
        places.append(where)
        corners.append(index[where])
    if not corners:
        return np.empty((0, 3), np.int64), np.empty((0, 3), np.int64)
    return np.concatenate(corners), np.concatenate(places)


def _runs(index: IntArray) -> tuple[IntArray, IntArray]:
    """Begin and end of each stretch between numbers below zero."""
    stops = np.concatenate([np.flatnonzero(index < 0), [len(index)]])
    return np.concatenate([[0], stops[:-1] + 1]), stops


def _faces(geometry: SceneNode, corners: IntArray, places: IntArray, smooth: bool) -> ShapeSurface | None:
    points = _points(geometry)
    if not len(corners) or not len(points):
        return None
    if corners.min() < 0 or corners.max() >= len(points):
        raise StudioError(
            f"{geometry.where}: a face names point {corners.max()}, and there are {len(points)}. Export the file again."
        )
    if not geometry.flag("ccw", True):
        corners, places = corners[:, ::-1], places[:, ::-1]
    textured = geometry.node("texCoord")
    coordinates = textured.numbers("point", 2) if textured is not None else np.empty((0, 2))
    named = _whole(geometry, "texCoordIndex") if geometry.kind == "IndexedFaceSet" else np.empty(0, np.int64)
    texture = named[places] if len(named) > places.max() else corners
    if not len(coordinates) or texture.min() < 0 or texture.max() >= len(coordinates):
        coordinates, texture = np.zeros((1, 2)), np.zeros_like(corners)
    smooth = smooth or geometry.vector("creaseAngle", (0.0,))[0] >= _CREASE
    two_sided = not geometry.flag("solid", True)
    if smooth:
        pairs, inverse = np.unique(np.stack([corners.ravel(), texture.ravel()]), axis=1, return_inverse=True)
        triangles, chosen, places_in_texture = inverse.reshape(-1, 3), pairs[0], pairs[1]
        vertices = points[chosen]
        normals = smooth_normals(vertices, triangles)
    else:
        chosen, places_in_texture = corners.ravel(), texture.ravel()
        vertices, triangles = points[chosen], np.arange(corners.size).reshape(-1, 3)
        normals = np.repeat(unit(face_normals(vertices, triangles)), 3, axis=0)
    return ShapeSurface(vertices, normals, coordinates[places_in_texture], triangles, chosen, two_sided)


def _box(size: FloatArray) -> ShapeSurface:
    """Six faces that share no corner."""
    face = np.array([[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
    cycles = [np.roll(np.eye(3), turn, axis=0) for turn in range(3)]
    turns = [*cycles, *(cycle @ np.diag([-1.0, 1.0, -1.0]) for cycle in cycles)]
    vertices = np.concatenate([face @ turn for turn in turns])
    normals = np.concatenate([np.tile(np.array([0.0, 0.0, 1.0]) @ turn, (4, 1)) for turn in turns])
    triangles = np.concatenate([np.array([[0, 1, 2], [0, 2, 3]]) + 4 * index for index in range(6)])
    return ShapeSurface(vertices * size / 2, normals, np.zeros((24, 2)), triangles, np.arange(24))


def _turned(profile: FloatArray, flat: bool = False) -> ShapeSurface:
    """Surface of revolution about Y of ``profile`` (N, 2), radius and height from below upwards; ``flat`` keeps its
    edges.
    """
    stretches = [profile[k : k + 2] for k in range(len(profile) - 1)] if flat else [profile]
    vertices, normals, triangles = [], [], []
    around = np.arange(_AROUND)
    following = (around + 1) % _AROUND
    first = 0
    for stretch in stretches:
        along = stretch[1] - stretch[0]
        outward = np.tile([along[1], -along[0]], (2, 1)) if flat else stretch
        vertices.append(_ring(stretch))
        normals.append(unit(_ring(outward)))
        for row in range(len(stretch) - 1):
            low, high = first + row * _AROUND, first + (row + 1) * _AROUND
            triangles.append(np.stack([low + around, low + following, high + following], axis=1))
            triangles.append(np.stack([low + around, high + following, high + around], axis=1))
        first += len(stretch) * _AROUND
    points = np.concatenate(vertices)
    faces = np.concatenate(triangles)
    return ShapeSurface(points, np.concatenate(normals), np.zeros((len(points), 2)), faces, np.arange(len(points)))


def _ring(profile: FloatArray) -> FloatArray:
    """(N * around, 3) points of each row of radius and height round Y."""
    angles = np.linspace(0.0, 2 * np.pi, _AROUND, endpoint=False)
    radius, height = profile[:, :1], np.repeat(profile[:, 1:], _AROUND, axis=1)
    return np.stack([radius * np.cos(angles), height, -radius * np.sin(angles)], axis=-1).reshape(-1, 3)
