"""STL, binary or text: triangles by their corners."""

import re

import numpy as np

from studio.io.meshes.triangles import MeshError, Points, Triangles

_HEAD = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
_VERTEX = re.compile(rb"^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.MULTILINE)


def read_stl(content: bytes) -> tuple[Points, Triangles]:
    """Points (3 T, 3) and triangles (T, 3), no point shared. Raises MeshError."""
    count = int.from_bytes(content[80:_HEAD], "little")
    if content[:5] == b"solid" and len(content) != _HEAD + count * _FACET.itemsize:
        points = _of_text(content)
    else:
        there = max(len(content) - _HEAD, 0) // _FACET.itemsize
        if count > there:
            raise MeshError(f"it says that it has {count} triangles and has {there}: it is cut off")
        points = np.frombuffer(content[_HEAD:], _FACET, count)["corners"].astype(np.float64)
    points = points.reshape(-1, 3)
    return points, np.arange(len(points)).reshape(-1, 3)


def _of_text(content: bytes) -> Points:
    try:
        points = [[float(number) for number in found.groups()] for found in _VERTEX.finditer(content)]
    except ValueError as error:
        raise MeshError(f"a vertex does not have three numbers ({error})") from error
    if len(points) % 3:
        raise MeshError("its last triangle is cut off")
    return np.array(points, dtype=np.float64).reshape(-1, 3)
