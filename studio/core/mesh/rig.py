"""Rig: the joints of a character's file, with their names and axes, and the skin bound to them."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.body.humanoid import BodyMap
from studio.core.plausible import SKIN

FloatArray = NDArray[np.float64]

NO_SEGMENT = -1
"""The segment of a joint above the pelvis, which no segment moves."""
_COLUMNS: tuple[tuple[str, type, tuple[int, ...]], ...] = (
    ("parents", np.int32, ()),
    ("positions", np.float64, (3,)),
    ("rotations", np.float64, (3, 3)),
    ("segments", np.int32, ()),
)


@dataclass(frozen=True, eq=False)
class RigFile:
    """Joints as they rest in the file that a rig comes from, so that an export drops on it.

    The file's world has the studio's axes here, as a file of its kind that the studio writes is turned: a point p of it
    is at ``rotation`` p + ``position`` in the space of the mesh. Raises ValueError naming a member that is wrong.
    """

    format: str
    """Name of its format."""
    rotation: FloatArray
    """(3, 3)"""
    position: FloatArray
    """(3,) metres"""
    scales: FloatArray
    """(J,) units of its kind of file (centimetres for FBX, else metres) in a unit of each joint's own axes."""
    bones: NDArray[np.bool_]
    """(J,) False for a node that only carries bones."""

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
        """Positions (..., 3) and rotations (..., 3, 3) in the file's world."""
        return (positions - self.position) @ self.rotation, self.rotation.T @ rotations


@dataclass(frozen=True, eq=False)
class Rig:
    """J joints, parents before children, at their bind positions in the space of the mesh.

    Raises ValueError naming a member whose shape or content is wrong.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int32]
    """(J,), -1 for the root."""
    positions: FloatArray
    """(J, 3) metres, Z up."""
    rotations: FloatArray
    """(J, 3, 3) of the joints' own axes in the world."""
    segments: NDArray[np.int32]
    """(J,) the canonical segment that each moves with, ``NO_SEGMENT`` above the pelvis."""
    joints: NDArray[np.int32]
    """(V, n) joints from which each vertex hangs."""
    weights: NDArray[np.float32]
    """(V, n), each row sums to 1; 0 where there is no influence."""
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
        SKIN.check(self.positions)
        if not np.allclose(self.rotations @ np.swapaxes(self.rotations, 1, 2), np.eye(3), atol=1e-4):
            raise ValueError("rig: holds a matrix that is not a rotation.")
        if self.segments.min() < NO_SEGMENT or not (np.linalg.det(self.rotations) > 0.0).all():
            raise ValueError("rig: holds a segment that is none, or a mirrored joint.")
        if (self.weights < 0.0).any() or not np.allclose(self.weights.sum(axis=1), 1.0, atol=1e-4):
            raise ValueError("rig: weights are not negative, and each row sums to 1.")
        if self.file is not None and self.file.scales.shape != (count,):
            raise ValueError("rig: the joints of its file are others.")


def _freeze(record: object, name: str, kind: type, shape: tuple[int, ...]) -> None:
    """Set a member of a frozen record to a read-only array of ``shape``; ValueError if it is none."""
    array: NDArray[Any] = np.array(getattr(record, name), dtype=kind)
    if array.shape != shape or not np.isfinite(array).all():
        raise ValueError(f"rig: {name} are not finite numbers of shape {shape}.")
    array.setflags(write=False)
    object.__setattr__(record, name, array)


def rig_body_map(rig: Rig, spine_count: int) -> BodyMap:
    """Body map: the first joint that moves with the segment of each part."""
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
