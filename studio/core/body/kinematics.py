"""Forward kinematics: world positions and rotations of the joints of posed skeletons."""

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.errors import StudioError
from studio.core.threads import do_over_frames

FloatArray = NDArray[np.float64]


def joint_world(skeleton: Skeleton, poses: PoseSequence) -> tuple[FloatArray, FloatArray]:
    """World positions (F, J, 3) in metres and rotations (F, J, 3, 3) of every joint in every frame."""
    shape = (poses.frame_count, poses.joint_count, 3)
    positions, rotations = np.empty(shape), np.empty((*shape, 3))
    do_over_frames(lambda run: _carry(skeleton, poses, run, positions[run], rotations[run]), poses.frame_count)
    return positions, rotations


def joint_world_in(skeleton: Skeleton, poses: PoseSequence, run: slice) -> tuple[FloatArray, FloatArray]:
    """World positions (N, J, 3) in metres and rotations (N, J, 3, 3) of every joint in the frames of ``run``.

    It saves memory, since the rotations of all frames of a long capture need much.
    """
    shape = poses.local_translations[run].shape
    positions, rotations = np.empty(shape), np.empty((*shape, 3))
    _carry(skeleton, poses, run, positions, rotations)
    return positions, rotations


def joint_positions(skeleton: Skeleton, poses: PoseSequence) -> FloatArray:
    """World positions (F, J, 3) in metres of every joint in every frame."""
    positions = np.empty((poses.frame_count, poses.joint_count, 3))

    def carry(run: slice) -> None:
        positions[run] = joint_world_in(skeleton, poses, run)[0]

    do_over_frames(carry, poses.frame_count)
    return positions


def _carry(
    skeleton: Skeleton, poses: PoseSequence, run: slice, out_positions: FloatArray, out_rotations: FloatArray
) -> None:
    from studio.core.kernels.body import forward_kinematics  # late: it loads numba

    if poses.joint_count != skeleton.joint_count:
        raise StudioError(f"Poses of {poses.joint_count} joints do not fit a skeleton of {skeleton.joint_count}.")
    turns, places = poses.local_rotations[run], poses.local_translations[run]
    forward_kinematics.joint_world(skeleton.parents, turns, places, out_positions, out_rotations)


def rest_poses(skeleton: Skeleton, local_rotations: FloatArray) -> PoseSequence:
    """Pose of one frame with the local rotations (J, 4) and every joint at its offset."""
    return PoseSequence(np.asarray(local_rotations)[None], skeleton.offsets[None])
