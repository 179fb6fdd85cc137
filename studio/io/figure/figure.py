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
"""(3, 3) axes of a file with Y up that faces +Z in the world of the studio."""
NO_SKELETON = "has no skeleton (bones), so its mesh cannot move. Rig it first, and export it with its skeleton."


@dataclass(frozen=True, eq=False)
class MeshPiece:
    """Mesh of one material in the file's world, in its bind pose, bound to joints of the figure.

    ``vertices`` and ``normals`` (V, 3), ``coordinates`` (V, 2) in its texture from the lower left, ``triangles`` (T,
    3), ``joints`` (V, n) with their ``weights`` (V, n) in any order and of any sum.
    """

    vertices: FloatArray
    normals: FloatArray
    coordinates: FloatArray
    triangles: IntArray
    joints: IntArray
    weights: FloatArray
    material: Material | None = None
    rigid: bool = False
    """True if it hangs from one joint as a whole."""
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
    """(J,) scale of joints at (J, 4, 4); 1 for all where one is not scaled evenly."""
    lengths = np.linalg.norm(matrices[:, :3, :3], axis=1)
    even = lengths.mean(axis=1)
    return even if np.allclose(lengths, even[:, None], rtol=1e-4, atol=0.0) else np.ones(len(lengths))


@dataclass(frozen=True, eq=False)
class Figure:
    """Joints in their bind pose, in the file's own axes and unit, and what is drawn around them."""

    name: str
    source: str
    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    """Each stands before its children; -1 for roots, of which there may be several."""
    positions: FloatArray
    """(J, 3)"""
    rotations: FloatArray | None = None
    """(J, 3, 3) of the joints' own axes, None where they have none: mirrored or sheared ones."""
    pieces: tuple[MeshPiece, ...] = ()
    parts: Mapping[str, str] = field(default_factory=dict)
    """Joints by part, where the file says it."""
    up: str = "Y"
    """The axis that is up by the format's own rule."""
    metres: float = 1.0
    """Metres a unit as the file, or the format's own rule, says."""
    moves: bool = False
    """True if the file holds a motion of it too."""
    repairs: tuple[str, ...] = ()
    kind: str = ""
    """Name of its format."""
    to_studio: FloatArray | None = None
    """(3, 3) rotation of the file's axes to those in which the studio writes its kind, None where it is unknown."""
    scales: FloatArray | None = None
    """(J,) length in the file of a unit of each joint's axes, None where all have the file's."""
    bones: NDArray[np.bool_] | None = None
    """(J,) False for a node that only carries bones, None where all are bones."""
