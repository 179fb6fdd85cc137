"""Fingers of a character's own rig, driven by captured fingers or by a grip."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_poses import FingerPoses
from studio.core.body.humanoid import BodyMap
from studio.core.body.morphology import Morphology
from studio.core.body.skeleton import Skeleton
from studio.core.mesh.hand_shapes import FINGER_BENDS, GRIPS
from studio.core.mesh.rig import UNMOVED_JOINT, Rig, rig_body_map
from studio.core.mesh.skin import SkinnedMesh, bound_pose, segment_forms
from studio.core.project_cache import project_cache
from studio.core.rigs.character_skeleton import t_pose_rotations
from studio.core.rigs.finger_rest import (
    FINGER_CELLS,
    HAND_PARTS,
    PALM_SIGNS,
    T_POSE_HANDS,
    FingerRest,
    bend,
    finger_rest,
    relative_rotations,
    rotations_in_hand,
)
from studio.core.rotations import (
    IDENTITY_QUATERNION,
    from_matrix,
    from_rotation_vector,
    inverse,
    multiply,
    normalized,
    slerp,
    to_matrix,
)

FloatArray = NDArray[np.float64]

_GRIPS = np.array(GRIPS)
_THUMB_BENDS = np.radians([[0.0, 0.0, 0.0], [5.0, 15.0, 25.0], [10.0, 30.0, 55.0], [15.0, 50.0, 95.0]])
"""(4, 3) angles of the bones of a thumb with its rest, across the palm."""
_THUMB_ASIDE = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
"""Direction of the thumb of a flat hand in the axes of the hand."""
_ACROSS_PALM = np.array([-1.0, 0.5, 0.0])
"""Direction in which thumbs bend: towards the little finger, and out of the palm."""


@dataclass(frozen=True, eq=False)
class FingerDrive:
    """Fingers of a rig, which can take any ``FingerPoses``."""

    rest: FingerRest
    gripping: FloatArray
    """Rotations (4, 2, 5, 3, 4) of each joint from a straight finger, relative to the previous joint, in ``_GRIPS``."""

    def rotations(self, poses: FingerPoses) -> dict[int, FloatArray]:
        """Rotations (N, 3, 3) from rest of each finger joint of the rig, by joint, in the space in which it
        is bound.
        """
        mixed = multiply(rotations_in_hand(self.relative(poses)), inverse(bend(self.rest.flexions)))
        axes = from_matrix(self.rest.axes)[:, None, None]
        turned = to_matrix(multiply(multiply(axes, mixed), inverse(axes)))
        return {joint: turned[(slice(None), *finger.cell)] for finger, joint in self.rest.joints.items()}

    def relative(self, poses: FingerPoses) -> FloatArray:
        """Rotations (N, 2, 5, 3, 4) of each joint from a straight finger, relative to the previous joint."""
        frames = slice(None), None, None, None
        resting = np.broadcast_to(relative_rotations(bend(self.rest.flexions)), poses.rotations.shape)
        own = slerp(resting, poses.rotations, poses.captured[frames])
        return slerp(own, self._gripping(poses.grips), poses.asked[frames])

    def _gripping(self, grips: FloatArray) -> FloatArray:
        """Rotations (N, 2, 5, 3, 4) in ``grips`` (N,), interpolated between two of ``_GRIPS``."""
        below = np.clip(np.searchsorted(_GRIPS, grips, side="right") - 1, 0, len(_GRIPS) - 2)
        part = (grips - _GRIPS[below]) / (_GRIPS[below + 1] - _GRIPS[below])
        return slerp(self.gripping[below], self.gripping[below + 1], part[:, None, None, None])


def finger_drive(rig: Skeleton, rig_map: BodyMap, mesh: SkinnedMesh, body: Morphology) -> FingerDrive | None:
    """Drive of the fingers of ``rig``, the ``still_skeleton`` of a mesh fitted to ``body``; None if it has
    no fingers.
    """
    unturned = np.tile(IDENTITY_QUATERNION, (rig.joint_count, 1))
    rest = finger_rest(rig, rig_map, unturned, _bound_hands(mesh, body) @ T_POSE_HANDS)
    return FingerDrive(rest, gripping_rotations(rest.directions)) if rest.joints else None


def t_pose_rotations_of_fingers(poses: FingerPoses) -> FloatArray:
    """Rotations (N, 2, 5, 3, 4) in world axes of each finger joint from a T-pose with straight fingers, relative to the
    previous joint.
    """
    directions = np.zeros((*FINGER_CELLS, 3))
    directions[..., 2] = 1.0
    directions[:, 0] = _THUMB_ASIDE
    rest = FingerRest({}, (0, 0), T_POSE_HANDS, np.zeros(FINGER_CELLS), directions)
    axes = from_matrix(T_POSE_HANDS)[:, None, None]
    return multiply(multiply(axes, FingerDrive(rest, gripping_rotations(directions)).relative(poses)), inverse(axes))


def gripping_rotations(directions: FloatArray) -> FloatArray:
    """Rotations as ``FingerDrive.gripping`` of hands whose bones have the directions (2, 5, 3, 3) at rest."""
    angles = np.empty((len(_GRIPS), *FINGER_CELLS))
    angles[:] = np.diff(FINGER_BENDS, prepend=0.0)[:, None, None]
    gripping = bend(angles)
    for side in range(len(HAND_PARTS)):
        across = normalized(np.cross(directions[side, 0, 0], _ACROSS_PALM * [1.0, PALM_SIGNS[side], 1.0]))
        gripping[:, side, 0] = from_rotation_vector(np.diff(_THUMB_BENDS, prepend=0.0)[..., None] * across)
    return gripping


def below_hands(skeleton: Skeleton, body: BodyMap) -> list[int]:
    """Joints that are descendants of the hands, parents first."""
    hands = {body[part] for part in HAND_PARTS}
    return [joint for joint in range(skeleton.joint_count) if hands & set(skeleton.path(0, joint)[:-1])]


def _bound_hands(mesh: SkinnedMesh, body: Morphology) -> FloatArray:
    """Rotations (2, 3, 3) of the hands from a T-pose to the bind pose of ``mesh``, fitted to ``body``."""
    wrists = [body.layout.hand_segment(side) for side in range(2)]
    return np.asarray(bound_pose(mesh, body)[1][wrists] @ np.swapaxes(t_pose_rotations(body)[wrists], 1, 2))


def bound_joints(mesh: SkinnedMesh, build: Morphology, body: Morphology) -> tuple[FloatArray, FloatArray]:
    """Positions (J, 3) and rotations (J, 3, 3) of the joints of a mesh of ``build``, fitted to ``body``."""
    rig = _rig_of(mesh)
    forms, shifts = segment_forms(mesh, build, body)
    of_joint = np.maximum(rig.segments, 0)
    positions = np.einsum("jab,jb->ja", forms[of_joint], rig.positions) + shifts[of_joint]
    left, _, right = np.linalg.svd(forms[of_joint])
    turns = left @ right
    is_still = rig.segments == UNMOVED_JOINT
    positions[is_still] = rig.positions[is_still]
    turns[is_still] = np.eye(3)
    return positions, turns @ rig.rotations


def still_skeleton(rig: Rig, positions: FloatArray) -> Skeleton:
    """Joints of ``rig`` at ``positions`` (J, 3), without rotations."""
    parents = rig.parents.astype(np.int64)
    offsets = np.where((parents < 0)[:, None], positions, positions - positions[np.maximum(parents, 0)])
    return Skeleton(rig.names, parents, offsets, np.zeros(len(parents), dtype=bool))


@dataclass(frozen=True, eq=False)
class BoundHands:
    """Hands of a mesh with a rig, fitted to a body."""

    drive: FingerDrive
    rig: Rig
    below: tuple[int, ...]
    """Joints below the hands, parents first."""
    positions: FloatArray
    """Positions (J, 3) of the joints in the bind pose of the fitted mesh."""
    rows: NDArray[np.int64]
    """Indices (N,) of the vertices that are bound to a joint below a hand."""

    def shaped(self, fitted: SkinnedMesh, poses: FingerPoses) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Vertices and normals (V, 3) of ``fitted`` in its bind pose, with the fingers of one frame."""
        turns, rig = self.drive.rotations(poses), self.rig
        forms = np.zeros((len(rig.names), 3, 4))
        forms[:, :, :3] = np.eye(3)
        for joint in self.below:
            above = forms[rig.parents[joint]]
            forms[joint, :, :3] = turns[joint][0] if joint in turns else above[:, :3]
            stands = above[:, :3] @ self.positions[joint] + above[:, 3]
            forms[joint, :, 3] = stands - forms[joint, :, :3] @ self.positions[joint]
        blended = np.einsum("vn,vnij->vij", rig.weights[self.rows], forms[rig.joints[self.rows]])
        vertices, normals = fitted.vertices.copy(), fitted.normals.copy()
        moved = np.einsum("vij,vj->vi", blended[:, :, :3], fitted.vertices[self.rows]) + blended[:, :, 3]
        turned = np.einsum("vij,vj->vi", blended[:, :, :3], fitted.normals[self.rows])
        vertices[self.rows] = moved
        normals[self.rows] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
        return vertices, normals


@project_cache(maxsize=16)
def bound_hands(mesh: SkinnedMesh, build: Morphology, body: Morphology) -> BoundHands | None:
    """Hands of a mesh that is bound to ``build`` and fitted to ``body``; None if it has no finger joints."""
    if mesh.rig is None:
        return None
    rig, positions = mesh.rig, bound_joints(mesh, build, body)[0]
    still, body_map = still_skeleton(rig, positions), rig_body_map(rig, body.layout.spine_count)
    drive = finger_drive(still, body_map, mesh, body)
    if drive is None:
        return None
    below = below_hands(still, body_map)
    rows = np.flatnonzero((np.isin(rig.joints, below) & (rig.weights > 0.0)).any(axis=1))
    return BoundHands(drive, rig, tuple(below), positions, rows)


def _rig_of(mesh: SkinnedMesh) -> Rig:
    if mesh.rig is None:
        raise ValueError("The mesh has no joints of its own.")
    return mesh.rig
