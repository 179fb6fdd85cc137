"""Captures whose root joint is far from the body that hangs from it, as some libraries of motions have it."""

from dataclasses import replace

import numpy as np

from studio.core.body.humanoid import BodyMap
from studio.core.body.pose import PoseSequence
from studio.core.body.skeleton import Skeleton
from studio.core.captures.capture import Capture
from studio.core.rotations import IDENTITY_QUATERNION


def with_far_root(capture: Capture, away: np.ndarray) -> Capture:
    """The capture with one more joint above its root, ``away`` (3,) metres from it, which stays where it is."""
    skeleton, poses, body_map = capture.skeleton, capture.poses, capture.body_map
    assert body_map is not None
    offsets = np.concatenate([[away], skeleton.offsets])
    offsets[1] -= away
    parents = np.concatenate([[-1], skeleton.parents + 1])
    grown = Skeleton(("origin", *skeleton.names), parents, offsets, np.concatenate([[False], skeleton.end_sites]))
    still = np.tile(IDENTITY_QUATERNION, (poses.frame_count, 1, 1))
    travels = np.concatenate([np.zeros((poses.frame_count, 1, 3)) + away, poses.local_translations], axis=1)
    travels[:, 1] -= away
    return replace(
        capture,
        skeleton=grown,
        poses=PoseSequence(np.concatenate([still, poses.local_rotations], axis=1), travels),
        body_map=BodyMap(
            {part: joint + 1 for part, joint in body_map.parts.items()}, tuple(np.array(body_map.spine) + 1)
        ),
        reference_rotations=np.concatenate([still[0], capture.reference_rotations]),
    )
