"""Remeshing of a surface with even triangles of given size: split, collapse, flip, relax (Botsch and Kobbelt 2004).

The mesh is the half y >= 0 of a body; its open edge, the vertices with y = 0, stays in that plane.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from studio.core.body.morphology import FloatArray
from studio.core.mannequin.surface import Triangles

Sizes = Callable[[FloatArray], FloatArray]
"""Function that returns the desired edge length at points."""
Onto = Callable[[FloatArray], FloatArray]
"""Function that projects points onto the surface."""


def remeshed_surface(
    vertices: FloatArray, triangles: Triangles, sizes: Sizes, onto: Onto, rounds: int
) -> tuple[FloatArray, Triangles]:
    """Vertices and triangles of a mesh with edges about ``sizes(points)`` long.

    ``onto`` projects relaxed vertices onto the surface.
    """
    mesh = _Mesh(vertices, triangles)
    for _ in range(rounds):
        wanted = sizes(np.array(mesh.points)).tolist()
        _collapse_short(mesh, wanted)
        _split_long(mesh, wanted)
        _flip_uneven(mesh)
        vertices, triangles = mesh.compact()
        vertices = onto(_relaxed(vertices, triangles, sizes(vertices)))
        mesh = _Mesh(vertices, triangles)
    return vertices, triangles


class _Mesh:
    """Mutable mesh: triangles, and the faces around each vertex."""

    def __init__(self, vertices: FloatArray, triangles: Triangles) -> None:
        self.points: list[FloatArray] = list(vertices)
        self.open: list[bool] = (vertices[:, 1] == 0).tolist()
        self.faces: list[tuple[int, int, int] | None] = [(a, b, c) for a, b, c in triangles.tolist()]
        self.around: list[set[int]] = [set() for _ in vertices]
        for index, face in enumerate(self.faces):
            for vertex in face or ():
                self.around[vertex].add(index)

    def corners(self, face: int) -> tuple[int, int, int]:
        found = self.faces[face]
        assert found is not None
        return found

    def neighbours(self, vertex: int) -> set[int]:
        found = {other for face in self.around[vertex] for other in self.corners(face)}
        found.discard(vertex)
        return found

    def edges(self) -> list[tuple[int, int]]:
        found = {
            (min(a, b), max(a, b))
            for face in self.faces
            if face
            for a, b in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0]))
        }
        return sorted(found)

    def length(self, a: int, b: int) -> float:
        difference = self.points[a] - self.points[b]
        return float(np.sqrt(difference @ difference))

    def put(self, face: int, corners: tuple[int, int, int]) -> None:
        """Set the corners of ``face``."""
        self.drop(face)
        self.faces[face] = corners
        for vertex in corners:
            self.around[vertex].add(face)

    def drop(self, face: int) -> None:
        for vertex in self.faces[face] or ():
            self.around[vertex].discard(face)
        self.faces[face] = None

    def add_point(self, point: FloatArray, is_open: bool) -> int:
        self.points.append(point)
        self.open.append(is_open)
        self.around.append(set())
        return len(self.points) - 1

    def normal(self, corners: tuple[int, int, int]) -> tuple[float, float, float]:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (self.points[vertex] for vertex in corners)
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx

    def compact(self) -> tuple[FloatArray, Triangles]:
        triangles = np.array([face for face in self.faces if face])
        used, renumbered = np.unique(triangles, return_inverse=True)
        return np.array(self.points)[used], renumbered.reshape(-1, 3)


def _collapse_short(mesh: _Mesh, wanted: list[float]) -> None:
    edges = mesh.edges()
    edges.sort(key=lambda edge: mesh.length(*edge) / (wanted[edge[0]] + wanted[edge[1]]))
    for gone, kept in edges:
        if not mesh.around[gone] or not mesh.around[kept]:
            continue
        size = (wanted[gone] + wanted[kept]) / 2
        if mesh.length(gone, kept) < 0.8 * size:
            _collapse(mesh, gone, kept, 1.35 * size)


def _collapse(mesh: _Mesh, gone: int, kept: int, longest: float) -> None:
    """Collapse an edge unless that would fold, pinch or coarsen the surface."""
    shared = mesh.around[gone] & mesh.around[kept]
    if mesh.open[gone] and mesh.open[kept] and len(shared) != 1:
        return
    if mesh.open[gone] and not mesh.open[kept]:
        gone, kept = kept, gone
    around_gone, around_kept = mesh.neighbours(gone), mesh.neighbours(kept)
    if not shared or len(around_gone & around_kept) != len(shared) or len(around_gone) < 4:
        return
    place = (
        mesh.points[kept] if mesh.open[kept] and not mesh.open[gone] else (mesh.points[gone] + mesh.points[kept]) / 2
    )
    ring = np.array([mesh.points[v] for v in (around_gone | around_kept) - {gone, kept}])
    if (((ring - place) ** 2).sum(axis=1) > longest**2).any():
        return
    turning = (mesh.around[gone] | mesh.around[kept]) - shared
    before = {face: mesh.normal(mesh.corners(face)) for face in turning}
    old = mesh.points[gone], mesh.points[kept]
    mesh.points[gone] = mesh.points[kept] = place
    if any(not _same_way(before[face], mesh.normal(mesh.corners(face))) for face in turning):
        mesh.points[gone], mesh.points[kept] = old
        return
    for face in shared:
        mesh.drop(face)
    for face in list(mesh.around[gone]):
        a, b, c = (kept if vertex == gone else vertex for vertex in mesh.corners(face))
        mesh.put(face, (a, b, c))


def _same_way(a: tuple[float, float, float], b: tuple[float, float, float]) -> bool:
    """True if two normals point within 60 degrees of each other."""
    dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    lengths = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2])
    return dot > 0 and dot * dot > 0.25 * lengths


def _split_long(mesh: _Mesh, wanted: list[float]) -> None:
    for a, b in mesh.edges():
        if mesh.length(a, b) <= 4 / 3 * (wanted[a] + wanted[b]) / 2:
            continue
        shared = mesh.around[a] & mesh.around[b]
        middle = mesh.add_point((mesh.points[a] + mesh.points[b]) / 2, len(shared) == 1)
        for face in shared:
            p, q, r = mesh.corners(face)
            mesh.put(face, (middle if p == a else p, middle if q == a else q, middle if r == a else r))
            mesh.faces.append(None)
            mesh.put(
                len(mesh.faces) - 1,
                (middle if p == b else p, middle if q == b else q, middle if r == b else r),
            )


def _flip_uneven(mesh: _Mesh) -> None:
    """Flip edges where that brings vertices nearer to six neighbours, or four on the open edge."""
    for a, b in mesh.edges():
        shared = mesh.around[a] & mesh.around[b]
        if len(shared) != 2:
            continue
        first, second = sorted(shared)
        corners = mesh.corners(first)
        if corners[(corners.index(a) + 1) % 3] != b:
            first, second = second, first
        (c,), (d,) = set(mesh.corners(first)) - {a, b}, set(mesh.corners(second)) - {a, b}
        if mesh.around[c] & mesh.around[d]:
            continue
        before = sum(_unevenness(mesh, vertex, 0) for vertex in (a, b, c, d))
        after = sum(_unevenness(mesh, v, -1) for v in (a, b)) + sum(_unevenness(mesh, v, 1) for v in (c, d))
        new = (a, d, c), (d, b, c)
        old = [mesh.normal(mesh.corners(face)) for face in (first, second)]
        if after < before and all(_same_way(o, mesh.normal(n)) for o in old for n in new):
            mesh.put(first, new[0])
            mesh.put(second, new[1])


def _unevenness(mesh: _Mesh, vertex: int, change: int) -> int:
    """Squared deviation from the ideal number of faces round a vertex: six, or three on the open edge."""
    return (len(mesh.around[vertex]) + change - (3 if mesh.open[vertex] else 6)) ** 2


def _relaxed(vertices: FloatArray, triangles: Triangles, size: FloatArray) -> FloatArray:
    """Vertices moved towards the centres of the faces around them, to even out the faces."""
    corners = vertices[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    weight = area / size[triangles].mean(axis=1) ** 2
    total, mass = np.zeros_like(vertices), np.zeros(len(vertices))
    for corner in range(3):
        np.add.at(total, triangles[:, corner], corners.mean(axis=1) * weight[:, None])
        np.add.at(mass, triangles[:, corner], weight)
    moved = total / mass[:, None]
    is_open = vertices[:, 1] == 0
    moved[is_open] = _open_neighbours_mean(vertices, triangles, is_open)[is_open]
    return np.asarray(vertices + 0.8 * (moved - vertices))


def _open_neighbours_mean(vertices: FloatArray, triangles: Triangles, is_open: NDArray[np.bool_]) -> FloatArray:
    """Mean of the two neighbours along the open edge."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    rim = unique[count == 1]
    total, number = np.zeros_like(vertices), np.zeros(len(vertices))
    for here, there in (rim.T, rim.T[::-1]):
        np.add.at(total, here, vertices[there])
        np.add.at(number, here, 1)
    return np.asarray(total / np.maximum(number, 1)[:, None])
