"""Forward kinematics: where the joints of posed skeletons stand in the world."""

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import StudioError
from studio.core.kernels import forward_kinematics
from studio.core.pose import PoseSequence
from studio.core.skeleton import Skeleton

FloatArray = NDArray[np.float64]


def joint_world(skeleton: Skeleton, poses: PoseSequence) -> tuple[FloatArray, FloatArray]:
    """World positions (F, J, 3) in metres and rotations (F, J, 3, 3) of every joint in every frame."""
    if poses.joint_count != skeleton.joint_count:
        raise StudioError(f"Poses of {poses.joint_count} joints do not fit a skeleton of {skeleton.joint_count}.")
    shape = (poses.frame_count, poses.joint_count, 3)
    positions, rotations = np.empty(shape), np.empty((*shape, 3))
    forward_kinematics.joint_world(
        skeleton.parents, poses.local_rotations, poses.local_translations, positions, rotations
    )
    return positions, rotations


def rest_poses(skeleton: Skeleton, local_rotations: FloatArray) -> PoseSequence:
    """One frame with the given local rotations (J, 4) and every joint at its offset."""
    return PoseSequence(np.asarray(local_rotations)[None], skeleton.offsets[None])
