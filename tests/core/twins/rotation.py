"""Rotations by scipy, told as plainly as can be."""

import numpy as np
from scipy.spatial.transform import Rotation


def from_vector(vector: np.ndarray) -> np.ndarray:
    return Rotation.from_rotvec(vector).as_matrix()


def from_quaternion(quaternion: np.ndarray) -> np.ndarray:
    return Rotation.from_quat(quaternion).as_matrix()


def to_vector(matrix: np.ndarray) -> np.ndarray:
    return Rotation.from_matrix(matrix).as_rotvec()


def about_z(angle: float) -> np.ndarray:
    return from_vector(np.array([0.0, 0.0, angle]))


def shortest_arc(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The turn about start x end by the angle between them; for unit vectors that do not oppose."""
    axis = np.cross(start, end)
    sine = np.linalg.norm(axis)
    if sine < 1e-15:
        return np.eye(3)
    return from_vector(axis / sine * np.arctan2(sine, start @ end))


def level(rotation: np.ndarray) -> np.ndarray:
    """The rotation about the vertical that looks where ``rotation`` looks."""
    return about_z(np.arctan2(rotation[1, 0], rotation[0, 0]))
