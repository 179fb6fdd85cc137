"""Points, cells and colours as VTK draws them: the few of its classes that the stage takes, in short words.

Wrappers of all of VTK take a second to import, a third of what a first start may take until bodies are seen.
"""

from typing import Any

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 - what VTK draws with
from numpy.typing import ArrayLike, NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersSources import vtkCylinderSource, vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkTexture

Polydata = Any
"""VTK's classes have no types."""


def surface(points: ArrayLike | None = None, faces: ArrayLike | None = None) -> Polydata:
    """A polydata, empty or of ``points`` (N, 3) and ``faces`` (F, 1 + corners), how many corners first."""
    made = vtkPolyData()
    if points is not None:
        put_points(made, points)
    if faces is not None:
        put_faces(made, faces)
    return made


def points_of(polydata: Polydata) -> NDArray[Any]:
    """(N, 3), as VTK has them."""
    return np.asarray(vtk_to_numpy(polydata.GetPoints().GetData()))


def put_points(polydata: Polydata, points: ArrayLike) -> None:
    """(N, 3) float32, in place of those there."""
    held = vtkPoints()
    held.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=np.float32), deep=True))
    polydata.SetPoints(held)


def put_faces(polydata: Polydata, faces: ArrayLike) -> None:
    """(F, 1 + corners), how many corners first."""
    polydata.SetPolys(_cells(faces))


def put_lines(polydata: Polydata, pairs: ArrayLike) -> None:
    """(L, 2) the points at the ends of each line."""
    ends = np.asarray(pairs)
    polydata.SetLines(_cells(np.column_stack([np.full(len(ends), 2), ends])))


def put_colours(polydata: Polydata, hues: NDArray[np.uint8]) -> None:
    """(N, 3) a colour for each point."""
    polydata.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(hues), deep=True))


def put_coordinates(polydata: Polydata, places: ArrayLike) -> None:
    """(N, 2) where on its texture each point lies."""
    polydata.GetPointData().SetTCoords(numpy_to_vtk(np.ascontiguousarray(places, dtype=np.float32), deep=True))


def ball(radius: float, around: int, upwards: int) -> Polydata:
    """With normals."""
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetThetaResolution(around)
    source.SetPhiResolution(upwards)
    source.Update()
    return source.GetOutput()


def upright_cylinder(radius: float, height: float, around: int) -> Polydata:
    """Closed, with normals, about z; VTK's own stands about y."""
    source = vtkCylinderSource()
    source.SetRadius(radius)
    source.SetHeight(height)
    source.SetResolution(around)
    source.Update()
    made = source.GetOutput()
    for array in (made.GetPoints().GetData(), made.GetPointData().GetNormals()):
        values = vtk_to_numpy(array)
        values[:] = np.stack([values[:, 0], -values[:, 2], values[:, 1]], axis=1)
    return made


def actor_of(polydata: Polydata, colour: str | None = None, culling: bool = False) -> Any:
    """What draws a polydata in one ``colour``, or in those of its points; ``culling``: not seen from behind."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(polydata)
    mapper.SetScalarVisibility(colour is None)
    mapper.SetColorModeToDirectScalars()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetBackfaceCulling(culling)
    if colour is not None:
        paint(actor, colour)
    return actor


def paint(actor: Any, colour: str) -> None:
    """In ``#RRGGBB``."""
    actor.GetProperty().SetColor(*(np.array(bytes_of(colour)) / 255.0))


def bytes_of(colour: str) -> tuple[int, int, int]:
    """Red, green and blue of ``#RRGGBB``."""
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue


def matrix_of(values: NDArray[np.float64]) -> Any:
    """(4, 4) as VTK has it."""
    matrix = vtkMatrix4x4()
    matrix.DeepCopy(values.ravel().tolist())
    return matrix


def texture_of(pixels: NDArray[np.uint8]) -> Any:
    """(rows, columns, channels), from the top down."""
    picture = vtkImageData()
    picture.SetDimensions(pixels.shape[1], pixels.shape[0], 1)
    rows = np.ascontiguousarray(pixels[::-1]).reshape(-1, pixels.shape[2])
    picture.GetPointData().SetScalars(numpy_to_vtk(rows, deep=True))
    texture = vtkTexture()
    texture.SetInputData(picture)
    return texture


def _cells(counted: ArrayLike) -> Any:
    cells = vtkCellArray()
    flat = np.ascontiguousarray(counted, dtype=np.int64).ravel()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(flat, deep=True))
    return cells
