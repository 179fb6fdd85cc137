"""Triangle meshes on the zero level of a distance field that is symmetric about y = 0."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from studio.core.body.morphology import FloatArray

Field = Callable[[FloatArray], FloatArray]
Triangles = NDArray[np.int64]


def left_half_surface(field: Field, low: FloatArray, high: FloatArray, cell: float) -> tuple[FloatArray, Triangles]:
    """Vertices and triangles of the half y >= 0, open along y = 0, by surface nets (Gibson 1998).

    One vertex lies in each cell that the surface crosses; the first row of cells is centred on y = 0, so the
    open edge lies exactly in the plane of symmetry.
    """
    axes = [np.arange(low[axis], high[axis] + cell, cell) for axis in range(3)]
    axes[1] = np.arange(-cell / 2, high[1] + cell, cell)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = np.concatenate([field(slab.reshape(-1, 3)) for slab in grid]).reshape(grid.shape[:3])
    vertices, index = _cell_vertices(values, grid, cell)
    quads = np.concatenate([_quads(values, index, axis) for axis in range(3)])
    vertices[index[:, 0, :][index[:, 0, :] >= 0], 1] = 0.0
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def whole_surface(vertices: FloatArray, triangles: Triangles) -> tuple[FloatArray, Triangles]:
    """Vertices and triangles of the closed surface: the half y >= 0 and its mirror image, joined along y = 0."""
    on_plane = vertices[:, 1] == 0
    twin = np.where(on_plane, np.arange(len(vertices)), len(vertices) + np.cumsum(~on_plane) - 1)
    reflected = vertices[~on_plane] * [1, -1, 1]
    return np.concatenate([vertices, reflected]), np.concatenate([triangles, twin[triangles][:, ::-1]])


def project(field: Field, vertices: FloatArray, span: float, steps: int = 3) -> FloatArray:
    """``vertices`` moved onto the surface by Newton steps of at most ``span``; those on y = 0 stay there."""
    on_plane = vertices[:, 1] == 0
    for _ in range(steps):
        slope = gradient(field, vertices)
        length = np.linalg.norm(slope, axis=1, keepdims=True)
        reach = field(vertices)[:, None] / np.maximum(length, 0.2)
        vertices = vertices - np.clip(reach, -span, span) * slope / np.maximum(length, 1e-9)
        vertices[on_plane, 1] = 0.0
    return vertices


def gradient(field: Field, points: FloatArray, step: float = 1e-4) -> FloatArray:
    """Gradients (N, 3) of the field by central differences."""
    offsets = step * np.eye(3)
    return np.stack([(field(points + o) - field(points - o)) / (2 * step) for o in offsets], axis=1)


def softened_surface(vertices: FloatArray, triangles: Triangles, rounds: int) -> FloatArray:
    """Vertices of a closed mesh with smoothed creases and the same volume (Taubin 1995: a step in, a step out)."""
    links = vertex_links(triangles, len(vertices))
    for _ in range(rounds):
        for step in (0.50, -0.53):
            vertices = vertices + step * (links @ vertices - vertices)
    return vertices


def vertex_links(triangles: Triangles, count: int) -> csr_array:
    """Sparse matrix (V, V) that averages the neighbours of each vertex."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    shares = 1 / np.bincount(edges[:, 0], minlength=count)[edges[:, 0]]
    return csr_array((shares, (edges[:, 0], edges[:, 1])), shape=(count, count))


def vertex_normals(vertices: FloatArray, triangles: Triangles) -> FloatArray:
    """Unit normals (V, 3): means of the normals of the surrounding faces, weighted by area."""
    corners = vertices[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], across)
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def _cell_vertices(values: FloatArray, grid: FloatArray, cell: float) -> tuple[FloatArray, NDArray[np.int64]]:
    """Mean of the edge crossings of each crossed cell, and the vertex of each cell or -1."""
    shape = tuple(n - 1 for n in values.shape)
    total, count = np.zeros((*shape, 3)), np.zeros(shape)
    for axis in range(3):
        first, second = np.swapaxes(values, 0, axis)[:-1], np.swapaxes(values, 0, axis)[1:]
        crossed = (first < 0) != (second < 0)
        share = np.where(crossed, first / np.where(crossed, first - second, 1), 0)
        place = np.swapaxes(grid, 0, axis)[:-1].copy()
        place[..., axis] += share * cell
        crossed, place = np.swapaxes(crossed, 0, axis), np.swapaxes(place, 0, axis)
        others = [a for a in range(3) if a != axis]
        for i in (0, 1):
            for j in (0, 1):
                window: list[slice] = [slice(None)] * 3
                window[others[0]] = slice(i, i + shape[others[0]])
                window[others[1]] = slice(j, j + shape[others[1]])
                total += np.where(crossed[tuple(window)][..., None], place[tuple(window)], 0)
                count += crossed[tuple(window)]
    index = np.where(count > 0, np.cumsum(count > 0).reshape(shape) - 1, -1)
    return total[count > 0] / count[count > 0][:, None], index


def _quads(values: FloatArray, index: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
    """Cells (Q, 4) around each crossed grid edge along ``axis``, counter-clockwise from outside."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    turned = np.transpose(values, (axis, u, v))
    cells = np.transpose(index, (axis, u, v))
    inside, outside = turned[:-1, 1:-1, 1:-1] < 0, turned[1:, 1:-1, 1:-1] < 0
    around = np.stack([cells[:, :-1, :-1], cells[:, 1:, :-1], cells[:, 1:, 1:], cells[:, :-1, 1:]], axis=-1)
    return np.concatenate([around[inside & ~outside], around[~inside & outside][:, ::-1]])
