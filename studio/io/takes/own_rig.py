"""Motion of a character on the joints of its own file: their names, hierarchy, rest pose and axes."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.mesh.rig import UNMOVED_JOINT, rig_body_map
from studio.core.mesh.skin import bound_pose, fit_skin
from studio.core.rigs.driven_fingers import below_hands, bound_joints, finger_drive, still_skeleton
from studio.core.rigs.joint_skin import FloatArray, JointSkin
from studio.core.rotations import from_matrix
from studio.core.stage.placement import Placement
from studio.io.export import Take

_Y_UP = (".fbx", ".glb", ".gltf")
"""Kinds of files whose writers turn the world and with it the axes of every joint."""
_SUFFIXES = {"FBX": (".fbx",), "glTF": (".glb", ".gltf"), "USD": (".usd", ".usda", ".usdc", ".usdz")}
"""Kinds of files of each format whose scaled joints are kept in files of the same format."""
_WORLD_TO_FILE = np.eye(3)[[1, 2, 0]]


def has_own_rig(take: Take) -> bool:
    """True if the character of an adapted motion has joints of its own."""
    return take.adapted is not None and take.character is not None and take.character.skin.rig is not None


def take_on_own_rig(take: Take, suffix: str, placement: Placement) -> Take:
    """Take on the character's own joints, with its skin bound to them.

    Every joint moves with its segment of the body, so that its skin deforms as in its own file. Fingers rotate as in
    the take; other extra joints of a capture are left out. Joints and skin rest as in the original file, and joints
    above the hips stay there; the body moves at ``placement`` on the stage. Files with Y up have other joint axes:
    these are chosen so that a file with ``suffix`` has those of the original file.
    """
    character, adapted = take.character, take.adapted
    assert character is not None
    assert adapted is not None
    mesh, body, rig = character.skin, adapted.morphology, character.skin.rig
    assert rig is not None
    positions, rotations = bound_joints(mesh, character.build, body)
    if suffix in _Y_UP:
        rotations = rotations @ _WORLD_TO_FILE
    moving = rig.segments != UNMOVED_JOINT
    segments = rig.segments[moving]
    proximal = np.array(body.layout.proximal_points())
    then, axes = bound_pose(mesh, body)
    turned = adapted.rotations[:] @ np.swapaxes(axes, 1, 2)
    frames, count = adapted.frame_count, len(rig.names)
    world_turns, world_places = np.empty((frames, count, 3, 3)), np.empty((frames, count, 3))
    at_rest, axes_at_rest = rig.file.to_file(positions, rotations) if rig.file else (positions, rotations)
    world_turns[:], world_places[:] = axes_at_rest, at_rest
    world_turns[:, moving] = turned[:, segments] @ rotations[moving]
    away = positions[moving] - then[proximal[segments]]
    world_places[:, moving] = adapted.positions[:][:, proximal[segments]] + np.einsum(
        "fjab,jb->fja", turned[:, segments], away
    )
    parents = rig.parents.astype(np.int64)
    body_map = rig_body_map(rig, body.layout.spine_count)
    still = still_skeleton(rig, positions)
    drive = finger_drive(still, body_map, mesh, body) if take.fingers and not take.fingers.is_at_rest else None
    fingers = drive.rotations(take.fingers) if drive and take.fingers else {}
    for joint in below_hands(still, body_map) if fingers else ():
        parent = parents[joint]
        above = world_turns[:, parent] @ rotations[parent].T
        hand_turns = turned[:, rig.segments[joint]]
        world_turns[:, joint] = (hand_turns @ fingers[joint] if joint in fingers else above) @ rotations[joint]
        world_places[:, joint] = world_places[:, parent] + above @ (positions[joint] - positions[parent])
    world_turns[:, moving] = placement.rotation @ world_turns[:, moving]
    world_places[:, moving] = placement.to_stage(world_places[:, moving])
    local_turns, local_places = _local(parents, world_turns, world_places)
    rest_turns, rest_places = (each[0] for each in _local(parents, axes_at_rest[None], at_rest[None]))
    skin = fit_skin(mesh if fingers else character.shown_skin, character.build, body)
    vertices, normals = skin.vertices.astype(np.float64), skin.normals.astype(np.float64)
    if rig.file is not None:
        vertices, _ = rig.file.to_file(vertices, np.eye(3))
        normals = normals @ rig.file.rotation
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
            vertices,
            normals,
            skin.triangles,
            rig.joints,
            rig.weights.astype(np.float64),
            at_rest,
            axes_at_rest,
            skin.appearance,
            rig.file.scales if rig.file and suffix in _SUFFIXES.get(rig.file.format, ()) else None,
            rig.file.bones if rig.file else None,
        ),
        place=Placement(),
        rest_rotations=from_matrix(rest_turns),
    )


def _local(parents: NDArray[np.int64], turns: FloatArray, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Local rotations (F, J, 3, 3) and translations (F, J, 3) in the parents' axes, of joints given in the world."""
    above = np.maximum(parents, 0)
    is_root = parents < 0
    carriers = np.where(is_root[:, None, None], np.eye(3), np.swapaxes(turns[:, above], -1, -2))
    moved = positions - np.where(is_root[:, None], 0.0, positions[:, above])
    return carriers @ turns, np.einsum("fjab,fjb->fja", carriers, moved)
