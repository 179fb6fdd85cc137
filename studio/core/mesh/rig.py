"""Rig of a character's file: its joints with their names and axes, and the skin bound to them."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.plausible import SKIN_RANGE

FloatArray = NDArray[np.float64]

UNMOVED_JOINT = -1
"""Segment index of a joint above the pelvis, which no segment moves."""
_COLUMNS: tuple[tuple[str, type, tuple[int, ...]], ...] = (
    ("parents", np.int32, ()),
    ("positions", np.float64, (3,)),
    ("rotations", np.float64, (3, 3)),
    ("segments", np.int32, ()),
)


@dataclass(frozen=True, eq=False)
class RigFile:
    """Bind pose of a rig in its own file, so that an exported motion fits on the rig.

    A point p of the file's world is at ``rotation`` p + ``position`` in the space of the mesh, after the file's axes
    are converted to the studio's. Raises ValueError naming a member that is wrong.
    """

    format: str
    """Name of the file format."""
    rotation: FloatArray
    """Rotation (3, 3) from the file's world to the space of the mesh."""
    position: FloatArray
    """Origin (3,) in metres of the file's world in the space of the mesh."""
    scales: FloatArray
    """Scale (J,) of each joint: file units (centimetres for FBX, else metres) per unit of the joint's own axes."""
    bones: NDArray[np.bool_]
    """Mask (J,) of bones; False for a node that only carries bones."""

    def __post_init__(self) -> None:
        for name, kind, shape in (
            ("rotation", np.float64, (3, 3)),
            ("position", np.float64, (3,)),
            ("scales", np.float64, np.shape(self.scales)),
            ("bones", np.bool_, np.shape(self.scales)),
        ):
            _freeze(self, name, kind, shape)
        if not np.allclose(self.rotation @ self.rotation.T, np.eye(3), atol=1e-6) or (self.scales <= 0.0).any():
            raise ValueError("rig: its file is mirrored or flat.")

    def to_file(self, positions: FloatArray, rotations: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions (..., 3) and rotations (..., 3, 3), converted to the file's world."""
        return (positions - self.position) @ self.rotation, self.rotation.T @ rotations


@dataclass(frozen=True, eq=False)
class Rig:
    """Joints of a character's file, parents before children, at their bind positions in the space of the mesh.

    Raises ValueError naming a member whose shape or content is wrong.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int32]
    """Index (J,) of the parent of each joint; -1 for the root."""
    positions: FloatArray
    """Bind positions (J, 3) in metres, Z up."""
    rotations: FloatArray
    """World rotations (J, 3, 3) of the joints' own axes."""
    segments: NDArray[np.int32]
    """Canonical segment (J,) with which each joint moves; ``UNMOVED_JOINT`` above the pelvis."""
    joints: NDArray[np.int32]
    """Joints (V, n) to which each vertex is bound."""
    weights: NDArray[np.float32]
    """Weights (V, n) of these joints, with sum 1 in each row; 0 where there is no influence."""
    file: RigFile | None = field(default=None, metadata={"sparse": True})
    """None for a file whose axes are unknown."""

    def __post_init__(self) -> None:
        count = len(self.names)
        if not count or len(set(self.names)) != count:
            raise ValueError("rig: every joint needs a name of its own.")
        for name, kind, shape in _COLUMNS:
            _freeze(self, name, kind, (count, *shape))
        _freeze(self, "joints", np.int32, np.shape(self.joints))
        _freeze(self, "weights", np.float32, np.shape(self.joints))
        if self.parents[0] != -1 or (self.parents[1:] < 0).any() or (self.parents[1:] >= np.arange(1, count)).any():
            raise ValueError("rig: a joint comes before its parent, or there are several roots.")
        if self.joints.ndim != 2 or self.joints.min(initial=0) < 0 or self.joints.max(initial=0) >= count:
            raise ValueError("rig: a vertex hangs from a joint that is not there.")
        SKIN_RANGE.check(self.positions)
        if not np.allclose(self.rotations @ np.swapaxes(self.rotations, 1, 2), np.eye(3), atol=1e-4):
            raise ValueError("rig: holds a matrix that is not a rotation.")
        if self.segments.min() < UNMOVED_JOINT or not (np.linalg.det(self.rotations) > 0.0).all():
            raise ValueError("rig: holds a segment that is none, or a mirrored joint.")
        if (self.weights < 0.0).any() or not np.allclose(self.weights.sum(axis=1), 1.0, atol=1e-4):
            raise ValueError("rig: weights are not negative, and each row sums to 1.")
        if self.file is not None and self.file.scales.shape != (count,):
            raise ValueError("rig: the joints of its file are others.")


def _freeze(record: object, name: str, kind: type, shape: tuple[int, ...]) -> None:
    """Set a member of a frozen record to a read-only array of ``shape``. Raises ValueError if it has another shape."""
    array: NDArray[Any] = np.array(getattr(record, name), dtype=kind)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"rig: {name} are not finite numbers of shape {shape}.")
    array.setflags(write=False)
    object.__setattr__(record, name, array)


def rig_body_map(rig: Rig, spine_count: int) -> BodyMap:
    """Body map of a rig: for each part, the first joint that moves with its segment."""
    first = {int(segment): int(np.argmax(rig.segments == segment)) for segment in np.unique(rig.segments)}
    spine = tuple(first[segment] for segment in range(spine_count) if segment in first)
    layout = BodyLayout(spine_count)
    inner = (BodyPart.ABDOMEN, BodyPart.THORAX)
    parts = {
        part: first[layout.segment_of_part(part)]
        for part in BodyPart
        if part not in inner and layout.segment_of_part(part) in first
    }
    return BodyMap(parts, spine)
