"""Wavefront OBJ: lines of ``v x y z`` and ``f 1 2 3``; other lines (normals, materials) are ignored."""

import io
from array import array

import numpy as np

from studio.io.meshes.triangles import Corners, MeshError, Points, Triangles, checked_index


def read_obj(content: bytes) -> tuple[Points, Triangles]:
    """Points (V, 3) and triangles (T, 3). Raises MeshError with the line."""
    points, corners = array("d"), Corners()
    for number, line in enumerate(io.BytesIO(content), 1):
        words = line.split()
        try:
            if words[:1] == [b"v"]:
                x, y, z = map(float, words[1:4])
                points.extend((x, y, z))
            elif words[:1] == [b"f"]:
                corners.add([_index(word, len(points) // 3) for word in words[1:]])
        except ValueError as error:
            reason = error if isinstance(error, MeshError) else f"'{line[:40].decode(errors='replace').strip()}'"
            raise MeshError(f"line {number}: {reason} cannot be read") from error
    return np.array(points).reshape(-1, 3), corners.triangles


def _index(word: bytes, count: int) -> int:
    """Index of a point, from 0; a negative number in the file counts from the last of the ``count`` points so far."""
    number = checked_index(int(word.partition(b"/")[0]))
    index = number - 1 if number > 0 else count + number
    if number == 0 or index < 0:
        raise MeshError(f"'{number}' is not the number of a vertex;")
    return index
