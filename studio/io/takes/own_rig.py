"""Character's motion on the joints of its own file: their names, hierarchy, rest pose and axes."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.finger_joints import Digit, find_fingers
from studio.core.body.humanoid import BodyMap, BodyPart
from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.mesh.rig import NO_SEGMENT, Rig, rig_body_map
from studio.core.mesh.skin import bound_pose, fit_skin, segment_forms
from studio.core.rigs.character_skeleton import t_pose_rotations
from studio.core.rigs.joint_skin import FloatArray, JointSkin
from studio.core.rotations import IDENTITY_QUATERNION, frame_along, from_matrix, multiply, to_matrix
from studio.io.export import Take

_Y_UP = (".fbx", ".glb", ".gltf")
"""Kinds of files whose writers turn the world and with it the axes of every joint."""
_WORLD_TO_FILE = np.eye(3)[[1, 2, 0]]


def has_own_rig(take: Take) -> bool:
    """True if the character of an adapted motion has joints of its own."""
    return take.adapted is not None and take.character is not None and take.character.skin.rig is not None


def on_own_rig(take: Take, suffix: str) -> Take:
    """Take on the character's own joints, with its skin bound to them.

    Every joint moves with its segment of the body, so that its skin deforms as that of the file would. Fingers rotate
    like those of the take; other extra joints of a capture are left out. Files with Y up have other joint axes: these
    are chosen so that those of the original file result in a file of the kind of ``suffix``.
    """
    character, adapted = take.character, take.adapted
    assert character is not None
    assert adapted is not None
    mesh, body, rig = character.skin, adapted.morphology, character.skin.rig
    assert rig is not None
    positions, rotations = _bound(rig, *segment_forms(mesh, character.build, body))
    if suffix in _Y_UP:
        rotations = rotations @ _WORLD_TO_FILE
    moving = rig.segments != NO_SEGMENT
    segments = rig.segments[moving]
    proximal = np.array(body.layout.proximal_points())
    then, axes = bound_pose(mesh, body)
    turned = adapted.rotations[:] @ np.swapaxes(axes, 1, 2)
    frames, count = adapted.frame_count, len(rig.names)
    world_turns, world_places = np.empty((frames, count, 3, 3)), np.empty((frames, count, 3))
    world_turns[:], world_places[:] = rotations, positions
    world_turns[:, moving] = turned[:, segments] @ rotations[moving]
    away = positions[moving] - then[proximal[segments]]
    world_places[:, moving] = adapted.positions[:][:, proximal[segments]] + np.einsum(
        "fjab,jb->fja", turned[:, segments], away
    )
    parents = rig.parents.astype(np.int64)
    body_map = rig_body_map(rig, body.layout.spine_count)
    still = Skeleton(rig.names, parents, _offsets(parents, positions), np.zeros(count, dtype=bool))
    wrists = [body.layout.hand_segment(side) for side in range(2)]
    hands = axes[wrists] @ np.swapaxes(t_pose_rotations(body)[wrists], 1, 2)
    fingers = _finger_turns(take, still, body_map, hands)
    for joint in _below_hands(still, body_map) if fingers else ():
        parent = parents[joint]
        above = world_turns[:, parent] @ rotations[parent].T
        hand_turns = turned[:, rig.segments[joint]]
        world_turns[:, joint] = (hand_turns @ fingers[joint] if joint in fingers else above) @ rotations[joint]
        world_places[:, joint] = world_places[:, parent] + above @ (positions[joint] - positions[parent])
    local_turns, local_places = _local(parents, world_turns, world_places)
    rest_turns, rest_places = (each[0] for each in _local(parents, rotations[None], positions[None]))
    skin = fit_skin(mesh if fingers else character.shown_skin, character.build, body)
    return replace(
        take,
        capture=replace(
            take.capture,
            skeleton=Skeleton(rig.names, parents, rest_places, np.zeros(count, dtype=bool)),
            poses=PoseSequence(from_matrix(local_turns), local_places),
            body_map=body_map,
            reference_rotations=from_matrix(rest_turns),
        ),
        bound=JointSkin(
            skin.vertices.astype(np.float64),
            skin.normals.astype(np.float64),
            skin.triangles,
            rig.joints,
            rig.weights.astype(np.float64),
            positions,
            rotations,
            skin.appearance,
        ),
        rest_rotations=from_matrix(rest_turns),
    )


def _below_hands(skeleton: Skeleton, body: BodyMap) -> list[int]:
    """Descendants of the hands, parents first."""
    hands = {body[BodyPart.LEFT_HAND], body[BodyPart.RIGHT_HAND]}
    return [joint for joint in range(skeleton.joint_count) if hands & set(skeleton.path(0, joint)[:-1])]


def _finger_turns(take: Take, rig: Skeleton, body: BodyMap, hands: FloatArray) -> dict[int, FloatArray]:
    """(F, 3, 3) rotations from rest of each finger joint of ``rig`` that is in ``take``, in the hand of the rig.

    ``rig`` is in its bind pose, with its hands rotated by ``hands`` (2, 3, 3) from those of the take's skeleton. If
    both have a row of knuckles, these align the hands, so that fingers close on the palm.
    """
    source = take.skeleton
    assert take.capture.body_map is not None
    theirs, own = find_fingers(source, take.capture.body_map), find_fingers(rig, body)
    turns: dict[int, FloatArray] = {}
    for side, part in enumerate((BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND)):
        both = [finger for finger in theirs if finger in own and finger.side == side]
        hand = take.capture.body_map[part]
        row = [each for each in both if each.place == 0 and each.digit is not Digit.THUMB]
        change = hands[side]
        if len(row) > 1:
            to_rig = _knuckle_frame(rig, body[part], [own[each] for each in row])
            change = to_rig @ _knuckle_frame(source, hand, [theirs[each] for each in row]).T
        for finger in both:
            turned = IDENTITY_QUATERNION
            for joint in source.path(hand, theirs[finger])[1:]:
                turned = multiply(turned, take.poses.local_rotations[:, joint])
            turns[own[finger]] = change @ to_matrix(turned) @ change.T
    return turns


def _knuckle_frame(skeleton: Skeleton, hand: int, knuckles: list[int]) -> FloatArray:
    """(3, 3) axes of a hand at rest: along the row of its ``knuckles``, out of the palm, and towards them."""
    rest = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    places = joint_world(skeleton, rest)[0][0]
    return frame_along((places[knuckles] - places[hand]).sum(axis=0), places[knuckles[0]] - places[knuckles[-1]])


def _bound(rig: Rig, forms: FloatArray, shifts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions (J, 3) and rotations (J, 3, 3) of the joints on the body to which the skin is fitted."""
    of_joint = np.maximum(rig.segments, 0)
    positions = np.einsum("jab,jb->ja", forms[of_joint], rig.positions) + shifts[of_joint]
    left, _, right = np.linalg.svd(forms[of_joint])
    turns = left @ right
    is_still = rig.segments == NO_SEGMENT
    positions[is_still] = rig.positions[is_still]
    turns[is_still] = np.eye(3)
    return positions, turns @ rig.rotations


def _offsets(parents: NDArray[np.int64], positions: FloatArray) -> FloatArray:
    """(J, 3) from each joint's parent to it, of joints without rotations."""
    return np.where((parents < 0)[:, None], positions, positions - positions[np.maximum(parents, 0)])


def _local(parents: NDArray[np.int64], turns: FloatArray, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rotations (F, J, 3, 3) and translations (F, J, 3) in the parents' axes, of joints in the world."""
    above = np.maximum(parents, 0)
    is_root = parents < 0
    carriers = np.where(is_root[:, None, None], np.eye(3), np.swapaxes(turns[:, above], -1, -2))
    moved = places - np.where(is_root[:, None], 0.0, places[:, above])
    return carriers @ turns, np.einsum("fjab,fjb->fja", carriers, moved)
