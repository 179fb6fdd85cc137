"""Fingers of a character's own rig, driven by those of a capture."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_joints import Digit, find_fingers
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.morphology import Morphology
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.mesh.rig import NO_SEGMENT, Rig, rig_body_map
from studio.core.mesh.skin import SkinnedMesh, bound_pose, segment_forms
from studio.core.project_cache import project_cache
from studio.core.rigs.character_skeleton import t_pose_rotations
from studio.core.rotations import IDENTITY_QUATERNION, frame_along, to_matrix

FloatArray = NDArray[np.float64]

_HANDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)


@dataclass(frozen=True, eq=False)
class FingerDrive:
    """Finger joints of a rig that a source has too, by their index in the rig."""

    chains: Mapping[int, tuple[int, ...]]
    """Joints of the source from the palm to the finger joint, whose rotations add up."""
    changes: Mapping[int, FloatArray]
    """(3, 3) rotation from the axes of the source's hand to those of the rig's."""

    def rotations(self, local_rotations: FloatArray) -> dict[int, FloatArray]:
        """(F, 3, 3) rotation from rest of each finger joint, in the hand of the rig, for the ``local_rotations``
        (F, J, 4) of the source.
        """
        used = sorted({each for chain in self.chains.values() for each in chain})
        local = dict(zip(used, np.moveaxis(to_matrix(local_rotations[:, used]), 1, 0), strict=True))
        turned: dict[tuple[int, ...], FloatArray] = {(): np.eye(3)}
        for chain in self.chains.values():
            for end in range(1, len(chain) + 1):
                if chain[:end] not in turned:
                    turned[chain[:end]] = turned[chain[: end - 1]] @ local[chain[end - 1]]
        return {
            joint: self.changes[joint] @ turned[chain] @ self.changes[joint].T for joint, chain in self.chains.items()
        }


def finger_drive(
    source: Skeleton, source_map: BodyMap, rig: Skeleton, rig_map: BodyMap, hands: FloatArray
) -> FingerDrive:
    """Drive of the fingers of ``rig`` by those of ``source``.

    ``rig`` is in its bind pose, with its hands rotated by ``hands`` (2, 3, 3) from those of the source. If both have a
    row of knuckles, these align the hands, so that fingers close on the palm.
    """
    theirs, own = find_fingers(source, source_map), find_fingers(rig, rig_map)
    chains: dict[int, tuple[int, ...]] = {}
    changes: dict[int, FloatArray] = {}
    for side, part in enumerate(_HANDS):
        both = [finger for finger in theirs if finger in own and finger.side == side]
        hand = source_map[part]
        row = [each for each in both if each.place == 0 and each.digit is not Digit.THUMB]
        change = hands[side]
        if len(row) > 1:
            to_rig = _knuckle_frame(rig, rig_map[part], [own[each] for each in row])
            change = to_rig @ _knuckle_frame(source, hand, [theirs[each] for each in row]).T
        for finger in both:
            chains[own[finger]] = source.path(hand, theirs[finger])[1:]
            changes[own[finger]] = change
    return FingerDrive(chains, changes)


def below_hands(skeleton: Skeleton, body: BodyMap) -> list[int]:
    """Descendants of the hands, parents first."""
    hands = {body[part] for part in _HANDS}
    return [joint for joint in range(skeleton.joint_count) if hands & set(skeleton.path(0, joint)[:-1])]


def bound_hands(mesh: SkinnedMesh, body: Morphology) -> FloatArray:
    """(2, 3, 3) rotations of the hands from a T-pose to the pose in which ``mesh``, fitted to ``body``, is bound."""
    wrists = [body.layout.hand_segment(side) for side in range(2)]
    return np.asarray(bound_pose(mesh, body)[1][wrists] @ np.swapaxes(t_pose_rotations(body)[wrists], 1, 2))


def bound_joints(mesh: SkinnedMesh, build: Morphology, body: Morphology) -> tuple[FloatArray, FloatArray]:
    """Positions (J, 3) and rotations (J, 3, 3) of the joints of a mesh, fitted from ``build`` to ``body``."""
    rig = _rig_of(mesh)
    forms, shifts = segment_forms(mesh, build, body)
    of_joint = np.maximum(rig.segments, 0)
    positions = np.einsum("jab,jb->ja", forms[of_joint], rig.positions) + shifts[of_joint]
    left, _, right = np.linalg.svd(forms[of_joint])
    turns = left @ right
    is_still = rig.segments == NO_SEGMENT
    positions[is_still] = rig.positions[is_still]
    turns[is_still] = np.eye(3)
    return positions, turns @ rig.rotations


def still_skeleton(rig: Rig, positions: FloatArray) -> Skeleton:
    """Joints of ``rig`` at ``positions`` (J, 3), without rotations."""
    parents = rig.parents.astype(np.int64)
    offsets = np.where((parents < 0)[:, None], positions, positions - positions[np.maximum(parents, 0)])
    return Skeleton(rig.names, parents, offsets, np.zeros(len(parents), dtype=bool))


@dataclass(frozen=True, eq=False)
class HandPose:
    """Fingers of a mesh with a rig, fitted to a body, in one frame of a capture."""

    drive: FingerDrive
    rig: Rig
    below: tuple[int, ...]
    """Joints below the hands, parents first."""
    positions: FloatArray
    """(J, 3) of the joints as the fitted mesh is bound."""
    rows: NDArray[np.int64]
    """(N,) vertices that hang from a joint below a hand."""
    local_rotations: FloatArray
    """(1, J, 4) of the joints of the capture."""

    def shaped(self, fitted: SkinnedMesh) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Vertices and normals (V, 3) of ``fitted`` in its bind pose, with bent fingers."""
        turns, rig = self.drive.rotations(self.local_rotations), self.rig
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


