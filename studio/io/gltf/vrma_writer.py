"""Writer of a take as VRM animation 1.0: the bones of a humanoid that rests in a T-pose, and the travel of its hips."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.errors import StudioError
from studio.core.rigs.zero_pose import t_pose, with_zero_pose
from studio.core.rotations import IDENTITY_QUATERNION, multiply, rotate
from studio.io.export import Take
from studio.io.gltf.take_writer import GltfScene, write_scene
from studio.io.gltf.vrm import humanoid_joints
from studio.io.guessing import SOLE_THICKNESS_METRES
from studio.io.registry import Progress

FloatArray = NDArray[np.float64]

VRMA_EXTENSION = "VRMC_vrm_animation"
_POSED = 0.3
"""The share of the work after which the humanoid has its poses."""


def write_take(path: Path, take: Take, progress: Progress) -> None:
    """Write the rotations of all bones and the translation of the hips; metres, Y up, facing +Z, one key per frame.

    Parts that a humanoid of VRM lacks (props, twist bones, changing bone lengths) are left out; rotations of joints
    between two bones are added to the lower one. Raises StudioError if the body has no spine or head.
    """
    progress(0.0, f"Writing {path.name}")
    capture, bones = humanoid_capture(take)
    moving = Take(capture)
    scene = GltfScene(take.name, take.frame_rate, take.poses.frame_count)
    scene.add_motion(moving, lambda share: progress(_POSED + (0.8 - _POSED) * share, f"Writing {path.name}"))
    nodes = {bone: {"node": node} for node, bone in enumerate(bones)}
    scene.extensions[VRMA_EXTENSION] = {"specVersion": "1.0", "humanoid": {"humanBones": nodes}}
    write_scene(path, scene, progress)


def humanoid_capture(take: Take) -> tuple[Capture, list[str]]:
    """Motion on the joints of a humanoid alone, and the bone of VRM 1 that each joint is. Raises StudioError.

    At rest it stands in a T-pose on the ground. World rotations, and the positions of the hips, stay those of ``take``;
    bones keep the length that they have at rest.
    """
    if take.capture.body_map is None:
        raise StudioError(f"'{take.name}' has no body map, so it cannot be a VRM animation. Complete it first.")
    in_t_pose = take.character is not None and take.rest_rotations is None
    capture = take.capture if in_t_pose else with_zero_pose(take.capture, t_pose(take.capture))
    bones = humanoid_joints(capture.skeleton, take.capture.body_map)
    joints = list(bones.values())
    skeleton, poses = capture.skeleton, capture.poses
    still = rest_poses(skeleton, np.tile(IDENTITY_QUATERNION, (skeleton.joint_count, 1)))
    places = joint_world(skeleton, still)[0][0]
    moving = places[~skeleton.end_sites]
    offsets = places[joints] - [0.0, 0.0, moving[:, 2].min() - SOLE_THICKNESS_METRES]
    offsets[0, :2] = 0.0
    rotations = np.empty((poses.frame_count, len(joints), 4))
    parents = np.full(len(joints), -1)
    for index, joint in enumerate(joints):
        rotations[:, index] = poses.local_rotations[:, joint]
        above = int(skeleton.parents[joint])
        while above >= 0 and above not in joints:
            rotations[:, index] = multiply(poses.local_rotations[:, above], rotations[:, index])
            above = int(skeleton.parents[above])
        if above >= 0:
            parents[index] = joints.index(above)
            offsets[index] = places[joint] - places[above]
    travel = poses.local_translations[:, joints[0]]
    for above in reversed(skeleton.path(0, int(joints[0]))[:-1]):
        travel = poses.local_translations[:, above] + rotate(poses.local_rotations[:, above], travel)
    translations = np.tile(offsets, (poses.frame_count, 1, 1))
    translations[:, 0] = travel
    names = tuple(skeleton.names[joint] for joint in joints)
    humanoid = replace(
        capture,
        skeleton=Skeleton(names, parents, offsets, np.zeros(len(joints), dtype=bool)),
        poses=PoseSequence(rotations, translations),
        body_map=None,
        reference_rotations=np.tile(IDENTITY_QUATERNION, (len(joints), 1)),
    )
    return humanoid, list(bones)
