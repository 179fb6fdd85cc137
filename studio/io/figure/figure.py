"""Figure: a character as in its file, before its body map is known."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.core.mesh.appearance import Material
from studio.core.rotations import from_matrix, to_matrix

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MOST_VERTICES = 500_000
MOST_FIGURE_JOINTS = 5_000
Y_UP_AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Axes (3, 3) in the studio's world of a file with Y up that faces +Z."""
NO_SKELETON_MESSAGE = "has no skeleton (bones), so its mesh cannot move. Rig it first, and export it with its skeleton."


@dataclass(frozen=True, eq=False)
class MeshPiece:
    """Mesh with one material in the file's world, in its bind pose, bound to joints of the figure.

    ``vertices`` and ``normals`` are (V, 3), ``coordinates`` (V, 2) in its texture from the lower left, ``triangles``
    (T, 3), and ``joints`` (V, n) with their ``weights`` (V, n) in any order and with any sum.
    """

    vertices: FloatArray
    normals: FloatArray
    coordinates: FloatArray
    triangles: IntArray
    joints: IntArray
    weights: FloatArray
    material: Material | None = None
    rigid: bool = False
    """True if the whole mesh is attached to one joint."""
    name: str = ""


def rotations_of(matrices: FloatArray) -> FloatArray | None:
    """Rotations (J, 3, 3) of transforms (J, 4, 4) without their scale; None if one is mirrored, flat, or sheared."""
    axes = matrices[:, :3, :3]
    lengths = np.linalg.norm(axes, axis=1, keepdims=True)
    if not (np.isfinite(axes).all() and (lengths > 0.0).all()):
        return None
    axes = axes / lengths
    if not np.allclose(np.swapaxes(axes, 1, 2) @ axes, np.eye(3), atol=1e-4) or (np.linalg.det(axes) < 0.0).any():
        return None
    return to_matrix(from_matrix(axes))


def scales_of(matrices: FloatArray) -> FloatArray:
    """Scales (J,) of joints with transforms (J, 4, 4); 1 for all if one is not scaled evenly."""
    lengths = np.linalg.norm(matrices[:, :3, :3], axis=1)
    even = lengths.mean(axis=1)
    return even if np.allclose(lengths, even[:, None], rtol=1e-4, atol=0.0) else np.ones(len(lengths))


@dataclass(frozen=True, eq=False)
class Figure:
    """Joints in their bind pose, in the file's own axes and unit, and the meshes bound to them."""

    name: str
    source: str
    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    """Index of each joint's parent, which comes before it; -1 for roots, of which there may be several."""
    positions: FloatArray
    """Positions (J, 3) of the joints."""
    rotations: FloatArray | None = None
    """Rotations (J, 3, 3) of the joints' own axes; None if some are mirrored or sheared."""
    pieces: tuple[MeshPiece, ...] = ()
    parts: Mapping[str, str] = field(default_factory=dict)
    """Names of joints by part, if the file states them."""
    up: str = "Y"
    """Up axis by the rule of the format."""
    metres: float = 1.0
    """Metres per unit, stated by the file or by the rule of the format."""
    moves: bool = False
    """True if the file also holds a motion of the figure."""
    repairs: tuple[str, ...] = ()
    kind: str = ""
    """Name of its format."""
    to_studio: FloatArray | None = None
    """Rotation (3, 3) from the file's axes to those in which the studio writes files of this format; None if it is
    unknown.
    """
    scales: FloatArray | None = None
    """File units (J,) per unit of each joint's own axes; None if all joints have the file's unit."""
    bones: NDArray[np.bool_] | None = None
    """Mask (J,) of bones, False for a node that only carries bones; None if all are bones."""