def hand_pose(mesh: SkinnedMesh, build: Morphology, body: Morphology, capture: Capture, frame: int) -> HandPose | None:
    """Fingers in a frame of ``capture`` of a mesh that is fitted to ``body``; None unless both have some."""
    fixed = _hand_pose(mesh, build, body, _Recorded(capture))
    if fixed is None:
        return None
    frame = min(max(frame, 0), capture.frame_count - 1)
    drive, below, positions, rows = fixed
    return HandPose(drive, _rig_of(mesh), below, positions, rows, capture.poses.local_rotations[frame : frame + 1])


@dataclass(frozen=True, eq=False)
class _Recorded:
    """Capture as a key of caches, equal to itself alone."""

    capture: Capture

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Recorded) and other.capture is self.capture

    def __hash__(self) -> int:
        return id(self.capture)


@project_cache(maxsize=16)
def _hand_pose(
    mesh: SkinnedMesh, build: Morphology, body: Morphology, recorded: _Recorded
) -> tuple[FingerDrive, tuple[int, ...], FloatArray, NDArray[np.int64]] | None:
    """All of a hand pose that is the same in every frame."""
    capture = recorded.capture
    if mesh.rig is None or not has_fingers(capture):
        return None
    from studio.core.normalized.normalize import normalize_capture  # late: what computes is loaded after the window
    from studio.core.rigs.carried_joints import carried_axes

    assert capture.body_map is not None
    rig, positions = mesh.rig, bound_joints(mesh, build, body)[0]
    still, body_map = still_skeleton(rig, positions), rig_body_map(rig, body.layout.spine_count)
    if not find_fingers(still, body_map):
        return None
    hands = bound_hands(mesh, body) @ carried_axes(body, normalize_capture(capture)[1])
    drive = finger_drive(capture.skeleton, capture.body_map, still, body_map, hands)
    below = below_hands(still, body_map)
    rows = np.flatnonzero((np.isin(rig.joints, below) & (rig.weights > 0.0)).any(axis=1))
    return (drive, tuple(below), positions, rows) if drive.chains else None


def has_fingers(capture: Capture) -> bool:
    """True if fingers were captured."""
    return _has_fingers(_Recorded(capture))


@project_cache(maxsize=64)
def _has_fingers(recorded: _Recorded) -> bool:
    capture = recorded.capture
    return capture.body_map is not None and bool(find_fingers(capture.skeleton, capture.body_map))


def _rig_of(mesh: SkinnedMesh) -> Rig:
    if mesh.rig is None:
        raise ValueError("The mesh has no joints of its own.")
    return mesh.rig


def _knuckle_frame(skeleton: Skeleton, hand: int, knuckles: Sequence[int]) -> FloatArray:
    """(3, 3) axes of a hand at rest: along the row of its ``knuckles``, out of the palm, and towards them."""
    rest = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    places = joint_world(skeleton, rest)[0][0]
    towards = (places[list(knuckles)] - places[hand]).sum(axis=0)
    return frame_along(towards, places[knuckles[0]] - places[knuckles[-1]])
