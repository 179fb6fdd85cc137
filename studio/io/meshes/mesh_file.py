"""Triangle meshes from OBJ, STL and PLY files, in metres, Z up and X forward."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studio.core.errors import StudioError
from studio.core.mesh.triangle_mesh import TriangleMesh
from studio.io.meshes.obj import read_obj
from studio.io.meshes.ply import read_ply
from studio.io.meshes.stl import read_stl
from studio.io.meshes.triangles import MeshError, Points, Triangles
from studio.io.referenced_files import path_beside, read_bytes

_READERS: dict[str, Callable[[bytes], tuple[Points, Triangles]]] = {
    ".obj": read_obj,
    ".stl": read_stl,
    ".ply": read_ply,
}
MESH_SUFFIXES = tuple(_READERS)
LARGEST_MESH_BYTES = 200_000_000
"""Maximum size of a mesh file in bytes."""
Y_UP_SUFFIXES = (".obj",)
"""Suffixes of formats whose programs mostly write Y up."""
UNITS_BY_LONGEST_SIDE = ((12.0, 1.0, "metres"), (1500.0, 0.01, "centimetres"), (np.inf, 0.001, "millimetres"))
"""Longest side of a mesh up to which its numbers are taken for metres, centimetres and millimetres; with the unit in
metres.
"""
_TO_Z_UP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class MeshFile:
    """Mesh of a file, and the guesses about it in words."""

    mesh: TriangleMesh
    guesses: str


def read_mesh(path: Path) -> MeshFile:
    """Mesh in a file; unit and up axis are guessed by size and format. Raises StudioError, which names the file."""
    suffix = path.suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise StudioError(f"{path}: a mesh is read from {', '.join(MESH_SUFFIXES)}, not from '{suffix}'.")
    points, triangles = _triangles_of(path)
    if not np.isfinite(points).all():
        raise StudioError(f"{path} is not readable as a mesh: a vertex is not finite. Export the mesh again.")
    side = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    factor, unit = next((factor, unit) for most, factor, unit in UNITS_BY_LONGEST_SIDE if not side > most)
    up = "Y" if suffix in Y_UP_SUFFIXES else "Z"
    try:
        mesh = TriangleMesh(factor * (points @ _TO_Z_UP.T if up == "Y" else points), triangles)
    except ValueError as error:
        raise StudioError(f"{path}: {error}") from error
    size = " x ".join(f"{edge:.2f}" for edge in np.ptp(mesh.vertices, axis=0))
    return MeshFile(mesh, f"{len(mesh.triangles)} triangles, {size} m; read as {unit}, {up} up")


def read_mesh_beside(name: str, beside: Path, where: str) -> MeshFile:
    """Mesh in a file that another file names, in the folder of that file; errors begin with ``where``."""
    path = path_beside(name, beside, where)
    try:
        return read_mesh(path)
    except StudioError as error:
        raise StudioError(f"{where}: {error}") from error


def _triangles_of(path: Path) -> tuple[np.ndarray, np.ndarray]:
    content = read_bytes(path, LARGEST_MESH_BYTES)
    try:
        points, triangles = _READERS[path.suffix.lower()](content)
    except MeshError as error:
        raise StudioError(f"{path} is not readable as a mesh: {error}. Export the mesh again.") from error
    if not len(triangles):
        raise StudioError(f"{path} holds no triangle. Export the mesh again.")
    return points, triangles
