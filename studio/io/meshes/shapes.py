"""Mesh functions for readers: normals for files that have none."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def face_normals(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """Normals (T, 3) of the faces, with twice the area as length."""
    corners = vertices[triangles]
    return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def smooth_normals(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """Unit normals (V, 3): the mean of the surrounding faces by area; vertices at one position share theirs."""
    _, place = np.unique(np.round(vertices, 9), axis=0, return_inverse=True)
    normals = np.zeros_like(vertices)
    faces = face_normals(vertices, triangles)
    for corner in range(3):
        np.add.at(normals, place.ravel()[triangles[:, corner]], faces)
    return unit(normals[place.ravel()])


def unit(vectors: FloatArray) -> FloatArray:
    """Vectors (N, 3) scaled to unit length; zero vectors become up vectors."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.maximum(lengths, 1e-12), [0.0, 0.0, 1.0])
