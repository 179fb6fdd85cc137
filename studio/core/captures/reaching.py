"""Frame of the farthest reach of a capture, which is taken as the moment of a blow."""

import numpy as np

from studio.core.body.canonical import BodyPart
from studio.core.body.kinematics import joint_positions
from studio.core.body.pose import PoseSequence
from studio.core.captures.capture import Capture

LIMB_ENDS = (BodyPart.LEFT_HAND, BodyPart.RIGHT_HAND, BodyPart.LEFT_FOOT, BodyPart.RIGHT_FOOT)


def farthest_reach_frame(capture: Capture, first: int, last: int) -> int:
    """Frame from ``first`` to ``last`` in which a wrist or an ankle is horizontally farthest from the hips.

    It is ``first`` for a capture without a body map.
    """
    if capture.body_map is None:
        return first
    frames = slice(first, last + 1)
    poses = PoseSequence(capture.poses.local_rotations[frames], capture.poses.local_translations[frames])
    positions = joint_positions(capture.skeleton, poses)[..., :2]
    ends = positions[:, [capture.body_map[part] for part in LIMB_ENDS]]
    away = np.linalg.norm(ends - positions[:, capture.body_map.spine[:1]], axis=2)
    return first + int(away.max(axis=1).argmax())
