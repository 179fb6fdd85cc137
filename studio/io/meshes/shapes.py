"""Meshes as readers need them: normals where a file has none, polygons as triangles."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def face_normals(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """(T, 3) normals of the faces, as long as twice the face's area."""
    corners = vertices[triangles]
    return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def smooth_normals(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """(V, 3) unit normals: the mean of the faces around by area; vertices at one place share theirs."""
    _, place = np.unique(np.round(vertices, 9), axis=0, return_inverse=True)
    normals = np.zeros_like(vertices)
    faces = face_normals(vertices, triangles)
    for corner in range(3):
        np.add.at(normals, place.ravel()[triangles[:, corner]], faces)
    return unit(normals[place.ravel()])


def unit(vectors: FloatArray) -> FloatArray:
    """(N, 3) of length 1; one without length points up."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.maximum(lengths, 1e-12), [0.0, 0.0, 1.0])
