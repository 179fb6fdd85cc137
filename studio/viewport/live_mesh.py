"""Meshes whose numpy arrays VTK reads in place."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints

from studio.document import colours
from studio.viewport.paths import StagePath

FloatBuffer = NDArray[np.float32]


class LiveMesh:
    """VTK mesh over the arrays ``points`` and ``normals`` (V, 3): write into them, then call ``touch``."""

    def __init__(self, vertex_count: int, triangles: NDArray[np.integer]) -> None:
        self.points: FloatBuffer = np.zeros((vertex_count, 3), dtype=np.float32)
        self.normals: FloatBuffer = np.zeros((vertex_count, 3), dtype=np.float32)
        self._vtk_points = vtkPoints()
        self._vtk_points.SetData(numpy_to_vtk(self.points, deep=False))
        self._vtk_normals = numpy_to_vtk(self.normals, deep=False)
        self._parts: list[pv.PolyData] = []
        self.polydata = self.part(triangles)

    def part(self, triangles: NDArray[np.integer]) -> pv.PolyData:
        """VTK mesh over the same points, with only these triangles."""
        polydata = pv.PolyData()
        polydata.SetPoints(self._vtk_points)
        polydata.GetPointData().SetNormals(self._vtk_normals)
        polydata.faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
        self._parts.append(polydata)
        return polydata

    def touch(self) -> None:
        """Notify VTK that the arrays have changed."""
        self._vtk_points.GetData().Modified()
        self._vtk_normals.Modified()
        self._vtk_points.Modified()
        for polydata in self._parts:
            polydata.Modified()


class LiveLines:
    """Coloured lines in one VTK mesh."""

    def __init__(self, width: float = 2.0) -> None:
        self._polydata = pv.PolyData()
        self.actor = flat_actor(self._polydata)
        self.actor.prop.line_width = width
        self._lengths: list[int] = []
        self._colours = np.empty((0, 3), dtype=np.uint8)

    def show_paths(self, paths: Sequence[StagePath]) -> None:
        """Show exactly these paths."""
        self.actor.SetVisibility(bool(paths))
        if not paths:
            return
        self._polydata.points = np.concatenate([path.points for path in paths]).astype(np.float32)
        lengths, tints = [len(path.points) for path in paths], _faded(paths)
        if lengths != self._lengths:  # else only places have changed, as under a hand
            self._lengths = lengths
            ends = np.cumsum(lengths)
            first = np.concatenate([np.arange(end - n, end - 1) for n, end in zip(lengths, ends, strict=True)])
            self._polydata.lines = np.column_stack([np.full(len(first), 2), first, first + 1]).ravel()
        if not np.array_equal(tints, self._colours):
            self._colours = tints
            self._polydata.point_data["colour"] = tints
            self._polydata.point_data.active_scalars_name = "colour"


def flat_actor(polydata: pv.PolyData) -> pv.Actor:
    """Actor that draws a mesh in the colours of its points, without lighting."""
    mapper = pv.DataSetMapper(polydata)
    mapper.SetColorModeToDirectScalars()
    mapper.scalar_visibility = True
    actor = pv.Actor(mapper=mapper)
    actor.prop.lighting = False
    return actor


@lru_cache
def _bytes_of(hue: str) -> tuple[int, int, int]:
    red, green, blue = pv.Color(hue).int_rgb
    return red, green, blue


def _faded(paths: Sequence[StagePath]) -> NDArray[np.uint8]:
    full = np.repeat([_bytes_of(path.colour) for path in paths], [len(path.points) for path in paths], axis=0)
    strength, away = np.concatenate([path.opacity for path in paths]), np.array(_bytes_of(colours.STAGE_BAR))
    bytes_: NDArray[np.uint8] = np.round(away + np.clip(strength, 0, 1)[:, None] * (full - away)).astype(np.uint8)
    return bytes_
