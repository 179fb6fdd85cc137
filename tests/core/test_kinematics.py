"""Forward kinematics: the kernel against a plain twin, and poses that can be told by eye."""

import numpy as np
import pytest

from studio.core.body.kinematics import joint_world, rest_poses
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.rotations import IDENTITY_QUATERNION, from_euler, to_matrix


def _tree(joints: int, seed: int = 0) -> Skeleton:
    random = np.random.default_rng(seed)
    parents = np.array([-1, *(random.integers(0, joint) for joint in range(1, joints))])
    names = tuple(f"joint{joint}" for joint in range(joints))
    return Skeleton(names, parents, random.normal(size=(joints, 3)), np.zeros(joints, dtype=bool))


def _joint_world_twin(skeleton: Skeleton, poses: PoseSequence) -> tuple[np.ndarray, np.ndarray]:
    rotations = to_matrix(poses.local_rotations)
    positions = np.array(poses.local_translations)
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            carried = np.einsum("fij,fj->fi", rotations[:, parent], poses.local_translations[:, joint])
            positions[:, joint] = positions[:, parent] + carried
            rotations[:, joint] = rotations[:, parent] @ rotations[:, joint]
    return positions, rotations


def test_the_kernel_agrees_with_its_twin() -> None:
    skeleton, random = _tree(20), np.random.default_rng(1)
    poses = PoseSequence(random.normal(size=(9, 20, 4)), random.normal(size=(9, 20, 3)))
    for result, expected in zip(joint_world(skeleton, poses), _joint_world_twin(skeleton, poses), strict=True):
        assert np.allclose(result, expected, atol=1e-12)


def test_a_bent_elbow_puts_the_hand_where_it_should_be() -> None:
    offsets = np.array([[0.0, 0, 1], [0.3, 0, 0], [0.2, 0, 0]])
    arm = Skeleton(("shoulder", "elbow", "hand"), np.array([-1, 0, 1]), offsets, np.zeros(3, dtype=bool))
    quarter = from_euler("Z", np.array([np.pi / 2]))
    positions, rotations = joint_world(
        arm, rest_poses(arm, np.stack([IDENTITY_QUATERNION, quarter, IDENTITY_QUATERNION]))
    )
    assert np.allclose(positions[0], [[0, 0, 1], [0.3, 0, 1], [0.3, 0.2, 1]])
    assert np.allclose(rotations[0, 2] @ [1, 0, 0], [0, 1, 0])


def test_poses_of_another_skeleton_are_refused() -> None:
    with pytest.raises(StudioError, match="Poses of 3 joints do not fit a skeleton of 4"):
        joint_world(_tree(4), rest_poses(_tree(3), np.tile(IDENTITY_QUATERNION, (3, 1))))
