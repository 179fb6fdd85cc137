"""A mesh whose points and normals are numpy arrays that VTK reads in place."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints

from studio.document import colours
from studio.viewport.paths import StagePath
from studio.viewport.surfaces import (
    Polydata,
    actor_of,
    bytes_of,
    put_colours,
    put_faces,
    put_lines,
    put_points,
    surface,
)

FloatBuffer = NDArray[np.float32]


class LiveMesh:
    """A polydata over ``points`` and ``normals`` (V, 3): write into them, then call ``touch``."""

    def __init__(self, vertex_count: int, triangles: NDArray[np.integer[Any]]) -> None:
        self.points: FloatBuffer = np.zeros((vertex_count, 3), dtype=np.float32)
        self.normals: FloatBuffer = np.zeros((vertex_count, 3), dtype=np.float32)
        self._vtk_points = vtkPoints()
        self._vtk_points.SetData(numpy_to_vtk(self.points, deep=False))
        self._vtk_normals = numpy_to_vtk(self.normals, deep=False)
        self._parts: list[Polydata] = []
        self.polydata = self.part(triangles)

    def part(self, triangles: NDArray[np.integer[Any]]) -> Polydata:
        """Another polydata over the same points, of these triangles alone."""
        polydata = surface()
        polydata.SetPoints(self._vtk_points)
        polydata.GetPointData().SetNormals(self._vtk_normals)
        put_faces(polydata, np.column_stack([np.full(len(triangles), 3), triangles]))
        self._parts.append(polydata)
        return polydata

    def touch(self) -> None:
        """Tell VTK that the buffers hold new numbers."""
        self._vtk_points.GetData().Modified()
        self._vtk_normals.Modified()
        self._vtk_points.Modified()
        for polydata in self._parts:
            polydata.Modified()


class LiveLines:
    """Coloured paths, as many as each ``show_paths`` is given, in one polydata."""

    def __init__(self, width: float = 2.0) -> None:
        self._polydata = surface()
        self.actor = flat_actor(self._polydata)
        self.actor.GetProperty().SetLineWidth(width)

    def show_paths(self, paths: Sequence[StagePath]) -> None:
        """Draw these paths and no others."""
        self.actor.SetVisibility(bool(paths))
        if not paths:
            return
        ends = np.cumsum([len(path.points) for path in paths])
        first = np.concatenate(
            [np.arange(end - len(path.points), end - 1) for path, end in zip(paths, ends, strict=True)]
        )
        put_points(self._polydata, np.concatenate([path.points for path in paths]))
        put_lines(self._polydata, np.column_stack([first, first + 1]))
        put_colours(self._polydata, _faded(paths))


def flat_actor(polydata: Polydata, colour: str | None = None, culling: bool = False) -> Any:
    """An actor that draws a polydata in the colours of its points, or in one, untouched by light."""
    actor = actor_of(polydata, colour, culling)
    actor.GetProperty().LightingOff()
    return actor


def _faded(paths: Sequence[StagePath]) -> NDArray[np.uint8]:
    full = np.repeat([bytes_of(path.colour) for path in paths], [len(path.points) for path in paths], axis=0)
    strength, away = np.concatenate([path.strength for path in paths]), np.array(bytes_of(colours.BAR))
    return np.round(away + np.clip(strength, 0, 1)[:, None] * (full - away)).astype(np.uint8)
