"""Skin bound to the joints of an ordinary skeleton, as file formats of other programs need it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.mesh.appearance import Appearance
from studio.core.mesh.character import Character
from studio.core.mesh.skin import VERTEX_INFLUENCES, bound_pose, fit_skin
from studio.core.rigs.character_skeleton import joint_points, joint_segments, t_pose_rotations
from studio.core.rotations import IDENTITY_QUATERNION, frame_along

FloatArray = NDArray[np.float64]

_GIRTH = 0.08
"""Half the thickness of a drawn bone, as a part of its length."""
_SHORTEST = 1e-4
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class JointSkin:
    """Mesh bound to joints, in the world space (metres, Z up) of its bind pose.

    ``vertices`` and unit ``normals`` are (V, 3), ``triangles`` (T, 3) counter-clockwise from outside, ``joints`` and
    ``weights`` (V, 4), 0 where there is no influence. ``bind_positions`` (J, 3) and ``bind_rotations`` (J, 3, 3) are
    those of the joints.
    """

    vertices: FloatArray
    normals: FloatArray
    triangles: NDArray[np.int32]
    joints: NDArray[np.int32]
    weights: FloatArray
    bind_positions: FloatArray
    bind_rotations: FloatArray
    appearance: Appearance | None = None
    bind_scales: FloatArray | None = None
    """File units (J,) per unit of each joint's own axes; None if all joints have the file's unit."""
    bones: NDArray[np.bool_] | None = None
    """Mask (J,) of bones, False for a node that only carries bones; None if all are bones."""

    def local_scales(self, parents: NDArray[np.int64]) -> tuple[FloatArray, FloatArray]:
        """Scales (J,) of each joint in its parent, and scales (J,) of the axes in which its position is given."""
        world = np.ones(len(parents)) if self.bind_scales is None else self.bind_scales
        above = np.where(parents < 0, 1.0, world[parents])
        return world / above, above

    def carrier(self) -> int | None:
        """Index of the deepest node that only carries bones; None if there is none."""
        carriers = [] if self.bones is None else np.flatnonzero(~self.bones).tolist()
        return carriers[-1] if carriers else None

    def with_joint_above(self) -> "JointSkin":
        """Copy for a skeleton with a new first joint at the origin, without influence; all its joints are bones."""
        return replace(
            self,
            joints=np.where(self.weights > 0.0, self.joints + 1, 0).astype(np.int32),
            bind_positions=np.concatenate([np.zeros((1, 3)), self.bind_positions]),
            bind_rotations=np.concatenate([np.eye(3)[None], self.bind_rotations]),
            bind_scales=None,
            bones=None,
        )

    def counted_from(self, rotations: FloatArray) -> "JointSkin":
        """Copy for joints whose axes are redefined as the world's at the world ``rotations`` (J, 3, 3)."""
        return replace(self, bind_rotations=self.bind_rotations @ np.swapaxes(rotations, 1, 2))


def character_skin(character: Character, skeleton: Skeleton | None = None) -> JointSkin:
    """Character's own skin on the joints of its ``character_skeleton``.

    Further joints of ``skeleton`` are bound at rest, without influence. Its plain linear blending equals the studio's
    skinning except within the creases of elbows and knees.
    """
    body = character.morphology
    mesh = fit_skin(character.shown_skin, character.build, body)
    positions, rotations = bound_pose(character.skin, body)
    segments = np.array(joint_segments(body.layout))
    joint_of = np.zeros(body.layout.segment_count, dtype=np.int32)
    joint_of[segments[segments >= 0]] = np.flatnonzero(segments >= 0)
    moved = rotations @ np.swapaxes(t_pose_rotations(body), 1, 2)
    weights = mesh.weights.astype(np.float64)
    binds = (
        positions[list(joint_points(body.layout))],
        np.where((segments >= 0)[:, None, None], moved[segments], np.eye(3)),
    )
    if skeleton is not None:
        binds = _with_those_behind(*binds, skeleton)
    return JointSkin(
        mesh.vertices.astype(np.float64),
        mesh.normals.astype(np.float64),
        mesh.triangles,
        np.where(weights > 0.0, joint_of[mesh.segments], 0).astype(np.int32),
        weights / weights.sum(axis=1, keepdims=True),
        binds[0],
        binds[1],
        mesh.appearance,
    )


def _with_those_behind(
    positions: FloatArray, rotations: FloatArray, skeleton: Skeleton
) -> tuple[FloatArray, FloatArray]:
    """Positions (J, 3) and rotations (J, 3, 3) of the first joints of ``skeleton``, followed by those of the others at
    rest.
    """
    places, turns = list(positions), list(rotations)
    for joint in range(len(positions), skeleton.joint_count):
        parent = int(skeleton.parents[joint])
        places.append(places[parent] + turns[parent] @ skeleton.offsets[joint])
        turns.append(turns[parent])
    return np.array(places), np.array(turns)


def bone_skin(skeleton: Skeleton) -> JointSkin:
    """Skin of octahedral bones, one from each joint to each of its children, for a skeleton without a skin."""
    rest = PoseSequence(np.tile(IDENTITY_QUATERNION, (1, skeleton.joint_count, 1)), skeleton.offsets[None])
    positions, rotations = (array[0] for array in joint_world(skeleton, rest))
    bones = [
        (parent, _bone(positions[parent], positions[joint]))
        for joint, parent in enumerate(skeleton.parents.tolist())
        if parent >= 0 and np.linalg.norm(skeleton.offsets[joint]) > _SHORTEST
    ]
    corners = np.concatenate([bone for _, bone in bones]) if bones else np.empty((0, 3, 3))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    count = 3 * len(corners)
    joints = np.zeros((count, VERTEX_INFLUENCES), dtype=np.int32)
    joints[:, 0] = np.repeat([joint for joint, _ in bones], 3 * 8)
    weights = np.zeros((count, VERTEX_INFLUENCES))
    weights[:, 0] = 1.0
    triangles = np.arange(count, dtype=np.int32).reshape(-1, 3)
    return JointSkin(
        corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), triangles, joints, weights, positions, rotations
    )


def _bone(start: FloatArray, end: FloatArray) -> FloatArray:
    """Corners (8, 3, 3) of the triangles of an octahedron from ``start`` to ``end``, thickest at a sixth of
    its length.
    """
    length = float(np.linalg.norm(end - start))
    frame = frame_along(end - start, _UP)
    ring = (
        start + (end - start) / 6.0 + _GIRTH * length * np.array([frame[:, 0], frame[:, 1], -frame[:, 0], -frame[:, 1]])
    )
    sides = [(ring[k], ring[(k + 1) % 4]) for k in range(4)]
    return np.array([(start, b, a) for a, b in sides] + [(end, a, b) for a, b in sides])
