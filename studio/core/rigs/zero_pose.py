"""Change of the zero pose of a motion: the pose of its joints if every angle in a file is 0."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture
from studio.core.normalized.normalize import normalize_capture
from studio.core.rigs.character_skeleton import t_pose_rotations
from studio.core.rotations import from_matrix, inverse, multiply, to_matrix

FloatArray = NDArray[np.float64]


def with_zero_pose(capture: Capture, rotations: FloatArray) -> Capture:
    """Copy for joints whose axes are redefined as the world's at the world ``rotations`` (J, 3, 3) of the body.

    World rotations become W' = W R^T, so local ones become R_p L R^T and translations R_p t, with p the parent. The
    ends of bones are rotated with their bone.
    """
    skeleton = capture.skeleton
    turns = from_matrix(rotations)
    for joint in np.flatnonzero(skeleton.end_sites & (skeleton.parents >= 0)):
        turns[joint] = turns[skeleton.parents[joint]]
    carriers = np.where((skeleton.parents >= 0)[:, None], turns[np.maximum(skeleton.parents, 0)], [0.0, 0.0, 0.0, 1.0])
    matrices = to_matrix(carriers)

    def turned(local: FloatArray) -> FloatArray:
        return multiply(multiply(carriers, local), inverse(turns))

    poses = PoseSequence(
        turned(capture.poses.local_rotations),
        np.einsum("jik,fjk->fji", matrices, capture.poses.local_translations),
    )
    return replace(
        capture,
        skeleton=replace(skeleton, offsets=np.einsum("jik,jk->ji", matrices, skeleton.offsets)),
        poses=poses,
        reference_rotations=turned(capture.reference_rotations),
    )


def t_pose(capture: Capture) -> FloatArray:
    """World rotations (J, 3, 3) of a human capture's joints with its body in a T-pose facing +X.

    Joints that belong to no body part are rotated with their parent.
    """
    actor = normalize_capture(capture)[1]
    targets = t_pose_rotations(actor.morphology) @ np.swapaxes(actor.alignments, 1, 2)
    segment_of = {int(joint): segment for segment, joint in enumerate(actor.segment_joints) if joint >= 0}
    rotations = np.tile(np.eye(3), (capture.skeleton.joint_count, 1, 1))
    for joint, parent in enumerate(capture.skeleton.parents.tolist()):
        if joint in segment_of:
            rotations[joint] = targets[segment_of[joint]]
        elif parent >= 0:
            rotations[joint] = rotations[parent]
    return rotations
