"""Local poses: rotations of all parts of a body relative to their parents, independent of the body's proportions."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import reduce
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from studio.core.body.canonical import BodyLayout, BodyPart
from studio.core.constraints.base import Vector
from studio.core.rotations import from_matrix, from_rotation_vector, to_matrix, to_rotation_vector
from studio.core.stage.correction import NO_OFFSET

FloatArray = NDArray[np.float64]

SPINE_ROUNDS = 16
"""Number of iterations that find the rotation shared by all inner vertebrae; one is exact for a single vertebra."""
_TRUNK = (BodyPart.ABDOMEN, BodyPart.THORAX)
_HEAD = (BodyPart.NECK, BodyPart.HEAD)
_LEFT_ARM, _RIGHT_ARM, _LEGS = (
    tuple(part for part in BodyPart if part.startswith(sides) and part.endswith(bones))
    for sides, bones in (
        ("left", ("clavicle", "arm", "hand")),
        ("right", ("clavicle", "arm", "hand")),
        (("left", "right"), ("thigh", "shank", "foot", "toe")),
    )
)
POSE_REGIONS: Mapping[str, tuple[BodyPart, ...]] = {
    "Whole body": tuple(BodyPart),
    "Upper body": (*_TRUNK, *_HEAD, *_LEFT_ARM, *_RIGHT_ARM),
    "Arms": (*_LEFT_ARM, *_RIGHT_ARM),
    "Left arm": _LEFT_ARM,
    "Right arm": _RIGHT_ARM,
    "Legs": _LEGS,
    "Head": _HEAD,
}
"""Body parts to which a pose is applied, by the label of the region."""


@dataclass(frozen=True)
class LocalPose:
    """Pose as rotation vectors (radians) of all parts relative to their parents; the pelvis is relative to its heading.

    The rotation of the abdomen is that of all inner vertebrae together. ``hips_height`` is in leg lengths.
    """

    rotations: Mapping[BodyPart, Vector]
    hips_height: float

    def __post_init__(self) -> None:
        missing = [part.label.lower() for part in BodyPart if part not in self.rotations]
        if missing:
            raise ValueError(f"It has no rotation of the {missing[0]}.")
        for part, rotation in self.rotations.items():
            if not all(map(isfinite, rotation)):
                raise ValueError(f"The rotation of the {part.label.lower()} is invalid: {rotation}.")
        if not isfinite(self.hips_height):
            raise ValueError(f"The height of the hips must be a number, not {self.hips_height}.")


def local_pose(layout: BodyLayout, rotations: FloatArray, hips_height: float) -> LocalPose:
    """Local pose of a body whose segments have the world ``rotations`` (S, 3, 3)."""
    own = _local_rotations(layout, rotations)
    return LocalPose({part: _vector(_product(own[_segments(layout, part)])) for part in BodyPart}, hips_height)


def posed_rotations(layout: BodyLayout, pose: LocalPose) -> FloatArray:
    """World rotations (S, 3, 3) of the segments of a body in ``pose`` that faces along X."""
    rotations = np.tile(np.eye(3), (layout.segment_count, 1, 1))
    for part in BodyPart:
        segments = _segments(layout, part)
        rotations[segments] = _matrix(np.array(pose.rotations[part]) / max(len(segments), 1))
    if layout.spine_count == 2:  # the thorax makes the rotation of the missing abdomen
        thorax = layout.segment_of_part(BodyPart.THORAX)
        rotations[thorax] = _matrix(pose.rotations[BodyPart.ABDOMEN]) @ rotations[thorax]
    for segment, parent in enumerate(layout.parent_segments()[1:], 1):
        rotations[segment] = rotations[parent] @ rotations[segment]
    return rotations


def offsets_towards(
    layout: BodyLayout,
    rotations: FloatArray,
    pose: LocalPose,
    parts: Collection[BodyPart],
    fraction: float,
    before: Mapping[BodyPart, Vector],
) -> dict[BodyPart, Vector]:
    """Rotation vectors, as in ``PoseOffsets``, that blend ``parts`` by ``fraction`` towards ``pose``.

    The world ``rotations`` (S, 3, 3) already include the offsets ``before``, which the new ones replace.
    """
    own, found = _local_rotations(layout, rotations), dict[BodyPart, Vector]()
    for part in parts:
        segments, saved = _segments(layout, part), _matrix(pose.rotations[part])
        offset = _matrix(before.get(part, NO_OFFSET))
        if layout.spine_count == 2 and part in _TRUNK:  # the thorax makes the rotation of the missing abdomen
            if part is BodyPart.ABDOMEN:
                found[part] = NO_OFFSET
                continue
            saved = _matrix(pose.rotations[BodyPart.ABDOMEN]) @ saved
            offset = _matrix(before.get(BodyPart.ABDOMEN, NO_OFFSET)) @ offset
        shown = _product(own[segments])
        goal = shown @ _matrix(fraction * np.array(_vector(shown.T @ saved)))
        found[part] = _vector(_shared(own[segments], offset, goal))
    return found


def _shared(chain: FloatArray, before: FloatArray, goal: FloatArray) -> FloatArray:
    """Rotation (3, 3) that, shared equally by all of ``chain`` (M, 3, 3) in place of ``before``, gives ``goal``."""

    def divided(rotation: FloatArray) -> FloatArray:
        return _matrix(np.array(_vector(rotation)) / len(chain))

    plain, rotation = chain @ divided(before).T, before
    for _ in range(1 if len(chain) == 1 else SPINE_ROUNDS):
        rotation = rotation @ _product(plain @ divided(rotation)).T @ goal
    return rotation


def _segments(layout: BodyLayout, part: BodyPart) -> list[int]:
    if part is BodyPart.ABDOMEN:
        return [*range(1, layout.spine_count - 1)]
    return [layout.segment_of_part(part)]


def _local_rotations(layout: BodyLayout, rotations: FloatArray) -> FloatArray:
    """Rotations (S, 3, 3) relative to the parents; the pelvis's is relative to its rotation about the vertical."""
    parents = rotations[list(layout.parent_segments())]
    pelvis = from_matrix(rotations[0])
    parents[0] = _matrix((0.0, 0.0, 2.0 * np.arctan2(pelvis[2], pelvis[3])))
    return np.asarray(parents.transpose(0, 2, 1) @ rotations)


def _product(chain: FloatArray) -> FloatArray:
    return reduce(np.matmul, chain, np.eye(3))


def _matrix(vector: Vector | FloatArray) -> FloatArray:
    return to_matrix(from_rotation_vector(np.asarray(vector)))


def _vector(matrix: FloatArray) -> Vector:
    x, y, z = to_rotation_vector(from_matrix(matrix)).tolist()
    return x, y, z
